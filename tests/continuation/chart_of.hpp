#pragma once
/// Charts of systems written as text: what a study file of kind `two-parameter` does, without the program. And what defines a point of codimension
/// two.

#include <Eigen/Eigenvalues>

#include "continuation/chart.hpp"
#include "tests/continuation/text_model.hpp"

namespace whirl::continuation::text_model {

inline TwoParameterOptions ranges(double a1, double b1, double a2, double b2) {
  TwoParameterOptions o;
  o.range1[0] = o.walk.lower = a1;
  o.range1[1] = o.walk.upper = b1;
  o.range2[0] = a2;
  o.range2[1] = b2;
  return o;
}

/// Every curve of the special points met on the branches from `start`, then those that codimension-2 points lead to.
inline std::vector<DefiningCurve> chart(const System& s, const std::vector<std::string>& lens, const TwoParameterOptions& o,
                                        const std::vector<double>& start) {
  const EquilibriumFlow f2 = s.flow(lens);
  Chart all(f2, o);
  all.want({EventType::fold, EventType::branch_point, EventType::hopf});
  all.on_curve([&, count = 0](DefiningCurve& c) mutable { c.name = to_string(c.type) + std::to_string(++count); });
  for (const auto& b : branches(s, lens[0], o.range1[0], o.range1[1], {start}))
    for (const auto& point : b.special) all.follow_from(point, s.parameters.at(lens[1]), b.name);
  all.follow_meetings();
  return all.curves();
}

inline std::vector<CodimensionTwo> of_type(const std::vector<DefiningCurve>& curves, const std::string& type) {
  std::vector<CodimensionTwo> found;
  for (const auto& c : curves)
    for (const auto& z : c.special)
      if (z.type == type) found.push_back(z);
  return found;
}

/// Sorted by distance from the imaginary axis.
inline Eigen::VectorXcd eigenvalues(const EquilibriumFlow& f2, const Vector& u) {
  Matrix j(f2.size(), f2.size() + 2);
  f2.jacobian(u, j);
  Eigen::VectorXcd z = Eigen::EigenSolver<Matrix>(j.leftCols(f2.size()), false).eigenvalues();
  std::sort(z.begin(), z.end(), [](const auto& a, const auto& b) { return std::abs(a.real()) < std::abs(b.real()); });
  return z;
}

}  // namespace whirl::continuation::text_model
