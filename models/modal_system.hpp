#pragma once
/// A forced polynomial modal model of any number of coordinates, the common form of every model that is integrated or balanced:
///
///     q_i'' + c_i q_i' + k_i q_i + sum over terms of equation i:  coefficient * q_f1 q_f2 ... * cos(h omega t)  =  sum of forces
///
/// Units: q in m, c in 1/s, k in 1/s^2, terms and forces in m/s^2. One scalar type S throughout, so parameters may be duals.

#include <array>
#include <cmath>
#include <span>
#include <stdexcept>
#include <vector>

#include "core/dual.hpp"

namespace whirl::models {

template <class S>
struct Term {
  static constexpr int max_degree = 8;
  int equation;
  S coefficient;
  int degree = 0;
  std::array<short, max_degree> factor{};  ///< coordinate of each factor, `degree` of them
  int cos_harmonic = 0;                    ///< h of cos(h omega t); 0: no time dependence
};

template <class S>
struct Force {
  int equation;
  S amplitude;
  int harmonic;
};

template <class S>
struct ModalSystem {
  S omega;                   ///< excitation frequency [rad/s]
  std::vector<S> damping;    ///< c_i
  std::vector<S> stiffness;  ///< k_i
  std::vector<Term<S>> terms;
  std::vector<Force<S>> forces;
  int max_harmonic = 0;  ///< of any term or force

  int size() const { return static_cast<int>(stiffness.size()); }

  void add_term(int equation, const S& coefficient, std::initializer_list<int> factors, int cos_harmonic = 0) {
    if (factors.size() > Term<S>::max_degree) throw std::invalid_argument("a term has at most 8 factors");
    Term<S> t{equation, coefficient, static_cast<int>(factors.size()), {}, cos_harmonic};
    int i = 0;
    for (int f : factors) t.factor[static_cast<std::size_t>(i++)] = static_cast<short>(f);
    terms.push_back(t);
    max_harmonic = std::max(max_harmonic, cos_harmonic);
  }
  void add_force(int equation, const S& amplitude, int harmonic) {
    forces.push_back({equation, amplitude, harmonic});
    max_harmonic = std::max(max_harmonic, harmonic);
  }

  /// The nonlinear and parametric left-hand terms b_i(q, phase), phase = omega t. Size of q and b: size().
  template <class Q>
  void coupling(std::span<const Q> q, double phase, std::span<Q> b) const {
    for (auto& x : b) x = Q(0.0);
    for (const auto& t : terms) {
      Q product(t.coefficient);
      for (int i = 0; i < t.degree; ++i) product = product * q[static_cast<std::size_t>(t.factor[static_cast<std::size_t>(i)])];
      if (t.cos_harmonic) product = product * std::cos(t.cos_harmonic * phase);
      b[static_cast<std::size_t>(t.equation)] += product;
    }
  }

  /// First-order form y = (q, q'), dydt = (q', q''), at phase = omega t.
  template <class Q>
  void flow(double phase, std::span<const Q> y, std::span<Q> dydt) const {
    const auto n = static_cast<std::size_t>(size());
    coupling<Q>(y.first(n), phase, dydt.subspan(n, n));
    for (std::size_t i = 0; i < n; ++i) {
      dydt[i] = y[n + i];
      dydt[n + i] = -(dydt[n + i] + y[n + i] * damping[i] + y[i] * stiffness[i]);
    }
    for (const auto& f : forces) dydt[n + static_cast<std::size_t>(f.equation)] += Q(f.amplitude) * std::cos(f.harmonic * phase);
  }
};

}  // namespace whirl::models
