#pragma once
/// A chain of masses and springs that hangs as a cable does, integrated in time: the independent check of nonlinear models.

#include <array>
#include <cmath>
#include <vector>

#include "models/catenary/geometry.hpp"

namespace catenary_test {

using whirl::models::catenary::Geometry;

// Masses ds at interior nodes of a polygon with equal sides ds, horizontal tension 1, unit weight per length: in equilibrium exactly. A side pulls
// with T0 + (l/ds - 1)/kappa. Integrated by leapfrog from W = A phi and the motion in plane that goes with it.
class Chain {
 public:
  Chain(const Geometry& g, double kappa, int sides) : kappa_(kappa), n_(sides), slope1_(std::sinh(g.x1)), ds_((std::sinh(g.x2) - slope1_) / sides) {
    rest_.assign(3 * std::size_t(n_ + 1), 0.0);
    for (int i = 0; i < n_; ++i) {
      const double slope = slope1_ + (i + 0.5) * ds_, c = std::sqrt(1.0 + slope * slope);
      tension_.push_back(c);
      rest_[at(i + 1)] = rest_[at(i)] + ds_ / c;
      rest_[at(i + 1) + 1] = rest_[at(i) + 1] + ds_ * slope / c;
    }
  }

  int nodes() const { return n_ + 1; }
  double place(int i) const { return std::asinh(slope1_ + i * ds_); }  // x of node i, in a

  // Displacement (horizontal, vertical, out of plane of every node in turn) of U, V, W given as functions of x.
  template <class Motion>
  std::vector<double> displaced(Motion&& motion) const {
    std::vector<double> u(rest_.size(), 0.0);
    for (int i = 1; i < n_; ++i) {
      const double x = place(i), sinh_x = std::sinh(x), c = std::cosh(x);
      const auto [U, V, W] = motion(x);
      u[at(i)] = (U - V * sinh_x) / c;
      u[at(i) + 1] = (U * sinh_x + V) / c;
      u[at(i) + 2] = W;
    }
    return u;
  }

  // Mean frequency of the projection on `shape` over `periods` periods, let go from rest.
  double frequency(const std::vector<double>& shape, const std::vector<double>& start, int periods) const {
    std::vector<double> x = rest_, v(x.size(), 0.0), a(x.size(), 0.0);
    for (std::size_t k = 0; k < x.size(); ++k) x[k] += start[k];
    const double dt = 0.4 * ds_ * std::sqrt(kappa_);  // a fifth of the limit: its error, 1e-5 of w at most, is the same at every amplitude
    forces(x, a);
    double before = 1.0, first = -1.0, last = 0.0;
    int crossings = 0;
    for (long step = 1; crossings < 2 * periods + 1; ++step) {
      for (std::size_t k = 0; k < x.size(); ++k) v[k] += 0.5 * dt * a[k];
      for (std::size_t k = 0; k < x.size(); ++k) x[k] += dt * v[k];
      forces(x, a);
      for (std::size_t k = 0; k < x.size(); ++k) v[k] += 0.5 * dt * a[k];
      double q = 0.0;
      for (std::size_t k = 0; k < x.size(); ++k) q += shape[k] * (x[k] - rest_[k]);
      if (step > 1 && q * before < 0.0) {
        last = dt * (double(step) - q / (q - before));
        if (first < 0.0) first = last;
        ++crossings;
      }
      before = q;
    }
    return 2.0 * 3.14159265358979324 * periods / (last - first);
  }

 private:
  static std::size_t at(int node) { return 3 * std::size_t(node); }
  void forces(const std::vector<double>& x, std::vector<double>& a) const {
    std::fill(a.begin(), a.end(), 0.0);
    for (int i = 0; i < n_; ++i) {
      double d[3], l = 0.0;
      for (std::size_t k = 0; k < 3; ++k) {
        d[k] = x[at(i + 1) + k] - x[at(i) + k];
        l += d[k] * d[k];
      }
      l = std::sqrt(l);
      const double T = tension_[std::size_t(i)] + (l / ds_ - 1.0) / kappa_;
      for (std::size_t k = 0; k < 3; ++k) {
        a[at(i) + k] += T * d[k] / (l * ds_);
        a[at(i + 1) + k] -= T * d[k] / (l * ds_);
      }
    }
    for (int i = 1; i < n_; ++i) a[at(i) + 1] -= 1.0;
    for (std::size_t k = 0; k < 3; ++k) a[k] = a[at(n_) + k] = 0.0;
  }

  double kappa_;
  int n_;
  double slope1_, ds_;
  std::vector<double> rest_, tension_;
};

}  // namespace catenary_test
