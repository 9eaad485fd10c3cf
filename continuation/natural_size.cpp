#include "continuation/natural_size.hpp"

#include <algorithm>
#include <cmath>

namespace whirl::continuation {
namespace {

constexpr int most_coordinates = 8;  // looked at for the least size: of a large system some, evenly
constexpr int most_decades = 30;     // from the first guess, up or down
constexpr double decade = 10.0;
constexpr double still_seen = 1e-7;  // of |x|: what is added to x and keeps half its digits

// Sizes of the entries of r_x, the largest at both ends and in the middle of the range and at u itself.
Matrix linear_sizes(const Problem& f, In u, double lower, double upper) {
  const int n = f.size(), last = static_cast<int>(u.size()) - 1;
  Matrix j(n, u.size()), sizes = Matrix::Zero(n, n);
  Vector at = u;
  for (const double p : {u[last], lower, 0.5 * (lower + upper), upper}) {
    at[last] = p;
    f.jacobian(at, j);
    if (j.allFinite()) sizes = sizes.cwiseMax(j.leftCols(n).cwiseAbs());
  }
  return sizes;
}

class CurvedPart {
 public:
  CurvedPart(const Problem& f, In u, double lower, double upper)
      : f_(f), u_(u), sizes_(linear_sizes(f, u, lower, upper)), r_(f.size()), r0_(f.size()), j_(f.size(), u.size()) {
    f.linearise(u, r0_, j_);
  }
  // Up or down by decades until what is not linear becomes the larger part; 0 if it never does.
  double size(int i, double s) {
    int row = i;
    if (!(sizes_(i, i) > 0.0) && !(sizes_.col(i).maxCoeff(&row) > 0.0)) return 0.0;
    return search(s, [&](double at) { return is_curved(i, row, at); });
  }
  // The same along a direction of all coordinates, where products of two make up what is not linear.
  double size_of_products(double s) {
    Vector direction(f_.size());
    for (int i = 0; i < f_.size(); ++i) direction[i] = 1.0 + 0.3 * std::cos(1.7 * i);  // no symmetry of a model is likely to be orthogonal to it
    const Vector linear = sizes_ * direction, slope = j_.leftCols(f_.size()) * direction;
    if (!(linear.maxCoeff() > 0.0)) return 0.0;
    return search(s, [&](double at) { return is_curved_along(direction, linear, slope, at); });
  }

 private:
  template <class Curved>
  double search(double s, const Curved& is_curved_at) {
    const bool curved = is_curved_at(s);
    for (int k = 0; k < most_decades; ++k) {
      const double next = curved ? s / decade : s * decade;
      if (is_curved_at(next) != curved) return !curved || s > still_seen * u_.head(f_.size()).lpNorm<Eigen::Infinity>() ? s : 0.0;
      s = next;
    }
    return 0.0;
  }
  // In some row.
  bool is_curved_along(const Vector& direction, const Vector& linear, const Vector& slope, double s) {
    Vector at = u_;
    at.head(f_.size()) += s * direction;
    f_.residual(at, r_);
    const Vector rest = (r_ - r0_ - s * slope).cwiseAbs();
    return !rest.allFinite() || ((rest - s * linear).array() > 0.0 && linear.array() > 0.0).any();
  }
  // Where r is not finite it is.
  bool is_curved(int i, int row, double s) {
    Vector at = u_;
    at[i] += s;
    f_.residual(at, r_);
    const double rest = std::abs(r_[row] - r0_[row] - s * j_(row, i));
    return !std::isfinite(rest) || rest > s * sizes_(row, i);
  }

  const Problem& f_;
  Vector u_;
  Matrix sizes_;
  Vector r_, r0_;
  Matrix j_;
};

}  // namespace

Vector natural_sizes(const Problem& f, In u, double lower, double upper) {
  CurvedPart part(f, u, lower, upper);
  Vector sizes(f.size());
  for (int i = 0; i < f.size(); ++i) {
    const double s = part.size(i, u[i] != 0.0 ? std::abs(u[i]) : 1.0);
    sizes[i] = s > 0.0 ? s : 1.0;
  }
  return sizes;
}

double natural_size(const Problem& f, In u, double lower, double upper) {
  const int n = f.size();
  CurvedPart part(f, u, lower, upper);
  const double state = u.head(n).lpNorm<Eigen::Infinity>();
  double least = 0.0;
  for (int k = 0; k < std::min(n, most_coordinates); ++k) {
    const int i = n <= most_coordinates ? k : k * n / most_coordinates;
    const double s = part.size(i, least > 0.0 ? least : state > 0.0 ? state : 1.0);
    if (s > 0.0) least = least > 0.0 ? std::min(least, s) : s;
  }
  if (!(least > 0.0)) least = part.size_of_products(state > 0.0 ? state : 1.0);
  return least > 0.0 ? least : 1.0;
}

}  // namespace whirl::continuation
