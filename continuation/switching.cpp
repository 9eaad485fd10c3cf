#include "continuation/switching.hpp"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "continuation/multiple_point.hpp"
#include "core/problem_in_units.hpp"

namespace whirl::continuation {
namespace {

constexpr int largest_searched = 64;  // unknowns; the search costs some hundred factorisations
constexpr int largest_kernel = 5;     // dimensions: 5^5 starts

// ---- several eigenvalues zero at once -----------------------------------------------------------------------------------------------------------

// The size of |x| at which terms of second or third order in x match those of first order times the range of the parameter: that of the branches
// that leave along the kernel.
double natural_size(const Problem& f, const SpecialPoint& point, const Matrix& kernel, const DepartureOptions& o) {
  const int n = f.size();
  Matrix h(n, n + 1);
  Vector t(n);
  double least = 0.0;
  for (Eigen::Index k = 0; k < kernel.cols(); ++k) {
    Vector v = kernel.col(k);
    v[n] = 0.0;
    if (v.norm() < 0.1) continue;
    f.second(point.u, v.normalized(), h);
    const double linear = h.col(n).norm() * o.range, quadratic = 0.5 * (h.leftCols(n) * v.head(n).normalized()).norm();
    double size = quadratic > 0.0 ? linear / quadratic : 0.0;
    if (f.derivatives() >= 3) {
      f.third(point.u, v.normalized(), v.normalized(), v.normalized(), t);
      const double cubic = t.norm() / 6.0, by_cubic = cubic > 0.0 ? std::sqrt(linear / cubic) : 0.0;
      if (by_cubic > 0.0) size = size > 0.0 ? std::min(size, by_cubic) : by_cubic;
    }
    if (size > 0.0 && std::isfinite(size)) least = least > 0.0 ? std::min(least, size) : size;
  }
  return least > 0.0 ? least : o.size;
}

// Search on the sphere |z| = radius, z = ((x - x0) / size, (p - p0) / range), about a point where [r_x r_p] has a kernel of three dimensions or more.
class SphereSearch {
 public:
  SphereSearch(const Problem& f, const SpecialPoint& point, const Matrix& kernel, const DepartureOptions& o)
      : f_(f), point_(point), n_(f.size()), scale_(Vector::Constant(n_ + 1, natural_size(f, point, kernel, o))), rows_(n_) {
    scale_[n_] = o.range;
    const Matrix scaled = scale_.cwiseInverse().asDiagonal() * kernel;
    kernel_ = Eigen::JacobiSVD<Matrix>(scaled, Eigen::ComputeThinU).matrixU();
    const double usual = usual_jacobian(f, point.u);
    rows_.setConstant(usual > 0.0 ? 1.0 / usual : 1.0);
    for (const auto& g : o.symmetries)
      if ((g.apply(point.u) - point.u).cwiseQuotient(scale_).norm() < same) kept_.push_back(g);
  }

  std::vector<Departure> run() {
    const Vector along = point_.tangent.cwiseQuotient(scale_).normalized();
    for (const double sign : {1.0, -1.0}) look(sign * along);  // the branch it was found on
    const std::size_t known = met_.size();
    for (const Vector& z : axes()) look(z);
    for (const Vector& z : grid()) look(z);
    std::vector<Departure> all;
    for (std::size_t i = known; i < met_.size(); ++i) all.push_back({met_[i].cwiseProduct(scale_).normalized(), false});
    return all;
  }
  int starts() const { return starts_; }

 private:
  static constexpr double radius = 0.02;  // higher terms part what the lowest leaves together, and directions are those at the point to as much
  static constexpr double same = 1e-2;    // directions nearer than this are one
  static constexpr std::size_t most_pairs = 3000;  // of symmetries

  // Newton on r = 0, |z| = radius.
  bool solve(Vector& z) const {
    Matrix full(n_ + 1, n_ + 1), j(n_, n_ + 1);
    Vector r(n_), rhs(n_ + 1);
    for (int i = 0; i < 80; ++i) {
      f_.linearise(point_.u + z.cwiseProduct(scale_), r, j);
      rhs << -r.cwiseProduct(rows_), 0.5 * (radius * radius - z.squaredNorm()) / radius;
      full << rows_.asDiagonal() * j * scale_.asDiagonal(), z.transpose() / radius;
      Vector step = full.fullPivLu().solve(rhs);
      if (!step.allFinite()) return false;
      if (step.norm() > 0.5 * radius) step *= 0.5 * radius / step.norm();
      z += step;
      if (step.norm() < 1e-9 * radius) return true;
    }
    return false;
  }

  void look(const Vector& direction) {
    ++starts_;
    Vector z = radius * direction;
    if (!solve(z)) return;
    z.normalize();
    const auto is_z = [&](const Vector& other) { return (other - z).norm() < same; };
    const auto image_is_z = [&](const SignedPermutation& g) {
      return std::any_of(met_.begin(), met_.end(), [&](const Vector& m) { return is_z(g.apply(m)); });
    };
    if (std::any_of(met_.begin(), met_.end(), is_z) || std::any_of(kept_.begin(), kept_.end(), image_is_z)) return;
    met_.push_back(z);
  }

  // Every pattern of -2 .. 2 in the coordinates of the kernel.
  std::vector<Vector> grid() const {
    const auto d = kernel_.cols();
    int patterns = 1;
    for (Eigen::Index k = 0; k < d; ++k) patterns *= 5;
    std::vector<Vector> all;
    for (int pattern = 0; pattern < patterns; ++pattern) {
      Vector c(d);
      for (Eigen::Index k = 0, rest = pattern; k < d; ++k, rest /= 5) c[k] = static_cast<double>(rest % 5) - 2.0;
      if (c.norm() > 0.0) all.emplace_back(kernel_ * c.normalized());
    }
    return all;
  }

  // What a symmetry, or two, leave of the kernel at fixed parameter: a line of it always carries a branch (the equivariant branching lemma), a plane
  // is searched all round.
  std::vector<Vector> axes() const {
    const Matrix state = at_fixed_parameter();
    std::vector<Vector> all;
    const auto add = [&](const Matrix& fixed) {
      if (fixed.cols() == 1)
        for (const double sign : {1.0, -1.0}) all.push_back(sign * fixed.col(0));
      constexpr int around = 16;
      for (int k = 0; fixed.cols() == 2 && k < around; ++k) {
        const double angle = 2.0 * std::numbers::pi * k / around;
        all.push_back(std::cos(angle) * fixed.col(0) + std::sin(angle) * fixed.col(1));
      }
    };
    std::vector<Matrix> moved;  // G - 1 on the kernel
    for (const auto& g : kept_) {
      Matrix image(n_ + 1, state.cols());
      for (Eigen::Index k = 0; k < state.cols(); ++k) image.col(k) = g.apply(state.col(k));
      moved.emplace_back(state.transpose() * image - Matrix::Identity(state.cols(), state.cols()));
    }
    std::size_t pairs = 0;
    for (std::size_t i = 0; i < moved.size(); ++i)
      for (std::size_t k = i; k < moved.size() && ++pairs <= most_pairs; ++k) {
        Matrix both(2 * state.cols(), state.cols());
        both << moved[i], moved[k];
        const Eigen::JacobiSVD<Matrix> svd(both, Eigen::ComputeFullV);
        const auto open = (svd.singularValues().array() < 1e-6).count();
        if (open == 1 || open == 2) add(state * svd.matrixV().rightCols(open));
      }
    return distinct(std::move(all));
  }

  // An orthonormal basis of the part of the kernel without the parameter.
  Matrix at_fixed_parameter() const {
    const Eigen::JacobiSVD<Matrix> svd(kernel_.row(n_), Eigen::ComputeFullV);
    if (svd.singularValues()[0] < 1e-9) return kernel_;
    return kernel_ * svd.matrixV().rightCols(kernel_.cols() - 1);
  }

  static std::vector<Vector> distinct(std::vector<Vector> all) {
    std::vector<Vector> kept;
    for (auto& z : all)
      if (std::none_of(kept.begin(), kept.end(), [&](const Vector& k) { return (k - z).norm() < same; })) kept.push_back(std::move(z));
    return kept;
  }

  const Problem& f_;
  const SpecialPoint& point_;
  int n_;
  Vector scale_, rows_;
  Matrix kernel_;                        // orthonormal in z
  std::vector<SignedPermutation> kept_;  // symmetries that leave the point in place
  std::vector<Vector> met_;              // directions, unit vectors in z
  int starts_ = 0;
};

// Basis of the kernel of [r_x r_p].
Matrix kernel_at(const Problem& f, In u) {
  const int n = f.size();
  Matrix j(n, n + 1);
  f.jacobian(u, j);
  const double usual = usual_jacobian(f, u);
  if (!j.allFinite() || !(usual > 0.0)) return {};
  const Eigen::JacobiSVD<Matrix> svd(j, Eigen::ComputeFullV);
  const auto rank = (svd.singularValues().array() > 1e-6 * usual).count();
  return svd.matrixV().rightCols(n + 1 - rank);
}

// ---- one eigenvalue zero ------------------------------------------------------------------------------------------------------------------------

// The two directions of the algebraic branching equation, that of the branch itself first. Empty if they are not two real ones.
std::vector<Vector> crossing_directions(const Problem& f, const SpecialPoint& point) {
  const int n = f.size();
  if (f.derivatives() < 2) return {};
  Matrix j(n, n + 1), h(n, n + 1);
  f.jacobian(point.u, j);
  const Eigen::BDCSVD<Matrix> svd(j, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Matrix phi = svd.matrixV().rightCols(2);
  const Vector w = svd.matrixU().col(n - 1);
  Eigen::Matrix2d q;
  for (int i = 0; i < 2; ++i) {
    f.second(point.u, phi.col(i), h);
    for (int k = 0; k < 2; ++k) q(i, k) = w.dot(h * phi.col(k));
  }
  // q00 a^2 + 2 q01 a b + q11 b^2 = 0, two real directions if the discriminant is positive
  const double d = q(0, 1) * q(0, 1) - q(0, 0) * q(1, 1), scale = q.cwiseAbs().maxCoeff();
  if (!(d > 1e-14 * scale * scale)) return {};
  std::vector<Vector> directions;
  const double root = std::sqrt(d);
  for (const double sign : {1.0, -1.0}) {
    // (a, b) from the larger pivot
    const double t = -q(0, 1) + sign * root;
    Eigen::Vector2d ab = std::abs(q(0, 0)) > std::abs(q(1, 1)) ? Eigen::Vector2d(t, q(0, 0)) : Eigen::Vector2d(q(1, 1), t);
    if (ab.norm() < 1e-12 * scale) ab = std::abs(q(0, 0)) > std::abs(q(1, 1)) ? Eigen::Vector2d(0.0, 1.0) : Eigen::Vector2d(1.0, 0.0);
    directions.push_back((phi * ab).normalized());
  }
  const Vector along = point.tangent.normalized();
  if (std::abs(along.dot(directions[0])) <= std::abs(along.dot(directions[1]))) std::swap(directions[0], directions[1]);
  return directions;
}

const char* name_of(const std::vector<Vector>& directions) {
  const auto upright = [](const Vector& d) { return std::abs(d[d.size() - 1]) < 1e-6; };
  return upright(directions[0]) || upright(directions[1]) ? "PF" : "TC";
}

// The problem and its point with x and p of order one, in which nothing hangs on the units of either.
class InUnits {
 public:
  InUnits(const Problem& f, const SpecialPoint& point, const DepartureOptions& o)
      : scaled(f, units_of(f, o), Vector::Ones(f.size())), at(point), options(o) {
    at.u = point.u.cwiseQuotient(scaled.units());
    if (point.tangent.size() > 0) at.tangent = point.tangent.cwiseQuotient(scaled.units());
    options.range = options.size = 1.0;
  }
  Vector outwards(const Vector& direction) const { return direction.cwiseProduct(scaled.units()).normalized(); }

  ProblemInUnits scaled;
  SpecialPoint at;
  DepartureOptions options;

 private:
  static Vector units_of(const Problem& f, const DepartureOptions& o) {
    Vector units = Vector::Constant(f.size() + 1, o.size);
    units[f.size()] = o.range;
    return units;
  }
};

Departures departures_in_units(const Problem& f, SpecialPoint& point, const DepartureOptions& options) {
  const int n = f.size();
  const Matrix kernel = f.is_flow() && n >= 2 ? kernel_at(f, point.u) : Matrix();
  Departures found;
  found.zeros = std::max(1, static_cast<int>(kernel.cols()) - 1);
  found.found_all = found.zeros == 1;
  if (found.zeros > 1 && kernel.cols() <= largest_kernel && n <= largest_searched) {
    SphereSearch search(f, point, kernel, options);
    found.branches = search.run();
    found.starts = search.starts();
  } else if (point.block > 0) {  // a reflection breaks: along the odd null vector, its mirror image the other way
    Vector direction = Vector::Zero(n + 1);
    direction.head(n) = point.null_vector;
    found.branches = {{direction, false}};
  } else if (const auto directions = crossing_directions(f, point); !directions.empty()) {
    if (point.subtype.empty()) point.subtype = name_of(directions);
    found.branches = {{directions[1], true}};
  }
  return found;
}

}  // namespace

Departures departures(const Problem& f, SpecialPoint& point, const DepartureOptions& options) {
  InUnits units(f, point, options);
  Departures found = departures_in_units(units.scaled, units.at, units.options);
  for (Departure& d : found.branches) d.direction = units.outwards(d.direction);
  point.subtype = units.at.subtype;
  return found;
}

void name_branch_point(const Problem& f, SpecialPoint& point, const DepartureOptions& options) {
  if (!point.subtype.empty()) return;
  const InUnits units(f, point, options);
  if (const auto directions = crossing_directions(units.scaled, units.at); !directions.empty()) point.subtype = name_of(directions);
}

}  // namespace whirl::continuation
