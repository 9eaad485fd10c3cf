#pragma once
/// How the frequencies of a hanging cable in plane depend on its flexibility kappa = H/EA, and where two of them meet.
///
/// At h = 0 symmetric and antisymmetric frequencies cross; on an inclined cable they veer and the modes in between are hybrid.
///
/// FrequencyCurve is a Problem for the walker: one mode followed in s = sqrt(kappa),
///
///     (K(s) - nu w_ref^2 M(s)) q = 0,    (q'q - 1)/2 = 0        unknowns q, nu = (w/w_ref)^2; K, M quadratic in s, all derivatives exact
///
/// At h = 0 it has the reflection about midspan: where the odd block becomes singular on a symmetric branch (or the other way round) two
/// frequencies cross, and the walker reports a branch point of subtype "X".
///
///     FrequencyCurve curve(g.x1, g.x2, 40);
///     Branch branch = Walker(curve, {.lower = 0.01, .upper = 0.4}).walk(curve.start(1e-4, 1, Parity::symmetric));
///     double crossing = FrequencyCurve::kappa(branch.special[0].u);
///
/// closest_approaches scans a range and finds where frequencies cross (h = 0) and where the ratio of neighbours is least, by the exact slope d ln w /
/// ds = q'(K' - w^2 M')q / (2 w^2).

#include "models/catenary/modes.hpp"

namespace whirl::models::catenary {

/// Functions that resolve so many modes at any flexibility of a range.
int functions_for_range(double x1, double x2, double kappa_lower, double kappa_upper, int modes);

class FrequencyCurve : public Problem {
 public:
  FrequencyCurve(double x1, double x2, int functions, double reference_omega = 1.0);
  /// The mode-th lowest (from 1) of a parity at kappa; throws std::invalid_argument if the discretisation has none.
  Vector start(double kappa, int mode, Parity parity = Parity::both) const;
  static double kappa(In u) { return u[u.size() - 1] * u[u.size() - 1]; }
  double omega(In u) const { return reference_ * std::sqrt(std::max(0.0, u[u.size() - 2])); }
  const InPlaneGalerkin& galerkin() const { return g_; }

 private:
  void update(double s) const;
  void do_residual(In u, Out r) const override;
  void do_jacobian(In u, MatrixOut j) const override;
  void do_second(In u, In v, MatrixOut h) const override;
  void do_third(In u, In a, In b, In c, Out t) const override;

  InPlaneGalerkin g_;
  double reference_;
  Matrix K2_, M2_;           // second derivatives, constant
  mutable double s_ = -1.0;  // where the others were evaluated
  mutable Matrix K_, M_, K1_, M1_;
};

/// The frequencies at many flexibilities; row i belongs to kappa[i].
struct FrequencyFan {
  Vector kappa;
  Matrix omega, odd_share;  ///< one column a mode
  bool resolved = true;
};
FrequencyFan frequency_fan(double x1, double x2, const Vector& kappa, int count);

/// Modes `lower_mode` and `lower_mode + 1` come closest; gap 0 is a crossing (h = 0).
struct Approach {
  int lower_mode;
  double kappa, lower, upper;  ///< frequencies in sqrt(g/a)
  double gap;                  ///< (upper - lower) / mean
  double odd_lower, odd_upper;
  bool crossing;
  double width;  ///< of the bracket in kappa, relative
};
std::vector<Approach> closest_approaches(double x1, double x2, double kappa_lower, double kappa_upper, int count, int scan_points = 160);

}  // namespace whirl::models::catenary
