#pragma once
/// Start values of periodic motions that no branch need lead to: all steady states of averaged equations about the resonances of order 1/2, 1, 3/2,
/// 2, 3 (models/averaged_states.hpp), and what deflation finds beside them in a balance of few harmonics (continuation/deflation.hpp).
///
///     OrbitSeeds seeds(source, values);                    // values of the parameter
///     for (const Vector& u : seeds.motions(balance, i))    // solutions of `balance` at values[i], each once, mirror images as one
///       net.add_seed(u, ...);
///
/// The averaged states are solved for once, `motions` polishes them in the balance given.

#include <map>

#include "models/averaged_states.hpp"
#include "studies/forced_system.hpp"

namespace whirl::studies {

class OrbitSeeds {
 public:
  /// nu: base period of the averaged motions, in excitation periods.
  OrbitSeeds(const ForcedSystem& source, std::vector<double> values, int nu);

  int size() const { return static_cast<int>(values_.size()); }
  double value(int i) const { return values_[static_cast<std::size_t>(i)]; }
  /// Motions whose least period is that of the balance, or a part of it that none of the excitation's periods divides.
  std::vector<Vector> motions(const models::HarmonicBalance& hb, int i) const;
  /// Are two motions of a balance equal, or images under its reflections? Much smaller than `size` is rest.
  static bool alike(const Problem& f, In a, In b, double size);

 private:
  std::vector<Vector> deflated(const models::HarmonicBalance& hb, const std::vector<Vector>& known, std::vector<Vector> starts, double p) const;
  std::vector<double> values_;
  int nu_;
  std::vector<std::vector<Eigen::MatrixXcd>> states_;                       // of each value
  mutable std::map<int, std::unique_ptr<models::HarmonicBalance>> coarse_;  // by nu
};

}  // namespace whirl::studies
