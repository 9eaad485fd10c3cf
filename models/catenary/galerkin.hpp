#pragma once
/// Spectral discretisation of small motion about the catenary: any sag, any flexibility kappa = H/EA >= 0, any linear drag.
///
/// Core system, [Gale1976, eqs (2.33), (2.34)] in x with c = cosh x, lengths in a, tensions in H, time in sqrt(a/g);
/// U tangential, V normal, W out of plane, N transverse force, T tension; N/c is the change of slope:
///
///     U_x = V/c + kappa c T      V_x = N - U/c       N_x = L2 c V - T/c      T_x = L1 c U + N/c      L_i = lambda^2 + eta_i lambda
///     W_xx = L3 c W              PE = 1/2 int [(V_x + U/c)^2 + (U_x - V/c)^2 / (kappa c)] dx         KE = lambda^2/2 int (U^2 + V^2) c dx
///
/// Unknowns are the turning Q and the stretch R, polynomials in the graded coordinate t of mesh.hpp (J = dx/dt), of which U is an exact integral:
///
///     V = c Q/J,   U_t = Q + s R,   s = sqrt(kappa),   T = R/(s c J)        PE = 1/2 int [(V_x + U/c)^2 + (R/J)^2/c] dx
///
///     A: Q = phi_k, k >= 1       B: R = P_k, k >= 1       C: Q = s phi_0, R = -1/sqrt 6, so that int (Q + s R) dt = 0
///
/// (phi_k, P_k as in core/legendre.hpp.) A alone is the inextensible cable. Nothing is divided by kappa: no digit is lost as kappa -> 0, and
///
///     K = D KF D + KR,   M = D (MU + MV) D,   D = 1 on A, s on B and C
///
/// makes another flexibility a scaling. At h = 0 even and odd k separate into symmetric and antisymmetric motion. Four more functions, the lifts,
/// carry prescribed end values U1, V1, U2, V2.
///
///     InPlaneGalerkin g(x1, x2, 48);
///     PencilModes modes = lowest_modes(g.stiffness(kappa), g.mass(kappa), 8);
///
/// Throws std::invalid_argument for fewer than 2 functions, x1 >= x2 or kappa < 0.

#include "models/catenary/mesh.hpp"

namespace whirl::models::catenary {

/// Of V about the middle. Symmetric and antisymmetric motion separate at h = 0 only.
enum class Parity { both, symmetric, antisymmetric };

class InPlaneGalerkin {
 public:
  static constexpr int lifts = 4;  ///< unit U1, V1, U2, V2 in this order

  /// A discretisation that is not elastic has the functions A only, and takes kappa = 0 only.
  InPlaneGalerkin(double x1, double x2, int n, bool elastic = true);

  int functions() const { return n_; }
  int size(double kappa) const { return kappa > 0.0 ? 2 * n_ + 1 : n_; }
  const Mesh& mesh() const { return mesh_; }

  Matrix stiffness(double kappa) const;
  /// tangential MU + normal MV; with (eta1, eta2) the damping matrix.
  Matrix mass(double kappa, double tangential = 1.0, double normal = 1.0) const;
  /// Derivatives with respect to s = sqrt(kappa), of order 1 or 2.
  Matrix stiffness_slope(double kappa, int order = 1) const;
  Matrix mass_slope(double kappa, int order = 1) const;
  /// Work of the lifts on the functions, size(kappa) x 4.
  Matrix lift_stiffness(double kappa) const;
  Matrix lift_mass(double kappa, double tangential, double normal) const;

  /// Which functions have one parity at h = 0, those with k <= largest_k.
  std::vector<int> indices(double kappa, Parity parity, int largest_k = 1 << 30) const;
  /// k of function i, 0 for C.
  int order(int i) const { return i == 2 * n_ ? 0 : i % n_ + 1; }

  /// Functions A, B, C and lifts at the mesh points, one column each; F = V_x + U/c. B and C still lack their factor s.
  const Matrix& U() const { return U_; }
  const Matrix& V() const { return V_; }
  const Matrix& F() const { return F_; }
  const Matrix& R() const { return R_; }  ///< stretch R/J = (U_x - V/c)/s of A, B and C, no lifts

  /// U, V, N at the mesh points for coefficients q of size(kappa) and end values.
  template <class S>
  struct Nodal {
    Eigen::Matrix<S, Eigen::Dynamic, 1> U, V, N;
  };
  template <class S>
  Nodal<S> nodal(double kappa, const Eigen::Matrix<S, Eigen::Dynamic, 1>& q, const Eigen::Matrix<S, 4, 1>& ends) const {
    const int n = size(kappa);
    const Eigen::Matrix<S, Eigen::Dynamic, 1> dq = scale(kappa).cwiseProduct(q);
    const auto sum = [&](const Matrix& table) -> Eigen::Matrix<S, Eigen::Dynamic, 1> {
      return table.leftCols(n).template cast<S>() * dq + table.rightCols(lifts).template cast<S>() * ends;
    };
    return {sum(U_), sum(V_), sum(F_)};
  }

 private:
  Vector scale(double kappa, int order = 0) const;  // D and its derivatives
  Matrix scaled(const Matrix& a, double kappa, int order) const;

  void add_lifts(Matrix& Q, Matrix& Q_t, const Matrix& phi_integral, const Matrix& p_integral);
  Matrix gram(const Matrix& a, const Vector& weight, const std::vector<int>& chosen) const;
  Matrix lift_work(const Matrix& a, const Vector& weight, double kappa) const;

  int n_;
  bool elastic_;
  Mesh mesh_;
  Matrix U_, V_, F_, R_;
  Matrix KF_, MU_, MV_, KR_;  // KR_: B and C alone
};

/// Out of plane: K = int W_x^2 dx, M = int c W^2 dx in the functions phi_0 ... phi_{n-1} of t; the lifts are the straight lines of unit W1, W2.
class LateralGalerkin {
 public:
  LateralGalerkin(double x1, double x2, int n);
  int size() const { return static_cast<int>(W_.cols()) - 2; }
  const Mesh& mesh() const { return mesh_; }
  const Matrix& stiffness() const { return K_; }
  const Matrix& mass() const { return M_; }
  const Matrix& lift_stiffness() const { return K_lift_; }  ///< size x 2
  const Matrix& lift_mass() const { return M_lift_; }
  std::vector<int> indices(Parity parity, int largest_k = 1 << 30) const;
  const Matrix& W() const { return W_; }            ///< functions and the two lifts at the mesh points
  const Matrix& W_slope() const { return slope_; }  ///< their x-derivatives

 private:
  Mesh mesh_;
  Matrix W_, slope_, K_, M_, K_lift_, M_lift_;
};

/// Rows and columns of a symmetric matrix.
Matrix pick(const Matrix& a, const std::vector<int>& chosen);

}  // namespace whirl::models::catenary
