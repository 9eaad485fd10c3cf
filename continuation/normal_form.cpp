#include "continuation/normal_form.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>

#include "continuation/null_vectors.hpp"
#include "continuation/period_doubling.hpp"

namespace whirl::continuation {
namespace {

using ComplexVector = Eigen::VectorXcd;

// B(a, b) and C(a, b, c) in x only; complex arguments by multilinearity.
class Forms {
 public:
  Forms(const Problem& f, In u) : f_(f), u_(u), full_(3, Vector::Zero(u.size())), h_(f.size(), u.size()), t_(f.size()) {}

  Vector B(const Vector& a, const Vector& b) {
    full_[0].head(f_.size()) = a;
    f_.second(u_, full_[0], h_);
    return h_.leftCols(f_.size()) * b;
  }
  Vector C(const Vector& a, const Vector& b, const Vector& c) {
    full_[0].head(f_.size()) = a;
    full_[1].head(f_.size()) = b;
    full_[2].head(f_.size()) = c;
    f_.third(u_, full_[0], full_[1], full_[2], t_);
    return t_;
  }
  ComplexVector B(const ComplexVector& a, const ComplexVector& b) {
    const std::complex<double> i(0.0, 1.0);
    return (B(Vector(a.real()), Vector(b.real())) - B(Vector(a.imag()), Vector(b.imag()))).cast<std::complex<double>>() +
           i * (B(Vector(a.real()), Vector(b.imag())) + B(Vector(a.imag()), Vector(b.real()))).cast<std::complex<double>>();
  }
  // C(q, q, conj q) with q = a + i b: C(aaa) + C(abb) + i (C(aab) + C(bbb))
  ComplexVector C_qqq(const ComplexVector& q) {
    const Vector a = q.real(), b = q.imag();
    const std::complex<double> i(0.0, 1.0);
    return (C(a, a, a) + C(a, b, b)).cast<std::complex<double>>() + i * (C(a, a, b) + C(b, b, b)).cast<std::complex<double>>();
  }

 private:
  const Problem& f_;
  Vector u_;
  std::vector<Vector> full_;
  Matrix h_;
  Vector t_;
};

// h with A h = rhs, made unique by v'h = 0; rhs must lie in the range of A.
Vector solve_off_null(const Matrix& a, const Vector& v, const Vector& w, const Vector& rhs) {
  const auto n = a.rows();
  Matrix m(n + 1, n + 1);
  m << a, w, v.transpose(), 0.0;
  Vector r(n + 1);
  r << rhs, 0.0;
  return m.partialPivLu().solve(r).head(n);
}

// Is another eigenvalue zero as well? A^-1 does not exist there, nor does l1: what rounding leaves of it is a number without meaning.
bool is_zero_hopf(const Eigen::VectorXcd& eigenvalues, double frequency) {
  constexpr double zero = 1e-7;  // of the frequency: special points are located to 1e-10
  return std::any_of(eigenvalues.begin(), eigenvalues.end(), [&](const auto& z) { return std::abs(z) < zero * frequency; });
}

void set_doubling_coefficient(const OrbitProblem& orbit, SpecialPoint& point) {
  auto doubled = period_doubling_near(orbit, point.u, point.block);
  if (!doubled) return;
  set_normal_form(orbit.doubled(), *doubled);
  point.coefficient = doubled->coefficient;
  point.has_coefficient = doubled->has_coefficient;
}

}  // namespace

std::string criticality(const SpecialPoint& point) {
  const bool pitchfork = point.type == EventType::branch_point && point.subtype != "TC" && (point.block > 0 || point.subtype == "PF");
  const bool branches_off = pitchfork || point.type == EventType::hopf || point.type == EventType::period_doubling;
  if (!point.has_coefficient || !branches_off || point.coefficient == 0.0) return "";
  return point.coefficient < 0.0 ? "supercritical" : "subcritical";
}

double mass(const Problem& f, In u, const Vector& v, const Vector& w) {
  const auto* orbit = dynamic_cast<const OrbitProblem*>(&f);
  if (!orbit) return w.dot(v);
  Matrix c(f.size(), f.size());
  orbit->velocity(u, c);
  return -w.dot(c * v);
}

void set_normal_form(const Problem& f, SpecialPoint& point, const Vector& sense) {
  const auto* orbit = dynamic_cast<const OrbitProblem*>(&f);
  if (orbit && point.type == EventType::period_doubling) return set_doubling_coefficient(*orbit, point);
  set_normal_form(f, point, sense, [&](const Vector& v, const Vector& w) { return mass(f, point.u, v, w); });
}

void set_normal_form(const Problem& f, SpecialPoint& point, const Vector& sense, const Mass& mass_of) {
  const int n = f.size();
  if (f.derivatives() < 3) return;
  Matrix j(n, n + f.parameters());
  f.jacobian(point.u, j);
  const Matrix a = j.leftCols(n);
  Forms forms(f, point.u);
  if (point.type == EventType::hopf) {
    const Eigen::EigenSolver<Matrix> right(a), left(Matrix(a.transpose()));
    const std::complex<double> target(0.0, point.frequency);
    const auto nearest = [](const Eigen::VectorXcd& values, std::complex<double> z) {
      Eigen::Index best = 0;
      (values.array() - z).abs().minCoeff(&best);
      return best;
    };
    if (is_zero_hopf(right.eigenvalues(), point.frequency)) {
      point.subtype = zero_hopf_subtype;
      point.has_coefficient = false;
      return;
    }
    const ComplexVector q = right.eigenvectors().col(nearest(right.eigenvalues(), target)).normalized();
    ComplexVector p = left.eigenvectors().col(nearest(left.eigenvalues(), std::conj(target)));  // A'p = -i w p
    p /= std::conj(p.dot(q));                                                                   // p* q = 1
    const Eigen::MatrixXcd A = a.cast<std::complex<double>>();
    const ComplexVector b11 = A.partialPivLu().solve(forms.B(q, ComplexVector(q.conjugate())));
    const ComplexVector b20 = (2.0 * target * Eigen::MatrixXcd::Identity(n, n) - A).partialPivLu().solve(forms.B(q, q));
    const std::complex<double> parts[] = {p.dot(forms.C_qqq(q)), -2.0 * p.dot(forms.B(q, b11)), p.dot(forms.B(ComplexVector(q.conjugate()), b20))};
    const double sum = (parts[0] + parts[1] + parts[2]).real(), size = std::abs(parts[0]) + std::abs(parts[1]) + std::abs(parts[2]);
    point.coefficient = std::abs(sum) > 1e-12 * size ? sum / (2.0 * point.frequency) : 0.0;  // a degenerate point is not told from rounding
    point.has_coefficient = std::isfinite(point.coefficient);
    point.null_vector = q.real();
    point.null_vector_im = q.imag();
    return;
  }
  if (point.type != EventType::fold && point.type != EventType::branch_point) return;
  Vector v, w;
  null_vectors(a, v, w);
  const double overlap = mass_of(v, w);
  if (std::abs(overlap) < 1e-10) return;  // a double zero: no coefficient
  const auto along = [&](In direction) { return direction.size() >= n && v.dot(direction.head(n)) < 0.0; };
  if (along(sense.size() > 0 ? sense : point.tangent)) {
    v = -v;
    w = -w;
  }
  w /= mass_of(v, w);
  if (point.type == EventType::fold) point.null_vector = v;
  const Vector bvv = forms.B(v, v);
  const double quadratic = 0.5 * w.dot(bvv);
  // At a branch point the centre manifold bends with the parameter too; w'B(v, v) = 0 marks the pitchfork.
  const bool told = !point.subtype.empty(), broken = point.block > 0 || point.subtype == "PF";
  const bool pitchfork = point.type == EventType::branch_point && (told ? broken : std::abs(quadratic) < 1e-7 * (1.0 + bvv.norm()));
  point.coefficient = pitchfork ? w.dot(forms.C(v, v, v)) / 6.0 + 0.5 * w.dot(forms.B(v, solve_off_null(a, v, w, Vector(-bvv)))) : quadratic;
  point.has_coefficient = std::isfinite(point.coefficient);
}

}  // namespace whirl::continuation
