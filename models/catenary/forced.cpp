#include "models/catenary/forced.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <numbers>

namespace whirl::models::catenary {
namespace {

using Complex = std::complex<double>;

Eigen::VectorXcd reduced_solve(const Matrix& re, const Matrix& im, const Eigen::VectorXcd& right) {
  Eigen::MatrixXcd A(re.rows(), re.cols());
  A.real() = re;
  A.imag() = im;
  return A.partialPivLu().solve(right);
}

}  // namespace

TangentNormal turned(double x, Complex horizontal, Complex vertical) {
  const double c = std::cosh(x), t = std::tanh(x);
  return {horizontal / c + vertical * t, vertical / c - horizontal * t};
}

ForcedSolver::ForcedSolver(const CoreCable& c, double largest_omega)
    : cable_(c),
      largest_omega_(largest_omega),
      g_(c.x1, c.x2, functions_up_to(c, largest_omega) + 8),
      lateral_(c.x1, c.x2, g_.functions()),
      K_(g_.stiffness(c.kappa)),
      MU_(g_.mass(c.kappa, 1.0, 0.0)),
      MV_(g_.mass(c.kappa, 0.0, 1.0)),
      K_lift_(g_.lift_stiffness(c.kappa)),
      MU_lift_(g_.lift_mass(c.kappa, 1.0, 0.0)),
      MV_lift_(g_.lift_mass(c.kappa, 0.0, 1.0)) {}

ForcedMotion ForcedSolver::at(double omega, const EndMotion& ends) const {
  if (!(omega >= 0.0 && omega <= largest_omega_ * (1.0 + 1e-12)))
    throw std::invalid_argument(fmt::format("the frequency must lie in [0, {:g}], got {:g}", largest_omega_, omega));
  ForcedMotion motion{omega, {}, {}};
  const Complex L1(-omega * omega, cable_.eta1 * omega), L2(-omega * omega, cable_.eta2 * omega), L3(-omega * omega, cable_.eta3 * omega);
  const Eigen::Vector4cd e(ends.U1, ends.V1, ends.U2, ends.V2);
  const Eigen::VectorXcd load =
      -((K_lift_ + L1.real() * MU_lift_ + L2.real() * MV_lift_) * e + Complex(0.0, 1.0) * ((L1.imag() * MU_lift_ + L2.imag() * MV_lift_) * e));
  const Eigen::VectorXcd q = reduced_solve(K_ + L1.real() * MU_ + L2.real() * MV_, L1.imag() * MU_ + L2.imag() * MV_, load);
  motion.in_plane = field_of<Complex>(g_.mesh(), g_.nodal<Complex>(cable_.kappa, q, e), L1, L2);
  const Eigen::Vector2cd w(ends.W1, ends.W2);
  motion.lateral = {lateral_.mesh().coordinate, Eigen::MatrixXcd::Zero(lateral_.mesh().t.size(), 2)};
  if (w.isZero(0.0)) return motion;
  const int n = lateral_.size();
  Eigen::VectorXcd all(n + 2);
  all.tail(2) = w;
  all.head(n) = reduced_solve(lateral_.stiffness() + L3.real() * lateral_.mass(), L3.imag() * lateral_.mass(),
                              -(lateral_.lift_stiffness() * w + L3 * (lateral_.lift_mass() * w)));
  motion.lateral.coefficients.col(0) = lateral_.mesh().project((lateral_.W() * all).eval());
  motion.lateral.coefficients.col(1) = lateral_.mesh().project((lateral_.W_slope() * all).eval());
  return motion;
}

PeakFinder::PeakFinder(const Mesh& mesh) {
  const auto n = mesh.t.size();
  const Vector t = Vector::LinSpaced(std::max<Eigen::Index>(200, 4 * n), -1.0, 1.0);
  x_ = t.unaryExpr([&](double s) { return mesh.coordinate.x(s); });
  c_ = x_.array().cosh();
  legendre_ = legendre_values(t, static_cast<int>(n));
}

template <class F>
Peak PeakFinder::maximum(const Vector& values, F&& f) const {
  const auto last = values.size() - 1;
  Peak best = values[last] > values[0] ? Peak{values[last], x_[last]} : Peak{values[0], x_[0]};
  const double top = values.maxCoeff(), near = top - 0.02 * (top - values.minCoeff());
  for (Eigen::Index i = 0; i <= last; ++i) {  // beside an end too, where the end may be lower than what follows
    const auto before = std::max<Eigen::Index>(i - 1, 0), behind = std::min(i + 1, last);
    if (values[i] < near || values[i] < values[before] || values[i] < values[behind]) continue;
    const auto found = boost::math::tools::brent_find_minima([&](double s) { return -f(s); }, x_[before], x_[behind], 34);
    if (-found.second > best.value) best = {-found.second, found.first};
  }
  return best;
}

Peak PeakFinder::largest(const Field<Complex>& f, Quantity quantity) const {
  const auto a = f.coefficients.col(static_cast<int>(quantity));
  const Vector re = legendre_ * a.real(), im = legendre_ * a.imag();
  return maximum((re.array().square() + im.array().square()).sqrt().matrix(), [&](double s) { return std::abs(f.at(s, quantity)); });
}

TotalTension PeakFinder::total_tension(const Field<Complex>& f) const {
  const auto a = f.coefficients.col(static_cast<int>(Quantity::T));
  const Vector re = legendre_ * a.real(), im = legendre_ * a.imag(), T = (re.array().square() + im.array().square()).sqrt();
  const auto at = [&](double s) { return std::abs(f.at(s, Quantity::T)); };
  Peak low = maximum(T - c_, [&](double s) { return at(s) - std::cosh(s); });
  low.value = -low.value;
  return {maximum(c_ + T, [&](double s) { return std::cosh(s) + at(s); }), low};
}

Matrix history(const std::vector<ForcedMotion>& motions, Quantity quantity, In x, In times, bool lateral) {
  Matrix sum = Matrix::Zero(x.size(), times.size());
  for (const auto& motion : motions) {
    const Eigen::VectorXcd values = (lateral ? motion.lateral : motion.in_plane).at(x, quantity);
    const Vector cosine = (motion.omega * times.array()).cos(), sine = (motion.omega * times.array()).sin();
    sum += values.real() * cosine.transpose() - values.imag() * sine.transpose();
  }
  return sum;
}

}  // namespace whirl::models::catenary
