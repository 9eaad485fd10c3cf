#include "models/dynamics/averaging/modulation.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <numbers>

namespace whirl::models {
namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;

// The harmonic a start is given to, 0 where only a mean is kept: that nearest the natural frequency.
int carrier(const ModalSystem<double>& system, const Ansatz& ansatz, int coordinate) {
  const auto c = static_cast<std::size_t>(coordinate);
  const double natural = std::sqrt(std::max(system.stiffness[c], 0.0)), base = system.omega / ansatz.nu;
  int best = 0;
  for (const int k : ansatz.harmonics[c])
    if (k > 0 && (best == 0 || std::abs(k * base - natural) < std::abs(best * base - natural))) best = k;
  return best;
}

// Displacements of the physical motion at `count` instants from t = 0 on; fewer, and `why`, where it does not go on.
Matrix displacements(const ModalSystem<double>& system, const Vector& y0, int count, double step, const IntegratorOptions& options,
                     std::string& why) {
  const int n = system.size();
  Matrix q(n, count);
  q.col(0) = y0.head(n);
  const auto flow = [&](double t, std::span<const double> y, std::span<double> d) { system.flow<double>(system.omega * t, y, d); };
  Integrator run(flow, 0.0, y0, options);
  for (int j = 1; j < count; ++j) {
    if (!run.advance(step * j)) {
      why = run.why();
      return q.leftCols(j);
    }
    q.col(j) = run.state().head(n);
  }
  return q;
}

// Harmonic k over the window of `window` steps whose middle is instant `middle`, by the trapezoidal rule: exact for harmonics of steady amplitude.
std::complex<double> demodulated(const Matrix& q, int coordinate, int k, int middle, int window) {
  std::complex<double> sum = 0.0;
  for (int j = middle - window / 2; j <= middle + window / 2; ++j) {
    const double weight = std::abs(j - middle) == window / 2 ? 0.5 : 1.0;
    sum += weight * q(coordinate, j) * std::polar(1.0, -k * two_pi / window * j);
  }
  return sum * ((k > 0 ? 2.0 : 1.0) / window);
}

}  // namespace

void ModulationOptions::validate() const {
  if (periods < 1 || samples < 4 || samples % 2 != 0)
    throw std::invalid_argument(fmt::format("a modulation needs periods >= 1 and an even number >= 4 of samples, got {}, {}", periods, samples));
}

double Modulation::difference() const {
  const double size = averaged.size() > 0 ? averaged.cwiseAbs().maxCoeff() : 0.0;
  return size > 0.0 ? (integrated - averaged).cwiseAbs().maxCoeff() / size : 0.0;
}

Vector averaged_start(const ModalSystem<double>& system, const AveragedFlow& averaged, In p, const Vector& y0) {
  const Ansatz& ansatz = averaged.ansatz;
  const int n = system.size();
  Vector u = Vector::Zero(ansatz.size() + p.size());
  u.tail(p.size()) = p;
  const Vector rest = averaged.motion(u, 0.0);  // what is frozen
  for (int i = 0; i < n; ++i) {
    const int k = carrier(system, ansatz, i);
    if (k == 0) continue;
    const double speed = k * system.omega / ansatz.nu;
    u[ansatz.index(i, k)] = y0[i] - rest[i];
    u[ansatz.index(i, k) + 1] = -(y0[n + i] - rest[n + i]) / speed;
  }
  return u.head(ansatz.size());
}

Modulation modulation(const ModalSystem<double>& system, const AveragedFlow& averaged, In p, const Vector& y0, const ModulationOptions& o) {
  o.validate();
  const Ansatz& ansatz = averaged.ansatz;
  Modulation m;
  for (int i = 0; i < ansatz.coordinates(); ++i)
    for (const int k : ansatz.harmonics[static_cast<std::size_t>(i)]) m.rows.emplace_back(i, k);
  const int window = o.samples * ansatz.nu, half = window / 2, last = o.periods * o.samples;
  const double step = two_pi / system.omega / o.samples;
  const Matrix q = displacements(system, y0, last + 1, step, o.integrator, m.why);
  Vector x = averaged_start(system, averaged, p, y0), u(x.size() + p.size());
  u.tail(p.size()) = p;
  const auto flow = [&](double, std::span<const double> y, std::span<double> d) {
    u.head(x.size()) = Eigen::Map<const Vector>(y.data(), x.size());
    averaged.flow.residual(u, Eigen::Map<Vector>(d.data(), x.size()));
  };
  Integrator run(flow, 0.0, x, o.integrator);
  const auto count = static_cast<Eigen::Index>(m.rows.size());
  const auto most = std::max<Eigen::Index>(0, q.cols() - window);
  m.t.resize(most);
  m.integrated.resize(count, most);
  m.averaged.resize(count, most);
  Eigen::Index done = 0;
  for (; done < most; ++done) {
    const int middle = half + static_cast<int>(done);
    m.t[done] = step * middle;
    if (!run.advance(m.t[done])) {
      m.why = run.why();
      break;
    }
    x = run.state();
    for (Eigen::Index r = 0; r < count; ++r) {
      const auto [i, k] = m.rows[static_cast<std::size_t>(r)];
      m.averaged(r, done) = amplitude(ansatz, x, i, k);
      m.integrated(r, done) = demodulated(q, i, k, middle, window);
    }
  }
  m.t.conservativeResize(done);
  m.integrated.conservativeResize(Eigen::NoChange, done);
  m.averaged.conservativeResize(Eigen::NoChange, done);
  return m;
}

}  // namespace whirl::models
