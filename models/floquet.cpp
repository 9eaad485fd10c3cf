#include "models/floquet.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <numbers>

#include "core/cvode.hpp"

namespace whirl::models {
namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;

}  // namespace

void FloquetOptions::validate() const {
  if (!(tolerance > 0.0)) throw std::invalid_argument(fmt::format("Floquet tolerance must be > 0, got {}", tolerance));
  if (max_steps < 8) throw std::invalid_argument(fmt::format("Floquet max_steps must be >= 8, got {}", max_steps));
}

Floquet::Floquet(const ModalSystem<double>& shape, int harmonics, int nu, const FloquetOptions& options)
    : options_(options), n_(shape.size()), harmonics_(harmonics), nu_(nu), max_harmonic_(shape.max_harmonic) {
  options_.validate();
  if (n_ < 1 || harmonics < 0 || nu < 1) throw std::invalid_argument("Floquet needs at least one coordinate, harmonics >= 0 and nu >= 1");
  coarse_ = fine_ = Matrix::Zero(2 * n_, 2 * n_);
  list_pairs(shape);
}

// The pairs (i, j) that some term couples, and whether g goes through its harmonics.
void Floquet::list_pairs(const ModalSystem<double>& shape) {
  terms_ = shape.terms.size();
  place_.assign(static_cast<std::size_t>(n_ * n_), -1);
  int degree = 1;
  double passes = 0.0;  // over the samples, for one tabulation
  for (const auto& t : shape.terms) {
    degree = std::max(degree, t.degree);
    for (int a = 0; a < t.degree; ++a) {
      int& place = place_[static_cast<std::size_t>(t.equation * n_ + t.factor[static_cast<std::size_t>(a)])];
      if (place < 0) place = pairs_++;
      passes += multiplicity(t, a) > 0 ? t.degree + 1.0 : 0.0;
    }
  }
  const int top = (degree - 1) * harmonics_ + max_harmonic_ * nu_;  // harmonic of g
  // Measured: an element of a pass takes as long as two to three multiplications within a matrix product.
  if (passes < 0.4 * pairs_ * (2 * top + 1)) return;
  const int samples = 2 * top + 2;
  even_ = fill_grid([samples](int m) { return static_cast<double>(m) / samples; }, samples, harmonics_);
  analysis_ = fill_grid([samples](int m) { return static_cast<double>(m) / samples; }, samples, top).basis.transpose() * (2.0 / samples);
  analysis_.row(0) *= 0.5;
}

// cos and sin of harmonics 0..top of theta, and cos(h omega t), where theta = 2 pi fraction(m).
template <class Fraction>
Floquet::Grid Floquet::fill_grid(Fraction fraction, int samples, int top) const {
  Grid g{Matrix(samples, 2 * top + 1), Matrix(samples, max_harmonic_ + 1)};
  for (int m = 0; m < samples; ++m) {
    const double theta = two_pi * fraction(m);
    g.basis(m, 0) = 1.0;
    for (int k = 1; k <= top; ++k) {
      g.basis(m, 2 * k - 1) = std::cos(k * theta);
      g.basis(m, 2 * k) = std::sin(k * theta);
    }
    for (int h = 0; h <= max_harmonic_; ++h) g.cosine(m, h) = std::cos(h * nu_ * theta);
  }
  return g;
}

const Floquet::Grid& Floquet::grid(int steps) {
  const auto known = grids_.find(steps);
  if (known != grids_.end()) return known->second;
  const int top = analysis_.size() > 0 ? static_cast<int>(analysis_.rows() - 1) / 2 : harmonics_;
  return grids_[steps] = fill_grid([&](int m) { return (m / nodes + gauss_.c[static_cast<std::size_t>(m % nodes)]) / steps; }, steps * nodes, top);
}

// g_ij at the instants of the grid, one column for each pair that a term couples.
void Floquet::sample(const ModalSystem<double>& system, In x, const Grid& grid) {
  const auto samples = static_cast<int>(grid.basis.rows());
  q_.noalias() = grid.basis.leftCols(2 * harmonics_ + 1) * Eigen::Map<const Matrix>(x.data(), 2 * harmonics_ + 1, n_);
  g_.setZero(samples, pairs_);
  product_.resize(static_cast<std::size_t>(samples));
  for (const auto& t : system.terms) {
    for (int a = 0; a < t.degree; ++a) {
      const int count = multiplicity(t, a);
      if (count == 0) continue;
      term_product(t, a, q_.data(), grid.cosine.col(t.cos_harmonic).data(), samples, product_.data());
      const double scale = t.coefficient * count;
      double* g = g_.col(place_[static_cast<std::size_t>(t.equation * n_ + t.factor[static_cast<std::size_t>(a)])]).data();
      for (int m = 0; m < samples; ++m) g[m] += scale * product_[static_cast<std::size_t>(m)];
    }
  }
}

// Harmonics of g as sampled, as far as they are more than rounding. Pairs that are zero throughout are passed over.
void Floquet::analyse() {
  coupled_.clear();
  for (int p = 0; p < pairs_; ++p)
    if ((g_.col(p).array() != 0.0).any()) coupled_.push_back(p);
  const auto count = static_cast<Eigen::Index>(coupled_.size());
  compact_.resize(g_.rows(), count);
  for (Eigen::Index k = 0; k < count; ++k) compact_.col(k) = g_.col(coupled_[static_cast<std::size_t>(k)]);
  gamma_.noalias() = analysis_ * compact_;
  const double largest = count > 0 ? gamma_.lpNorm<Eigen::Infinity>() : 0.0;
  kept_ = static_cast<int>(gamma_.rows());
  while (kept_ > 1 && gamma_.middleRows(kept_ - 2, 2).lpNorm<Eigen::Infinity>() < 1e-17 * largest) kept_ -= 2;
}

// g at the nodes of so many steps.
void Floquet::tabulate(const ModalSystem<double>& system, In x, int steps) {
  const Grid& nodes_of_steps = grid(steps);
  if (analysis_.size() == 0) {
    sample(system, x, nodes_of_steps);
    return;
  }
  compact_.noalias() = nodes_of_steps.basis.leftCols(kept_) * gamma_.topRows(kept_);
  g_.setZero(steps * nodes, pairs_);
  for (std::size_t k = 0; k < coupled_.size(); ++k) g_.col(coupled_[k]) = compact_.col(static_cast<Eigen::Index>(k));
}

bool Floquet::couples(int i, int j) const {
  const int place = place_[static_cast<std::size_t>(i * n_ + j)];
  return place >= 0 && (g_.col(place).array() != 0.0).any();
}

Floquet::Blocks Floquet::find_blocks() const {
  std::vector<int> label(static_cast<std::size_t>(n_));
  for (int i = 0; i < n_; ++i) label[static_cast<std::size_t>(i)] = i;
  for (int i = 0; i < n_; ++i)
    for (int j = 0; j < n_; ++j) {
      const int from = label[static_cast<std::size_t>(i)], to = label[static_cast<std::size_t>(j)];
      if (from != to && couples(i, j))
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

void Floquet::check_blocks(const Blocks& blocks) const {
  std::vector<int> owner(static_cast<std::size_t>(n_), -1);
  for (std::size_t k = 0; k < blocks.size(); ++k)
    for (int i : blocks[k]) {
      if (i < 0 || i >= n_ || owner[static_cast<std::size_t>(i)] >= 0) throw std::invalid_argument("Floquet blocks must name each coordinate once");
      owner[static_cast<std::size_t>(i)] = static_cast<int>(k);
    }
  for (int i = 0; i < n_; ++i) {
    if (owner[static_cast<std::size_t>(i)] < 0) throw std::invalid_argument("Floquet blocks must name each coordinate once");
    for (int j = 0; j < n_; ++j) {
      if (owner[static_cast<std::size_t>(i)] != owner[static_cast<std::size_t>(j)] && couples(i, j))
        throw std::invalid_argument(fmt::format("the motion couples coordinates {} and {}: they cannot be separate Floquet blocks", i, j));
    }
  }
}

// Some two radians of the stiffest instant a first step: order 16 is past 1e-11 there when the steps have been refined once.
int Floquet::first_guess(const ModalSystem<double>& system, double period) const {
  double largest = 0.0;
  for (int i = 0; i < n_; ++i) {
    double row = std::abs(system.stiffness[static_cast<std::size_t>(i)]);
    for (int j = 0; j < n_; ++j) {
      const int place = place_[static_cast<std::size_t>(i * n_ + j)];
      if (place >= 0) row += g_.col(place).lpNorm<Eigen::Infinity>();
    }
    largest = std::max(largest, row);
  }
  return std::clamp(static_cast<int>(std::ceil(period * std::sqrt(largest) / 2.2)), 3, options_.max_steps / 2);
}

const FloquetResult& Floquet::compute(const ModalSystem<double>& system, In x, const Blocks& blocks) {
  if (system.size() != n_ || x.size() < n_ * (2 * harmonics_ + 1) || system.max_harmonic > max_harmonic_ || system.terms.size() != terms_)
    throw std::invalid_argument("this Floquet object was made for another system or number of harmonics");
  const double period = two_pi * nu_ / system.omega;
  if (analysis_.size() > 0) {
    sample(system, x, even_);
    analyse();
  } else {
    sample(system, x, grid(4));
  }
  result_.eliminated = 0;
  result_.blocks = blocks.empty() ? find_blocks() : blocks;
  if (!blocks.empty()) check_blocks(blocks);
  int steps = first_guess(system, period);
  tabulate(system, x, steps);
  integrate(system, period, steps, fine_);
  result_.converged = false;
  while (!result_.converged && 2 * steps <= options_.max_steps) {
    coarse_.swap(fine_);
    const int refined = steps + (steps + 1) / 2;
    tabulate(system, x, refined);
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
  // Sweeps of a step leave a hundredth of the tolerance: there are some hundred steps, and each adds to the largest entry less than that.
  for (const auto& block : result_.blocks) {
    steps_of_block_.integrate(system, block, {g_, place_}, h, steps, 0.01 * options_.tolerance, monodromy);
    result_.eliminated += steps_of_block_.eliminated();
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
