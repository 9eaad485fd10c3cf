#include "continuation/torus.hpp"

#include <numbers>

namespace whirl::continuation {
namespace {

using Complex = std::complex<double>;

void embed(const Vector& v, const Indices& block, Vector& full) {
  full.setZero();
  for (std::size_t i = 0; i < block.size(); ++i) full[block[i]] = v[static_cast<int>(i)];
}

}  // namespace

TorusSystem::TorusSystem(const OrbitProblem& orbit, Indices state, Indices block, In u, double kappa)
    : AugmentedSystem(orbit, std::move(state), 1),
      orbit_(orbit),
      block_(std::move(block)),
      kappa0_(kappa),
      h_im_(orbit.size(), orbit.size() + orbit.parameters()),
      full_(orbit.size() + orbit.parameters()) {
  const int m = static_cast<int>(block_.size());
  bordered_.resize(m + 1, m + 1);
  // Any start not orthogonal to the null vectors: inverse iteration turns it.
  b_ = c_ = Eigen::VectorXcd::LinSpaced(m, Complex(1.0, 0.5), Complex(0.5, -1.0)).normalized();
  for (int i = 0; i < u_.size(); ++i)
    if (column(i) >= 0) u_[i] = u[i];
  update_borders(unknowns(u));
  update_borders(unknowns(u));
}

Vector TorusSystem::unknowns(In u) const {
  Vector y(size() + parameters());
  for (int i = 0; i < u_.size(); ++i)
    if (column(i) >= 0) y[column(i)] = u[i];
  y[static_cast<int>(state_.size()) + 1] = kappa0_;
  return y;
}

// The bordered solutions themselves, made unit length, are better borders: they tend to the null vectors.
void TorusSystem::update_borders(In y) {
  prepare(y);
  const auto m = static_cast<Eigen::Index>(block_.size());
  c_ = v_.head(m).normalized();
  b_ = w_.head(m).normalized();
}

void TorusSystem::solve_bordered(In y) const {
  orbit_.characteristic(u_, kappa(y), shift_, by_kappa_);
  const auto m = static_cast<Eigen::Index>(block_.size());
  for (Eigen::Index c = 0; c < m; ++c)  // L
    for (Eigen::Index r = 0; r < m; ++r) {
      const int row = block_[std::size_t(r)], col = block_[std::size_t(c)];
      bordered_(r, c) = j_(row, col) + shift_(row, col);
    }
  bordered_.col(m).head(m) = b_;
  bordered_.row(m).head(m) = c_.adjoint();
  bordered_(m, m) = 0.0;
  lu_.compute(bordered_);
  const Eigen::VectorXcd e = Eigen::VectorXcd::Unit(m + 1, m);
  v_ = lu_.solve(e);
  w_ = lu_.adjoint().solve(e);
}

void TorusSystem::fill_residual(In, Out r) const {
  const auto s = static_cast<int>(state_.size());
  for (int i = 0; i < s; ++i) r[i] = r_[state_[std::size_t(i)]];
  const Complex g = v_[static_cast<Eigen::Index>(block_.size())];
  r[s] = g.real();
  r[s + 1] = g.imag();
}

void TorusSystem::fill_jacobian(In y, MatrixOut j) const {
  const auto s = static_cast<int>(state_.size());
  const auto m = static_cast<Eigen::Index>(block_.size());
  const double k = kappa(y);
  j.setZero();
  gather_rows(j_, 1, j);
  embed(v_.head(m).real(), block_, full_);
  base_.second(u_, full_, h_);
  embed(v_.head(m).imag(), block_, full_);
  base_.second(u_, full_, h_im_);
  const auto against_w = [&](auto entry) {
    Complex sum = 0.0;
    for (Eigen::Index i = 0; i < m; ++i) sum -= std::conj(w_[i]) * entry(block_[std::size_t(i)]);
    return sum;
  };
  const auto times_v = [&](const Eigen::MatrixXcd& matrix, int row) {
    Complex sum = 0.0;
    for (Eigen::Index l = 0; l < m; ++l) sum += matrix(row, block_[std::size_t(l)]) * v_[l];
    return sum;
  };
  const auto put = [&](int col, Complex g) {
    j(s, col) = g.real();
    j(s + 1, col) = g.imag();
  };
  Eigen::MatrixXcd slope(orbit_.size(), orbit_.size());
  for (int c = 0; c < h_.cols(); ++c) {
    if (column(c) < 0) continue;
    Complex g = against_w([&](int row) { return Complex(h_(row, c), h_im_(row, c)); });
    if (orbit_.characteristic_slope(u_, k, c, slope)) g += against_w([&](int row) { return times_v(slope, row); });
    put(column(c), g);
  }
  put(s + 1, against_w([&](int row) { return times_v(by_kappa_, row); }));
}

Eigen::VectorXcd TorusSystem::null_vector(In y) const {
  prepare(y);
  Eigen::VectorXcd full = Eigen::VectorXcd::Zero(base_.size());
  for (std::size_t i = 0; i < block_.size(); ++i) full[block_[i]] = v_[static_cast<Eigen::Index>(i)];
  return full.normalized();
}

Indices unknowns_of_group(const OrbitProblem& orbit, In u, int group) {
  Indices found;
  for (int i = 0; i < orbit.size(); ++i)
    if (orbit.group_of_unknown(u, i) == group) found.push_back(i);
  return found;
}

double torus_frequency(const OrbitProblem& orbit, In u, int group) {
  Eigen::VectorXcd mu(orbit.multiplier_count());
  Eigen::VectorXi groups(orbit.multiplier_count());
  if (!orbit.multipliers(u, mu, groups)) return 0.0;
  double nearest = std::numeric_limits<double>::infinity(), angle = 0.0;
  for (Eigen::Index i = 0; i < mu.size(); ++i) {
    const double excess = std::abs(std::abs(mu[i]) - 1.0);
    if (groups[i] != group || !(mu[i].imag() > 0.0) || excess >= nearest) continue;
    nearest = excess;
    angle = std::arg(mu[i]);
  }
  return angle / (2.0 * std::numbers::pi) * orbit.base_frequency(u);
}

}  // namespace whirl::continuation
