#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <complex>
#include <numbers>

#include "models/dynamics/periodic/cyclic_eigenvalues.hpp"
#include "models/dynamics/periodic/limit_cycle_state.hpp"

namespace whirl::models {

bool LimitCycle::do_multipliers(In u, Eigen::VectorXcd& mu, Eigen::VectorXi& group) const {
  const int n = flow_.size(), m = segments_;
  group.setZero();
  if (!(sweep_->ok && sweep_->at == u) && !evaluate(u, 1, u, nullptr, nullptr)) return false;
  // Planes normal to f at the points: M maps f to itself, and the rest is what remains of it there.
  std::vector<Matrix> plane(static_cast<std::size_t>(m)), map(static_cast<std::size_t>(m));
  Vector at(n + flow_.parameters()), f(n);
  at.tail(flow_.parameters()) = u.tail(flow_.parameters());
  for (int i = 0; i < m; ++i) {
    at.head(n) = sweep_->x.col(i);
    flow_.residual(at, f);
    if (!(f.norm() > 0.0)) return false;
    const Eigen::HouseholderQR<Matrix> qr(f);
    plane[static_cast<std::size_t>(i)] = (qr.householderQ() * Matrix::Identity(n, n)).rightCols(n - 1);
  }
  for (int i = 0; i < m; ++i)
    map[static_cast<std::size_t>(i)] = plane[static_cast<std::size_t>((i + 1) % m)].transpose() *
                                       sweep_->phi[static_cast<std::size_t>(i)].leftCols(n) * plane[static_cast<std::size_t>(i)];
  mu = cyclic_eigenvalues(map);
  return mu.allFinite();
}

void LimitCycle::shift_to_next(MatrixOut s) const {
  const int n = flow_.size(), m = segments_;
  s.setZero();
  for (int i = 0; i < m; ++i) s.block(scalars + i * n, scalars + ((i + 1) % m) * n, n, n).diagonal().setOnes();
  rows_and_columns(s);
}

// L(lambda) = blkdiag(phi_x) - e^{lambda T/m} S = r_x + (1 - e^{lambda T/m}) S, to first order r_x - lambda T/m S.
void LimitCycle::do_velocity(In u, int slope, MatrixOut c) const {
  c.setZero();
  if (slope >= 0) return;
  shift_to_next(c);
  c *= -period(u) / segments_;
}

void LimitCycle::do_characteristic(In u, double kappa, Eigen::MatrixXcd& shift, Eigen::MatrixXcd& by_kappa) const {
  Matrix s(size(), size());
  shift_to_next(s);
  const double part = period(u) / segments_;
  const std::complex<double> turn = std::polar(1.0, kappa * part);
  shift = (1.0 - turn) * s;
  by_kappa = (std::complex<double>(0.0, -part) * turn) * s;
}

bool LimitCycle::do_characteristic_slope(In u, double kappa, int i, Eigen::MatrixXcd& slope) const {
  if (i != log_period) return false;
  Matrix s(size(), size());
  shift_to_next(s);
  const double angle = kappa * period(u) / segments_;
  slope = (std::complex<double>(0.0, -angle) * std::polar(1.0, angle)) * s;
  return true;
}

double LimitCycle::do_base_frequency(In u) const { return 2.0 * std::numbers::pi / period(u); }

const OrbitProblem& LimitCycle::do_doubled() const {
  if (!doubled_) doubled_.reset(new LimitCycle(*this));
  return *doubled_;
}

Vector LimitCycle::do_in_doubled(In u) const {
  (void)do_doubled();
  Matrix x, twice(flow_.size(), 2 * segments_);
  to_points(u, x);
  twice << x, x;
  Vector u2(doubled_->size() + parameters());
  u2[first_harmonic] = u[first_harmonic];
  doubled_->from_points(twice, u2);
  u2[log_period] = u[log_period];
  u2.tail(parameters()) = u.tail(parameters());
  if (evaluate(u, 0, u, nullptr, nullptr)) {  // its mesh twice over
    auto mesh = std::make_unique<Mesh>();
    const Mesh& own = *mesh_;
    for (int turn = 0; turn < 2; ++turn) {
      for (int i = 0; i < segments_; ++i) mesh->first.push_back(own.first[static_cast<std::size_t>(i)] + turn * own.intervals());
      for (int i = 0; i < own.intervals(); ++i) mesh->s.push_back(0.5 * (turn + own.s[static_cast<std::size_t>(i)]));
      mesh->step.insert(mesh->step.end(), own.step.begin(), own.step.end());
      mesh->from.insert(mesh->from.end(), own.from.begin(), own.from.end());
    }
    mesh->first.push_back(2 * own.intervals());
    mesh->s.push_back(1.0);
    mesh->size = own.size;
    mesh->reference = u2;
    doubled_->mesh_ = std::move(mesh);
    doubled_->sweep_->ok = false;
  }
  return u2;
}

Vector LimitCycle::do_from_doubled(In u) const {
  Matrix x;
  doubled_->to_points(u, x);
  Vector single(size() + parameters());
  single[first_harmonic] = u[first_harmonic];
  from_points(0.5 * (x.leftCols(segments_) + x.rightCols(segments_)), single);
  single[log_period] = u[log_period];
  single.tail(parameters()) = u.tail(parameters());
  return single;
}

}  // namespace whirl::models
