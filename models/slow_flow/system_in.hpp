#pragma once
/// A ParametricSystem in the scalars of DualProblem's sweeps, which carry slopes in other directions than the parameters: by the chain rule
///
///     c(p) = c + sum over parameters of  dc/dp_k (p_k - value of p_k)
///
/// from the slopes that the system gives. Exact at every order, because the inner scalar carries the higher slopes.

#include "models/harmonic_balance.hpp"

namespace whirl::models {

/// Room for one scalar: the system wanted, and the one it is made from.
template <class S>
struct SystemRoom {
  ModalSystem<S> system;
  const ModalSystem<S>& fill(const ParametricSystem& parametric, std::span<const S> p) {
    parametric.at(p, system);
    return system;
  }
};

template <class Q, int N>
requires(N > ParametricSystem::max_parameters) struct SystemRoom<Dual<Q, N>> {
  using S = Dual<Q, N>;
  using Inner = Dual<Q, ParametricSystem::max_parameters>;
  ModalSystem<S> system;
  ModalSystem<Inner> inner;

  const ModalSystem<S>& fill(const ParametricSystem& parametric, std::span<const S> p) {
    std::array<Inner, ParametricSystem::max_parameters> at;
    for (std::size_t k = 0; k < p.size(); ++k) {
      at[k] = Inner();
      at[k].v = p[k].v;
      at[k].d[k] = Q(1.0);
    }
    parametric.at(std::span<const Inner>(at.data(), p.size()), inner);
    const auto lift = [&](const Inner& c) {
      S s;
      s.v = c.v;
      for (std::size_t k = 0; k < p.size(); ++k)
        for (std::size_t i = 0; i < N; ++i) s.d[i] += c.d[k] * p[k].d[i];
      return s;
    };
    system.omega = lift(inner.omega);
    system.max_harmonic = inner.max_harmonic;
    const std::size_t n = inner.stiffness.size();
    system.damping.resize(n);
    system.stiffness.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      system.damping[i] = lift(inner.damping[i]);
      system.stiffness[i] = lift(inner.stiffness[i]);
    }
    system.terms.resize(inner.terms.size());
    for (std::size_t i = 0; i < inner.terms.size(); ++i) {
      const auto& t = inner.terms[i];
      system.terms[i] = {t.equation, lift(t.coefficient), t.degree, t.factor, t.cos_harmonic};
    }
    system.forces.resize(inner.forces.size());
    for (std::size_t i = 0; i < inner.forces.size(); ++i)
      system.forces[i] = {inner.forces[i].equation, lift(inner.forces[i].amplitude), inner.forces[i].harmonic};
    return system;
  }
};

}  // namespace whirl::models
