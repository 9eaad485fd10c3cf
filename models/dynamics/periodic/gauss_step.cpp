#include "models/dynamics/periodic/gauss_step.hpp"

#include <cmath>

namespace whirl::models {
namespace {

constexpr int max_iterations = 12;
constexpr double stage_tolerance = 1e-13;  // of a stage slope, relative: the next correction is its square
constexpr double rounding = 1e-15;

}  // namespace

// Roots of the Legendre polynomial of degree four on [0, 1] and the integrals of its Lagrange polynomials, to double precision.
const double GaussStep::c[stages] = {0.06943184420297371238802675555359525, 0.33000947820757186759866712044837766,
                                     0.66999052179242813240133287955162234, 0.93056815579702628761197324444640475};
const double GaussStep::b[stages] = {0.17392742256872692868653197461099970, 0.32607257743127307131346802538900030,
                                     0.32607257743127307131346802538900030, 0.17392742256872692868653197461099970};
const double GaussStep::a[stages][stages] = {{0.08696371128436346434326598730549985, -0.02660418008499879331338513047695310,
                                              0.01262746268940472451505688057461809, -0.00355514968579568315691098184956959},
                                             {0.18811811749986807165068554508717117, 0.16303628871563653565673401269450015,
                                              -0.02788042860247089522415110641899741, 0.00673550059453815551539866908570379},
                                             {0.16719192197418877317113330552529591, 0.35395300603374396653761913180799772,
                                              0.16303628871563653565673401269450015, -0.01419069493114114296415357047617147},
                                             {0.17748257225452261184344295646056930, 0.31344511474186834679841114481438222,
                                              0.35267675751627186462685315586595340, 0.08696371128436346434326598730549985}};

GaussStep::GaussStep(const Problem& flow, int columns)
    : flow_(flow),
      n_(flow.size()),
      parameters_(flow.parameters()),
      columns_(columns),
      u_(n_ + parameters_),
      end_(n_),
      rhs_(stages * n_),
      delta_(stages * n_),
      f_(n_),
      k_(n_, stages),
      block_(stages * n_, stages * n_),
      second_(n_, n_ + parameters_),
      y_(stages, Vector(n_)),
      dy_v_(stages, Vector(n_)),
      jacobian_(stages, Matrix(n_, n_ + parameters_)),
      dk_(stages, Matrix(n_, columns)),
      dy_(stages, Matrix(n_, columns)),
      ddy_(stages, Matrix(n_, columns)),
      ddk_(stages, Matrix(n_, columns)),
      right_(stages * n_, columns),
      lu_(stages * n_),
      dh_(columns) {}

void GaussStep::stage_points(In x) {
  for (int i = 0; i < stages; ++i) {
    Vector& y = y_[static_cast<std::size_t>(i)];
    y = x;
    for (int j = 0; j < stages; ++j) y.noalias() += (h_ * a[i][j]) * k_.col(j);
  }
}

void GaussStep::factorise() {
  for (int i = 0; i < stages; ++i)
    for (int j = 0; j < stages; ++j) {
      block_.block(i * n_, j * n_, n_, n_) = (-h_ * a[i][j]) * jacobian_[static_cast<std::size_t>(i)].leftCols(n_);
      if (i == j) block_.block(i * n_, j * n_, n_, n_).diagonal().array() += 1.0;
    }
  lu_.compute(block_);
}

bool GaussStep::solve(In x, In p, double h, Matrix& k) {
  h_ = h;
  k_ = k;
  if (!iterate(x, p)) {
    u_.head(n_) = x;
    u_.tail(parameters_) = p;
    flow_.residual(u_, f_);
    k_ = f_.replicate(1, stages);
    k = k_;
    if (!iterate(x, p)) return false;
  }
  k = k_;
  end_ = x;
  for (int i = 0; i < stages; ++i) end_.noalias() += (h_ * b[i]) * k_.col(i);
  return true;
}

bool GaussStep::iterate(In x, In p) {
  u_.tail(parameters_) = p;
  bool last = false;
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    stage_points(x);
    double size = 0.0;
    for (int i = 0; i < stages; ++i) {
      u_.head(n_) = y_[static_cast<std::size_t>(i)];
      flow_.linearise(u_, f_, jacobian_[static_cast<std::size_t>(i)]);
      rhs_.segment(i * n_, n_) = f_ - k_.col(i);
      size = std::max(size, f_.lpNorm<Eigen::Infinity>());
    }
    if (!rhs_.allFinite()) return false;
    factorise();
    if (last) break;
    delta_ = lu_.solve(rhs_);
    for (int i = 0; i < stages; ++i) k_.col(i) += delta_.segment(i * n_, n_);
    const double change = delta_.lpNorm<Eigen::Infinity>();
    if (!std::isfinite(change)) return false;
    last = change <= std::sqrt(stage_tolerance) * size + rounding;  // the next change would be below the tolerance: only the Jacobians are renewed
    if (!last && iteration + 1 == max_iterations) return false;
  }
  return true;
}

void GaussStep::first(Matrix& dx, In dh) {
  dh_ = dh;
  for (int i = 0; i < stages; ++i) {
    Vector& lever = f_;  // sum_j a_ij K_j
    lever.setZero();
    for (int j = 0; j < stages; ++j) lever.noalias() += a[i][j] * k_.col(j);
    Matrix& dy = dy_[static_cast<std::size_t>(i)];
    dy = dx;
    dy.noalias() += lever * dh_.transpose();
    const Matrix& jacobian = jacobian_[static_cast<std::size_t>(i)];
    right_.middleRows(i * n_, n_).noalias() = jacobian.leftCols(n_) * dy;
    right_.block(i * n_, columns_ - parameters_, n_, parameters_) += jacobian.rightCols(parameters_);
  }
  right_ = lu_.solve(right_);
  for (int i = 0; i < stages; ++i) dk_[static_cast<std::size_t>(i)] = right_.middleRows(i * n_, n_);
  for (int i = 0; i < stages; ++i)
    for (int j = 0; j < stages; ++j) dy_[static_cast<std::size_t>(i)].noalias() += (h_ * a[i][j]) * dk_[static_cast<std::size_t>(j)];
  for (int j = 0; j < stages; ++j) {
    dx.noalias() += (h_ * b[j]) * dk_[static_cast<std::size_t>(j)];
    dx.noalias() += (b[j] * k_.col(j)) * dh_.transpose();
  }
}

// With J dY + f_p dp = dK once more differentiated along v:
//     d2K_i = D2f[(dY_v, dp_v), (dY, dp)] + J_i d2Y_i,   d2Y_i = d2x + sum_j a_ij (h d2K_j + dh_v dK_j + dh dK_j,v + d2h K_j)
void GaussStep::second(Vector& dx_v, double dh_v, In dp_v, Matrix& ddx, In ddh) {
  Matrix dk_v(n_, stages);
  Vector right = Vector::Zero(stages * n_);
  for (int i = 0; i < stages; ++i) {
    Vector start = dx_v;
    for (int j = 0; j < stages; ++j) start += (a[i][j] * dh_v) * k_.col(j);
    const Matrix& jacobian = jacobian_[static_cast<std::size_t>(i)];
    right.segment(i * n_, n_) = jacobian.leftCols(n_) * start + jacobian.rightCols(parameters_) * dp_v;
    dy_v_[static_cast<std::size_t>(i)] = start;
  }
  right = lu_.solve(right);
  for (int i = 0; i < stages; ++i) dk_v.col(i) = right.segment(i * n_, n_);
  for (int i = 0; i < stages; ++i)
    for (int j = 0; j < stages; ++j) dy_v_[static_cast<std::size_t>(i)] += (h_ * a[i][j]) * dk_v.col(j);
  Vector along(n_ + parameters_);
  along.tail(parameters_) = dp_v;
  for (int i = 0; i < stages; ++i) {
    const auto at = static_cast<std::size_t>(i);
    Matrix& ddy = ddy_[at];
    ddy = ddx;
    for (int j = 0; j < stages; ++j) {
      ddy += (a[i][j] * dh_v) * dk_[static_cast<std::size_t>(j)];
      ddy += (a[i][j] * dk_v.col(j)) * dh_.transpose();
      ddy += (a[i][j] * k_.col(j)) * ddh.transpose();
    }
    u_.head(n_) = y_[at];
    along.head(n_) = dy_v_[at];
    flow_.second(u_, along, second_);
    right_.middleRows(i * n_, n_) = second_.leftCols(n_) * dy_[at] + jacobian_[at].leftCols(n_) * ddy;
    right_.block(i * n_, columns_ - parameters_, n_, parameters_) += second_.rightCols(parameters_);
  }
  right_ = lu_.solve(right_);
  for (int i = 0; i < stages; ++i) ddk_[static_cast<std::size_t>(i)] = right_.middleRows(i * n_, n_);
  for (int i = 0; i < stages; ++i)
    for (int j = 0; j < stages; ++j) ddy_[static_cast<std::size_t>(i)] += (h_ * a[i][j]) * ddk_[static_cast<std::size_t>(j)];
  for (int j = 0; j < stages; ++j) {
    const auto at = static_cast<std::size_t>(j);
    ddx += (h_ * b[j]) * ddk_[at] + (b[j] * dh_v) * dk_[at] + (b[j] * dk_v.col(j)) * dh_.transpose() + (b[j] * k_.col(j)) * ddh.transpose();
    dx_v += (h_ * b[j]) * dk_v.col(j) + (b[j] * dh_v) * k_.col(j);
  }
}

}  // namespace whirl::models
