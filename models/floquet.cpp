#include "models/floquet.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <numbers>

#include "core/cvode.hpp"

namespace whirl::models {
namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;

// P_0(y) .. P_count-1(y)
template <std::size_t count>
std::array<double, count> legendre(double y) {
  std::array<double, count> p{};
  p[0] = 1.0;
  p[1] = y;
  for (std::size_t j = 2; j < count; ++j) {
    const double k = static_cast<double>(j);
    p[j] = ((2.0 * k - 1.0) * y * p[j - 1] - (k - 1.0) * p[j - 2]) / k;
  }
  return p;
}

}  // namespace

void FloquetOptions::validate() const {
  if (!(tolerance > 0.0)) throw std::invalid_argument(fmt::format("Floquet tolerance must be > 0, got {}", tolerance));
  if (max_steps < 8) throw std::invalid_argument(fmt::format("Floquet max_steps must be >= 8, got {}", max_steps));
}

Floquet::Floquet(const ModalSystem<double>& shape, int harmonics, int nu, const FloquetOptions& options)
    : options_(options), n_(shape.size()), harmonics_(harmonics), nu_(nu), max_harmonic_(shape.max_harmonic) {
  options_.validate();
  if (n_ < 1 || harmonics < 0 || nu < 1) throw std::invalid_argument("Floquet needs at least one coordinate, harmonics >= 0 and nu >= 1");
  constexpr std::size_t s = nodes;
  std::array<std::array<double, s + 1>, s> p;  // Legendre polynomials at the nodes
  for (std::size_t m = 0; m < s; ++m) {
    double y = -std::cos(std::numbers::pi * (static_cast<double>(m) + 0.75) / (s + 0.5));  // Newton on P_s
    for (int i = 0; i < 20; ++i) {
      const auto v = legendre<s + 1>(y);
      y -= v[s] * (y * y - 1.0) / (static_cast<double>(s) * (y * v[s] - v[s - 1]));
    }
    p[m] = legendre<s + 1>(y);
    const double slope = static_cast<double>(s) * (y * p[m][s] - p[m][s - 1]) / (y * y - 1.0);
    c_[m] = 0.5 * (1.0 + y);
    b_[m] = 1.0 / ((1.0 - y * y) * slope * slope);
  }
  // A_ml = integral to c_m of the Lagrange polynomial of node l, by its Legendre series.
  Eigen::Matrix<double, nodes, nodes> a;
  for (std::size_t m = 0; m < s; ++m)
    for (std::size_t l = 0; l < s; ++l) {
      double sum = c_[m];
      for (std::size_t j = 1; j < s; ++j) sum += p[l][j] * 0.5 * (p[m][j + 1] - p[m][j - 1]);
      a(static_cast<int>(m), static_cast<int>(l)) = b_[l] * sum;
    }
  const Eigen::Matrix<double, nodes, nodes> a2 = a * a;
  for (std::size_t m = 0; m < s; ++m) {
    bbar_[m] = b_[m] * (1.0 - c_[m]);
    for (std::size_t l = 0; l < s; ++l) abar_[m][l] = a2(static_cast<int>(m), static_cast<int>(l));
  }
  coarse_ = fine_ = Matrix::Zero(2 * n_, 2 * n_);
}

const Floquet::Grid& Floquet::grid(int steps) {
  const auto known = grids_.find(steps);
  if (known != grids_.end()) return known->second;
  Grid& g = grids_[steps];
  const int samples = steps * nodes;
  g.basis.resize(samples, 2 * harmonics_ + 1);
  g.cosine.resize(samples, max_harmonic_ + 1);
  for (int m = 0; m < samples; ++m) {
    const double theta = two_pi * (m / nodes + c_[static_cast<std::size_t>(m % nodes)]) / steps;
    g.basis(m, 0) = 1.0;
    for (int k = 1; k <= harmonics_; ++k) {
      g.basis(m, 2 * k - 1) = std::cos(k * theta);
      g.basis(m, 2 * k) = std::sin(k * theta);
    }
    for (int h = 0; h <= max_harmonic_; ++h) g.cosine(m, h) = std::cos(h * nu_ * theta);
  }
  return g;
}

// g_ij at the nodes, sample m of pair (i, j) at g_[(i n + j) samples + m].
void Floquet::tabulate(const ModalSystem<double>& system, In x, const Grid& grid, int samples) {
  const Eigen::Map<const Matrix> coefficients(x.data(), 2 * harmonics_ + 1, n_);
  q_.resize(samples, n_);
  q_.noalias() = grid.basis * coefficients;
  const auto size = static_cast<std::size_t>(samples);
  g_.assign(size * static_cast<std::size_t>(n_ * n_), 0.0);
  product_.resize(size);
  for (const auto& t : system.terms) {
    for (int a = 0; a < t.degree; ++a) {
      const int count = multiplicity(t, a);
      if (count == 0) continue;
      term_product(t, a, q_.data(), grid.cosine.col(t.cos_harmonic).data(), samples, product_.data());
      const double scale = t.coefficient * count;
      double* g = g_.data() + std::ptrdiff_t(samples) * (t.equation * n_ + t.factor[static_cast<std::size_t>(a)]);
      for (int m = 0; m < samples; ++m) g[m] += scale * product_[static_cast<std::size_t>(m)];
    }
  }
}

Floquet::Blocks Floquet::find_blocks(int samples) const {
  std::vector<int> label(static_cast<std::size_t>(n_));
  for (int i = 0; i < n_; ++i) label[static_cast<std::size_t>(i)] = i;
  for (int i = 0; i < n_; ++i)
    for (int j = 0; j < n_; ++j) {
      const int from = label[static_cast<std::size_t>(i)], to = label[static_cast<std::size_t>(j)];
      const double* g = g_.data() + std::ptrdiff_t(samples) * (i * n_ + j);
      if (from != to && std::any_of(g, g + samples, [](double v) { return v != 0.0; }))
        for (auto& l : label)
          if (l == std::max(from, to)) l = std::min(from, to);
    }
  Blocks blocks;
  for (int first = 0; first < n_; ++first) {
    std::vector<int> block;
    for (int i = 0; i < n_; ++i)
      if (label[static_cast<std::size_t>(i)] == first) block.push_back(i);
    if (!block.empty()) blocks.push_back(block);
  }
  return blocks;
}

void Floquet::check_blocks(const Blocks& blocks, int samples) const {
  std::vector<int> owner(static_cast<std::size_t>(n_), -1);
  for (std::size_t k = 0; k < blocks.size(); ++k)
    for (int i : blocks[k]) {
      if (i < 0 || i >= n_ || owner[static_cast<std::size_t>(i)] >= 0) throw std::invalid_argument("Floquet blocks must name each coordinate once");
      owner[static_cast<std::size_t>(i)] = static_cast<int>(k);
    }
  for (int i = 0; i < n_; ++i) {
    if (owner[static_cast<std::size_t>(i)] < 0) throw std::invalid_argument("Floquet blocks must name each coordinate once");
    for (int j = 0; j < n_; ++j) {
      const double* g = g_.data() + std::ptrdiff_t(samples) * (i * n_ + j);
      if (owner[static_cast<std::size_t>(i)] != owner[static_cast<std::size_t>(j)] && std::any_of(g, g + samples, [](double v) { return v != 0.0; }))
        throw std::invalid_argument(fmt::format("the motion couples coordinates {} and {}: they cannot be separate Floquet blocks", i, j));
    }
  }
}

// Some two radians of the stiffest instant a first step: order 16 is past 1e-11 there when the steps have been refined once.
int Floquet::first_guess(const ModalSystem<double>& system, double period, int samples) const {
  double largest = 0.0;
  for (int i = 0; i < n_; ++i) {
    double row = std::abs(system.stiffness[static_cast<std::size_t>(i)]);
    for (int j = 0; j < n_; ++j) {
      const double* g = g_.data() + std::ptrdiff_t(samples) * (i * n_ + j);
      row += std::abs(*std::max_element(g, g + samples, [](double a, double b) { return std::abs(a) < std::abs(b); }));
    }
    largest = std::max(largest, row);
  }
  return std::clamp(static_cast<int>(std::ceil(period * std::sqrt(largest) / 2.2)), 3, options_.max_steps / 2);
}

const FloquetResult& Floquet::compute(const ModalSystem<double>& system, In x, const Blocks& blocks) {
  if (system.size() != n_ || x.size() < n_ * (2 * harmonics_ + 1) || system.max_harmonic > max_harmonic_)
    throw std::invalid_argument("this Floquet object was made for another system or number of harmonics");
  const double period = two_pi * nu_ / system.omega;
  int steps = 4;
  tabulate(system, x, grid(steps), steps * nodes);
  result_.blocks = blocks.empty() ? find_blocks(steps * nodes) : blocks;
  if (!blocks.empty()) check_blocks(blocks, steps * nodes);
  steps = first_guess(system, period, steps * nodes);
  tabulate(system, x, grid(steps), steps * nodes);
  integrate(system, period, steps, fine_);
  result_.converged = false;
  while (!result_.converged && 2 * steps <= options_.max_steps) {
    coarse_.swap(fine_);
    const int refined = steps + (steps + 1) / 2;
    tabulate(system, x, grid(refined), refined * nodes);
    integrate(system, period, refined, fine_);
    // The difference shrinks with the 16th power of the step; the 8th is claimed.
    const double claimed = std::pow(static_cast<double>(refined) / steps, nodes);
    result_.error = (fine_ - coarse_).lpNorm<Eigen::Infinity>() / (claimed * fine_.lpNorm<Eigen::Infinity>());
    result_.converged = result_.error < options_.tolerance;
    steps = refined;
  }
  result_.steps = steps;
  collect(system, period);
  return result_;
}

void Floquet::integrate(const ModalSystem<double>& system, double period, int steps, MatrixOut monodromy) {
  monodromy.setZero();
  const double h = period / steps;
  for (const auto& block : result_.blocks) {
    if (block.size() == 1) integrate_block<1>(system, block, h, steps, monodromy);
    else if (block.size() == 2) integrate_block<2>(system, block, h, steps, monodromy);
    else integrate_block<0>(system, block, h, steps, monodromy);
  }
}

// One step, unknowns z_p at the nodes tau_p = c_p h, all columns of the monodromy matrix at once:
//
//     z_p + h^2 sum_l Abar_pl K_l z_l = y + tau_p w,     K_l = diag(k - c^2/4) + g(tau_l) e^{(c_i - c_j) tau_l/2},   w = y' + c y/2
//     y <- e^{-c h/2} (y + h w - h^2 sum_l bbar_l K_l z_l),   w <- e^{-c h/2} (w - h sum_l b_l K_l z_l)
//
// The matrix tends to the identity with h: eliminated without pivoting; a step too long for that shows in the doubling.
template <int fixed>
void Floquet::integrate_block(const ModalSystem<double>& system, const std::vector<int>& block, double h, int steps, MatrixOut monodromy) {
  const int m = fixed > 0 ? fixed : static_cast<int>(block.size());
  const int columns = 2 * m, unknowns = nodes * m, width = unknowns + columns, mm = m * m, samples = steps * nodes;
  const auto at = [](int i) { return static_cast<std::size_t>(i); };
  work_.resize(at(unknowns * width));
  stiffness_.resize(at(2 * nodes * mm));
  state_.assign(at(2 * m * columns + m), 0.0);
  double* const W = work_.data();
  double* const K = stiffness_.data();                    // of this step
  double* const factor = stiffness_.data() + nodes * mm;  // e^{(c_i - c_j) tau_l/2}
  double* const y = state_.data();                        // m x columns, row after row; w behind it
  double* const w = y + m * columns;
  double* const decay = w + m * columns;  // e^{-c h/2}
  for (int i = 0; i < m; ++i) decay[i] = std::exp(-0.5 * h * system.damping[at(block[at(i)])]);
  for (int i = 0; i < m; ++i) y[i * columns + i] = w[i * columns + m + i] = 1.0;
  for (int l = 0; l < nodes; ++l)
    for (int i = 0; i < m; ++i)
      for (int j = 0; j < m; ++j)
        factor[l * mm + i * m + j] = std::exp(0.5 * h * c_[at(l)] * (system.damping[at(block[at(i)])] - system.damping[at(block[at(j)])]));
  for (int step = 0; step < steps; ++step) {
    for (int l = 0; l < nodes; ++l)
      for (int i = 0; i < m; ++i) {
        for (int j = 0; j < m; ++j)
          K[l * mm + i * m + j] = factor[l * mm + i * m + j] * g_[at(samples) * at(block[at(i)] * n_ + block[at(j)]) + at(step * nodes + l)];
        const double c = system.damping[at(block[at(i)])];
        K[l * mm + i * m + i] += system.stiffness[at(block[at(i)])] - 0.25 * c * c;
      }
    for (int p = 0; p < nodes; ++p)
      for (int i = 0; i < m; ++i) {
        double* row = W + (p * m + i) * width;
        for (int l = 0; l < nodes; ++l) {
          const double a = h * h * abar_[at(p)][at(l)];
          for (int j = 0; j < m; ++j) row[l * m + j] = a * K[l * mm + i * m + j];
        }
        row[p * m + i] += 1.0;
        const double tau = h * c_[at(p)];
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
    for (int i = 0; i < m; ++i)
      for (int k = 0; k < columns; ++k) {
        double dy = w[i * columns + k], dw = 0.0;
        for (int l = 0; l < nodes; ++l) {
          double Kz = 0.0;
          for (int j = 0; j < m; ++j) Kz += K[l * mm + i * m + j] * W[(l * m + j) * width + unknowns + k];
          dy -= h * bbar_[at(l)] * Kz;
          dw -= b_[at(l)] * Kz;
        }
        y[i * columns + k] += h * dy;
        w[i * columns + k] += h * dw;
      }
    for (int i = 0; i < m; ++i)
      for (int k = 0; k < columns; ++k) {
        y[i * columns + k] *= decay[i];
        w[i * columns + k] *= decay[i];
      }
  }
  // From (y, w) to (q, q'): w = q' + c q/2.
  for (int i = 0; i < m; ++i)
    for (int j = 0; j < m; ++j) {
      const double ci = 0.5 * system.damping[at(block[at(i)])], cj = 0.5 * system.damping[at(block[at(j)])];
      const double yy = y[i * columns + j] + y[i * columns + m + j] * cj, yw = y[i * columns + m + j];
      const double wy = w[i * columns + j] + w[i * columns + m + j] * cj, ww = w[i * columns + m + j];
      const int r = block[at(i)], q = block[at(j)];
      monodromy(r, q) = yy;
      monodromy(r, n_ + q) = yw;
      monodromy(n_ + r, q) = wy - ci * yy;
      monodromy(n_ + r, n_ + q) = ww - ci * yw;
    }
}

void Floquet::collect(const ModalSystem<double>& system, double period) {
  result_.monodromy = fine_;
  result_.multipliers.resize(2 * n_);
  int first = 0;
  for (const auto& block : result_.blocks) {
    const int m = static_cast<int>(block.size());
    auto part = result_.multipliers.segment(first, 2 * m);
    if (m == 1) {
      const int i = block[0];
      const double half = 0.5 * (fine_(i, i) + fine_(n_ + i, n_ + i)), det = std::exp(-system.damping[static_cast<std::size_t>(i)] * period);
      const double discriminant = half * half - det;
      if (discriminant < 0.0) {
        part[0] = {half, std::sqrt(-discriminant)};
        part[1] = std::conj(part[0]);
      } else {
        part[0] = half + std::copysign(std::sqrt(discriminant), half);
        part[1] = det / part[0];
      }
    } else {
      Matrix a(2 * m, 2 * m);
      for (int i = 0; i < m; ++i)
        for (int j = 0; j < m; ++j) {
          const int r = block[static_cast<std::size_t>(i)], q = block[static_cast<std::size_t>(j)];
          a(i, j) = fine_(r, q);
          a(i, m + j) = fine_(r, n_ + q);
          a(m + i, j) = fine_(n_ + r, q);
          a(m + i, m + j) = fine_(n_ + r, n_ + q);
        }
      part = Eigen::EigenSolver<Matrix>(a, false).eigenvalues();
      std::sort(part.begin(), part.end(), [](const auto& p, const auto& q) {
        const double d = std::abs(p) - std::abs(q);
        return d != 0.0 ? d > 0.0 : p.imag() > q.imag();
      });
    }
    first += 2 * m;
  }
}

IntegratedPeriod monodromy_by_integration(const ModalSystem<double>& system, const Vector& start, int nu, double tolerance) {
  using D = Dual<double, 1>;
  const int size = 2 * system.size();
  if (start.size() != size) throw std::invalid_argument(fmt::format("a start needs {} values (q, q'), got {}", size, start.size()));
  const auto n = static_cast<std::size_t>(size);
  std::vector<D> y(n), d(n);
  const auto flow = [&](double t, std::span<const double> z, std::span<double> out) {
    for (std::size_t i = 0; i < n; ++i) {
      y[i] = D(z[i]);
      y[i].d[0] = z[n + i];
    }
    system.flow<D>(system.omega * t, y, d);
    for (std::size_t i = 0; i < n; ++i) {
      out[i] = d[i].v;
      out[n + i] = d[i].d[0];
    }
  };
  IntegratedPeriod result{start, Matrix::Zero(size, size), true};
  for (int column = 0; column < size && result.ok; ++column) {
    Vector z(2 * size);
    z << start, Vector::Unit(size, column);
    Integrator run(flow, 0.0, z, {.relative_tolerance = tolerance, .absolute_tolerance = 0.1 * tolerance});
    result.ok = run.advance(two_pi * nu / system.omega);
    result.end = run.state().head(size);
    result.monodromy.col(column) = run.state().tail(size);
  }
  return result;
}

IntegratedOrbit periodic_by_integration(const ModalSystem<double>& system, Vector start, int nu, double tolerance) {
  IntegratedOrbit orbit;
  orbit.state = std::move(start);
  for (int i = 0; i < 12 && !orbit.ok; ++i) {
    const IntegratedPeriod period = monodromy_by_integration(system, orbit.state, nu);
    if (!period.ok) return orbit;
    const Vector defect = period.end - orbit.state;
    orbit.monodromy = period.monodromy;
    orbit.defect = defect.norm();
    orbit.ok = orbit.defect < tolerance * (1.0 + orbit.state.norm());
    const Matrix a = period.monodromy - Matrix::Identity(defect.size(), defect.size());
    orbit.state -= a.partialPivLu().solve(defect);
    if (!orbit.state.allFinite()) return orbit;
  }
  return orbit;
}

}  // namespace whirl::models
