#include "models/dynamics/time/lyapunov_spectrum.hpp"

#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <functional>
#include <limits>
#include <numeric>

#include "core/explicit_integrator.hpp"

namespace whirl::models {
namespace {

constexpr int blocks = 20;
constexpr double errors_from_zero = 3.0;
constexpr double turns_left_over = 5.0;  // over the time counted: what the first turns of the tangents leave in a mean

// The state with n tangent vectors and the integral of the divergence behind it.
using State = std::vector<double>;

struct TangentField {
  const Problem* flow;
  Vector u, f;
  Matrix jacobian;
  void operator()(const State& x, State& dx, double) {
    const int n = flow->size();
    u.head(n) = Eigen::Map<const Vector>(x.data(), n);
    flow->linearise(u, f, jacobian);
    Eigen::Map<Vector>(dx.data(), n) = f;
    Eigen::Map<Matrix>(dx.data() + n, n, n).noalias() = jacobian.leftCols(n) * Eigen::Map<const Matrix>(x.data() + n, n, n);
    dx[static_cast<std::size_t>(n * (n + 1))] = jacobian.leftCols(n).trace();
  }
};

// Carries the frame over one interval and returns the growth of the divergence's integral, NaN where it is not known; false: no further.
using Advance = std::function<bool(Matrix& frame, double& divergence)>;

FlowMotion verdict(const LyapunovSpectrum& s, bool autonomous) {
  int positive = 0, zero = 0;
  for (Eigen::Index i = 0; i < s.exponent.size(); ++i) {
    if (s.exponent[i] > s.margin(i)) ++positive;
    else if (s.exponent[i] >= -s.margin(i)) ++zero;
  }
  if (positive > 0) return FlowMotion::chaotic;
  if (autonomous && zero == 0) return FlowMotion::equilibrium;
  return zero > (autonomous ? 1 : 0) ? FlowMotion::torus : FlowMotion::cycle;
}

LyapunovSpectrum measure(int n, double interval, const LyapunovSpectrumOptions& o, bool autonomous, const Advance& advance) {
  LyapunovSpectrum s;
  Matrix frame = Matrix::Identity(n, n), growth(n, o.counted);
  double divergence = 0.0;
  for (int k = -o.skip; k < o.counted; ++k) {
    double part = 0.0;
    if ((o.interrupted && *o.interrupted) || !advance(frame, part)) return s;
    const Eigen::HouseholderQR<Matrix> qr(frame);
    const Vector diagonal = qr.matrixQR().diagonal().cwiseAbs();
    if (!diagonal.allFinite()) return s;
    frame = qr.householderQ() * Matrix::Identity(n, n);
    if (k < 0) continue;
    growth.col(k) = diagonal.cwiseMax(std::numeric_limits<double>::min()).array().log();
    divergence += part;
  }
  s.time = o.counted * interval;
  const int each = o.counted / blocks;
  Matrix means(n, blocks);
  for (int b = 0; b < blocks; ++b) means.col(b) = growth.middleCols(b * each, each).rowwise().mean() / interval;
  const Vector exponent = growth.rowwise().mean() / interval;
  const Vector error = ((means.colwise() - Vector(means.rowwise().mean())).rowwise().squaredNorm() / (blocks * (blocks - 1.0))).cwiseSqrt();
  std::vector<int> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return exponent[a] > exponent[b]; });
  s.exponent.resize(n);
  s.error.resize(n);
  for (int i = 0; i < n; ++i) {
    s.exponent[i] = exponent[order[static_cast<std::size_t>(i)]];
    s.error[i] = error[order[static_cast<std::size_t>(i)]];
  }
  s.divergence = divergence / s.time;
  s.kind = verdict(s, autonomous);
  return s;
}

}  // namespace

const char* to_string(FlowMotion motion) {
  switch (motion) {
    case FlowMotion::equilibrium:
      return "equilibrium";
    case FlowMotion::cycle:
      return "periodic";
    case FlowMotion::torus:
      return "quasi-periodic";
    case FlowMotion::chaotic:
      return "chaotic";
    case FlowMotion::failed:
      break;
  }
  return "failed";
}

void LyapunovSpectrumOptions::validate() const {
  if (!(interval > 0.0) || skip < 0 || counted < blocks)
    throw std::invalid_argument(
        fmt::format("Lyapunov exponents need interval > 0, skip >= 0, counted >= {}, got {}, {}, {}", blocks, interval, skip, counted));
}

double LyapunovSpectrum::margin(Eigen::Index i) const { return std::max(errors_from_zero * error[i], turns_left_over / time); }

double LyapunovSpectrum::dimension() const {
  double sum = 0.0;
  for (Eigen::Index i = 0; i < exponent.size(); ++i) {
    const double own = std::abs(exponent[i]) > margin(i) ? exponent[i] : 0.0;
    if (sum + own < 0.0) return static_cast<double>(i) + sum / std::abs(own);
    sum += own;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

LyapunovSpectrum lyapunov_spectrum(const Problem& flow, const Vector& x0, const Vector& p, const LyapunovSpectrumOptions& o) {
  o.validate();
  if (!flow.is_flow() || x0.size() != flow.size() || p.size() != flow.parameters())
    throw std::invalid_argument("Lyapunov exponents need a flow, a start and parameters of its sizes");
  const int n = flow.size();
  TangentField field{&flow, Vector(n + flow.parameters()), Vector(n), Matrix(n, n + flow.parameters())};
  field.u.tail(flow.parameters()) = p;
  ExplicitIntegrator<State, TangentField> run(
      field, {.relative_tolerance = o.relative_tolerance, .absolute_tolerance = 1e-2 * o.relative_tolerance, .first_step = 1e-3 * o.interval});
  State state(static_cast<std::size_t>(n * (n + 1) + 1), 0.0);
  Eigen::Map<Vector>(state.data(), n) = x0;
  LyapunovSpectrum s = measure(n, o.interval, o, true, [&](Matrix& frame, double& divergence) {
    Eigen::Map<Matrix>(state.data() + n, n, n) = frame;
    state.back() = 0.0;
    run.restart(0.0, state);
    if (!run.advance(o.interval)) return false;
    state = run.state();
    frame = Eigen::Map<const Matrix>(state.data() + n, n, n);
    divergence = state.back();
    return true;
  });
  s.end = Eigen::Map<const Vector>(state.data(), n);
  return s;
}

LyapunovSpectrum lyapunov_spectrum(Stroboscope& strobe, const Vector& y0, const LyapunovSpectrumOptions& o) {
  o.validate();
  Vector y = y0;
  const int n = strobe.size();
  Matrix derivative(n, n);
  LyapunovSpectrum s = measure(n, strobe.period(), o, false, [&](Matrix& frame, double& divergence) {
    if (!strobe.map(y, derivative)) return false;
    frame = derivative * frame;
    divergence = std::numeric_limits<double>::quiet_NaN();
    return true;
  });
  s.end = y;
  return s;
}

}  // namespace whirl::models
