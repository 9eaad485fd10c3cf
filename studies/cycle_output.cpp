#include "studies/cycle_output.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <limits>

#include "core/newton.hpp"

namespace whirl::studies {

using namespace models;

namespace {

constexpr int least_samples = 256;  // of a period
constexpr int samples_a_step = 8;   // of the mesh
constexpr double slow = 0.05;       // a cycle whose slowest point is slower than this part of its fastest comes near an equilibrium

// Largest of periodic samples by a parabola through it and its neighbours.
double largest(const Vector& f) {
  Eigen::Index at = 0;
  const auto n = f.size();
  const double top = f.maxCoeff(&at), before = f[(at + n - 1) % n], after = f[(at + 1) % n], bend = before - 2.0 * top + after;
  return bend < 0.0 ? top - 0.125 * (after - before) * (after - before) / bend : top;
}

}  // namespace

CycleReader::CycleReader(const Problem& flow, std::vector<PointColumn> columns, const LimitCycleOptions& options)
    : flow_(flow), columns_(std::move(columns)), extremes_(static_cast<Eigen::Index>(columns_.size()), 2) {
  levels_.push_back(std::make_unique<LimitCycle>(flow, Vector::Unit(flow.size(), 0), options));
  single_ = levels_.front().get();
}

const LimitCycle* CycleReader::cycle_of(In u) {
  if (u.size() == flow_.size() + flow_.parameters()) return nullptr;
  const LimitCycle* cycle = single_;
  while (cycle->size() + cycle->parameters() < u.size()) cycle = static_cast<const LimitCycle*>(&cycle->doubled());
  return cycle;
}

double CycleReader::period(In u) {
  const LimitCycle* cycle = cycle_of(u);
  return cycle ? cycle->period(u) : 0.0;
}

int CycleReader::multiple(In u) {
  const LimitCycle* cycle = cycle_of(u);
  return cycle ? 1 << cycle->level() : 0;
}

void CycleReader::look_at(In u) {
  if (last_.size() == u.size() && last_ == u) return;
  last_ = u;
  const LimitCycle* cycle = cycle_of(u);
  error_ = 0.0;
  if (!cycle) {
    for (std::size_t c = 0; c < columns_.size(); ++c) extremes_.row(static_cast<Eigen::Index>(c)).setConstant(columns_[c].value(u));
    return;
  }
  error_ = cycle->trivial_error(u);
  const Matrix x = cycle->samples(u, std::max(least_samples, samples_a_step * cycle->steps()));
  Vector at(flow_.size() + flow_.parameters()), values(x.cols());
  at.tail(flow_.parameters()) = u.tail(flow_.parameters());
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    for (Eigen::Index i = 0; i < x.cols(); ++i) {
      at.head(flow_.size()) = x.col(i);
      values[i] = columns_[c].value(at);
    }
    extremes_(static_cast<Eigen::Index>(c), 0) = largest(values);
    extremes_(static_cast<Eigen::Index>(c), 1) = -largest(-values);
  }
}

std::vector<PointColumn> CycleReader::extremes(const std::string& unit_of_time) {
  std::vector<PointColumn> all;
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    if (columns_[c].unit == "rad") continue;  // a phase may run round
    for (const int side : {0, 1})
      all.push_back({columns_[c].name + (side == 0 ? "_max" : "_min"), columns_[c].unit,
                     columns_[c].description + (side == 0 ? ", largest along the cycle" : ", least along the cycle"),
                     [this, c, side](In u) {
                       look_at(u);
                       return extremes_(static_cast<Eigen::Index>(c), side);
                     },
                     side == 0 && (columns_[c].shown || columns_[c].name.starts_with("q"))});
  }
  all.push_back({"cycle_period", unit_of_time, "period of the cycle; 0 for equilibria", [this](In u) { return period(u); }, true});
  all.push_back({"trivial_error", "-", "distance from 1 of the multiplier of the cycle's own direction; 0 for equilibria", [this](In u) {
                   look_at(u);
                   return error_;
                 }});
  return all;
}

std::vector<Column> CycleReader::orbit(In u, int count, const std::string& unit_of_time) {
  const LimitCycle* cycle = cycle_of(u);
  if (!cycle) return {};
  const Matrix x = cycle->samples(u, count);
  std::vector<Column> all = {{"t", unit_of_time, "time", {}}};
  for (int i = 0; i <= count; ++i) all[0].values.push_back(cycle->period(u) * i / count);
  Vector at(flow_.size() + flow_.parameters());
  at.tail(flow_.parameters()) = u.tail(flow_.parameters());
  for (const auto& column : columns_) {
    Column c{column.name, column.unit, column.description, {}};
    for (int i = 0; i <= count; ++i) {
      at.head(flow_.size()) = x.col(i % count);
      c.values.push_back(column.value(at));
    }
    all.push_back(std::move(c));
  }
  return all;
}

std::optional<NearEquilibrium> equilibrium_approached(const Problem& flow, const LimitCycle& cycle, In u) {
  NearEquilibrium near;
  Vector x;
  near.slowness = cycle.slowest(u, x);
  if (!(near.slowness < slow)) return std::nullopt;
  Vector start(flow.size() + flow.parameters());
  start << x, u.tail(flow.parameters());
  const NewtonResult at = newton(flow, start);
  if (!at.ok()) return std::nullopt;
  near.x = at.x.head(flow.size());
  Matrix j(flow.size(), flow.size() + flow.parameters());
  flow.jacobian(at.x, j);
  near.eigenvalues = Eigen::EigenSolver<Matrix>(Matrix(j.leftCols(flow.size())), false).eigenvalues();
  double unstable = std::numeric_limits<double>::infinity(), stable = -unstable;
  for (const auto& z : near.eigenvalues) {
    if (z.real() > 0.0) unstable = std::min(unstable, z.real());
    else stable = std::max(stable, z.real());
  }
  near.saddle_quantity = unstable + stable;
  return near;
}

std::string describe(const NearEquilibrium& near) {
  std::string point, values;
  for (const double x : near.x) point += fmt::format("{}{:.6g}", point.empty() ? "" : ", ", x);
  for (const auto& z : near.eigenvalues) {
    if (z.imag() < 0.0) continue;
    values += values.empty() ? "" : ", ";
    values += z.imag() > 0.0 ? fmt::format("{:.6g} +- {:.6g} i", z.real(), z.imag()) : fmt::format("{:.6g}", z.real());
  }
  return fmt::format("near the equilibrium ({}), eigenvalues {}, saddle quantity {:.6g}", point, values, near.saddle_quantity);
}

}  // namespace whirl::studies
