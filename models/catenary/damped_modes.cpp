// Damped modes in plane: the quadratic eigenproblem (lambda^2 M + lambda C + K) q = 0, C = eta1 MU + eta2 MV.
//
//     mu = 1/lambda,  K = L L',  z = L' q:      [ 0        I     ] [z ]        [z ]
//                                               [ -M~     -C~    ] [w ]  = mu  [w ],   w = mu z,  A~ = L^-1 A L^-T
//
// The slowest modes are the largest mu. Each is then polished: inverse iteration for q, the Rayleigh functional q'(lambda^2 M + lambda C + K) q = 0
// (q', not its conjugate: K, M, C are real symmetric, so q is its own left eigenvector) for lambda.
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>

#include "models/catenary/largest.hpp"
#include "models/catenary/modes.hpp"

namespace whirl::models::catenary {
namespace {

using Complex = std::complex<double>;
using ComplexVector = Eigen::VectorXcd;

struct QuadraticProblem {
  Matrix K, C, M;

  // All roots with Im lambda >= 0.
  std::vector<Complex> roots() const {
    const Eigen::LLT<Matrix> llt(K);
    const auto reduced = [&](const Matrix& a) {
      Matrix b = a;
      llt.matrixL().solveInPlace(b);
      b.transposeInPlace();
      llt.matrixL().solveInPlace(b);
      return b;
    };
    const auto n = K.rows();
    Matrix A = Matrix::Zero(2 * n, 2 * n);
    A.topRightCorner(n, n).setIdentity();
    A.bottomLeftCorner(n, n) = -reduced(M);
    A.bottomRightCorner(n, n) = -reduced(C);
    const Eigen::EigenSolver<Matrix> solver(A, false);
    std::vector<Complex> lambda;
    for (Eigen::Index i = 0; i < 2 * n; ++i) {
      const Complex mu = solver.eigenvalues()[i];
      if (std::abs(mu) > 1e-8 && mu.imag() <= 0.0) lambda.push_back(1.0 / mu);
    }
    return lambda;
  }

  // The root of the Rayleigh functional next to lambda.
  Complex functional(const ComplexVector& q, Complex lambda) const {
    const Complex m = (q.transpose() * (M * q))(0), c = (q.transpose() * (C * q))(0), k = (q.transpose() * (K * q))(0);
    const Complex root = std::sqrt(c * c - 4.0 * m * k), one = (-c + root) / (2.0 * m), two = (-c - root) / (2.0 * m);
    return std::abs(one - lambda) < std::abs(two - lambda) ? one : two;
  }

  ComplexVector polish(Complex& lambda) const {
    ComplexVector q = ComplexVector::Ones(K.rows());
    for (int step = 0; step < 4; ++step) {
      const Complex shift = lambda * (1.0 + 1e-10);  // just off the root: the matrix stays invertible
      const Eigen::PartialPivLU<Eigen::MatrixXcd> lu(shift * shift * M + shift * C + K);
      for (int i = 0; i < (step == 0 ? 3 : 1); ++i) q = lu.solve((2.0 * shift * M + C) * q).normalized();
      const Complex next = functional(q, lambda);
      if (!(std::abs(next - lambda) < 1e-3 * std::abs(lambda))) break;  // a double root: keep what the eigenvalues gave
      const bool done = std::abs(next - lambda) < 1e-14 * std::abs(lambda);
      lambda = next;
      if (done) break;
    }
    return q;
  }
};

DampedMode mode_of(const InPlaneGalerkin& g, const Mirror& mirror, const CoreCable& c, Complex lambda, const ComplexVector& q) {
  const auto at = g.nodal<Complex>(c.kappa, q, Eigen::Vector4cd::Zero());
  const Complex L1 = lambda * lambda + c.eta1 * lambda, L2 = lambda * lambda + c.eta2 * lambda;
  DampedMode mode{lambda, 0.0, field_of<Complex>(g.mesh(), at, L1, L2)};
  Eigen::Index i;
  (at.U.cwiseAbs2() + at.V.cwiseAbs2()).maxCoeff(&i);
  const Complex lead = std::abs(at.V[i]) > std::abs(at.U[i]) ? at.V[i] : at.U[i];  // real and positive there
  mode.field.coefficients *= std::conj(lead) / (std::abs(lead) * largest_displacement<Complex>(g.mesh(), mode.field, at, c.kappa, L1, L2));
  mode.odd_share = mirror.odd_share(mode.field, Quantity::V);
  return mode;
}

}  // namespace

std::complex<double> damped_root(double omega, double eta) {
  const double d = omega * omega - 0.25 * eta * eta;
  return d >= 0.0 ? Complex(-0.5 * eta, std::sqrt(d)) : Complex(-0.5 * eta + std::sqrt(-d), 0.0);
}

namespace {

// Roots of one discretisation: oscillating ones by their frequency, the others from the slowest on.
struct Roots {
  std::vector<Complex> oscillating;
  std::vector<double> overdamped;
};

Roots roots_of(const QuadraticProblem& problem) {
  Roots r;
  for (const Complex lambda : problem.roots())
    if (lambda.imag() > 1e-9 * std::abs(lambda)) r.oscillating.push_back(lambda);
    else r.overdamped.push_back(lambda.real());
  std::sort(r.overdamped.begin(), r.overdamped.end(), std::greater<>());
  std::sort(r.oscillating.begin(), r.oscillating.end(), [](Complex a, Complex b) { return a.imag() < b.imag(); });
  return r;
}

// How many of the first `count` agree, from the lowest frequency on. Unpolished roots have lost some digits.
std::size_t agreeing(const std::vector<Complex>& a, const std::vector<Complex>& b, int count) {
  std::size_t n = 0;
  const std::size_t most = std::min({a.size(), b.size(), static_cast<std::size_t>(count)});
  while (n < most && std::abs(a[n] - b[n]) < 1e-6 * std::abs(b[n])) ++n;
  return n;
}

QuadraticProblem problem_of(const InPlaneGalerkin& g, const CoreCable& c) {
  return {g.stiffness(c.kappa), g.mass(c.kappa, c.eta1, c.eta2), g.mass(c.kappa)};
}

}  // namespace

// Drag changes which motions are slow: with much of it the lowest oscillating modes may be short waves. So the discretisation is refined by half
// until the modes asked for stay where they are.
DampedSet damped_modes(const CoreCable& c, const ModeOptions& o) {
  constexpr int most_functions = 400;
  ModeOptions undamped = o;
  undamped.verify = false;
  undamped.shapes = false;
  int n = in_plane_modes(c, undamped).functions;  // checks, and tells how many functions resolve that many modes without drag
  const auto wanted = static_cast<std::size_t>(o.count);
  Roots now = roots_of(problem_of(InPlaneGalerkin(c.x1, c.x2, n), c));
  std::size_t good = 0;
  for (bool settled = false; !settled;) {
    const Roots coarse = std::move(now);
    n += n / 2;
    now = roots_of(problem_of(InPlaneGalerkin(c.x1, c.x2, n), c));
    good = agreeing(coarse.oscillating, now.oscillating, o.count);
    settled = good == wanted || (good == now.oscillating.size() && good == coarse.oscillating.size()) || n + n / 2 > most_functions;
    if (settled) {
      // Of motions that do not oscillate there may be as many as functions: those count that refinement leaves in place.
      std::size_t k = 0;
      while (k < std::min(coarse.overdamped.size(), now.overdamped.size()) &&
             std::abs(coarse.overdamped[k] - now.overdamped[k]) < 1e-6 * std::abs(now.overdamped[k]))
        ++k;
      now.overdamped.resize(k);
    }
  }
  DampedSet out;
  out.functions = n;
  out.resolved = good == wanted || good == now.oscillating.size();
  out.overdamped = std::move(now.overdamped);
  const InPlaneGalerkin g(c.x1, c.x2, n);
  const QuadraticProblem problem = problem_of(g, c);
  const Mirror mirror(g.mesh());
  now.oscillating.resize(good);
  for (Complex lambda : now.oscillating) {
    const ComplexVector q = problem.polish(lambda);
    if (o.shapes) out.modes.push_back(mode_of(g, mirror, c, lambda, q));
    else out.modes.push_back({lambda, 0.0, {}});
  }
  return out;
}

std::vector<int> partners(const std::vector<Mode>& modes, const std::vector<DampedMode>& damped) {
  std::vector<int> partner(modes.size(), -1);
  if (modes.empty() || damped.empty()) return partner;
  const double x1 = modes[0].field.coordinate.x1(), x2 = modes[0].field.coordinate.x2();
  const auto samples = static_cast<Eigen::Index>(40 * std::max(modes.size(), damped.size()));
  const Vector x = Vector::LinSpaced(samples, x1, x2), weight = x.array().cosh().sqrt();
  const auto part = [&](const auto& field) {  // (U, V) in the square root of their mass
    auto f = field.at(x);
    f.resize(2 * samples, f.cols() / 2);
    return (f.col(0).array() * weight.replicate(2, 1).array()).matrix().normalized().eval();
  };
  Eigen::MatrixXd shapes(2 * samples, Eigen::Index(modes.size()));
  for (std::size_t i = 0; i < modes.size(); ++i) shapes.col(Eigen::Index(i)) = part(modes[i].field);
  Eigen::MatrixXd share(modes.size(), damped.size());
  for (std::size_t j = 0; j < damped.size(); ++j)
    share.col(Eigen::Index(j)) = (shapes.transpose().cast<Complex>() * part(damped[j].field)).cwiseAbs2();
  for (std::size_t k = 0; k < std::min(modes.size(), damped.size()); ++k) {
    Eigen::Index i, j;
    if (!(share.maxCoeff(&i, &j) > 0.5)) break;
    partner[std::size_t(i)] = static_cast<int>(j);
    share.row(i).setZero();
    share.col(j).setZero();
  }
  return partner;
}

}  // namespace whirl::models::catenary
