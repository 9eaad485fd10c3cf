#include "models/floquet_block.hpp"

#include <algorithm>
#include <cmath>

#include "core/legendre.hpp"

namespace whirl::models {
namespace {

constexpr int nodes = FloquetBlock::nodes;
constexpr int solved = nodes + 2;  // columns of a coordinate's own elimination
constexpr int most_sweeps = 24;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

}  // namespace

GaussNystrom::GaussNystrom() {
  constexpr int s = nodes;
  const GaussRule rule = gauss_legendre(s);
  const Matrix p = legendre_values(rule.nodes, s + 1);
  // A_ml = integral to c_m of the Lagrange polynomial of node l, by its Legendre series.
  Eigen::Matrix<double, s, s> a;
  for (int m = 0; m < s; ++m)
    for (int l = 0; l < s; ++l) {
      double sum = 0.5 * (1.0 + rule.nodes[m]);
      for (int j = 1; j < s; ++j) sum += p(l, j) * 0.5 * (p(m, j + 1) - p(m, j - 1));
      a(m, l) = 0.5 * rule.weights[l] * sum;
    }
  const Eigen::Matrix<double, s, s> a2 = a * a;
  for (int m = 0; m < s; ++m) {
    c[at(m)] = 0.5 * (1.0 + rule.nodes[m]);
    b[at(m)] = 0.5 * rule.weights[m];
    bbar[at(m)] = b[at(m)] * (1.0 - c[at(m)]);
    for (int l = 0; l < s; ++l) abar[at(m)][at(l)] = a2(m, l);
  }
}

void FloquetBlock::integrate(const ModalSystem<double>& system, const std::vector<int>& block, const Coupling& coupling, double h, int steps,
                             double tolerance, MatrixOut monodromy) {
  system_ = &system;
  block_ = &block;
  coupling_ = &coupling;
  h_ = h;
  steps_ = steps;
  tolerance_ = tolerance;
  n_ = system.size();
  m_ = static_cast<int>(block.size());
  eliminated_ = 0;
  if (m_ == 1) run<1>(monodromy);
  else if (m_ == 2) run<2>(monodromy);
  else run<0>(monodromy);
}

void FloquetBlock::make_room(int m) {
  const int columns = 2 * m, unknowns = nodes * m, mm = m * m;
  stiffness_.resize(at(nodes * mm));
  own_.resize(at(nodes * m));
  next_.resize(at(columns));
  factor_.resize(at(nodes * mm));
  state_.assign(at(2 * m * columns + m), 0.0);
  if (m <= 2) work_.resize(at(unknowns * (unknowns + columns)));
  z_.resize(at(unknowns * columns));
  nz_.resize(z_.size());
  diagonal_.resize(at(m * nodes * solved));
}

template <int fixed>
void FloquetBlock::run(MatrixOut monodromy) {
  const int m = fixed > 0 ? fixed : m_;
  const int columns = 2 * m, mm = m * m;
  const auto& block = *block_;
  make_room(m);
  double *const y = state_.data(), *const w = y + m * columns, *const decay = w + m * columns;
  for (int i = 0; i < m; ++i) {
    const double ci = system_->damping[at(block[at(i)])];
    decay[i] = std::exp(-0.5 * h_ * ci);
    y[i * columns + i] = w[i * columns + m + i] = 1.0;
    for (int l = 0; l < nodes; ++l)
      for (int j = 0; j < m; ++j) factor_[at(l * mm + i * m + j)] = std::exp(0.5 * h_ * gauss_.c[at(l)] * (ci - system_->damping[at(block[at(j)])]));
  }
  for (int step = 0; step < steps_; ++step) {
    stiffness_of_step<fixed>(step);
    if (fixed > 0 || !sweep_step()) eliminate_step<fixed>();
    advance<fixed>();
  }
  // From (y, w) to (q, q'): w = q' + c q/2.
  for (int i = 0; i < m; ++i)
    for (int j = 0; j < m; ++j) {
      const double ci = 0.5 * system_->damping[at(block[at(i)])], cj = 0.5 * system_->damping[at(block[at(j)])];
      const double yy = y[i * columns + j] + y[i * columns + m + j] * cj, yw = y[i * columns + m + j];
      const double wy = w[i * columns + j] + w[i * columns + m + j] * cj, ww = w[i * columns + m + j];
      const int r = block[at(i)], q = block[at(j)];
      monodromy(r, q) = yy;
      monodromy(r, n_ + q) = yw;
      monodromy(n_ + r, q) = wy - ci * yy;
      monodromy(n_ + r, n_ + q) = ww - ci * yw;
    }
}

template <int fixed>
void FloquetBlock::stiffness_of_step(int step) {
  const int m = fixed > 0 ? fixed : m_;
  const auto& block = *block_;
  for (int i = 0; i < m; ++i)
    for (int j = 0; j < m; ++j) {
      const int place = coupling_->place[at(block[at(i)] * n_ + block[at(j)])];
      const double* g = place < 0 ? nullptr : coupling_->g.col(place).data() + step * nodes;
      for (int l = 0; l < nodes; ++l) stiffness_[at((l * m + i) * m + j)] = g ? factor_[at((l * m + i) * m + j)] * g[l] : 0.0;
    }
  for (int i = 0; i < m; ++i) {
    const double c = system_->damping[at(block[at(i)])], k = system_->stiffness[at(block[at(i)])] - 0.25 * c * c;
    for (int l = 0; l < nodes; ++l) {
      own_[at(i * nodes + l)] = k + stiffness_[at((l * m + i) * m + i)];
      stiffness_[at((l * m + i) * m + i)] = 0.0;
    }
  }
}

// The matrix tends to the identity with h: eliminated without pivoting; a step too long for that shows in the refinement.
template <int fixed>
void FloquetBlock::eliminate_step() {
  const int m = fixed > 0 ? fixed : m_;
  const int columns = 2 * m, unknowns = nodes * m, width = unknowns + columns;
  if (fixed == 0) {
    ++eliminated_;
    work_.resize(at(unknowns * width));
  }
  double* const W = work_.data();
  const double *const K = stiffness_.data(), *const y = state_.data(), *const w = y + m * columns;
  for (int p = 0; p < nodes; ++p)
    for (int i = 0; i < m; ++i) {
      double* row = W + (p * m + i) * width;
      for (int l = 0; l < nodes; ++l) {
        const double a = h_ * h_ * gauss_.abar[at(p)][at(l)];
        for (int j = 0; j < m; ++j) row[l * m + j] = a * K[(l * m + i) * m + j];
        row[l * m + i] = a * own_[at(i * nodes + l)];
      }
      row[p * m + i] += 1.0;
      const double tau = h_ * gauss_.c[at(p)];
      for (int k = 0; k < columns; ++k) row[unknowns + k] = y[i * columns + k] + tau * w[i * columns + k];
    }
  // Pairs of columns: the width is even, and what an odd k spoils left of it is not looked at again.
  for (int k = 0; k < unknowns; ++k) {
    const double* pivot = W + k * width;
    const double inverse = 1.0 / pivot[k];
    for (int r = k + 1; r < unknowns; ++r) {
      double* row = W + r * width;
      const double f = row[k] * inverse;
      for (int q = k & ~1; q < width; q += 2) {
        row[q] -= f * pivot[q];
        row[q + 1] -= f * pivot[q + 1];
      }
    }
  }
  for (int k = unknowns - 1; k >= 0; --k) {
    double* row = W + k * width;
    for (int r = k + 1; r < unknowns; ++r)
      for (int q = unknowns; q < width; ++q) row[q] -= row[r] * W[r * width + q];
    const double inverse = 1.0 / row[k];
    for (int q = unknowns; q < width; ++q) row[q] *= inverse;
  }
  for (int l = 0; l < nodes; ++l)
    for (int i = 0; i < m; ++i) std::copy_n(W + (l * m + i) * width + unknowns, columns, z_.data() + (i * nodes + l) * columns);
  for (int i = 0; i < m; ++i)
    for (int l = 0; l < nodes; ++l) {
      double* out = nz_.data() + (i * nodes + l) * columns;
      std::fill_n(out, columns, 0.0);
      for (int j = 0; j < m; ++j) {
        const double k = K[(l * m + i) * m + j], *z = z_.data() + (j * nodes + l) * columns;
        for (int q = 0; q < columns; ++q) out[q] += k * z[q];
      }
    }
}

// (I + h^2 Abar D)^{-1} [h^2 Abar, 1, tau] of every coordinate. Without pivoting, as above.
void FloquetBlock::solve_diagonals() {
  for (int i = 0; i < m_; ++i) {
    double a[nodes][nodes + solved];
    for (int p = 0; p < nodes; ++p) {
      for (int l = 0; l < nodes; ++l) {
        const double A = h_ * h_ * gauss_.abar[at(p)][at(l)];
        a[p][l] = (p == l ? 1.0 : 0.0) + A * own_[at(i * nodes + l)];
        a[p][nodes + l] = A;
      }
      a[p][2 * nodes] = 1.0;
      a[p][2 * nodes + 1] = h_ * gauss_.c[at(p)];
    }
    for (int k = 0; k < nodes; ++k) {
      const double inverse = 1.0 / a[k][k];
      for (int q = k & ~1; q < nodes + solved; ++q) a[k][q] *= inverse;
      for (int r = 0; r < nodes; ++r) {
        if (r == k) continue;
        const double f = a[r][k];
        for (int q = k & ~1; q < nodes + solved; ++q) a[r][q] -= f * a[k][q];
      }
    }
    for (int p = 0; p < nodes; ++p) std::copy_n(a[p] + nodes, solved, diagonal_.data() + (i * nodes + p) * solved);
  }
}

// z and N z of the step; false if the sweeps do not contract.
bool FloquetBlock::sweep_step() {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  using Stride = Eigen::OuterStride<>;
  const int m = m_, columns = 2 * m;
  const double *const y = state_.data(), *const w = y + m * columns;
  solve_diagonals();
  Eigen::Map<Eigen::ArrayXd> z_all(z_.data(), nodes * m * columns);
  for (int i = 0; i < m; ++i)
    for (int p = 0; p < nodes; ++p) {
      const double* d = diagonal_.data() + (i * nodes + p) * solved;
      double* z = z_.data() + (i * nodes + p) * columns;
      for (int q = 0; q < columns; ++q) z[q] = d[nodes] * y[i * columns + q] + d[nodes + 1] * w[i * columns + q];
    }
  const double size = z_all.matrix().norm();
  double before = 0.0;
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    for (int l = 0; l < nodes; ++l) {
      const Eigen::Map<const RowMajor> N(stiffness_.data() + l * m * m, m, m);
      const Eigen::Map<const RowMajor, 0, Stride> z(z_.data() + l * columns, m, columns, Stride(nodes * columns));
      Eigen::Map<RowMajor, 0, Stride>(nz_.data() + l * columns, m, columns, Stride(nodes * columns)).noalias() = N * z;
    }
    double change = 0.0;
    for (int i = 0; i < m; ++i) {
      const double *const yi = y + i * columns, *const wi = w + i * columns, *const f = nz_.data() + i * nodes * columns;
      for (int p = 0; p < nodes; ++p) {
        const double* d = diagonal_.data() + (i * nodes + p) * solved;
        double *const z = z_.data() + (i * nodes + p) * columns, *const next = next_.data();
        for (int q = 0; q < columns; ++q)
          next[q] = d[nodes] * yi[q] + d[nodes + 1] * wi[q] - d[0] * f[q] - d[1] * f[columns + q] - d[2] * f[2 * columns + q] -
                    d[3] * f[3 * columns + q] - d[4] * f[4 * columns + q] - d[5] * f[5 * columns + q] - d[6] * f[6 * columns + q] -
                    d[7] * f[7 * columns + q];
        Eigen::Map<Eigen::ArrayXd> old(z, columns);
        const Eigen::Map<const Eigen::ArrayXd> fresh(next, columns);
        change += (fresh - old).matrix().squaredNorm();
        old = fresh;
      }
    }
    change = std::sqrt(change);
    const double rate = sweep == 0 ? 0.3 : change / before;
    if (change * rate <= tolerance_ * size) return true;
    if (!(rate < 0.7)) return false;
    before = change;
  }
  return false;
}

template <int fixed>
void FloquetBlock::advance() {
  const int m = fixed > 0 ? fixed : m_;
  const int columns = 2 * m;
  double *const y = state_.data(), *const w = y + m * columns, *const decay = w + m * columns;
  for (int i = 0; i < m; ++i) {
    for (int k = 0; k < columns; ++k) {
      double dy = w[i * columns + k], dw = 0.0;
      for (int l = 0; l < nodes; ++l) {
        const int place = (i * nodes + l) * columns + k;
        const double Kz = own_[at(i * nodes + l)] * z_[at(place)] + nz_[at(place)];
        dy -= h_ * gauss_.bbar[at(l)] * Kz;
        dw -= gauss_.b[at(l)] * Kz;
      }
      y[i * columns + k] = decay[i] * (y[i * columns + k] + h_ * dy);
      w[i * columns + k] = decay[i] * (w[i * columns + k] + h_ * dw);
    }
  }
}

}  // namespace whirl::models
