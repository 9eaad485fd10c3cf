#include "continuation/augmented.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SVD>

#include "continuation/null_vectors.hpp"

namespace whirl::continuation {
namespace {

Matrix block_of(const Matrix& j, const Indices& rows) {
  const int m = static_cast<int>(rows.size());
  Matrix a(m, m);
  for (int c = 0; c < m; ++c)
    for (int r = 0; r < m; ++r) a(r, c) = j(rows[std::size_t(r)], rows[std::size_t(c)]);
  return a;
}

// v on the block's coordinates, zero elsewhere and in the parameters.
void embed(In v, const Indices& block, Vector& full) {
  full.setZero();
  for (std::size_t i = 0; i < block.size(); ++i) full[block[i]] = v[static_cast<int>(i)];
}

// Small A: directions b, c of unit length (a zero behind them) that A, nearly singular, almost annihilates from the left and from the right. Borders
// with which [A b; c' 0] is well conditioned: three rounds of solving with the borders so far, else singular vectors.
void null_directions(const Matrix& a, Vector& b, Vector& c) {
  const int m = static_cast<int>(a.rows());
  Matrix bordered(m + 1, m + 1);
  bordered.topLeftCorner(m, m) = a;
  const double size = a.norm();
  DenseLu lu(m + 1);
  for (int i = 0; i < m; ++i) {  // no symmetry of a model is likely to be orthogonal to these
    b[i] = 1.0 + 0.37 * std::cos(1.7 * i);
    c[i] = 1.0 + 0.41 * std::sin(2.3 * i + 0.4);
  }
  b[m] = c[m] = 0.0;
  bool fine = size > 0.0;
  for (int round = 0; round < 3 && fine; ++round) {
    b /= b.norm();
    c /= c.norm();
    bordered.col(m) = size * b;
    bordered.row(m) = size * c.transpose();
    lu.compute(bordered);
    Vector v = Vector::Unit(m + 1, m), w = v;
    lu.solve(v, v);
    lu.solve_transposed(w, w);
    v[m] = w[m] = 0.0;
    fine = v.allFinite() && w.allFinite() && v.norm() > 0.0 && w.norm() > 0.0 && v.norm() * size < 1e8 && w.norm() * size < 1e8;
    c = v;
    b = w;
  }
  if (fine) {
    b /= b.norm();
    c /= c.norm();
    return;
  }
  const Eigen::JacobiSVD<Matrix> svd(a, Eigen::ComputeFullU | Eigen::ComputeFullV);
  b.head(m) = svd.matrixU().col(m - 1);
  c.head(m) = svd.matrixV().col(m - 1);
  b[m] = c[m] = 0.0;
}

Indices all_coordinates(const Problem& f) {
  Indices all(static_cast<std::size_t>(f.size()));
  for (int i = 0; i < f.size(); ++i) all[static_cast<std::size_t>(i)] = i;
  return all;
}

}  // namespace

AugmentedSystem::AugmentedSystem(const Problem& base, Indices state, int extra)
    : Problem(static_cast<int>(state.size()) + 1 + extra, base.parameters() - 1, false),
      base_(base),
      state_(std::move(state)),
      extra_(extra),
      column_(static_cast<std::size_t>(base.size() + base.parameters()), -1),
      u_(Vector::Zero(base.size() + base.parameters())),
      r_(base.size()),
      j_(base.size(), base.size() + base.parameters()),
      h_(base.size(), base.size() + base.parameters()) {
  if (base.parameters() < 1) throw std::invalid_argument("a system for special points needs at least one free parameter");
  const int s = static_cast<int>(state_.size());
  for (int i = 0; i < s; ++i) column_[std::size_t(state_[std::size_t(i)])] = i;
  column_[std::size_t(base.size())] = s;
  for (int k = 1; k < base.parameters(); ++k) column_[std::size_t(base.size() + k)] = s + extra + k;
  if (base.parameters() > 1) name_parameters({base.parameter_names().begin() + 1, base.parameter_names().end()});
}

Vector AugmentedSystem::base_point(In y) const {
  spread(y);
  return u_;
}

void AugmentedSystem::spread(In y) const {
  for (int i = 0; i < u_.size(); ++i)
    if (column(i) >= 0) u_[i] = y[column(i)];
}

void AugmentedSystem::gather_rows(MatrixIn j, int, MatrixOut out) const {
  for (int c = 0; c < j.cols(); ++c)
    if (column(c) >= 0)
      for (std::size_t r = 0; r < state_.size(); ++r) out(static_cast<int>(r), column(c)) = j(state_[r], c);
}

void AugmentedSystem::prepare(In y) const {
  spread(y);
  base_.jacobian(u_, j_);
  solve_bordered(y);
}

void AugmentedSystem::do_residual(In y, Out r) const {
  spread(y);
  base_.linearise(u_, r_, j_);
  solve_bordered(y);
  fill_residual(y, r);
}

void AugmentedSystem::do_jacobian(In y, MatrixOut j) const {
  prepare(y);
  fill_jacobian(y, j);
}

void AugmentedSystem::do_linearise(In y, Out r, MatrixOut j) const {
  spread(y);
  base_.linearise(u_, r_, j_);
  solve_bordered(y);
  fill_residual(y, r);
  fill_jacobian(y, j);
}

// ----------------------------------------------------------------------------------------------------------- SingularSystem

SingularSystem::SingularSystem(const Problem& base, Indices state, Indices block, In u)
    : AugmentedSystem(base, std::move(state), 0), block_(std::move(block)), full_(base.size() + base.parameters()) {
  const int m = static_cast<int>(block_.size());
  bordered_.resize(m + 1, m + 1);
  b_ = c_ = v_ = w_ = Vector::Zero(m + 1);
  update_borders(unknowns(u));
}

Vector SingularSystem::unknowns(In u) const {
  Vector y(size() + parameters());
  for (int i = 0; i < u_.size(); ++i)
    if (column(i) >= 0) y[column(i)] = u[i];
  return y;
}

void SingularSystem::update_borders(In y) {
  spread(y);
  base_.jacobian(u_, j_);
  const int m = static_cast<int>(block_.size());
  Vector b = Vector::Zero(m + 1), c = b;
  if (m < DenseLu::small) {
    null_directions(block_of(j_, block_), b, c);
  } else {
    Vector right, left;
    null_vectors(block_of(j_, block_), right, left);
    b.head(m) = left;
    c.head(m) = right;
  }
  // Null vectors come with any sign; keep it along a curve, so that test functions do not jump.
  b_ = b.dot(b_) < 0.0 ? Vector(-b) : b;
  c_ = c.dot(c_) < 0.0 ? Vector(-c) : c;
}

void SingularSystem::solve_bordered(In) const {
  const int m = static_cast<int>(block_.size());
  for (int c = 0; c < m; ++c)
    for (int r = 0; r < m; ++r) bordered_(r, c) = j_(block_[std::size_t(r)], block_[std::size_t(c)]);
  bordered_.col(m) = b_;
  bordered_.row(m) = c_.transpose();
  lu_.compute(bordered_);
  v_ = w_ = Vector::Unit(m + 1, m);
  lu_.solve(v_, v_);
  lu_.solve_transposed(w_, w_);
}

void SingularSystem::fill_residual(In, Out r) const {
  for (std::size_t i = 0; i < state_.size(); ++i) r[static_cast<int>(i)] = r_[state_[i]];
  r[static_cast<int>(state_.size())] = v_[static_cast<int>(block_.size())];
}

void SingularSystem::fill_jacobian(In, MatrixOut j) const {
  j.setZero();
  gather_rows(j_, 0, j);
  embed(v_.head(static_cast<int>(block_.size())), block_, full_);
  base_.second(u_, full_, h_);
  for (int c = 0; c < h_.cols(); ++c)
    if (column(c) >= 0) {
      double dg = 0.0;
      for (std::size_t i = 0; i < block_.size(); ++i) dg -= w_[static_cast<int>(i)] * h_(block_[i], c);
      j(static_cast<int>(state_.size()), column(c)) = dg;
    }
}

Vector SingularSystem::null_vector(In y) const {
  prepare(y);
  embed(v_.head(static_cast<int>(block_.size())), block_, full_);
  return full_.head(base_.size()).normalized();
}

Vector SingularSystem::left_null_vector(In y) const {
  prepare(y);
  embed(w_.head(static_cast<int>(block_.size())), block_, full_);
  return full_.head(base_.size()).normalized();
}

// -------------------------------------------------------------------------------------------------------- BranchPointSystem

BranchPointSystem::BranchPointSystem(const Problem& base, In u)
    : AugmentedSystem(base, all_coordinates(base), 1), full_(base.size() + base.parameters()) {
  const int n = base.size();
  bordered_.resize(n + 2, n + 2);
  b_.resize(n);
  c_.resize(n + 1, 2);
  update_borders(unknowns(u));
}

Vector BranchPointSystem::unknowns(In u) const {
  Vector y = Vector::Zero(size() + parameters());
  for (int i = 0; i < u_.size(); ++i) y[column(i)] = u[i];
  return y;
}

void BranchPointSystem::update_borders(In y) {
  spread(y);
  base_.jacobian(u_, j_);
  const int n = base_.size();
  const Eigen::JacobiSVD<Matrix> svd(j_.leftCols(n + 1), Eigen::ComputeFullU | Eigen::ComputeFullV);
  b_ = svd.matrixU().col(n - 1);
  c_ = svd.matrixV().rightCols(2);
}

void BranchPointSystem::solve_bordered(In) const {
  const int n = base_.size();
  bordered_.setZero();
  bordered_.topLeftCorner(n, n + 1) = j_.leftCols(n + 1);
  bordered_.col(n + 1).head(n) = b_;
  bordered_.bottomLeftCorner(2, n + 1) = c_.transpose();
  lu_.compute(bordered_);
  Matrix e = Matrix::Zero(n + 2, 2);
  e(n, 0) = e(n + 1, 1) = 1.0;
  v_.resize(n + 2, 2);
  for (int i = 0; i < 2; ++i) lu_.solve(e.col(i), v_.col(i));
  w_ = Vector::Unit(n + 2, n + 1);
  lu_.solve_transposed(w_, w_);
}

void BranchPointSystem::fill_residual(In y, Out r) const {
  const int n = base_.size();
  r.head(n) = r_ + y[n + 1] * b_;
  r[n] = v_(n + 1, 0);
  r[n + 1] = v_(n + 1, 1);
}

void BranchPointSystem::fill_jacobian(In, MatrixOut j) const {
  const int n = base_.size();
  j.setZero();
  gather_rows(j_, 1, j);
  j.col(n + 1).head(n) = b_;
  for (int i = 0; i < 2; ++i) {
    full_.setZero();
    full_.head(n + 1) = v_.col(i).head(n + 1);
    base_.second(u_, full_, h_);
    for (int c = 0; c < h_.cols(); ++c) j(n + i, column(c)) = -w_.head(n).dot(h_.col(c));
  }
}

bool BranchPointSystem::persists(In y) const {
  spread(y);
  base_.jacobian(u_, j_);
  return std::abs(y[base_.size() + 1]) <= 1e-8 * (1.0 + j_.norm());
}

Matrix BranchPointSystem::null_space(In y) const {
  spread(y);
  base_.jacobian(u_, j_);
  const int n = base_.size();
  return Eigen::JacobiSVD<Matrix>(j_.leftCols(n + 1), Eigen::ComputeFullV).matrixV().rightCols(2);
}

Vector BranchPointSystem::left_null_vector(In y) const {
  prepare(y);
  return w_.head(base_.size()).normalized();
}

// --------------------------------------------------------------------------------------------------------------- HopfSystem

HopfSystem::HopfSystem(const Problem& base, Indices state, Indices block, In u, double kappa)
    : AugmentedSystem(base, std::move(state), 1), block_(std::move(block)), kappa0_(kappa), full_(base.size() + base.parameters()) {
  const int m = static_cast<int>(block_.size());
  bordered_.resize(m + 2, m + 2);
  a_.resize(m, m);
  x_.resize(m + 2, 2);
  y_.resize(m + 2, 2);
  against_.resize(m);
  four_.resize(4, size() + parameters());
  for (int i = 0; i < u_.size(); ++i)
    if (column(i) >= 0) u_[i] = u[i];
  if (!(kappa0_ > 0.0)) {
    base_.jacobian(u_, j_);
    const Eigen::EigenSolver<Matrix> solver(block_of(j_, block_), false);
    double nearest = std::numeric_limits<double>::infinity();
    for (const auto& z : solver.eigenvalues())
      if (z.imag() > 0.0 && std::abs(z.real()) < nearest) {
        nearest = std::abs(z.real());
        kappa0_ = z.imag() * z.imag();
      }
  }
  const Vector start = unknowns(u);
  update_borders(start);
}

Vector HopfSystem::unknowns(In u) const {
  Vector y(size() + parameters());
  for (int i = 0; i < u_.size(); ++i)
    if (column(i) >= 0) y[column(i)] = u[i];
  y[static_cast<int>(state_.size()) + 1] = kappa0_;
  return y;
}

void HopfSystem::update_borders(In y) {
  spread(y);
  base_.jacobian(u_, j_);
  const int m = static_cast<int>(block_.size());
  if (m + 2 > DenseLu::small || !null_planes(kappa(y))) {
    const Matrix a = block_of(j_, block_), q = a * a + kappa(y) * Matrix::Identity(m, m);
    const Eigen::JacobiSVD<Matrix> svd(q, Eigen::ComputeFullU | Eigen::ComputeFullV);
    left_ = svd.matrixU().rightCols(2);
    right_ = svd.matrixV().rightCols(2);
  }
  solve_bordered(kappa(y));
  choose_entries();
}

// Planes that A^2 + kappa I, nearly of rank m - 2, almost annihilates from the left and from the right: three rounds of solving with the borders so
// far, which are as large as the matrix. j_ is at hand.
bool HopfSystem::null_planes(double kappa) {
  const int m = static_cast<int>(block_.size());
  const Matrix a = block_of(j_, block_);
  const double size = (a * a).norm() + std::abs(kappa);
  left_.resize(m, 2);
  right_.resize(m, 2);
  for (int i = 0; i < m; ++i)  // no symmetry of a model is likely to be orthogonal to these
    for (int s = 0; s < 2; ++s) {
      left_(i, s) = std::cos(1.7 * i + 1.9 * s) + 0.3 * s;
      right_(i, s) = std::sin(2.3 * i + 0.4 + 1.3 * s) + 0.2;
    }
  const auto orthonormal = [](Matrix& q) {
    q.col(0) /= q.col(0).norm();
    q.col(1) -= q.col(0).dot(q.col(1)) * q.col(0);
    q.col(1) /= q.col(1).norm();
    return q.allFinite();
  };
  for (int round = 0; round < 3; ++round) {
    if (!orthonormal(left_) || !orthonormal(right_)) return false;
    left_ *= size;
    right_ *= size;
    solve_bordered(kappa);
    right_ = x_.topRows(m);
    left_ = y_.topRows(m);
    if (!(right_.norm() * size < 1e8) || !(left_.norm() * size < 1e8)) return false;
  }
  return orthonormal(left_) && orthonormal(right_);
}

// Of the four entries of G, two whose gradients are the least parallel: the longest, and the longest of what is left across it.
void HopfSystem::choose_entries() {
  gradients(true, true);
  int first = 0;
  for (int i = 1; i < 4; ++i)
    if (four_.row(i).squaredNorm() > four_.row(first).squaredNorm()) first = i;
  const double size = four_.row(first).squaredNorm();
  int second = first == 0 ? 1 : 0;
  double longest = -1.0;
  for (int i = 0; i < 4; ++i) {
    if (i == first) continue;
    const double along = four_.row(i).dot(four_.row(first)), across = four_.row(i).squaredNorm() - along * along / size;
    const double weight = i / 2 == first / 2 ? 4.0 : 1.0;  // the other entry of the same column costs half
    if (weight * across > longest) {
      longest = weight * across;
      second = i;
    }
  }
  entry_[0] = first;
  entry_[1] = second;
}

void HopfSystem::solve_bordered(double kappa) const {
  const int m = static_cast<int>(block_.size());
  for (int c = 0; c < m; ++c)
    for (int r = 0; r < m; ++r) a_(r, c) = j_(block_[std::size_t(r)], block_[std::size_t(c)]);
  bordered_.setZero();
  bordered_.topLeftCorner(m, m).noalias() = a_.lazyProduct(a_);
  for (int i = 0; i < m; ++i) bordered_(i, i) += kappa;
  bordered_.topRightCorner(m, 2) = left_;
  bordered_.bottomLeftCorner(2, m) = right_.transpose();
  lu_.compute(bordered_);
  x_.setZero();
  x_(m, 0) = x_(m + 1, 1) = 1.0;
  y_ = x_;
  lu_.solve_two(x_.col(0), x_.col(1), x_.col(0), x_.col(1));
  for (int i = 0; i < 2; ++i) lu_.solve_transposed(y_.col(i), y_.col(i));
  g_ = x_.bottomRows(2);
}

void HopfSystem::fill_residual(In, Out r) const {
  const int s = static_cast<int>(state_.size());
  for (int i = 0; i < s; ++i) r[i] = r_[state_[std::size_t(i)]];
  for (int e = 0; e < 2; ++e) r[s + e] = g_(entry_[e] % 2, entry_[e] / 2);
}

void HopfSystem::fill_jacobian(In, MatrixOut j) const {
  gradients(entry_[0] < 2 || entry_[1] < 2, entry_[0] >= 2 || entry_[1] >= 2);
  j.setZero();
  gather_rows(j_, 1, j);
  const int s = static_cast<int>(state_.size());
  for (int e = 0; e < 2; ++e) j.row(s + e) = four_.row(entry_[e]);
}

// dG_ij = -Y_i' (dA A + A dA + dkappa) X_j
void HopfSystem::gradients(bool first, bool second) const {
  const int m = static_cast<int>(block_.size()), s = static_cast<int>(state_.size());
  four_.setZero();
  for (int jx = first ? 0 : 1; jx < (second ? 2 : 1); ++jx)
    for (int pass = 0; pass < 2; ++pass) {  // dA (A X_j) against Y_i, dA X_j against A'Y_i
      full_.setZero();
      for (int i = 0; i < m; ++i) full_[block_[std::size_t(i)]] = pass == 0 ? a_.row(i).dot(x_.col(jx).head(m)) : x_(i, jx);
      base_.second(u_, full_, h_);
      for (int i = 0; i < 2; ++i) {
        for (int k = 0; k < m; ++k) against_[k] = pass == 0 ? y_(k, i) : a_.col(k).dot(y_.col(i).head(m));
        for (int c = 0; c < h_.cols(); ++c)
          if (column(c) >= 0) {
            double dg = 0.0;
            for (int k = 0; k < m; ++k) dg -= against_[k] * h_(block_[std::size_t(k)], c);
            four_(i + 2 * jx, column(c)) += dg;
          }
      }
    }
  for (int jx = 0; jx < 2; ++jx)
    for (int i = 0; i < 2; ++i) four_(i + 2 * jx, s + 1) = -y_.col(i).head(m).dot(x_.col(jx).head(m));
}

// --------------------------------------------------------------------------------------------------------------- PeakSystem

QuadraticForm QuadraticForm::coordinate(int n, int i) { return {Matrix::Zero(n, n), Vector::Unit(n, i)}; }

QuadraticForm QuadraticForm::square_sum(int n, const Indices& of) {
  QuadraticForm form{Matrix::Zero(n, n), Vector::Zero(n)};
  for (const int i : of) form.Q(i, i) = 1.0;
  return form;
}

PeakSystem::PeakSystem(const Problem& base, Indices state, QuadraticForm form, In u)
    : AugmentedSystem(base, std::move(state), 0), form_(std::move(form)), full_(base.size() + base.parameters()) {
  const int s = static_cast<int>(state_.size());
  bordered_.resize(s + 1, s + 1);
  c_ = v_ = w_ = gradient_ = Vector::Zero(s + 1);
  update_borders(unknowns(u));
}

Vector PeakSystem::unknowns(In u) const {
  Vector y(size() + parameters());
  for (int i = 0; i < u_.size(); ++i)
    if (column(i) >= 0) y[column(i)] = u[i];
  return y;
}

// c = the curve's own tangent.
void PeakSystem::update_borders(In y) {
  spread(y);
  base_.jacobian(u_, j_);
  const int s = static_cast<int>(state_.size());
  Matrix wide(s, s + 1);
  for (int r = 0; r < s; ++r) {
    for (int c = 0; c < s; ++c) wide(r, c) = j_(state_[std::size_t(r)], state_[std::size_t(c)]);
    wide(r, s) = j_(state_[std::size_t(r)], base_.size());
  }
  const Vector tangent = Eigen::JacobiSVD<Matrix>(wide, Eigen::ComputeFullV).matrixV().col(s);
  c_ = tangent.dot(c_) < 0.0 ? Vector(-tangent) : tangent;
}

void PeakSystem::solve_bordered(In) const {
  const int s = static_cast<int>(state_.size());
  const Vector slope = form_.gradient(u_.head(base_.size()));
  gradient_.setZero();
  for (int r = 0; r < s; ++r) {
    gradient_[r] = slope[state_[std::size_t(r)]];
    for (int c = 0; c < s; ++c) bordered_(r, c) = j_(state_[std::size_t(r)], state_[std::size_t(c)]);
    bordered_(r, s) = j_(state_[std::size_t(r)], base_.size());
  }
  bordered_.row(s) = c_.transpose();
  lu_.compute(bordered_);
  v_ = Vector::Unit(s + 1, s);
  lu_.solve(v_, v_);
  lu_.solve_transposed(gradient_, w_);
}

void PeakSystem::fill_residual(In, Out r) const {
  const int s = static_cast<int>(state_.size());
  for (int i = 0; i < s; ++i) r[i] = r_[state_[std::size_t(i)]];
  r[s] = gradient_.dot(v_);
}

void PeakSystem::fill_jacobian(In, MatrixOut j) const {
  const int s = static_cast<int>(state_.size());
  j.setZero();
  gather_rows(j_, 0, j);
  embed(v_.head(s), state_, full_);
  const Vector bend = form_.Q * full_.head(base_.size());
  full_[base_.size()] = v_[s];
  base_.second(u_, full_, h_);
  for (int c = 0; c < h_.cols(); ++c)
    if (column(c) >= 0) {
      double dh = c < base_.size() ? bend[c] : 0.0;
      for (int i = 0; i < s; ++i) dh -= w_[i] * h_(state_[std::size_t(i)], c);
      j(s, column(c)) = dh;
    }
}

}  // namespace whirl::continuation
