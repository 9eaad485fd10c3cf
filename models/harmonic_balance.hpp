#pragma once
/// Periodic motion of a forced modal system by harmonic balance, base frequency Omega = omega/nu, as a Problem.
///
///     q_i = a_i0 + sum_{k=1..H} a_ik cos(k theta) + b_ik sin(k theta),   theta = Omega t
///     r   = harmonics 0..H of  q'' + c q' + k q + b(q, t) - f            rows as unknowns: per coordinate [a0, a1, b1, .., aH, bH]
///
///     row a_k: (K - k^2 Omega^2) a_k + c k Omega b_k + <b cos>     row b_k: (K - k^2 Omega^2) b_k - c k Omega a_k + <b sin>
///
/// q in m, r in m/s^2. The terms are sampled at so many instants that no harmonic of theirs is mistaken for one kept: residual, Jacobian and
/// higher derivatives are exact. Transforms fold theta and theta + pi together, so harmonics that a symmetry forbids stay zero to the last bit.
///
/// Multipliers are those of `Floquet` (floquet.hpp), grouped by the signs of their coordinates under the reflections that the motion keeps.
///
/// Reflections told to the engine, each checked on the residual at construction: coordinate reflections given ("WH" of the stay), the shift
/// by half a base period where it is a symmetry by itself ("PD": for nu = 2 the shift by one excitation period), and combined with signs ("SB").
///
///     HarmonicBalance hb = stay_harmonic_balance(stay, {Lens("omega")}, {.harmonics = 20});
///     NewtonResult at = newton(hb, hb.linear_response(p));
///     hb.observe(at.x)(1, 2);                    // complex amplitude of cos(2 Omega t + phase) in q2
///     hb.floquet(at.x).multipliers;              // Floquet multipliers over nu excitation periods
///     Orbit orbit = solve_orbit(hb, at.x, {.tolerance = 1e-9});   // with as many harmonics as that needs
///
/// Throws std::invalid_argument for options out of range and reflections that are none. Objects hold scratch memory: one per thread.

#include <complex>
#include <cstdint>
#include <memory>
#include <optional>

#include "core/newton.hpp"
#include "core/orbit_problem.hpp"
#include "models/floquet.hpp"
#include "models/nielsen_kirkegaard.hpp"
#include "models/steady_motion.hpp"

namespace whirl::models {

/// A modal system that depends on up to two free parameters, in every scalar that derivatives need.
class ParametricSystem {
 public:
  static constexpr int max_parameters = 2;
  using Slopes = Dual<double, max_parameters>;
  using Along = Dual<double, 1>;
  using SlopesAlong = Dual<Along, max_parameters>;
  using Triple = Dual<Dual<Along, 1>, 1>;

  /// `make(std::span<const S> p)` gives ModalSystem<S>; if it also takes (p, ModalSystem<S>& out) it is called so, and need not allocate.
  /// The list of terms and forces must not depend on p. `reference`: values at which shape and symmetries are looked at.
  template <class Make>
  ParametricSystem(Make make, std::vector<std::string> names, Vector reference);

  /// The system as it is, with the excitation frequency as its only parameter.
  static ParametricSystem over_omega(const ModalSystem<double>& system);

  const std::vector<std::string>& names() const { return names_; }
  const Vector& reference() const { return reference_; }
  int parameters() const { return static_cast<int>(names_.size()); }

  void at(std::span<const double> p, ModalSystem<double>& out) const { value_(p, out); }
  void at(std::span<const Slopes> p, ModalSystem<Slopes>& out) const { slopes_(p, out); }
  void at(std::span<const SlopesAlong> p, ModalSystem<SlopesAlong>& out) const { slopes_along_(p, out); }
  void at(std::span<const Triple> p, ModalSystem<Triple>& out) const { triple_(p, out); }

 private:
  template <class S>
  using Call = std::function<void(std::span<const S>, ModalSystem<S>&)>;
  template <class S, class Make>
  static Call<S> call(std::shared_ptr<const Make> make);
  void validate() const;

  std::vector<std::string> names_;
  Vector reference_;
  Call<double> value_;
  Call<Slopes> slopes_;
  Call<SlopesAlong> slopes_along_;
  Call<Triple> triple_;
};

/// The two-mode stay seen through lenses.
ParametricSystem stay_system(const StayParameters<double>& stay, const std::vector<Lens>& lenses, Terms terms, Coefficients coefficients);

/// Between harmonics 0..K and samples at theta_j = 2 pi j / samples (even number), theta and theta + pi folded together.
class HarmonicTransform {
 public:
  HarmonicTransform() = default;
  HarmonicTransform(int harmonics, int samples);
  int samples() const { return samples_; }
  void synthesise(const double* x, double* f) const;
  void analyse(const double* f, double* x) const;

 private:
  int samples_ = 0;
  std::vector<int> place_[2];  // of even and odd harmonics in [a0, a1, b1, ..]
  Matrix basis_[2], projection_[2];
  mutable Vector x_[2], f_[2];
};

struct CoordinateReflection {
  std::vector<int> signs;  ///< +1 or -1 of each coordinate
  std::string subtype;
};

struct HarmonicBalanceOptions {
  int harmonics = 15;  ///< H, of the base frequency omega/nu
  int nu = 1;          ///< the motion repeats after nu excitation periods
  std::vector<CoordinateReflection> reflections;
  FloquetOptions floquet;
  void validate() const;
};

/// What the harmonics left out do, to first order.
struct Truncation {
  double residual;  ///< largest sum of harmonics of the full equations' residual beyond H, over the coordinates [m/s^2]
  double error;     ///< bound on the change of any coordinate, over the largest amplitude
};

class HarmonicBalance : public OrbitProblem {
 public:
  HarmonicBalance(const ParametricSystem& system, const HarmonicBalanceOptions& options);

  int coordinates() const { return n_; }
  int harmonics() const { return options_.harmonics; }
  int nu() const { return options_.nu; }
  const ParametricSystem& system() const { return system_; }

  /// Where coordinate i has its mean (k = 0), cosine of harmonic k; the sine stands behind the cosine.
  int index(int i, int k) const { return i * width_ + (k == 0 ? 0 : 2 * k - 1); }

  ModalSystem<double> system_at(In u) const;
  /// Complex amplitudes Q e^{i phase} of Q cos(k Omega t + phase), coordinates x (H + 1).
  Eigen::MatrixXcd observe(In u) const;
  /// (q, q') at time t, cos(omega t) = 1 at t = 0.
  Vector state_at(In u, double t) const;
  /// Largest amplitude of the last two harmonics (of each parity of k) over the largest of all.
  double tail(In u) const;
  /// Along a curve of motions give its tangent at u (size n + parameters, one parameter): the error is then the distance of the curves, which stays
  /// finite at folds, where the motion at a held parameter is not.
  Truncation truncation(In u, const Vector& tangent = {}) const;
  /// Harmonics that bring `truncation` down by `factor` if the amplitudes fall on as they do at u.
  int harmonics_for(In u, double factor) const;
  const FloquetResult& floquet(In u, const Floquet::Blocks& blocks = {}) const;

  /// Start values (x, p): the response without the terms, and the harmonics of a settled periodic motion.
  Vector linear_response(In p) const;
  Vector from_motion(const SteadyMotion& motion, In p) const;
  /// A motion of another balance of the same coordinates whose nu divides this one's: harmonics filled up with zeros or cut.
  Vector carry(const HarmonicBalance& from, In u) const;
  HarmonicBalance with_harmonics(int harmonics) const;
  HarmonicBalance with_nu(int nu, int harmonics) const;

 private:
  HarmonicBalance(const ParametricSystem& system, const HarmonicBalanceOptions& options, const ModalSystem<double>& shape);
  static ModalSystem<double> shape_of(const ParametricSystem& system, const HarmonicBalanceOptions& options);

  template <class Q>
  struct Samples {  // of one evaluation
    std::vector<Q> x, q, b, product, g;
    std::array<std::vector<Q>, ParametricSystem::max_parameters> slope;
    void resize(int unknowns, int samples, int coordinates, int pairs);
  };
  void do_residual(In u, Out r) const override;
  void do_jacobian(In u, MatrixOut j) const override;
  void do_linearise(In u, Out r, MatrixOut j) const override;
  void do_second(In u, In v, MatrixOut h) const override;
  void do_third(In u, In a, In b, In c, Out t) const override;
  bool do_multipliers(In u, Eigen::VectorXcd& mu, Eigen::VectorXi& group) const override;
  int do_group_of_unknown(In u, int i) const override;
  void do_velocity(In u, int slope, MatrixOut c) const override;
  double do_base_frequency(In u) const override;
  const OrbitProblem& do_doubled() const override;
  Vector do_in_doubled(In u) const override;
  Vector do_from_doubled(In u) const override;
  unsigned reflections_at(In u) const;                             // coordinate reflections that leave the motion in place
  int group_of_coordinate(unsigned active, int coordinate) const;  // by its signs under them

  template <class Q>
  void differentiate(const ModalSystem<Dual<Q, ParametricSystem::max_parameters>>& system, Samples<Q>& s, double* r, MatrixOut j) const;
  template <class Q>
  void residual_samples(const ModalSystem<Q>& system, Samples<Q>& s) const;
  template <class Q, class S>
  void linear_part(const ModalSystem<S>& system, const Samples<Q>& s, int row, int k, S& cosine, S& sine) const;
  void add_toeplitz(int i, int j, MatrixOut out) const;
  void synthesise(const double* x, double* q) const;
  static Matrix cosines(int max_harmonic, int nu, int samples);
  void find_pairs(const ModalSystem<double>& system);
  static std::optional<std::uint64_t> shift_symmetry(const ModalSystem<double>& system, int nu);
  void find_reflections(const ModalSystem<double>& system);
  void check_reflection(const Reflection& reflection) const;

  ParametricSystem system_;
  HarmonicBalanceOptions options_;
  int n_, width_, samples_;
  std::vector<int> pair_;  // number of the pair (i, j) of equation and coordinate that some term couples, -1: none
  int pairs_ = 0;
  HarmonicTransform transform_, wide_;  // harmonics to H, to 2H
  Matrix cosine_;                       // cos(h omega t) at the samples
  mutable Samples<double> value_;
  mutable Samples<ParametricSystem::Along> along_;
  mutable Samples<ParametricSystem::Triple> triple_;
  mutable ModalSystem<double> system_value_;
  mutable ModalSystem<ParametricSystem::Slopes> system_slopes_;
  mutable ModalSystem<ParametricSystem::SlopesAlong> system_along_;
  mutable ModalSystem<ParametricSystem::Triple> system_triple_;
  mutable Vector r_, signal_, c_, s_, harmonic_;           // scratch; c_, s_: harmonics -2H..2H of one g_ij
  mutable std::shared_ptr<const HarmonicTransform> fine_;  // of `truncation`: all harmonics the terms can make
  mutable Matrix fine_cosine_;
  mutable Floquet floquet_;
  // Made on demand and not copied: a copy is another object with scratch memory of its own.
  struct OnDemand {
    OnDemand() = default;
    OnDemand(const OnDemand&) {}
    OnDemand& operator=(const OnDemand&) { return *this; }
    std::shared_ptr<const HarmonicBalance> problem;
  };
  mutable OnDemand doubled_;
};

/// The stay's balance with its reflection q1 -> -q1, subtype "WH".
HarmonicBalance stay_harmonic_balance(const StayParameters<double>& stay, const std::vector<Lens>& lenses, HarmonicBalanceOptions options = {},
                                      Terms terms = Terms::reduced, Coefficients coefficients = Coefficients::exact);

struct OrbitOptions {
  double tolerance = 1e-9;  ///< on Truncation::error
  int max_harmonics = 200;
  NewtonOptions newton;
  void validate() const;
};

struct Orbit {
  std::shared_ptr<HarmonicBalance> problem;
  Vector u;
  Truncation truncation{};
  NewtonResult newton;  ///< of the last number of harmonics tried
  bool ok = false;      ///< converged and truncation below tolerance
};

/// The motion near `start` (of `problem`) with as many harmonics as the tolerance needs.
Orbit solve_orbit(const HarmonicBalance& problem, const Vector& start, const OrbitOptions& options = {});

// ---------------------------------------------------------------------------------------------------------------------------

template <class S, class Make>
ParametricSystem::Call<S> ParametricSystem::call(std::shared_ptr<const Make> make) {
  return [make](std::span<const S> p, ModalSystem<S>& out) {
    if constexpr (requires { (*make)(p, out); }) (*make)(p, out);
    else out = (*make)(p);
  };
}

template <class Make>
ParametricSystem::ParametricSystem(Make make, std::vector<std::string> names, Vector reference)
    : names_(std::move(names)), reference_(std::move(reference)) {
  const auto shared = std::make_shared<const Make>(std::move(make));
  value_ = call<double, Make>(shared);
  slopes_ = call<Slopes, Make>(shared);
  slopes_along_ = call<SlopesAlong, Make>(shared);
  triple_ = call<Triple, Make>(shared);
  validate();
}

}  // namespace whirl::models
