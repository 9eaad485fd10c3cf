#include "continuation/membership.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "continuation/curve.hpp"

namespace whirl::continuation {
namespace {

double x_distance(In a, In b) { return (a.head(a.size() - 1) - b.head(b.size() - 1)).norm(); }

class Membership {
 public:
  Membership(const Problem& f, const Branch& branch, const BranchShape& shape, In u, const MembershipOptions& o)
      : f_(f), branch_(branch), shape_(shape), u_(u), o_(o), x_scale_(std::max({shape.size, u.head(f.size()).norm(), o.least_size})) {
    if (x_scale_ == 0.0) x_scale_ = 1.0;
  }

  bool holds() {
    const auto is_u = [this](In other) { return length(x_distance(u_, other), u_[f_.size()] - other[f_.size()]) < o_.same; };
    if (branch_.points() > 0 && (is_u(branch_.u(0)) || is_u(branch_.u(branch_.points() - 1)))) return true;
    if (std::any_of(branch_.special.begin(), branch_.special.end(), [&](const SpecialPoint& s) { return is_u(s.u); })) return true;
    // A symmetry that the branch does not keep holds at such points only.
    const auto kept = active_reflections(f_, u_.head(f_.size()));
    if (!std::includes(branch_.active_reflections.begin(), branch_.active_reflections.end(), kept.begin(), kept.end())) return false;
    for (int i = 0; i + 1 < branch_.points(); ++i)
      if (beside_chord(i) && meets_curve(i)) return true;
    return false;
  }

 private:
  double length(double x, double p) const { return std::hypot(x / x_scale_, p / o_.range); }

  // Is u near enough to the chord from point i to the next that the arc may pass it?
  bool beside_chord(int i) {
    const int n = f_.size();
    const double from = branch_.parameter(i), to = branch_.parameter(i + 1), p = u_[n];
    chord_ = length(shape_.chord_x[static_cast<std::size_t>(i)], to - from);
    const double reach = o_.reach * chord_ + o_.same + o_.accuracy / x_scale_;
    if (p < std::min(from, to) - reach * o_.range || p > std::max(from, to) + reach * o_.range || chord_ == 0.0) return false;
    const auto a = branch_.u(i), b = branch_.u(i + 1);
    const double along = (u_ - a).head(n).dot((b - a).head(n)) / (x_scale_ * x_scale_) + (p - from) * (to - from) / (o_.range * o_.range);
    part_ = along / (chord_ * chord_);
    if (part_ * chord_ < -o_.beyond || (part_ - 1.0) * chord_ > o_.beyond) return false;
    return length((u_ - a - part_ * (b - a)).head(n).norm(), p - from - part_ * (to - from)) <= reach;
  }

  // Newton from the cubic through both ends, in the plane through u: onto this curve and no other.
  bool meets_curve(int i) {
    const int n = f_.size();
    if (!curve_) {
      curve_ = std::make_unique<Curve>(f_, make_blocks(f_, branch_.active_reflections), CurveOptions{});
      curve_->set_scales(x_scale_, o_.range);
    }
    const auto end = [&](int k, Sample& s) {
      s.u = branch_.u(k);
      s.tangent = branch_.tangent(k) / curve_->length(branch_.tangent(k));
    };
    Sample a, b, there;
    end(i, a);
    end(i + 1, b);
    const Vector normal = b.u - a.u;
    curve_->guess(a, b, part_, there);
    if (curve_->length(there.u - u_) > o_.cubic * chord_ + o_.same + o_.accuracy / x_scale_) return false;
    if (!curve_->correct(there.u, normal, there.u).ok) return false;
    const Vector off = there.u - u_;
    if (curve_->length(off) < o_.same) return true;
    constexpr double most = 3.0;  // a single step finds about all of an error
    return std::abs(off[n]) < o_.same * o_.range && off.head(n).norm() < most * o_.accuracy;
  }

  const Problem& f_;
  const Branch& branch_;
  const BranchShape& shape_;
  const Vector u_;
  const MembershipOptions& o_;
  double x_scale_, chord_ = 0.0, part_ = 0.0;
  std::unique_ptr<Curve> curve_;
};

}  // namespace

double newton_error(const Problem& f, In u) {
  constexpr double matters = 1e-7, contracts = 0.1;
  const int n = f.size();
  Vector at = u, r(n), step(n);
  Matrix j(n, n + f.parameters());
  DenseLu lu(n);
  double first = 0.0;
  for (int i = 0; i < 2; ++i) {
    f.linearise(at, r, j);
    lu.compute(j.leftCols(n));
    lu.solve(r, step);
    if (!step.allFinite()) return 0.0;
    if (i == 1) break;
    first = step.norm();
    if (first < matters * u.head(n).norm()) return 0.0;
    at.head(n) -= step;
  }
  return step.norm() < contracts * first ? first : 0.0;
}

std::vector<Vector> reflection_products(const Problem& f) {
  std::vector<Vector> all = {Vector::Ones(f.size())};
  for (const auto& r : f.reflections())
    for (std::size_t k = 0, count = all.size(); k < count; ++k) all.push_back(all[k].cwiseProduct(r.signs));
  return all;
}

BranchShape::BranchShape(const Branch& branch) : size(0.0) {
  for (int i = 0; i < branch.points(); ++i) {
    size = std::max(size, branch.u(i).head(branch.size()).norm());
    if (i > 0) chord_x.push_back(x_distance(branch.u(i - 1), branch.u(i)));
  }
}

bool lies_on(const Problem& f, const Branch& branch, const BranchShape& shape, In u, const MembershipOptions& options) {
  return Membership(f, branch, shape, u, options).holds();
}

}  // namespace whirl::continuation
