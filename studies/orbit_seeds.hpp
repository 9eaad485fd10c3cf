#pragma once
/// Start values of periodic motions that no branch need lead to: all steady states of averaged equations about the resonances of order 1/2, 1, 3/2,
/// 2, 3 (models/averaged_states.hpp), and what deflation finds beside them in a balance of few harmonics (continuation/deflation.hpp).
///
///     OrbitSeeds seeds(source, values, {.nu = 1, .doubled = true});    // values of the parameter
///     for (const Vector& u : seeds.motions(balance, i))                // solutions of `balance` at values[i], each once, mirror images as one
///       net.add_seed(u, ...);
///
/// The averaged states are solved for once, `motions` polishes them in the balance given. With nu > 1 the orders k/nu are tried too. Deflation is for
/// models of few coordinates: its cost grows with the cube of their number.

#include <map>

#include "models/averaged_states.hpp"
#include "studies/forced_system.hpp"

namespace whirl::studies {

class OrbitSeeds {
 public:
  struct Options {
    int nu = 1;              ///< base period in excitation periods
    bool doubled = true;     ///< motions of twice that period too
    int deflated_up_to = 3;  ///< coordinates beyond which there is no deflation
  };
  OrbitSeeds(const ForcedSystem& source, std::vector<double> values, const Options& options);

  int size() const { return static_cast<int>(values_.size()); }
  double value(int i) const { return values_[static_cast<std::size_t>(i)]; }
  /// Of a balance over nu excitation periods all, of one over 2 nu those that do not repeat after nu already.
  std::vector<Vector> motions(const models::HarmonicBalance& hb, int i) const;
  /// Are two motions of a balance equal, or images under its reflections? Much smaller than `size` is rest.
  static bool alike(const Problem& f, In a, In b, double size);

 private:
  std::vector<Vector> deflated(const models::HarmonicBalance& hb, const std::vector<Vector>& known, std::vector<Vector> starts, double p) const;
  std::vector<double> values_;
  Options options_;
  int nu_;                                                                  // of the averaged states
  std::vector<std::vector<Eigen::MatrixXcd>> states_;                       // of each value
  mutable std::map<int, std::unique_ptr<models::HarmonicBalance>> coarse_;  // by nu
};

}  // namespace whirl::studies
