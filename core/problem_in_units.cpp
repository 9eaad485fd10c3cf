#include "core/problem_in_units.hpp"

#include <algorithm>

namespace whirl {
namespace {

constexpr double ordinary = 1e3;  // units between 1 / ordinary and ordinary are left alone

}  // namespace

ProblemInUnits::ProblemInUnits(const Problem& f, Vector units, Vector rows)
    : Problem(f.size(), f.parameters(), f.is_flow()), f_(f), units_(std::move(units)), rows_(std::move(rows)), u_(units_.size()) {
  if (units_.size() != f.size() + f.parameters() || rows_.size() != f.size() || !(units_.minCoeff() > 0.0) || !(rows_.minCoeff() > 0.0))
    throw std::invalid_argument("units must be positive, one for each unknown, parameter and equation");
  for (const auto& r : f.reflections()) add_reflection(r);
  name_parameters(f.parameter_names());
  offer_derivatives(f.derivatives());
}

void ProblemInUnits::do_residual(In y, Out r) const {
  u_ = y.cwiseProduct(units_);
  f_.residual(u_, r);
  r.array() /= rows_.array();
}

void ProblemInUnits::do_jacobian(In y, MatrixOut j) const {
  u_ = y.cwiseProduct(units_);
  f_.jacobian(u_, j);
  for (Eigen::Index c = 0; c < j.cols(); ++c) j.col(c).array() *= units_[c] / rows_.array();
}

void ProblemInUnits::do_linearise(In y, Out r, MatrixOut j) const {
  u_ = y.cwiseProduct(units_);
  f_.linearise(u_, r, j);
  r.array() /= rows_.array();
  for (Eigen::Index c = 0; c < j.cols(); ++c) j.col(c).array() *= units_[c] / rows_.array();
}

void ProblemInUnits::do_second(In y, In v, MatrixOut h) const {
  u_ = y.cwiseProduct(units_);
  f_.second(u_, v.cwiseProduct(units_), h);
  for (Eigen::Index c = 0; c < h.cols(); ++c) h.col(c).array() *= units_[c] / rows_.array();
}

void ProblemInUnits::do_third(In y, In a, In b, In c, Out t) const {
  u_ = y.cwiseProduct(units_);
  f_.third(u_, a.cwiseProduct(units_), b.cwiseProduct(units_), c.cwiseProduct(units_), t);
  t.array() /= rows_.array();
}

Vector row_sizes(const Problem& f, In u, const Vector& units) {
  const int n = f.size();
  Matrix j(n, n + f.parameters());
  f.jacobian(u, j);
  Vector rows = j.leftCols(n).cwiseAbs() * units.head(n);
  const double largest = rows.allFinite() ? rows.maxCoeff() : 0.0;
  for (double& row : rows)
    if (!(row > 0.0) || !std::isfinite(row)) row = largest > 0.0 ? largest : 1.0;
  return rows;
}

NewtonResult newton_in_units(const Problem& f, const Vector& start, const Vector& units, const NewtonOptions& options) {
  const int n = f.size();
  const Vector rows = row_sizes(f, start, units);
  const auto far = [](const Vector& sizes) { return sizes.minCoeff() < 1.0 / ordinary || sizes.maxCoeff() > ordinary; };
  if (!far(units) && !far(rows)) return newton(f, start, options);
  Vector all = Vector::Ones(n + f.parameters());
  all.head(n) = units;
  const ProblemInUnits scaled(f, all, rows);
  NewtonResult result = newton(scaled, start.cwiseQuotient(all), options);
  result.x.array() *= all.array();
  result.x.tail(f.parameters()) = start.tail(f.parameters());
  return result;
}

}  // namespace whirl
