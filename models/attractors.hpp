#pragma once
/// Attractors of a forced modal system seen in its stroboscopic map P, x(t) -> x(t + T): periodic of multiple m (m points of P, P^m x = x, all
/// Floquet multipliers inside the unit circle), quasi-periodic (the points fill closed curves, largest Lyapunov exponent zero), chaotic (it is
/// positive). A motion that decays more slowly than the run can show is none of them: `slow_decay.hpp` tells it from a torus.
///
/// Two attractors are one if their stroboscopic points are: a shift in time by excitation periods makes no difference. A mirror image under a
/// reflection of the system is another attractor, linked by `mirror_of`.
///
/// A periodic attractor is found by Newton's method on P^m from a point the motion itself reached, and carries the neighbourhood in which it
/// captures:
///
///     V(x) = (x - p)' S (x - p) < r^2,   S = sum_k (B^k)' B^k,   B = A/sqrt|mu|,   A = DP^m(p),   so that V(A d) <= |mu| V(d)
///
/// with mu its largest multiplier. r is 0.7 of the largest for which V falls under one P^m at all of 160 points on five shells inside; it is a
/// tested radius, not a proven one.
///
///     AttractorFinder finder(system, reflections);
///     AttractorSet known(reflections);
///     const Settled s = finder.settle(y0, known);               // captured by a known one, or a new one found
///     const int index = s.known >= 0 ? s.known : known.add(*s.fresh);
///
/// Throws std::invalid_argument for options out of range and starts of the wrong size; what does not settle is an outcome. One finder per thread.

#include <atomic>
#include <optional>

#include "models/steady_motion.hpp"
#include "models/stroboscope.hpp"

namespace whirl::models {

struct AttractorOptions {
  int max_periods = 4000;
  int max_multiple = 12;        ///< longest period looked for, in excitation periods
  int nonperiodic_after = 400;  ///< excitation periods after which the Lyapunov exponent is asked, again after twice as many
  int lyapunov_periods = 800;
  double newton_radius = 0.02;  ///< stroboscopic distance, relative to 1 + |x|, at which Newton's method is tried
  StroboscopeOptions transient{.relative_tolerance = 1e-7, .absolute_tolerance = 1e-9};
  StroboscopeOptions fine{.relative_tolerance = 1e-11, .absolute_tolerance = 1e-13};
  const std::atomic<bool>* interrupted = nullptr;
  void validate() const;
};

struct Attractor {
  MotionKind kind = MotionKind::failed;
  int multiple = 0;                     ///< m; 0 if not periodic
  Matrix points;                        ///< stroboscopic points: 2 n x m in order, or 2 n x lyapunov_periods
  Eigen::VectorXcd multipliers;         ///< of P^m, by falling modulus, where periodic
  double residual = 0.0;                ///< |P^m x - x|
  double lyapunov = 0.0;                ///< largest exponent [1/s]; ln|mu|/(m T) where periodic
  double lyapunov_error = 0.0;          ///< [1/s]
  double second_frequency = 0.0;        ///< over omega, in (0, 1/2], modulo 1 and sign: of a quasi-periodic motion
  std::vector<std::string> symmetries;  ///< reflections that map it to itself
  int mirror_of = -1;                   ///< index in the set of its mirror image, if that is another attractor
  std::string mirror;                   ///< by which reflection
};

/// Where an attractor captures.
class Capture {
 public:
  static constexpr int hits = 30;  ///< consecutive stroboscopic points near a cloud that count as capture
  Capture() = default;
  /// Of a periodic attractor: the ellipsoids around its points.
  Capture(const Attractor& attractor, Stroboscope& coarse, Stroboscope& fine);
  /// Of any other: within `reach` of its cloud of points.
  explicit Capture(const Attractor& attractor);
  Capture reflected(const Vector& signs) const;

  bool near(const Vector& y) const;
  bool at_once() const { return !factors_.empty(); }  ///< one point inside decides
  double radius() const { return radius_; }           ///< r, or the reach of a cloud

 private:
  Matrix points_;
  std::vector<Matrix> factors_;  // upper triangular U, V = |U (x - p)|^2
  double radius_ = 0.0;
};

class AttractorSet {
 public:
  explicit AttractorSet(std::vector<Reflection> reflections = {}) : reflections_(std::move(reflections)) {}
  /// Index of the attractor, new or known. Its mirror images enter with it.
  int add(Attractor attractor, const Capture& capture);
  /// Index of the attractor with these points; -1 if there is none.
  int find(const Attractor& attractor) const;
  int size() const { return static_cast<int>(attractors_.size()); }
  const Attractor& operator[](int i) const { return attractors_[static_cast<std::size_t>(i)]; }
  const Capture& capture(int i) const { return captures_[static_cast<std::size_t>(i)]; }
  const std::vector<Reflection>& reflections() const { return reflections_; }
  /// The attractor that reflection r makes of attractor i.
  int image(int i, std::size_t r) const;

 private:
  std::vector<Reflection> reflections_;
  std::vector<Attractor> attractors_;
  std::vector<Capture> captures_;
};

/// Do both have the same stroboscopic points, in any order?
bool same_motion(const Attractor& a, const Attractor& b);
Attractor reflected(const Attractor& a, const Vector& signs);

struct Settled {
  int known = -1;                  ///< index in the set given
  std::optional<Attractor> fresh;  ///< an attractor that is not in it
  Capture capture;                 ///< of the fresh one
  MotionKind kind = MotionKind::failed;
  int periods = 0;                 ///< excitation periods until decided
  Vector state;                    ///< last stroboscopic point
  double distance = 0.0;           ///< |x(t + T) - x(t)| there
  std::string why;                 ///< if unsettled or failed
  std::optional<Attractor> ahead;  ///< the periodic motion that a decay too slow to be seen leads to
};

class AttractorFinder {
 public:
  explicit AttractorFinder(const ModalSystem<double>& system, const AttractorOptions& options = {});

  /// Follows the motion from (q, q') = y0 at omega t = phase until it is decided where it ends.
  Settled settle(Vector y0, const AttractorSet& known, double phase = 0.0);
  /// The periodic motion of multiple m near x, whether stable or not; none if Newton's method does not converge near it.
  std::optional<Attractor> refine(const Vector& x, int multiple);
  /// The motion on the attractor over its period, or over `periods` where it has none.
  SteadyMotion motion(const Attractor& a, int samples, int periods);

  Stroboscope& fine() { return fine_; }
  Stroboscope& transient() { return transient_; }

 private:
  struct Saddle {  // an unstable periodic motion: a point of it and the derivative of the map over its period there
    int multiple = 0;
    Vector point;
    Matrix derivative;
  };
  std::optional<Attractor> refine(const Vector& start, int multiple, Saddle& at);
  static bool explains(const Saddle& s, const Vector& before, const Vector& after, int periods);
  bool not_periodic(Settled& s, Vector& y);

  AttractorOptions options_;
  Stroboscope transient_, fine_;
};

}  // namespace whirl::models
