#pragma once
/// Third derivatives of the discrete map of a Gauss step along three directions a, b, c: all mixed derivatives by subsets of them, as the parts of
/// a number with three nilpotent units.
///
///     K_S = J_i (Y_S, p_S) + sum over partitions of S of D2f and D3f of the parts,   Y_S = x_S + sum_j a_ij sum_{R in S} h_{S\R} K_j,R
///
///     GaussJet jet(flow);
///     jet.x = {x, x_a, x_b, 0, x_c, 0, 0, 0};       // bits 1, 2, 4 of the place: a, b, c
///     if (step.solve(jet.x[0], p, jet.h[0], k)) jet.advance(step);
///     jet.x[7];                                     // D3 x+ [a, b, c]

#include <array>

#include "models/dynamics/periodic/gauss_step.hpp"

namespace whirl::models {

class GaussJet {
 public:
  static constexpr std::size_t parts = 8;
  static constexpr std::size_t whole = parts - 1;

  /// `flow` is kept by reference and offers third derivatives.
  explicit GaussJet(const Problem& flow);

  /// Over the step that has just been solved from x[0] over h[0]: x becomes the point behind it.
  void advance(const GaussStep& step);
  const Vector& stage(int i) const { return y_[static_cast<std::size_t>(i)][whole]; }  ///< D3 Y_i [a, b, c]

  std::array<Vector, parts> x, p;  ///< size n and k
  std::array<double, parts> h{};

 private:
  using Parts = std::array<Vector, parts>;
  void stage_points(const GaussStep& step, std::size_t part);
  Vector higher(std::size_t stage, std::size_t part);

  const Problem& flow_;
  int n_;
  std::array<Parts, GaussStep::stages> k_, y_, u_;  // u_: (Y, p)
  Matrix second_;
  Vector third_;
};

}  // namespace whirl::models
