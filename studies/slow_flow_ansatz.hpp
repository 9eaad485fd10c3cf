#pragma once
/// The ansatz of a slow-flow study: its keys and the averaged equations they choose.

#include "models/slow_flow/ansatz.hpp"
#include "studies/forced_system.hpp"

namespace whirl::studies {

/// Averaged equations of one ansatz, whichever class they come from.
struct AveragedEquations {
  std::unique_ptr<Problem> flow;
  models::Ansatz ansatz;
  std::function<Vector(In u, double t)> motion;  ///< (q, q') at time t
  std::function<Vector(In u)> balance_state;     ///< in the layout of Floquet
  int balance_harmonics = 0;
};

/// [ansatz]
void add_ansatz_keys(Schema& schema);
/// `forced` must outlive the result. Throws InputError (one line) for lists and systems that do not fit.
AveragedEquations averaged_of(const Configuration& c, const ForcedSystem& forced);

}  // namespace whirl::studies
