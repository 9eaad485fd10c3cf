#pragma once
/// The full linear problem of a guy: varying tension and curvature, extensible, damped, in plane and out of plane.
///
///     (D u')' + m p_e^2 u = 0,   u = 0 at the anchor,   K(p) = [D u'] at the mast for unit motion e^{ipt} there,   p_e^2 = p^2 - i p c/m
///
/// in place of [Sarvi1968, eqs (3.28)-(3.30)], whose strain lacks the term eta/R. Spectral Galerkin, one eigenproblem for all
/// frequencies: with the static lift of the end, Ks its stiffness, Mb its mass, mu_n = 1/w_n^2 and g_n the modes' shares of it,
///
///     K(p) = Ks - p_e^2 Mb - p_e^4 sum_n g_n g_n^T / (1 - p_e^2 mu_n)
///
/// which is passive for c >= 0 by construction, has its poles at the modes of the guy with both ends held, and between two poles of a diagonal entry
/// exactly one zero. Frequencies p in rad/s, c/m in 1/s, K in N/m. Throws std::invalid_argument for a state of the first-order form, frequencies or
/// damping below zero, and guys too slack for `largest_degree`.
///
///     const LinearGuy guy(rest, 8.0);                          // resolved up to p = 8 rad/s
///     const StiffnessMatrix k = guy.stiffness(3.14, 0.009);    // k.xx: the dynamic guy modulus
///     for (const Pole& p : guy.poles(Plane::in_plane)) ...     // p.frequency, p.strength_xx

#include <Eigen/Core>
#include <complex>
#include <span>
#include <vector>

#include "models/guy/statics.hpp"

namespace whirl::models::guy {

enum class Plane { in_plane, out_of_plane };
enum class Direction { horizontal, vertical, out_of_plane };

inline constexpr int largest_degree = 600;

struct StiffnessMatrix {
  std::complex<double> xx, xy, yy, zz;  ///< symmetric; xz = yz = 0
};

/// A mode with both ends held. Near it K ~ -strength / (1 - p_e^2 / frequency^2).
struct Pole {
  double frequency;                              ///< w_n, undamped [rad/s]
  double strength_xx, strength_yy, strength_zz;  ///< [N/m]
};

struct ModePoint {
  double x, y, z;  ///< displacement; the largest over the points asked for is 1
};

class LinearGuy {
 public:
  /// `degree` 0: chosen from the travel time and the slackness.
  LinearGuy(const Statics& exact, double highest_frequency, int degree = 0);

  StiffnessMatrix stiffness(double p, double damping_rate) const;
  std::complex<double> modulus(Direction direction, double p, double damping_rate) const;
  /// The same at many frequencies.
  void modulus(Direction direction, std::span<const double> p, double damping_rate, std::span<std::complex<double>> k) const;

  std::vector<Pole> poles(Plane plane) const;            ///< up to the highest frequency
  std::vector<double> zeros(Direction direction) const;  ///< of the undamped modulus, up to the highest frequency
  std::vector<ModePoint> shape(Plane plane, int number, std::span<const double> sigma) const;  ///< mode `number` >= 1 at s/L0 = sigma

  const Statics& state() const { return state_; }
  int degree() const { return degree_; }
  double highest_frequency() const { return highest_; }

 private:
  struct Part {                        // of one plane; `ends` is 2 or 1
    Eigen::MatrixXd static_stiffness;  // Ks, ends x ends
    Eigen::MatrixXd end_mass;          // Mb
    Eigen::VectorXd mu;                // decreasing
    Eigen::MatrixXd share;             // g, modes x ends
    Eigen::MatrixXd vectors;           // coefficients of the modes
  };
  static Part solve(const Eigen::MatrixXd& stiffness, const Eigen::MatrixXd& mass, int ends);
  const Part& part(Direction d) const { return d == Direction::out_of_plane ? out_ : in_; }
  static int end_of(Direction d) { return d == Direction::vertical ? 1 : 0; }
  std::complex<double> entry(const Part& part, int i, int j, std::complex<double> pe2) const;

  Statics state_;
  double highest_;
  int degree_;
  Part in_, out_;
};

/// Degree that resolves frequencies up to `highest_frequency` to rounding.
int suitable_degree(const Statics& exact, double highest_frequency);

}  // namespace whirl::models::guy
