#pragma once
/// The right-hand side y' = f(t, y), y = (q, q'), of a forced modal system as a flat list of multiplications and additions: every product of
/// coordinates and cos(h omega t) that terms share is formed once, and the cosines come from one by recurrence,
///
///     cos(h x) = 2 cos(x) cos((h - 1) x) - cos((h - 2) x).
///
/// With m tangent vectors v' = f_y v behind the state (variational equations), y = (q, q', v_1, ..., v_m), each of size 2 n.
/// Holds scratch memory: one per thread; copies are cheap. Nothing is allocated in a call.
///
///     FlatFlow f(system);
///     f(t, y.data(), dydt.data());
///     f.with_tangents(t, y.data(), dydt.data(), 4);

#include <vector>

#include "models/modal_system.hpp"

namespace whirl::models {

class FlatFlow {
 public:
  explicit FlatFlow(const ModalSystem<double>& system);

  int coordinates() const { return n_; }
  int size() const { return 2 * n_; }
  double omega() const { return omega_; }
  int products() const { return static_cast<int>(products_.size()); }

  void operator()(double t, const double* y, double* dydt) const;
  void with_tangents(double t, const double* y, double* dydt, int tangents) const;

 private:
  struct Product {  // value[first] * value[second], stored behind the coordinates and cosines
    int first, second;
  };
  struct Sum {  // acceleration[equation] -= coefficient * value[node]
    int equation, node;
    double coefficient;
  };
  static constexpr int most_lanes = 8;
  void evaluate(double t, const double* y, double* dydt) const;
  template <int lanes>
  void tangent_group(const double* y, double* dydt) const;

  int n_, harmonics_;
  double omega_;
  std::vector<double> damping_, stiffness_, constant_;
  std::vector<Product> products_;
  std::vector<Sum> sums_;
  mutable std::vector<double> value_, slope_, sum_;  // coordinates, cosines 1..H, products; slopes side by side, of a group of tangents
};

}  // namespace whirl::models
