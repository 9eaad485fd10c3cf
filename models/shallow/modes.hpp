#pragma once
/// Linear modes of a shallow cable of any order, [IrvineCaughey1974, eqs (4)-(25)]. xi = x/l, b = beta l = omega l sqrt(m/T).
///
///     out of plane    b = n pi,    w = sin(n pi xi)                                                       (8)(9)
///     antisymmetric   b = 2 n pi,  v = sin(2 n pi xi),  no added tension                                   (12)(13)
///     symmetric       tan(b/2) = b/2 - (4/lambda2)(b/2)^3, one root b/2 in each ((n-1/2) pi, (n+1/2) pi)     (19)
///                     v = [cos(b (1/2 - xi)) - cos(b/2)] / D,  D = (-1)^(n-1) - cos(b/2)                    (17), scaled
///     all in plane    u = h Lx/EA - 4 r (1 - 2 xi) v - 8 r int_0^xi v,   Lx = int_0^x (ds/dx)^3             (14)(25)
///                     h = (EA/Le) 8 r int_0^1 v                                                            (18)
///
/// The largest |v| or |w| is 1; signs are those of the taut string's sin(k pi xi). v, w, u are then in metres a metre of amplitude, h in N/m.
///
///     ModeShape z(statics(cable), cable, Family::symmetric, 1);
///     z.frequency_hz();  z.transverse(0.5);  z.longitudinal(0.25);  z.added_tension();
///
/// Throws std::invalid_argument for an order < 1 and lambda2 < 0.

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "models/shallow/statics.hpp"

namespace whirl::models::shallow {

/// b = beta l of the n-th symmetric mode; lambda2 from 0 (taut string, (2n-1) pi) to infinity (inextensible).
double symmetric_root(double lambda2, int n = 1);
/// lambda2 at which the n-th symmetric and antisymmetric frequencies agree: (2 n pi)^2.
double cross_over(int n);

enum class Family { out_of_plane, symmetric, antisymmetric };
const char* to_string(Family family);

class ModeShape {
 public:
  ModeShape(const Statics& statics, const Cable<double>& cable, Family family, int order);

  Family family() const { return family_; }
  int order() const { return order_; }            ///< within the family, from 1
  int half_waves() const;                         ///< k of the taut string's sin(k pi xi) that it comes from
  std::string name() const;                       ///< "y1", "z3": y out of plane, z in plane, with half_waves()
  double frequency_number() const { return b_; }  ///< b
  double omega() const { return omega_; }         ///< [rad/s]
  double frequency_hz() const { return omega_ / (2.0 * std::numbers::pi); }

  /// v or w at xi.
  template <class S>
  S transverse(const S& xi) const {
    using std::cos;
    using std::sin;
    if (family_ == Family::symmetric) return (cos((0.5 - xi) * b_) - half_cos_) / divisor_;
    return sin(xi * b_);
  }
  /// u at xi, 0 out of plane.
  template <class S>
  S longitudinal(const S& xi) const {
    if (family_ == Family::out_of_plane) return S(0.0);
    return stretch(xi) * strain_ - (1.0 - 2.0 * xi) * transverse(xi) * (4.0 * ratio_) - area(xi) * (8.0 * ratio_);
  }
  double added_tension() const { return tension_; }                  ///< h, horizontal (along the chord), a metre of amplitude [N/m]
  int internal_nodes() const;                                        ///< zeros of v or w between the supports
  double mean() const { return mean_; }                              ///< int_0^1 v
  double mean_square() const { return square_; }                     ///< int_0^1 v^2: modal mass over m l
  double participation() const { return mean_ / square_; }           ///< of a uniform acceleration
  double effective_mass() const { return mean_ * mean_ / square_; }  ///< share of the mass that it moves, of m l

 private:
  // int_0^xi v and Lx/l
  template <class S>
  S area(const S& xi) const {
    using std::cos;
    using std::sin;
    if (family_ == Family::symmetric) return ((half_sin_ - sin((0.5 - xi) * b_)) / b_ - xi * half_cos_) / divisor_;
    return (1.0 - cos(xi * b_)) / b_;
  }
  template <class S>
  S stretch(const S& xi) const {
    return xi + (xi - xi * xi * 2.0 + xi * xi * xi * (4.0 / 3.0)) * (24.0 * ratio_ * ratio_);
  }

  Family family_;
  int order_;
  double ratio_, b_, omega_;
  double half_cos_, half_sin_, divisor_;     // cos(b/2), sin(b/2), D
  double mean_, square_, tension_, strain_;  // strain_: h l/EA
};

/// The lowest modes of each family: `count` out of plane and `count` in plane, families mixed, by rising frequency within a plane.
std::vector<ModeShape> lowest_modes(const Cable<double>& cable, int count);

}  // namespace whirl::models::shallow
