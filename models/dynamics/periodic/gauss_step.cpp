#include "models/dynamics/periodic/gauss_step.hpp"

#include <cmath>

namespace whirl::models {
namespace {

constexpr int max_iterations = 24;
constexpr double stage_tolerance = 1e-15;  // of a stage slope, relative: what the next correction would be at most
constexpr double rounding = 1e-16;         // of the state
constexpr double quadratic = 3e-8;         // a Newton correction below it, relative, is the last
constexpr double rounding_of_field = 1e4;  // corrections that shrink no more are rounding up to so many times the tolerance
constexpr double too_slow = 0.1;           // ratio of two corrections: above it the factors are made anew
constexpr double far = 1e-3;               // a Newton correction above it, relative, is followed by another
constexpr int most_factors = 14;

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
      key_(n_ + parameters_ + 1),
      end_(n_),
      rhs_(stages * n_),
      delta_(stages * n_),
      f_(n_),
      along_(n_ + parameters_),
      block_(stages * n_, stages * n_),
      dk_v_(n_, stages),
      second_(n_, n_ + parameters_),
      y_(stages, Vector(n_)),
      dy_v_(stages, Vector(n_)),
      dk_(stages, Matrix(n_, columns)),
      dy_(stages, Matrix(n_, columns)),
      ddy_(stages, Matrix(n_, columns)),
      ddk_(stages, Matrix(n_, columns)),
      right_(stages * n_, columns),
      dh_(columns) {}

void GaussStep::stage_points(In x, const Matrix& k) {
  for (int i = 0; i < stages; ++i) {
    Vector& y = y_[static_cast<std::size_t>(i)];
    y = x;
    for (int j = 0; j < stages; ++j) y.noalias() += (h_ * a[i][j]) * k.col(j);
  }
}

// Jacobians at the stage points and the factors that go with them; false where they are not finite.
bool GaussStep::linearise(In p, GaussMemory& m) {
  m.jacobian.resize(stages, Matrix(n_, n_ + parameters_));
  u_.tail(parameters_) = p;
  for (int i = 0; i < stages; ++i) {
    u_.head(n_) = y_[static_cast<std::size_t>(i)];
    flow_.jacobian(u_, m.jacobian[static_cast<std::size_t>(i)]);
  }
  for (int i = 0; i < stages; ++i)
    for (int j = 0; j < stages; ++j) {
      block_.block(i * n_, j * n_, n_, n_) = (-h_ * a[i][j]) * m.jacobian[static_cast<std::size_t>(i)].leftCols(n_);
      if (i == j) block_.block(i * n_, j * n_, n_, n_).diagonal().array() += 1.0;
    }
  m.at.resize(0);
  if (!block_.allFinite()) return false;
  m.lu.compute(block_);
  return true;
}

bool GaussStep::solve(In x, In p, double h, GaussMemory& m, bool derivatives) {
  memory_ = &m;
  h_ = h;
  key_ << x, p, h;
  const bool known = m.at.size() == key_.size() && m.at == key_;
  if (!known) {
    if (!iterate(x, p, m) && !from_slope(x, p, m)) return false;
  }
  stage_points(x, m.k);
  if (!known && derivatives) {
    if (!linearise(p, m)) return false;
    m.at = key_;
  }
  end_ = x;
  for (int i = 0; i < stages; ++i) end_.noalias() += (h_ * b[i]) * m.k.col(i);
  return true;
}

bool GaussStep::from_slope(In x, In p, GaussMemory& m) {
  u_.head(n_) = x;
  u_.tail(parameters_) = p;
  flow_.residual(u_, f_);
  m.k = f_.replicate(1, stages);
  m.lu = Eigen::PartialPivLU<Matrix>();
  if (f_.allFinite() && iterate(x, p, m)) return true;
  m.k = f_.replicate(1, stages);
  m.lu = Eigen::PartialPivLU<Matrix>();
  return false;
}

bool GaussStep::iterate(In x, In p, GaussMemory& m) {
  m.at.resize(0);
  bool fresh = false;
  int factors = 0;
  double before = 0.0;
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    stage_points(x, m.k);
    const bool newton = m.lu.rows() == 0 || fresh;
    if (newton) {
      if (++factors > most_factors || !linearise(p, m)) return false;
      fresh = false;
      before = 0.0;
    }
    u_.tail(parameters_) = p;
    double size = 0.0;
    for (int i = 0; i < stages; ++i) {
      u_.head(n_) = y_[static_cast<std::size_t>(i)];
      flow_.residual(u_, f_);
      rhs_.segment(i * n_, n_) = f_ - m.k.col(i);
      size = std::max(size, f_.lpNorm<Eigen::Infinity>());
    }
    if (!rhs_.allFinite()) return false;
    delta_ = m.lu.solve(rhs_);
    const double change = delta_.lpNorm<Eigen::Infinity>();
    if (!std::isfinite(change)) return false;
    for (int i = 0; i < stages; ++i) m.k.col(i) += delta_.segment(i * n_, n_);
    const double ratio = before > 0.0 ? change / before : 1.0;
    const double small = stage_tolerance * size + rounding * x.lpNorm<Eigen::Infinity>() / std::abs(h_);
    if (change <= small || (ratio < 1.0 && change * ratio / (1.0 - ratio) <= small)) return true;
    if (newton && change <= quadratic * size) return true;  // the next would be its square
    if (change <= rounding_of_field * small && ratio > too_slow) return true;
    fresh = (newton && change > far * size) || (ratio > too_slow && before > 0.0);
    before = change;
  }
  return false;
}

void GaussStep::first(Matrix& dx, In dh) {
  dh_ = dh;
  for (int i = 0; i < stages; ++i) {
    Vector& lever = f_;  // sum_j a_ij K_j
    lever.setZero();
    for (int j = 0; j < stages; ++j) lever.noalias() += a[i][j] * memory_->k.col(j);
    Matrix& dy = dy_[static_cast<std::size_t>(i)];
    dy = dx;
    dy.noalias() += lever * dh_.transpose();
    const Matrix& jacobian = memory_->jacobian[static_cast<std::size_t>(i)];
    right_.middleRows(i * n_, n_).noalias() = jacobian.leftCols(n_) * dy;
    right_.block(i * n_, columns_ - parameters_, n_, parameters_) += jacobian.rightCols(parameters_);
  }
  right_ = memory_->lu.solve(right_);
  for (int i = 0; i < stages; ++i) dk_[static_cast<std::size_t>(i)] = right_.middleRows(i * n_, n_);
  for (int i = 0; i < stages; ++i)
    for (int j = 0; j < stages; ++j) dy_[static_cast<std::size_t>(i)].noalias() += (h_ * a[i][j]) * dk_[static_cast<std::size_t>(j)];
  for (int j = 0; j < stages; ++j) {
    dx.noalias() += (h_ * b[j]) * dk_[static_cast<std::size_t>(j)];
    dx.noalias() += (b[j] * memory_->k.col(j)) * dh_.transpose();
  }
}

// With J dY + f_p dp = dK once more differentiated along v:
//     d2K_i = D2f[(dY_v, dp_v), (dY, dp)] + J_i d2Y_i,   d2Y_i = d2x + sum_j a_ij (h d2K_j + dh_v dK_j + dh dK_j,v + d2h K_j)
void GaussStep::second(Vector& dx_v, double dh_v, In dp_v, Matrix& ddx, In ddh) {
  Matrix& dk_v = dk_v_;
  Vector& right = rhs_;
  for (int i = 0; i < stages; ++i) {
    Vector& start = dy_v_[static_cast<std::size_t>(i)];
    start = dx_v;
    for (int j = 0; j < stages; ++j) start += (a[i][j] * dh_v) * memory_->k.col(j);
    const Matrix& jacobian = memory_->jacobian[static_cast<std::size_t>(i)];
    right.segment(i * n_, n_).noalias() = jacobian.leftCols(n_) * start;
    right.segment(i * n_, n_).noalias() += jacobian.rightCols(parameters_) * dp_v;
  }
  delta_ = memory_->lu.solve(right);
  for (int i = 0; i < stages; ++i) dk_v.col(i) = delta_.segment(i * n_, n_);
  for (int i = 0; i < stages; ++i)
    for (int j = 0; j < stages; ++j) dy_v_[static_cast<std::size_t>(i)] += (h_ * a[i][j]) * dk_v.col(j);
  Vector& along = along_;
  along.tail(parameters_) = dp_v;
  for (int i = 0; i < stages; ++i) {
    const auto at = static_cast<std::size_t>(i);
    Matrix& ddy = ddy_[at];
    ddy = ddx;
    for (int j = 0; j < stages; ++j) {
      ddy += (a[i][j] * dh_v) * dk_[static_cast<std::size_t>(j)];
      ddy.noalias() += (a[i][j] * dk_v.col(j)) * dh_.transpose();
      ddy.noalias() += (a[i][j] * memory_->k.col(j)) * ddh.transpose();
    }
    u_.head(n_) = y_[at];
    along.head(n_) = dy_v_[at];
    flow_.second(u_, along, second_);
    right_.middleRows(i * n_, n_).noalias() = second_.leftCols(n_) * dy_[at];
    right_.middleRows(i * n_, n_).noalias() += memory_->jacobian[at].leftCols(n_) * ddy;
    right_.block(i * n_, columns_ - parameters_, n_, parameters_) += second_.rightCols(parameters_);
  }
  right_ = memory_->lu.solve(right_);
  for (int i = 0; i < stages; ++i) ddk_[static_cast<std::size_t>(i)] = right_.middleRows(i * n_, n_);
  for (int i = 0; i < stages; ++i)
    for (int j = 0; j < stages; ++j) ddy_[static_cast<std::size_t>(i)] += (h_ * a[i][j]) * ddk_[static_cast<std::size_t>(j)];
  for (int j = 0; j < stages; ++j) {
    const auto at = static_cast<std::size_t>(j);
    ddx += (h_ * b[j]) * ddk_[at] + (b[j] * dh_v) * dk_[at];
    ddx.noalias() += (b[j] * dk_v.col(j)) * dh_.transpose();
    ddx.noalias() += (b[j] * memory_->k.col(j)) * ddh.transpose();
    dx_v += (h_ * b[j]) * dk_v.col(j) + (b[j] * dh_v) * memory_->k.col(j);
  }
}

}  // namespace whirl::models
