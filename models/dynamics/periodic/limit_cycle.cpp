#include "models/dynamics/periodic/limit_cycle.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <complex>
#include <limits>
#include <numbers>

#include "models/dynamics/periodic/cyclic_eigenvalues.hpp"

namespace whirl::models {
namespace {

constexpr double pi = std::numbers::pi;
constexpr int stages = GaussStep::stages;
// Error of a step at its end, (4!)^4 / (9 (8!)^3) h^9 x^(9), the constant of the Gauss method of order 8.
constexpr double error_constant = 2e-8;
constexpr int first_steps = 3;          // of a segment, before anything is known
constexpr double shortest_scale = 2.0;  // a cycle moves by its size in at most its period over this
constexpr double far = 0.05;            // of the cycle's size or in ln T: beyond it the mesh is laid anew
constexpr double smallest_part = 1e-3;  // of the largest range: points that stand for a coordinate may not show how it moves
constexpr double very_far = 0.3;        // beyond it twice, since the first was laid on a poor solution

// int_0^theta L_j, the polynomial that the slopes of a step define: x(theta) = x + h sum_j weight_j K_j.
std::array<double, stages> inner_weights(double theta) {
  // Monomials of L_j by solving the Vandermonde system once.
  static const Eigen::Matrix4d monomials = [] {
    Eigen::Matrix4d v;
    for (int i = 0; i < stages; ++i)
      for (int power = 0; power < stages; ++power) v(i, power) = std::pow(GaussStep::c[i], power);
    return Eigen::Matrix4d(v.inverse());  // column j: coefficients of L_j
  }();
  std::array<double, stages> weight{};
  double power = theta;
  for (int i = 0; i < stages; ++i, power *= theta)
    for (int j = 0; j < stages; ++j) weight[static_cast<std::size_t>(j)] += monomials(i, j) * power / (i + 1);
  return weight;
}

// Third divided difference of the slopes: the fourth derivative of x over the step, in s, times h^-3 of what is returned.
Vector fourth_difference(const Matrix& k) {
  Vector d[stages];
  for (int i = 0; i < stages; ++i) d[i] = k.col(i);
  for (int order = 1; order < stages; ++order)
    for (int i = 0; i + order < stages; ++i) d[i] = (d[i + 1] - d[i]) / (GaussStep::c[i + order] - GaussStep::c[i]);
  return 6.0 * d[0];
}

}  // namespace

void LimitCycleOptions::validate() const {
  if (segments < 1 || segments > 1000) throw std::invalid_argument(fmt::format("segments must be in 1..1000, got {}", segments));
  if (!(tolerance >= 1e-14 && tolerance <= 1e-2)) throw std::invalid_argument(fmt::format("tolerance must be in [1e-14, 1e-2], got {}", tolerance));
  if (most_steps < segments) throw std::invalid_argument(fmt::format("most_steps must be >= segments, got {}", most_steps));
}

struct LimitCycle::Mesh {
  std::vector<double> s;     // ends of the intervals, 0 .. 1; all i/m among them
  std::vector<int> first;    // interval at which segment i begins, one more for the end
  std::vector<Matrix> k;     // slopes in each interval, the guess for the next solution
  std::vector<Vector> from;  // x at the beginning of each interval
  Vector reference;          // u it was laid for
  Vector size;               // of the cycle, per coordinate
  int intervals() const { return static_cast<int>(k.size()); }
};

// Everything one evaluation fills, of all segments: end points, slopes over (X_i, ln T, p), phase.
struct LimitCycle::Sweep {
  Sweep(const Problem& flow, int segments)
      : columns(flow.size() + 1 + flow.parameters()),
        step(flow, columns),
        end(flow.size(), segments),
        x(flow.size(), segments),
        phi(static_cast<std::size_t>(segments), Matrix(flow.size(), columns)),
        ddphi(phi),
        harmonic_slope(columns, 2 * segments),
        harmonic_second(harmonic_slope) {}
  int columns;
  GaussStep step;
  Matrix end, x;
  std::vector<Matrix> phi, ddphi;
  Eigen::Vector2d harmonic;
  Matrix harmonic_slope, harmonic_second;  // two columns a segment
  Vector at;                               // u it holds first derivatives of
  bool ok = false;
};

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
  if (flow.derivatives() >= 2) offer_derivatives(2);
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
  if (flow_.derivatives() >= 2) offer_derivatives(2);
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
  const int n = flow_.size(), k = flow_.parameters(), m = segments_, at_log_period = n;
  if (!u.allFinite() || !follow(u)) return false;
  Mesh& mesh = *mesh_;
  Sweep& w = *sweep_;
  const double period = this->period(u), winding = 2.0 * pi * (1 << level_);
  const auto p = u.tail(k);
  Matrix x, x_v;
  to_points(u, x);
  w.x = x;
  w.harmonic.setZero();
  w.harmonic_slope.setZero();
  w.harmonic_second.setZero();
  w.ok = false;
  double log_period_v = 0.0;
  if (order == 2) {
    to_points(v, x_v);
    log_period_v = v[log_period];
  }
  Vector at(n), dh = Vector::Zero(w.columns), ddh = Vector::Zero(w.columns), at_v(n);
  for (int i = 0; i < m; ++i) {
    const auto slot = static_cast<std::size_t>(i);
    Matrix& slope = w.phi[slot];
    Matrix& second = w.ddphi[slot];
    at = x.col(i);
    slope.setZero();
    slope.leftCols(n).setIdentity();
    if (order == 2) {
      second.setZero();
      at_v = x_v.col(i);
    }
    for (int step = mesh.first[slot]; step < mesh.first[slot + 1]; ++step) {
      const auto place = static_cast<std::size_t>(step);
      const double length = mesh.s[place + 1] - mesh.s[place], h = period * length;
      mesh.from[place] = at;
      if (!w.step.solve(at, p, h, mesh.k[place])) return false;
      dh[at_log_period] = h;
      ddh[at_log_period] = h * log_period_v;
      if (order >= 1) w.step.first(slope, dh);
      if (order == 2) w.step.second(at_v, h * log_period_v, v.tail(k), second, ddh);
      for (int stage = 0; stage < stages; ++stage) {
        // cos and sin part of the first harmonic of <c, x>
        const double angle = winding * (mesh.s[place] + GaussStep::c[stage] * length), share = 2.0 * length * GaussStep::b[stage];
        const Eigen::Vector2d weight(share * std::cos(angle), share * std::sin(angle));
        w.harmonic += weight * phase_.dot(w.step.stage(stage));
        if (order >= 1) w.harmonic_slope.middleCols(2 * i, 2).noalias() += (w.step.stage_slope(stage).transpose() * phase_) * weight.transpose();
        if (order == 2) w.harmonic_second.middleCols(2 * i, 2).noalias() += (w.step.stage_second(stage).transpose() * phase_) * weight.transpose();
      }
      at = w.step.end();
    }
    w.end.col(i) = at;
  }
  if (order >= 1) {
    w.at = u;
    w.ok = true;
  }
  if (r) {
    Matrix gap(n, m);
    for (int i = 0; i < m; ++i) gap.col(i) = w.end.col(i) - x.col((i + 1) % m);
    from_points(gap, *r);
    (*r)[0] = w.harmonic[0] - u[first_harmonic];
    (*r)[1] = w.harmonic[1];
  }
  if (!j) return true;
  const auto& maps = order == 2 ? w.ddphi : w.phi;
  const Matrix& harmonic = order == 2 ? w.harmonic_second : w.harmonic_slope;
  j->setZero();
  for (int i = 0; i < m; ++i) {
    const Matrix& map = maps[static_cast<std::size_t>(i)];
    const int here = scalars + i * n, next = scalars + ((i + 1) % m) * n;
    j->block(here, here, n, n) += map.leftCols(n);
    if (order == 1) j->block(here, next, n, n).diagonal().array() -= 1.0;
    j->block(here, log_period, n, 1) = map.col(n);
    j->block(here, size(), n, k) = map.rightCols(k);
    const auto rows = harmonic.middleCols(2 * i, 2).transpose();
    j->block(0, here, scalars, n) = rows.leftCols(n);
    j->block(0, log_period, scalars, 1) += rows.col(n);
    j->block(0, size(), scalars, k) += rows.rightCols(k);
  }
  if (order == 1) (*j)(0, first_harmonic) = -1.0;
  rows_and_columns(*j);
  return true;
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

// ------------------------------------------------------------------------------------------------------------------------- mesh

bool LimitCycle::follow(In u) const {
  if (!mesh_) {  // uniform; guess() lays a better one
    mesh_ = std::make_unique<Mesh>();
    Matrix x;
    to_points(u, x);
    const int n = flow_.size();
    mesh_->size = Vector::Ones(n);
    for (int i = 0; i < segments_; ++i) {
      mesh_->first.push_back(i * first_steps);
      for (int step = 0; step < first_steps; ++step) mesh_->s.push_back((i + static_cast<double>(step) / first_steps) / segments_);
    }
    mesh_->first.push_back(segments_ * first_steps);
    mesh_->s.push_back(1.0);
    Vector at(n + flow_.parameters()), f(n);
    at.tail(flow_.parameters()) = u.tail(flow_.parameters());
    for (int i = 0; i < segments_ * first_steps; ++i) {
      at.head(n) = x.col(i / first_steps);
      flow_.residual(at, f);
      mesh_->k.push_back(f.replicate(1, stages));
      mesh_->from.push_back(x.col(i / first_steps));
    }
    mesh_->reference = Vector();
  }
  if (mesh_->reference.size() == 0) {
    mesh_->reference = u;  // so that the evaluations below do not come here again
    for (int pass = 0; pass < 3; ++pass) {
      if (!evaluate(u, 0, u, nullptr, nullptr)) break;
      Matrix x;
      to_points(u, x);
      lay_mesh(u, x);
    }
    return true;
  }
  const int n = flow_.size();
  // In the size of either cycle: the mesh may be that of a far larger one.
  Matrix x;
  to_points(u, x);
  const Vector range = x.rowwise().maxCoeff() - x.rowwise().minCoeff(), own = range.cwiseMax(smallest_part * range.maxCoeff());
  double distance = std::abs(u[log_period] - mesh_->reference[log_period]);
  for (int i = 0; i < n * segments_; ++i)
    distance = std::max(distance, std::abs(u[scalars + i] - mesh_->reference[scalars + i]) / std::min(mesh_->size[i % n], own[i % n]));
  if (distance <= far) return true;
  mesh_->reference = u;
  for (int pass = 0; pass < (distance > very_far ? 2 : 1); ++pass) {
    if (!evaluate(u, 0, u, nullptr, nullptr)) {  // the mesh of a far-off evaluation: a fresh one
      mesh_.reset();
      return follow(u);
    }
    lay_mesh(u, x);
  }
  return true;
}

// Equal errors: an interval has length eta l, l = (size / |x^(5)|)^(1/5) the scale on which x moves by its size, and eta such that all
// intervals together stay below the tolerance.
void LimitCycle::lay_mesh(In u, const Matrix&) const {
  Mesh& old = *mesh_;
  const int n = flow_.size(), count = old.intervals();
  const double period = this->period(u);
  Vector low = old.from[0], high = low;
  for (const Vector& x : old.from) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  const Vector range = high - low;
  old.size = range.cwiseMax(1e-6 * range.maxCoeff()).cwiseMax(std::numeric_limits<double>::min());
  // 1/l in each interval, from the fourth derivatives on either side of it.
  std::vector<Vector> fourth(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    fourth[at] = (period / std::pow(old.s[at + 1] - old.s[at], 3) * fourth_difference(old.k[at])).cwiseQuotient(old.size);
  }
  std::vector<double> jump(static_cast<std::size_t>(count));  // |x^(5)| about the end of each interval
  for (int i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(i), next = static_cast<std::size_t>((i + 1) % count);
    const double apart = 0.5 * (old.s[at + 1] - old.s[at] + old.s[next + 1] - old.s[next]);
    jump[at] = (fourth[next] - fourth[at]).lpNorm<Eigen::Infinity>() / apart;
  }
  std::vector<double> density(static_cast<std::size_t>(count));
  double total = 0.0;
  for (int i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(i), before = static_cast<std::size_t>((i + count - 1) % count);
    density[at] = shortest_scale + std::pow(std::max(jump[at], jump[before]), 0.2);
    total += density[at] * (old.s[at + 1] - old.s[at]);
  }
  double eta = 1.0;
  for (int i = 0; i < 6; ++i) eta = std::pow(options_.tolerance / (error_constant * std::max(1.0, total / eta)), 1.0 / 9.0);
  eta = std::max(eta, total / options_.most_steps);
  // Segment by segment, so that all i/m stay ends of intervals.
  auto fresh = std::make_unique<Mesh>();
  fresh->reference = u;
  fresh->size = old.size;
  Vector state(n + flow_.parameters()), f(n);
  state.tail(flow_.parameters()) = u.tail(flow_.parameters());
  const auto interpolated = [&](int interval, double s) {
    const auto at = static_cast<std::size_t>(interval);
    const double length = old.s[at + 1] - old.s[at];
    const auto weight = inner_weights((s - old.s[at]) / length);
    Vector x = old.from[at];
    for (int stage = 0; stage < stages; ++stage) x += (period * length * weight[static_cast<std::size_t>(stage)]) * old.k[at].col(stage);
    return x;
  };
  for (int i = 0; i < segments_; ++i) {
    const int from = old.first[static_cast<std::size_t>(i)], to = old.first[static_cast<std::size_t>(i) + 1];
    double share = 0.0;
    for (int step = from; step < to; ++step)
      share += density[static_cast<std::size_t>(step)] * (old.s[static_cast<std::size_t>(step) + 1] - old.s[static_cast<std::size_t>(step)]);
    const int pieces = std::max(1, static_cast<int>(std::ceil(share / eta)));
    fresh->first.push_back(fresh->intervals());
    int step = from;
    double passed = 0.0;
    std::vector<double> ends = {old.s[static_cast<std::size_t>(from)]};
    for (int piece = 1; piece < pieces; ++piece) {
      const double target = share * piece / pieces;
      while (passed + density[static_cast<std::size_t>(step)] * (old.s[static_cast<std::size_t>(step) + 1] - old.s[static_cast<std::size_t>(step)]) <
                 target &&
             step + 1 < to) {
        passed += density[static_cast<std::size_t>(step)] * (old.s[static_cast<std::size_t>(step) + 1] - old.s[static_cast<std::size_t>(step)]);
        ++step;
      }
      ends.push_back(old.s[static_cast<std::size_t>(step)] + (target - passed) / density[static_cast<std::size_t>(step)]);
    }
    ends.push_back(old.s[static_cast<std::size_t>(to)]);
    int place = from;
    for (int piece = 0; piece < pieces; ++piece) {
      const auto at = static_cast<std::size_t>(piece);
      const double length = ends[at + 1] - ends[at];
      const auto interval_of = [&](double s) {
        while (place + 1 < to && old.s[static_cast<std::size_t>(place) + 1] <= s) ++place;
        return place;
      };
      fresh->s.push_back(ends[at]);
      fresh->from.push_back(interpolated(interval_of(ends[at]), ends[at]));
      Matrix k(n, stages);
      for (int stage = 0; stage < stages; ++stage) {
        const double s = ends[at] + GaussStep::c[stage] * length;
        state.head(n) = interpolated(interval_of(s), s);
        flow_.residual(state, f);
        k.col(stage) = f;
      }
      fresh->k.push_back(std::move(k));
    }
  }
  fresh->first.push_back(fresh->intervals());
  fresh->s.push_back(1.0);
  sweep_->ok = false;
  mesh_ = std::move(fresh);
}

int LimitCycle::steps() const { return mesh_ ? mesh_->intervals() : 0; }

// ---------------------------------------------------------------------------------------------------------------- what is asked

Vector LimitCycle::guess(const Orbit& orbit, double period, In p) const {
  constexpr int count = 256;
  std::complex<double> harmonic = 0.0;
  for (int i = 0; i < count; ++i) harmonic += phase_.dot(orbit(static_cast<double>(i) / count)) * std::polar(1.0, -2.0 * pi * i / count);
  const double shift = -std::arg(harmonic) / (2.0 * pi);  // the peak
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
    for (int stage = 0; stage < stages; ++stage) all.col(i) += (period * length * weight[static_cast<std::size_t>(stage)]) * mesh_->k[at].col(stage);
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
  for (std::size_t step = 0; step < mesh_->k.size(); ++step) {
    const double h = period * (mesh_->s[step + 1] - mesh_->s[step]);
    for (int i = 0; i < stages; ++i) {
      at.head(n) = mesh_->from[step];
      for (int l = 0; l < stages; ++l) at.head(n) += h * GaussStep::a[i][l] * mesh_->k[step].col(l);
      flow_.jacobian(at, jacobian);
      sum += h * GaussStep::b[i] * jacobian.leftCols(n).trace();
    }
  }
  return sum;
}

double LimitCycle::slowest(In u, Vector& x) const {
  if (!evaluate(u, 0, u, nullptr, nullptr)) return std::numeric_limits<double>::quiet_NaN();
  double least = std::numeric_limits<double>::infinity(), largest = 0.0;
  for (std::size_t step = 0; step < mesh_->k.size(); ++step)
    for (int i = 0; i < stages; ++i) {
      const double speed = mesh_->k[step].col(i).cwiseQuotient(mesh_->size).norm();
      largest = std::max(largest, speed);
      if (speed >= least) continue;
      least = speed;
      x = mesh_->from[step];
    }
  return least / largest;
}

// ------------------------------------------------------------------------------------------------------------------ multipliers

bool LimitCycle::do_multipliers(In u, Eigen::VectorXcd& mu, Eigen::VectorXi& group) const {
  const int n = flow_.size(), m = segments_;
  group.setZero();
  if (!(sweep_->ok && sweep_->at == u) && !evaluate(u, 1, u, nullptr, nullptr)) return false;
  // Planes normal to f at the points: M maps f to itself, and the rest is what remains of it there.
  std::vector<Matrix> plane(static_cast<std::size_t>(m)), map(static_cast<std::size_t>(m));
  Vector at(n + flow_.parameters()), f(n);
  at.tail(flow_.parameters()) = u.tail(flow_.parameters());
  for (int i = 0; i < m; ++i) {
    at.head(n) = sweep_->x.col(i);
    flow_.residual(at, f);
    if (!(f.norm() > 0.0)) return false;
    const Eigen::HouseholderQR<Matrix> qr(f);
    plane[static_cast<std::size_t>(i)] = (qr.householderQ() * Matrix::Identity(n, n)).rightCols(n - 1);
  }
  for (int i = 0; i < m; ++i)
    map[static_cast<std::size_t>(i)] = plane[static_cast<std::size_t>((i + 1) % m)].transpose() *
                                       sweep_->phi[static_cast<std::size_t>(i)].leftCols(n) * plane[static_cast<std::size_t>(i)];
  mu = cyclic_eigenvalues(map);
  return mu.allFinite();
}

void LimitCycle::shift_to_next(MatrixOut s) const {
  const int n = flow_.size(), m = segments_;
  s.setZero();
  for (int i = 0; i < m; ++i) s.block(scalars + i * n, scalars + ((i + 1) % m) * n, n, n).diagonal().setOnes();
  rows_and_columns(s);
}

// L(lambda) = blkdiag(phi_x) - e^{lambda T/m} S = r_x + (1 - e^{lambda T/m}) S, to first order r_x - lambda T/m S.
void LimitCycle::do_velocity(In u, int slope, MatrixOut c) const {
  c.setZero();
  if (slope >= 0) return;
  shift_to_next(c);
  c *= -period(u) / segments_;
}

void LimitCycle::do_characteristic(In u, double kappa, Eigen::MatrixXcd& shift, Eigen::MatrixXcd& by_kappa) const {
  Matrix s(size(), size());
  shift_to_next(s);
  const double part = period(u) / segments_;
  const std::complex<double> turn = std::polar(1.0, kappa * part);
  shift = (1.0 - turn) * s;
  by_kappa = (std::complex<double>(0.0, -part) * turn) * s;
}

bool LimitCycle::do_characteristic_slope(In u, double kappa, int i, Eigen::MatrixXcd& slope) const {
  if (i != log_period) return false;
  Matrix s(size(), size());
  shift_to_next(s);
  const double angle = kappa * period(u) / segments_;
  slope = (std::complex<double>(0.0, -angle) * std::polar(1.0, angle)) * s;
  return true;
}

double LimitCycle::do_base_frequency(In u) const { return 2.0 * pi / period(u); }

const OrbitProblem& LimitCycle::do_doubled() const {
  if (!doubled_) doubled_.reset(new LimitCycle(*this));
  return *doubled_;
}

Vector LimitCycle::do_in_doubled(In u) const {
  (void)do_doubled();
  Matrix x, twice(flow_.size(), 2 * segments_);
  to_points(u, x);
  twice << x, x;
  Vector u2(doubled_->size() + parameters());
  u2[first_harmonic] = u[first_harmonic];
  doubled_->from_points(twice, u2);
  u2[log_period] = u[log_period];
  u2.tail(parameters()) = u.tail(parameters());
  if (evaluate(u, 0, u, nullptr, nullptr)) {  // its mesh twice over
    auto mesh = std::make_unique<Mesh>();
    const Mesh& own = *mesh_;
    for (int turn = 0; turn < 2; ++turn) {
      for (int i = 0; i < segments_; ++i) mesh->first.push_back(own.first[static_cast<std::size_t>(i)] + turn * own.intervals());
      for (int i = 0; i < own.intervals(); ++i) mesh->s.push_back(0.5 * (turn + own.s[static_cast<std::size_t>(i)]));
      mesh->k.insert(mesh->k.end(), own.k.begin(), own.k.end());
      mesh->from.insert(mesh->from.end(), own.from.begin(), own.from.end());
    }
    mesh->first.push_back(2 * own.intervals());
    mesh->s.push_back(1.0);
    mesh->size = own.size;
    mesh->reference = u2;
    doubled_->mesh_ = std::move(mesh);
    doubled_->sweep_->ok = false;
  }
  return u2;
}

Vector LimitCycle::do_from_doubled(In u) const {
  Matrix x;
  doubled_->to_points(u, x);
  Vector single(size() + parameters());
  single[first_harmonic] = u[first_harmonic];
  from_points(0.5 * (x.leftCols(segments_) + x.rightCols(segments_)), single);
  single[log_period] = u[log_period];
  single.tail(parameters()) = u.tail(parameters());
  return single;
}

}  // namespace whirl::models
