#include <complex>
#include <limits>
#include <numbers>

#include "models/dynamics/periodic/limit_cycle_state.hpp"

namespace whirl::models {

constexpr int stages = GaussStep::stages;

Vector LimitCycle::guess(const Orbit& orbit, double period, In p) const {
  constexpr int count = 256;
  std::complex<double> harmonic = 0.0;
  for (int i = 0; i < count; ++i)
    harmonic += phase_.dot(orbit(static_cast<double>(i) / count)) * std::polar(1.0, -2.0 * std::numbers::pi * i / count);
  const double shift = -std::arg(harmonic) / (2.0 * std::numbers::pi);  // the peak
  Matrix x(flow_.size(), segments_);
  for (int i = 0; i < segments_; ++i) {
    const double s = static_cast<double>(i) / segments_ + shift;
    x.col(i) = orbit(s - std::floor(s));
  }
  Vector u(size() + parameters());
  from_points(x, u);
  u[first_harmonic] = 2.0 * std::abs(harmonic) / count;
  u[log_period] = std::log(period / (1 << level_));
  u.tail(parameters()) = p;
  mesh_.reset();
  return u;
}

Matrix LimitCycle::samples(In u, int count) const {
  const int n = flow_.size();
  Matrix all = Matrix::Constant(n, count, std::numeric_limits<double>::quiet_NaN());
  if (!evaluate(u, 0, u, nullptr, nullptr)) return all;
  const double period = this->period(u);
  int place = 0;
  for (int i = 0; i < count; ++i) {
    const double s = static_cast<double>(i) / count;
    while (place + 1 < mesh_->intervals() && mesh_->s[static_cast<std::size_t>(place) + 1] <= s) ++place;
    const auto at = static_cast<std::size_t>(place);
    const double length = mesh_->s[at + 1] - mesh_->s[at];
    const auto weight = inner_weights((s - mesh_->s[at]) / length);
    all.col(i) = mesh_->from[at];
    for (int stage = 0; stage < stages; ++stage)
      all.col(i) += (period * length * weight[static_cast<std::size_t>(stage)]) * mesh_->step[at].k.col(stage);
  }
  return all;
}

double LimitCycle::trivial_error(In u) const {
  const int n = flow_.size();
  Vector at(n + flow_.parameters()), f(n);
  if (!(sweep_->ok && sweep_->at == u) && !evaluate(u, 1, u, nullptr, nullptr)) return std::numeric_limits<double>::quiet_NaN();
  at << sweep_->x.col(0), u.tail(flow_.parameters());
  flow_.residual(at, f);
  Vector w = f;
  for (const Matrix& map : sweep_->phi) w = map.leftCols(n) * w;
  return (w - f).norm() / f.norm();
}

double LimitCycle::divergence(In u) const {
  const int n = flow_.size();
  if (!evaluate(u, 0, u, nullptr, nullptr)) return std::numeric_limits<double>::quiet_NaN();
  const double period = this->period(u);
  Vector at(n + flow_.parameters());
  at.tail(flow_.parameters()) = u.tail(flow_.parameters());
  Matrix jacobian(n, n + flow_.parameters());
  double sum = 0.0;
  for (std::size_t step = 0; step < mesh_->step.size(); ++step) {
    const double h = period * (mesh_->s[step + 1] - mesh_->s[step]);
    for (int i = 0; i < stages; ++i) {
      at.head(n) = mesh_->from[step];
      for (int l = 0; l < stages; ++l) at.head(n) += h * GaussStep::a[i][l] * mesh_->step[step].k.col(l);
      flow_.jacobian(at, jacobian);
      sum += h * GaussStep::b[i] * jacobian.leftCols(n).trace();
    }
  }
  return sum;
}

double LimitCycle::slowest(In u, Vector& x) const {
  if (!evaluate(u, 0, u, nullptr, nullptr)) return std::numeric_limits<double>::quiet_NaN();
  double least = std::numeric_limits<double>::infinity(), largest = 0.0;
  for (std::size_t step = 0; step < mesh_->step.size(); ++step)
    for (int i = 0; i < stages; ++i) {
      const double speed = mesh_->step[step].k.col(i).cwiseQuotient(mesh_->size).norm();
      largest = std::max(largest, speed);
      if (speed >= least) continue;
      least = speed;
      x = mesh_->from[step];
    }
  return least / largest;
}

}  // namespace whirl::models
