#pragma once
/// Averaged (van der Pol) equations of a forced modal system for any list of harmonics, as a Problem that is a flow.
///
///     q_i = sum over the ansatz of Re[ Z_k e^{i k w t} ],  Z_k = u + i v,  a mean B for k = 0       (frozen linear response added if asked for)
///     R_k = (K - k^2 w^2 + i k w c) Z_k + 2 <b e^{-i k w t}> - F_k,      R_0 = K B + <b> - F_0      exact projection, c and K of coordinate i
///
///     2 k w Z_k' = i R_k                [NielsenKirkegaard2002, eq. (41) in Cartesian form]
///     tau B'     = -R_0,                tau = sqrt(c^2 + (w/1000)^2)
///
/// u, v, B in m, rates in m/s. Equilibria are the harmonic balance on the ansatz, exactly. Stability is that of the averaged motion.
///
/// Why so for the mean. A slowly varying Z gives q'' + c q' the factor Z'' + (2 i k w + c) Z' for every k. Averaging keeps the first order:
/// 2 i k w Z' where k > 0, c B' where k = 0. The mean then follows within 1/tau * 1/K, some milliseconds for a stay, as if quasi-static, and its
/// lag behind a slow motion of rate s is right to first order in s. The second part of tau stands in for c where there is no damping. A mean that is
/// statically unstable (dR_0/dB < 0) shows as a fast unstable direction.
///
/// What stability by averaging means. R_x is singular where harmonic balance is: folds, branch points and, on an ansatz with nu = 2, period
/// doublings lie where the balance has them. Rates and Hopf points are of first order: right while the exponents are small beside k w.
///
///     SlowFlow flow(stay_system(stay, {Lens("omega")}, Terms::reduced, Coefficients::exact), Ansatz::combinatorial_coupled(), {{{-1, 1}, "WH"}});
///     flow.residual(u, r);                                    // u = (x, omega), r = x'
///     NewtonResult at = newton(flow, flow.linear_response(p));
///     amplitude(flow.ansatz(), at.x, 1, 2);                   // cos(omega t) in q2
///     flow.motion(at.x, t);                                   // q, q'
///
/// Residual and Jacobian do not allocate. Throws std::invalid_argument for an ansatz that does not fit and reflections that are none.

#include <tuple>

#include "core/dual_problem.hpp"
#include "models/slow_flow/ansatz.hpp"
#include "models/slow_flow/list_transform.hpp"
#include "models/slow_flow/system_in.hpp"

namespace whirl::models {

/// Relaxation time scale of a mean [1/s]; see above.
template <class S>
S mean_rate(const S& damping, const S& omega) {
  using std::sqrt;
  return sqrt(damping * damping + omega * omega * 1e-6);
}

class SlowFlowModel {
 public:
  SlowFlowModel(const ParametricSystem& system, const Ansatz& ansatz);

  const ParametricSystem& system() const { return system_; }
  const Ansatz& ansatz() const { return ansatz_; }

  /// In any scalar of DualProblem.
  template <class S>
  void residual(std::span<const S> u, std::span<S> r) const;
  /// x' and [r_x r_p]: terms sampled once, the Jacobian from the harmonics of db_i/dq_j.
  void linearise(const double* u, double* r, MatrixOut j) const;
  /// Frozen amplitudes at p, in the order of `frozen_of`.
  std::vector<std::complex<double>> frozen(const ModalSystem<double>& system, int coordinate) const;
  int highest() const { return highest_; }  ///< harmonic of omega/nu in the motion, kept or frozen
  const std::vector<int>& frozen_of(int coordinate) const { return frozen_[static_cast<std::size_t>(coordinate)]; }

 private:
  using D8 = Dual<double, 8>;
  using A8 = Dual<ParametricSystem::Along, 8>;
  using Slopes = ParametricSystem::Slopes;
  template <class S>
  struct Room {
    SystemRoom<S> system;
    std::vector<S> q, b, product, y, z, extra;  // samples of all coordinates; amplitudes of one; frozen amplitudes and samples of one
  };
  struct Pair {              // db_i/dq_j
    std::vector<int> place;  // of harmonic h in the transform's numbers, -1 where no block needs it
    ListTransform transform;
  };
  template <class S>
  void make_room(Room<S>& room) const;
  template <class S>
  void frozen_amplitudes(const ModalSystem<S>& system, int i, S* z) const;
  template <class S>
  void synthesise(const ModalSystem<S>& system, std::span<const S> x, Room<S>& room) const;
  template <class S>
  void row(const ModalSystem<S>& system, int i, int k, const S* z, const S* y, S* out, S& scale) const;
  void sample_terms(const ModalSystem<Slopes>& system) const;
  void add_block(int i, int j, MatrixOut out) const;

  ParametricSystem system_;
  Ansatz ansatz_;
  int n_, size_, parameters_, samples_, highest_;
  Matrix cosine_;                         // cos(h omega t) at the samples, one column an h
  std::vector<ListTransform> transform_;  // per coordinate
  std::vector<std::vector<int>> frozen_;  // harmonics of omega per coordinate
  std::vector<ListTransform> frozen_transform_;
  std::vector<int> offset_, pair_;  // pair_[i n + j]: number of the pair, -1 where no term couples
  std::vector<Pair> pairs_;
  mutable std::tuple<Room<double>, Room<D8>, Room<A8>, Room<ParametricSystem::Triple>> rooms_;
  mutable ModalSystem<Slopes> slopes_;
  mutable std::vector<double> g_, gamma_, slope_[ParametricSystem::max_parameters], frozen_slope_;
  mutable Vector y_, ys_, scale_;
};

class SlowFlow : public DualProblem<SlowFlowModel> {
 public:
  SlowFlow(const ParametricSystem& system, const Ansatz& ansatz, const std::vector<CoordinateReflection>& reflections = {});

  const Ansatz& ansatz() const { return model().ansatz(); }
  ModalSystem<double> system_at(In u) const;
  /// (q, q') at time t, cos(omega t) = 1 at t = 0, the frozen part included.
  Vector motion(In u, double t) const;
  /// The motion in the layout of HarmonicBalance, the frozen part included; H of it.
  Vector balance_state(In u) const;
  int balance_harmonics() const { return model().highest(); }
  /// Start values (x, p): the response without the terms, and a settled motion.
  Vector linear_response(In p) const;
  Vector from_motion(const SteadyMotion& motion, In p) const;

 private:
  void do_jacobian(In u, MatrixOut j) const override;
  void do_linearise(In u, Out r, MatrixOut j) const override;
  mutable Vector r_;
};

// ---------------------------------------------------------------------------------------------------------------------------

template <class S>
void SlowFlowModel::make_room(Room<S>& room) const {
  std::size_t widest = 0, frozen = 0;
  for (int i = 0; i < n_; ++i) {
    widest = std::max(widest, static_cast<std::size_t>(ansatz_.width(i)));
    frozen = std::max(frozen, 2 * frozen_[static_cast<std::size_t>(i)].size());
  }
  room.q.resize(static_cast<std::size_t>(samples_ * n_));
  room.b.resize(room.q.size());
  room.product.resize(static_cast<std::size_t>(samples_));
  room.extra.resize(static_cast<std::size_t>(samples_));
  room.y.resize(widest);
  room.z.resize(frozen);
}

// Linear response to the forces outside the list, [NielsenKirkegaard2002, eq. (34)]: F / (K - h^2 w^2 + i h w c).
template <class S>
void SlowFlowModel::frozen_amplitudes(const ModalSystem<S>& system, int i, S* z) const {
  const auto& list = frozen_[static_cast<std::size_t>(i)];
  for (std::size_t f = 0; f < 2 * list.size(); ++f) z[f] = S(0.0);
  for (const auto& force : system.forces) {
    const auto found = std::find(list.begin(), list.end(), force.harmonic * ansatz_.nu);
    if (force.equation != i || found == list.end()) continue;
    const auto slot = 2 * static_cast<std::size_t>(found - list.begin());
    const S speed = system.omega * static_cast<double>(force.harmonic);
    const S D = system.stiffness[static_cast<std::size_t>(i)] - speed * speed, E = system.damping[static_cast<std::size_t>(i)] * speed;
    const S scale = force.amplitude / (D * D + E * E);
    z[slot] += scale * D;
    z[slot + 1] += -(scale * E);
  }
}

template <class S>
void SlowFlowModel::synthesise(const ModalSystem<S>& system, std::span<const S> x, Room<S>& room) const {
  for (int i = 0; i < n_; ++i) {
    const auto c = static_cast<std::size_t>(i);
    S* q = room.q.data() + i * samples_;
    transform_[c].synthesise(x.data() + offset_[c], q);
    if (frozen_[c].empty()) continue;
    frozen_amplitudes(system, i, room.z.data());
    frozen_transform_[c].synthesise(static_cast<const S*>(room.z.data()), room.extra.data());
    for (int m = 0; m < samples_; ++m) q[m] += room.extra[static_cast<std::size_t>(m)];
  }
}

// Row of harmonic k from its amplitude z = (u, v) and the projection y of the terms, forces still missing: i R / (2 k w), or -R / tau.
template <class S>
void SlowFlowModel::row(const ModalSystem<S>& system, int i, int k, const S* z, const S* y, S* out, S& scale) const {
  const S &K = system.stiffness[static_cast<std::size_t>(i)], &c = system.damping[static_cast<std::size_t>(i)];
  if (k == 0) {
    scale = S(-1.0) / mean_rate(c, system.omega);
    out[0] = (K * z[0] + y[0]) * scale;
    return;
  }
  const S speed = system.omega * (static_cast<double>(k) / ansatz_.nu), D = K - speed * speed, E = c * speed;
  scale = S(0.5) / speed;
  out[0] = -(D * z[1] + E * z[0] + y[1]) * scale;
  out[1] = (D * z[0] - E * z[1] + y[0]) * scale;
}

template <class S>
void SlowFlowModel::residual(std::span<const S> u, std::span<S> r) const {
  Room<S>& room = std::get<Room<S>>(rooms_);
  const auto& system = room.system.fill(system_, u.subspan(static_cast<std::size_t>(size_)));
  synthesise(system, u, room);
  std::fill(room.b.begin(), room.b.end(), S(0.0));
  for (const auto& t : system.terms) {
    term_product(t, -1, room.q.data(), cosine_.col(t.cos_harmonic).data(), samples_, room.product.data());
    S* b = room.b.data() + t.equation * samples_;
    for (int m = 0; m < samples_; ++m) b[m] += room.product[static_cast<std::size_t>(m)] * t.coefficient;
  }
  for (int i = 0; i < n_; ++i) {
    const auto c = static_cast<std::size_t>(i);
    transform_[c].analyse(static_cast<const S*>(room.b.data() + i * samples_), room.y.data());
    int at = 0;
    S scale(0.0);
    for (const int k : ansatz_.harmonics[c]) {
      for (const auto& f : system.forces)
        if (f.equation == i && f.harmonic * ansatz_.nu == k) room.y[static_cast<std::size_t>(at)] -= f.amplitude;
      row(system, i, k, u.data() + offset_[c] + at, static_cast<const S*>(room.y.data()) + at, r.data() + offset_[c] + at, scale);
      at += k > 0 ? 2 : 1;
    }
  }
}

}  // namespace whirl::models
