// Amplitude dependence of the swing out of plane: taut limit, stiff limit, and a chain of masses and springs integrated in time.
#include <cmath>

#include "models/catenary/backbone.hpp"
#include "tests/models/catenary/reference.hpp"

using namespace catenary_test;

namespace {

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

  // Mean frequency of sum phi W over `periods` periods.
  double frequency(const std::vector<double>& phi, const Backbone& b, double A, int periods) const {
    std::vector<double> x = rest_, v(x.size(), 0.0), a(x.size(), 0.0);
    for (int i = 1; i < n_; ++i) {
      const double sinh_x = slope1_ + i * ds_, c = std::sqrt(1.0 + sinh_x * sinh_x), place = std::asinh(sinh_x);
      const double U = A * A * (b.steady.at(place, Quantity::U) + b.twice.at(place, Quantity::U));
      const double V = A * A * (b.steady.at(place, Quantity::V) + b.twice.at(place, Quantity::V));
      x[at(i)] += (U - V * sinh_x) / c;
      x[at(i) + 1] += (U * sinh_x + V) / c;
      x[at(i) + 2] = A * phi[std::size_t(i)];
    }
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
      for (int i = 0; i <= n_; ++i) q += phi[std::size_t(i)] * x[at(i) + 2];
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

}  // namespace

TEST_CASE("catenary backbone: taut string under uniform tension") {
  const double m = 1e-3, kappa = 1e-3, p = 3.14159265358979324 / (2.0 * m);
  // omega^2 = p^2 + 3 A^2 (p^2 m/2)^2 / (4 m kappa) / m with kappa c^2 -> 0; lambda^2 = 8e-6: sag counts for 1e-4 of it, axial inertia for 4 kappa/12
  const Backbone b = lateral_backbone(core(unit_geometry(m, 0.0), kappa), 1);
  const double uniform = 3.0 * std::pow(0.5 * p * p * m, 2) / (4.0 * m * kappa) / (2.0 * p * p * m);
  CHECK(b.curvature == Approx(uniform).epsilon(3e-3));
  CHECK(b.direct == Approx(1.5 * uniform).epsilon(3e-3));  // mean cos^4 over the square of mean cos^2
}

TEST_CASE("catenary backbone: finite for a stiff cable, where projection on the mode alone is not") {
  const Geometry g = unit_geometry(1.0, 0.5);
  const Backbone soft = lateral_backbone(core(g, 1e-5), 1), stiff = lateral_backbone(core(g, 1e-7), 1);
  CHECK(stiff.curvature == Approx(soft.curvature).epsilon(1e-3));
  CHECK(stiff.curvature < 0.0);  // a deep cable swings like a pendulum: softer
  CHECK(stiff.direct > 1e5 * std::abs(stiff.curvature));
  CHECK_THROWS_AS(lateral_backbone(core(g), 1), std::invalid_argument);
}

TEST_CASE("catenary backbone: a chain of masses swings as predicted", "[slow]") {
  for (const auto& [m, h] : {std::pair{1.0, 0.0}, {0.8, 0.6}}) {
    const double kappa = 5e-3;
    const Geometry g = unit_geometry(m, h);
    const Backbone b = lateral_backbone(core(g, kappa), 1);
    const Mode swing = out_of_plane_modes(core(g, kappa), {.count = 1}).modes[0];
    const int sides = 60;
    std::vector<double> phi;
    for (int i = 0; i <= sides; ++i)
      phi.push_back(swing.field.at(std::asinh(std::sinh(g.x1) + (std::sinh(g.x2) - std::sinh(g.x1)) * i / sides), Quantity::W));
    const Chain chain(g, kappa, sides);
    const double small = 0.02, base = chain.frequency(phi, b, small, 40);
    const auto curvature = [&](double A) { return (chain.frequency(phi, b, A, 40) / base - 1.0) / (A * A - small * small); };
    // The curvature measured at an amplitude differs from that at rest by its square; two amplitudes take that out.
    const double A = 0.06, larger = 0.1, at = curvature(A), measured = at - (curvature(larger) - at) * A * A / (larger * larger - A * A);
    INFO("m " << m << " h " << h << " predicted " << b.curvature << " measured " << measured << " direct " << b.direct);
    CHECK(measured == Approx(b.curvature).epsilon(0.01));  // 60 sides: 2e-3 of it, and the fourth power of the amplitude
  }
}
