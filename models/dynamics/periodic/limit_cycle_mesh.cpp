#include <algorithm>

#include "models/dynamics/periodic/limit_cycle_state.hpp"

namespace whirl::models {
namespace {

constexpr int stages = GaussStep::stages;
// Error of a step at its end, (4!)^4 / (9 (8!)^3) h^9 x^(9), the constant of the Gauss method of order 8.
constexpr double error_constant = 2e-8;
constexpr int first_steps = 3;          // of a segment, before anything is known
constexpr double shortest_scale = 2.0;  // a cycle moves by its size in at most its period over this
constexpr double far = 0.05;            // of the cycle's size or in ln T: beyond it the mesh is laid anew
constexpr double smallest_part = 1e-3;  // of the largest range: points that stand for a coordinate may not show how it moves
constexpr double very_far = 0.3;        // beyond it twice, since the first was laid on a poor solution

// Third divided difference of the slopes: the fourth derivative of x over the step, in s, times h^-3 of what is returned.
Vector fourth_difference(const Matrix& k) {
  Vector d[stages];
  for (int i = 0; i < stages; ++i) d[i] = k.col(i);
  for (int order = 1; order < stages; ++order)
    for (int i = 0; i + order < stages; ++i) d[i] = (d[i + 1] - d[i]) / (GaussStep::c[i + order] - GaussStep::c[i]);
  return 6.0 * d[0];
}

}  // namespace

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
      mesh_->step.push_back({.k = f.replicate(1, stages), .lu = {}});
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
    fourth[at] = (period / std::pow(old.s[at + 1] - old.s[at], 3) * fourth_difference(old.step[at].k)).cwiseQuotient(old.size);
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
    for (int stage = 0; stage < stages; ++stage) x += (period * length * weight[static_cast<std::size_t>(stage)]) * old.step[at].k.col(stage);
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
      fresh->step.push_back({.k = std::move(k), .lu = {}});
    }
  }
  fresh->first.push_back(fresh->intervals());
  fresh->s.push_back(1.0);
  sweep_->ok = false;
  mesh_ = std::move(fresh);
}

int LimitCycle::steps() const { return mesh_ ? mesh_->intervals() : 0; }

}  // namespace whirl::models
