#include "models/guy/linear_guy.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <boost/math/tools/toms748_solve.hpp>
#include <cassert>
#include <cmath>
#include <stdexcept>

#include "models/guy/guy_matrices.hpp"
#include "models/guy/legendre_basis.hpp"

namespace whirl::models::guy {
namespace {

std::complex<double> damped_square(double p, double damping_rate) {
  if (!(p >= 0.0) || !std::isfinite(p)) throw std::invalid_argument(fmt::format("guy stiffness: frequency must be >= 0, got {:g}", p));
  if (!(damping_rate >= 0.0) || !std::isfinite(damping_rate))
    throw std::invalid_argument(fmt::format("guy stiffness: damping rate c/m must be >= 0, got {:g}", damping_rate));
  return {p * p, -p * damping_rate};
}

}  // namespace

int suitable_degree(const Statics& exact, double highest_frequency) {
  // e^{i kappa x} on [-1, 1] needs degree kappa + O(kappa^(1/3)); kappa is half the phase from end to end.
  const double kappa = 0.5 * highest_frequency * travel_time(exact);
  return static_cast<int>(std::ceil(kappa + 8.0 * std::cbrt(kappa))) + std::max(16, degree_of_tension(exact)) + 6;
}

// Ends first: [ bb bi ; ib ii ], lift q = -A_ii^-1 A_ib.
LinearGuy::Part LinearGuy::solve(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, int ends) {
  const Eigen::Index n = A.rows() - ends;
  const auto Aii = A.bottomRightCorner(n, n), Bii = B.bottomRightCorner(n, n), Aib = A.bottomLeftCorner(n, ends), Bib = B.bottomLeftCorner(n, ends);
  const Eigen::MatrixXd lift = -Eigen::MatrixXd(Aii).llt().solve(Aib);
  Part part;
  part.static_stiffness = A.topLeftCorner(ends, ends) + Aib.transpose() * lift;
  const Eigen::MatrixXd coupling = Bib + Bii * lift;
  part.end_mass = B.topLeftCorner(ends, ends) + Bib.transpose() * lift + lift.transpose() * coupling;
  // B v = mu A v: A is well conditioned in this basis, so the large mu, the low modes, come out to rounding.
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> eigen(Bii, Aii);
  part.mu = eigen.eigenvalues().reverse();
  part.vectors = eigen.eigenvectors().rowwise().reverse();
  part.share = part.vectors.transpose() * coupling;
  return part;
}

LinearGuy::LinearGuy(const Statics& exact, double highest_frequency, int degree) : state_(exact), highest_(highest_frequency), degree_(degree) {
  require_exact(exact, "guy stiffness");
  if (!(highest_frequency > 0.0) || !std::isfinite(highest_frequency))
    throw std::invalid_argument(fmt::format("guy stiffness: highest frequency must be > 0, got {:g}", highest_frequency));
  if (degree_ == 0) degree_ = suitable_degree(exact, highest_frequency);
  if (degree_ < 2 || degree_ > largest_degree)
    throw std::invalid_argument(
        fmt::format("guy stiffness: degree {} outside 2 to {}; the guy is too slack or the frequency too high", degree_, largest_degree));
  const GuyMatrices m(exact, 0.0, exact.unstressed_length, degree_);
  const Eigen::Index n = degree_, full = n + 1;  // without the function of the lower end
  Eigen::MatrixXd A(2 * n, 2 * n), B = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  // order: x end, y end, x interior, y interior
  const auto place = [n](int component, Eigen::Index j) { return j == 0 ? component : 2 + component * (n - 1) + j - 1; };
  for (int a = 0; a < 2; ++a)
    for (int b = 0; b < 2; ++b)
      for (Eigen::Index i = 0; i < n; ++i)
        for (Eigen::Index j = 0; j < n; ++j) {
          A(place(a, i), place(b, j)) = m.in_plane(a * full + i, b * full + j);
          if (a == b) B(place(a, i), place(b, j)) = m.mass(i, j);
        }
  in_ = solve(A, B, 2);
  out_ = solve(m.out_of_plane.topLeftCorner(n, n), m.mass.topLeftCorner(n, n), 1);
}

std::complex<double> LinearGuy::entry(const Part& part, int i, int j, std::complex<double> pe2) const {
  const double a = pe2.real(), b = pe2.imag(), *mu = part.mu.data(), *gi = part.share.col(i).data(), *gj = part.share.col(j).data();
  double re = 0.0, im = 0.0;
  for (Eigen::Index n = 0; n < part.mu.size(); ++n) {  // 1/(1 - pe2 mu)
    const double x = 1.0 - a * mu[n], y = -b * mu[n], weight = gi[n] * gj[n] / (x * x + y * y);
    re += weight * x;
    im -= weight * y;
  }
  return part.static_stiffness(i, j) - pe2 * part.end_mass(i, j) - pe2 * pe2 * std::complex<double>(re, im);
}

StiffnessMatrix LinearGuy::stiffness(double p, double damping_rate) const {
  const auto pe2 = damped_square(p, damping_rate);
  return {entry(in_, 0, 0, pe2), entry(in_, 0, 1, pe2), entry(in_, 1, 1, pe2), entry(out_, 0, 0, pe2)};
}

std::complex<double> LinearGuy::modulus(Direction d, double p, double damping_rate) const {
  return entry(part(d), end_of(d), end_of(d), damped_square(p, damping_rate));
}

void LinearGuy::modulus(Direction d, std::span<const double> p, double damping_rate, std::span<std::complex<double>> k) const {
  if (p.size() != k.size()) throw std::invalid_argument("guy stiffness: as many results as frequencies are needed");
  for (std::size_t i = 0; i < p.size(); ++i) k[i] = modulus(d, p[i], damping_rate);
}

std::vector<Pole> LinearGuy::poles(Plane plane) const {
  const Part& part = plane == Plane::in_plane ? in_ : out_;
  std::vector<Pole> all;
  for (Eigen::Index n = 0; n < part.mu.size(); ++n) {
    const double lambda = 1.0 / part.mu[n], w = std::sqrt(lambda);
    if (!(w <= highest_)) break;
    const auto strength = [&](int end) { return std::pow(part.share(n, end) * lambda, 2); };
    all.push_back(plane == Plane::in_plane ? Pole{w, strength(0), strength(1), 0.0} : Pole{w, 0.0, 0.0, strength(0)});
  }
  return all;
}

// The undamped modulus falls from +infinity to -infinity between two poles, and from Ks > 0 to the first: one zero in each gap.
std::vector<double> LinearGuy::zeros(Direction d) const {
  const Part& of = part(d);
  const int e = end_of(d);
  const auto f = [&](double lambda) { return entry(of, e, e, {lambda, 0.0}).real(); };
  std::vector<double> found;
  double before = 0.0;
  for (Eigen::Index n = 0; n < of.mu.size(); ++n) {
    const double pole = 1.0 / of.mu[n], step = 1e-13;
    double a = n == 0 ? 0.0 : before * (1.0 + step), b = pole * (1.0 - step), zero = 0.0;
    before = pole;
    if (a >= b) continue;
    const double fa = f(a), fb = f(b);
    if (fa <= 0.0) zero = a;  // a mode that the end hardly moves: its zero stands at the pole
    else if (fb >= 0.0) zero = b;
    else {
      std::uintmax_t steps = 200;
      const auto r = boost::math::tools::toms748_solve(f, a, b, fa, fb, boost::math::tools::eps_tolerance<double>(50), steps);
      zero = 0.5 * (r.first + r.second);
    }
    if (!(std::sqrt(zero) <= highest_)) break;
    found.push_back(std::sqrt(zero));
  }
  return found;
}

std::vector<ModePoint> LinearGuy::shape(Plane plane, int number, std::span<const double> sigma) const {
  const Part& part = plane == Plane::in_plane ? in_ : out_;
  if (number < 1 || number > part.mu.size())
    throw std::invalid_argument(fmt::format("guy mode: number must be 1 to {}, got {}", part.mu.size(), number));
  Eigen::VectorXd x(static_cast<Eigen::Index>(sigma.size()));
  for (Eigen::Index i = 0; i < x.size(); ++i) x[i] = 2.0 * sigma[static_cast<std::size_t>(i)] - 1.0;
  const Eigen::MatrixXd bubbles = LegendreBasis(degree_, x).value.rightCols(degree_ - 1);
  const auto v = part.vectors.col(number - 1);
  std::vector<ModePoint> points;
  double largest = 0.0;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const double first = bubbles.row(i).dot(v.head(degree_ - 1)), second = plane == Plane::in_plane ? bubbles.row(i).dot(v.tail(degree_ - 1)) : 0.0;
    points.push_back(plane == Plane::in_plane ? ModePoint{first, second, 0.0} : ModePoint{0.0, 0.0, first});
    if (std::hypot(first, second) > std::abs(largest)) largest = std::copysign(std::hypot(first, second), plane == Plane::in_plane ? second : first);
  }
  for (ModePoint& p : points) p = {p.x / largest, p.y / largest, p.z / largest};
  return points;
}

}  // namespace whirl::models::guy
