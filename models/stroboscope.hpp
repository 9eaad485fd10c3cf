#pragma once
/// The stroboscopic map of a forced modal system, x(t0) -> x(t0 + T), T = 2 pi/omega, with its derivative (monodromy matrix) by the variational
/// equations, and the flow between any two times, all with the fast explicit integrator.
///
///     Stroboscope strobe(system, {.relative_tolerance = 1e-10});
///     strobe.map(y);                 // one period from omega t = 0
///     strobe.map(y, derivative, 2);  // two periods and d end / d start
///
/// Size of states: 2 n, (q, q'). Throws std::invalid_argument for sizes that do not fit; a run that cannot go on returns false, see `diverged`.
/// Holds scratch memory: one per thread.

#include <memory>
#include <string>

#include "core/problem.hpp"
#include "models/flat_flow.hpp"

namespace whirl::models {

struct StroboscopeOptions {
  double relative_tolerance = 1e-10;
  double absolute_tolerance = 1e-12;  ///< of q [m] and q' [m/s]
  double largest_norm = 1e6;          ///< beyond it the motion diverges
};

class Stroboscope {
 public:
  explicit Stroboscope(const ModalSystem<double>& system, const StroboscopeOptions& options = {});
  ~Stroboscope();
  Stroboscope(Stroboscope&&) noexcept;
  Stroboscope& operator=(Stroboscope&&) noexcept;

  int size() const;  ///< 2 n
  double omega() const;
  double period() const;

  /// From t0 to t1 in place.
  [[nodiscard]] bool advance(Vector& y, double t0, double t1);
  [[nodiscard]] bool map(Vector& y, int periods = 1);
  [[nodiscard]] bool map(Vector& y, Matrix& derivative, int periods = 1);
  /// One period of the state with one tangent vector.
  [[nodiscard]] bool map_tangent(Vector& y, Vector& tangent);

  bool diverged() const;  ///< of the last call that returned false
  std::string why() const;
  long steps() const;  ///< taken so far

 private:
  struct Base;
  template <class State>
  struct Run;
  static std::unique_ptr<Base> make(const ModalSystem<double>& system, int tangents, const StroboscopeOptions& options);
  void remember(const Base& run);
  std::unique_ptr<Base> plain_, tangent_, monodromy_;
  ModalSystem<double> system_;
  StroboscopeOptions options_;
  bool diverged_ = false;
  std::string why_;
};

}  // namespace whirl::models
