#pragma once
/// Largest and least value of what repeats, with their signs, from its harmonics:
///
///     q(t) = Re sum_k z_k e^{i k t},   k = 0, 1, ...
///
///     const Extremes e = extremes_of(std::vector<std::complex<double>>{0.0, z1, z2});
///     e.highest; e.lowest; e.largest();    // of q, of q, of |q|

#include <algorithm>
#include <complex>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "models/superharmonic.hpp"
#include "studies/branch_output.hpp"

namespace whirl::studies {

struct Extremes {
  double highest, lowest;
  double largest() const { return std::max(highest, -lowest); }  ///< of |q|
};

/// To rounding: the extremes among samples are polished by Newton on q' = 0.
Extremes extremes_of(std::span<const std::complex<double>> z);

/// Columns <q>_max, <q>_crest, <q>_trough of each coordinate of averaged states. `harmonics(u, i)` gives coordinate i as harmonics of one base
/// frequency; `what` is added to the descriptions.
std::vector<PointColumn> extreme_columns(const std::vector<std::string>& coordinates, const std::string& unit, const std::string& what,
                                         std::function<std::vector<std::complex<double>>(In, int)> harmonics);

/// q1 and q2 of an averaged superharmonic response, its linear part included. `flow` must live on.
std::vector<PointColumn> extreme_columns(const models::SuperharmonicFlow& flow, int order);

}  // namespace whirl::studies
