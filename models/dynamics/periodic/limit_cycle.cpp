#include "models/dynamics/periodic/limit_cycle.hpp"

#include <fmt/format.h>

#include <limits>
#include <numbers>

#include "models/dynamics/periodic/gauss_jet.hpp"
#include "models/dynamics/periodic/limit_cycle_state.hpp"

namespace whirl::models {

void LimitCycleOptions::validate() const {
  if (segments < 1 || segments > 1000) throw std::invalid_argument(fmt::format("segments must be in 1..1000, got {}", segments));
  if (!(tolerance >= 1e-14 && tolerance <= 1e-2)) throw std::invalid_argument(fmt::format("tolerance must be in [1e-14, 1e-2], got {}", tolerance));
  if (most_steps < segments) throw std::invalid_argument(fmt::format("most_steps must be >= segments, got {}", most_steps));
}

LimitCycle::LimitCycle(const Problem& flow, Vector phase, const LimitCycleOptions& options)
    : OrbitProblem(scalars + flow.size() * options.segments, flow.parameters(), flow.size() - 1),
      flow_(flow),
      phase_(std::move(phase)),
      options_(options),
      segments_(options.segments) {
  options_.validate();
  if (!flow.is_flow()) throw std::invalid_argument("a limit cycle needs a flow");
  if (phase_.size() != flow.size() || !(phase_.norm() > 0.0))
    throw std::invalid_argument("the phase vector must have the size of the flow and not vanish");
  if (flow.size() < 2) throw std::invalid_argument("a flow of one variable has no limit cycles");
  name_parameters(flow.parameter_names());
  if (flow.derivatives() >= 2) offer_derivatives(flow.derivatives() >= 3 ? 3 : 2);
  sweep_ = std::make_unique<Sweep>(flow_, segments_);
}

LimitCycle::LimitCycle(const LimitCycle& single)
    : OrbitProblem(scalars + 2 * (single.size() - scalars), single.parameters(), single.multiplier_count()),
      flow_(single.flow_),
      phase_(single.phase_),
      options_(single.options_),
      level_(single.level_ + 1),
      segments_(2 * single.segments_) {
  name_parameters(flow_.parameter_names());
  if (flow_.derivatives() >= 2) offer_derivatives(flow_.derivatives() >= 3 ? 3 : 2);
  Vector signs = Vector::Ones(size());
  signs.tail((size() - scalars) / 2).setConstant(-1.0);
  add_reflection({signs, "PD"});
  sweep_ = std::make_unique<Sweep>(flow_, segments_);
}

LimitCycle::~LimitCycle() = default;

// ------------------------------------------------------------------------------------------------------------ points and unknowns

void LimitCycle::to_points(In u, Matrix& x) const {
  x = Eigen::Map<const Matrix>(u.data() + scalars, flow_.size(), segments_);
  if (level_ == 0) return;
  const int half = segments_ / 2;
  const Matrix sum = x.leftCols(half), difference = x.rightCols(half);
  x.leftCols(half) = sum + difference;
  x.rightCols(half) = sum - difference;
}

void LimitCycle::from_points(const Matrix& x, Out u) const {
  Eigen::Map<Matrix> to(u.data() + scalars, flow_.size(), segments_);
  to = x;
  if (level_ == 0) return;
  const int half = segments_ / 2;
  to.leftCols(half) = 0.5 * (x.leftCols(half) + x.rightCols(half));
  to.rightCols(half) = 0.5 * (x.leftCols(half) - x.rightCols(half));
}

void LimitCycle::rows_and_columns(MatrixOut j) const {
  if (level_ == 0) return;
  const auto half = (size() - scalars) / 2;
  const Matrix a = j.middleCols(scalars, half), b = j.middleCols(scalars + half, half);
  j.middleCols(scalars, half) = a + b;
  j.middleCols(scalars + half, half) = a - b;
  const Matrix c = j.middleRows(scalars, half), d = j.middleRows(scalars + half, half);
  j.middleRows(scalars, half) = 0.5 * (c + d);
  j.middleRows(scalars + half, half) = 0.5 * (c - d);
}

// ------------------------------------------------------------------------------------------------------------------- evaluation

// order 0: ends and phase; 1: first derivatives; 2: second along v as well. False where the stages have no solution.
bool LimitCycle::evaluate(In u, int order, In v, Out* r, MatrixOut* j) const {
  const bool known = order <= 1 && sweep_->ok && sweep_->at == u;
  if (!known && (!u.allFinite() || !follow(u) || !sweep_segments(u, order, v))) return false;
  Sweep& w = *sweep_;
  if (r) {
    const int m = segments_;
    for (int i = 0; i < m; ++i) w.gap.col(i) = w.end.col(i) - w.x.col((i + 1) % m);
    from_points(w.gap, *r);
    (*r)[0] = w.harmonic[0] - u[first_harmonic];
    (*r)[1] = w.harmonic[1];
  }
  if (j) assemble(order, *j);
  return true;
}

bool LimitCycle::sweep_segments(In u, int order, In v) const {
  const int n = flow_.size(), k = flow_.parameters(), m = segments_;
  Mesh& mesh = *mesh_;
  Sweep& w = *sweep_;
  const double period = this->period(u), winding = 2.0 * std::numbers::pi * (1 << level_);
  const auto p = u.tail(k);
  to_points(u, w.x);
  w.harmonic.setZero();
  w.harmonic_slope.setZero();
  w.harmonic_second.setZero();
  w.ok = false;
  double log_period_v = 0.0;
  if (order == 2) {
    to_points(v, w.x_v);
    log_period_v = v[log_period];
  }
  w.dh.setZero();
  w.ddh.setZero();
  for (int i = 0; i < m; ++i) {
    const auto slot = static_cast<std::size_t>(i);
    Matrix& slope = w.phi[slot];
    Matrix& second = w.ddphi[slot];
    w.point = w.x.col(i);
    slope.setZero();
    slope.leftCols(n).setIdentity();
    if (order == 2) {
      second.setZero();
      w.point_v = w.x_v.col(i);
    }
    for (int step = mesh.first[slot]; step < mesh.first[slot + 1]; ++step) {
      const auto place = static_cast<std::size_t>(step);
      const double length = mesh.s[place + 1] - mesh.s[place], h = period * length;
      mesh.from[place] = w.point;
      if (!w.step.solve(w.point, p, h, mesh.step[place], order >= 1)) return false;
      w.dh[n] = h;
      w.ddh[n] = h * log_period_v;
      if (order >= 1) w.step.first(slope, w.dh);
      if (order == 2) w.step.second(w.point_v, h * log_period_v, v.tail(k), second, w.ddh);
      for (int stage = 0; stage < GaussStep::stages; ++stage) {
        // cos and sin part of the first harmonic of <c, x>
        const double angle = winding * (mesh.s[place] + GaussStep::c[stage] * length), share = 2.0 * length * GaussStep::b[stage];
        const Eigen::Vector2d weight(share * std::cos(angle), share * std::sin(angle));
        w.harmonic += weight * phase_.dot(w.step.stage(stage));
        if (order >= 1) w.harmonic_slope.middleCols(2 * i, 2).noalias() += (w.step.stage_slope(stage).transpose() * phase_) * weight.transpose();
        if (order == 2) w.harmonic_second.middleCols(2 * i, 2).noalias() += (w.step.stage_second(stage).transpose() * phase_) * weight.transpose();
      }
      w.point = w.step.end();
    }
    w.end.col(i) = w.point;
  }
  if (order >= 1) {
    w.at = u;
    w.ok = true;
  }
  return true;
}

// The Jacobian, or the second derivative along v, from the maps of the segments.
void LimitCycle::assemble(int order, MatrixOut j) const {
  const int n = flow_.size(), k = flow_.parameters(), m = segments_;
  const Sweep& w = *sweep_;
  const auto& maps = order == 2 ? w.ddphi : w.phi;
  const Matrix& harmonic = order == 2 ? w.harmonic_second : w.harmonic_slope;
  j.setZero();
  for (int i = 0; i < m; ++i) {
    const Matrix& map = maps[static_cast<std::size_t>(i)];
    const int here = scalars + i * n, next = scalars + ((i + 1) % m) * n;
    j.block(here, here, n, n) += map.leftCols(n);
    if (order == 1) j.block(here, next, n, n).diagonal().array() -= 1.0;
    j.block(here, log_period, n, 1) = map.col(n);
    j.block(here, size(), n, k) = map.rightCols(k);
    const auto rows = harmonic.middleCols(2 * i, 2).transpose();
    j.block(0, here, scalars, n) = rows.leftCols(n);
    j.block(0, log_period, scalars, 1) += rows.col(n);
    j.block(0, size(), scalars, k) += rows.rightCols(k);
  }
  if (order == 1) j(0, first_harmonic) = -1.0;
  rows_and_columns(j);
}

void LimitCycle::do_residual(In u, Out r) const {
  if (!evaluate(u, 0, u, &r, nullptr)) r.setConstant(std::numeric_limits<double>::quiet_NaN());
}
void LimitCycle::do_jacobian(In u, MatrixOut j) const {
  if (!evaluate(u, 1, u, nullptr, &j)) j.setConstant(std::numeric_limits<double>::quiet_NaN());
}
void LimitCycle::do_linearise(In u, Out r, MatrixOut j) const {
  if (evaluate(u, 1, u, &r, &j)) return;
  r.setConstant(std::numeric_limits<double>::quiet_NaN());
  j.setConstant(std::numeric_limits<double>::quiet_NaN());
}
void LimitCycle::do_second(In u, In v, MatrixOut h) const {
  if (!evaluate(u, 2, v, nullptr, &h)) h.setConstant(std::numeric_limits<double>::quiet_NaN());
}

// Of the residual only the ends of the segments and the first harmonic are not linear in u.
void LimitCycle::do_third(In u, In a, In b, In c, Out t) const {
  const int n = flow_.size(), k = flow_.parameters(), m = segments_;
  t.setConstant(std::numeric_limits<double>::quiet_NaN());
  if (!u.allFinite() || !follow(u)) return;
  Mesh& mesh = *mesh_;
  const double period = this->period(u), winding = 2.0 * std::numbers::pi * (1 << level_);
  std::array<Matrix, GaussJet::parts> x;
  x.fill(Matrix::Zero(n, m));
  to_points(u, x[0]);
  GaussJet jet(flow_);
  std::array<double, GaussJet::parts> period_part{};  // T and its mixed derivatives: those of exp
  period_part.fill(period);
  jet.p[0] = u.tail(k);
  for (const auto& [part, v] : {std::pair<std::size_t, const Eigen::Ref<const Vector>*>{1, &a}, {2, &b}, {4, &c}}) {
    to_points(*v, x[part]);
    jet.p[part] = v->tail(k);
    for (std::size_t i = 0; i < GaussJet::parts; ++i)
      if (i & part) period_part[i] *= (*v)[log_period];
  }
  Matrix ends(n, m);
  Eigen::Vector2d harmonic = Eigen::Vector2d::Zero();
  for (int i = 0; i < m; ++i) {
    const auto slot = static_cast<std::size_t>(i);
    for (std::size_t part = 0; part < GaussJet::parts; ++part) jet.x[part] = x[part].col(i);
    for (int step = mesh.first[slot]; step < mesh.first[slot + 1]; ++step) {
      const auto place = static_cast<std::size_t>(step);
      const double length = mesh.s[place + 1] - mesh.s[place];
      for (std::size_t part = 0; part < GaussJet::parts; ++part) jet.h[part] = length * period_part[part];
      if (!sweep_->step.solve(jet.x[0], jet.p[0], jet.h[0], mesh.step[place], true)) return;
      jet.advance(sweep_->step);
      for (int stage = 0; stage < GaussStep::stages; ++stage) {
        const double angle = winding * (mesh.s[place] + GaussStep::c[stage] * length), share = 2.0 * length * GaussStep::b[stage];
        harmonic += share * Eigen::Vector2d(std::cos(angle), std::sin(angle)) * phase_.dot(jet.stage(stage));
      }
    }
    ends.col(i) = jet.x[GaussJet::whole];
  }
  from_points(ends, t);
  t.head(scalars) = harmonic;
}

}  // namespace whirl::models
