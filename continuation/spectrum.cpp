#include "continuation/spectrum.hpp"

#include <cmath>

namespace whirl::continuation {
namespace {

// Roots of z^2 - trace z + det, the smaller real root without cancellation.
void two_by_two(const Matrix& a, std::complex<double>& z0, std::complex<double>& z1) {
  const double half_trace = 0.5 * (a(0, 0) + a(1, 1)), half_gap = 0.5 * (a(0, 0) - a(1, 1));
  const double discriminant = half_gap * half_gap + a(0, 1) * a(1, 0);
  if (discriminant < 0.0) {
    z0 = {half_trace, std::sqrt(-discriminant)};
    z1 = std::conj(z0);
    return;
  }
  const double det = a(0, 0) * a(1, 1) - a(0, 1) * a(1, 0);
  const double large = half_trace + std::copysign(std::sqrt(discriminant), half_trace);
  z0 = large;
  z1 = large == 0.0 ? 0.0 : det / large;
}

// Scales rows and columns by powers of two until they are of like size (Parlett and Reinsch): eigenvalues far smaller than the matrix keep their
// digits where rows and columns differ by decades.
void balance(Matrix& a) {
  for (bool scaled = true; scaled;) {
    scaled = false;
    for (Eigen::Index i = 0; i < a.rows(); ++i) {
      double row = 0.0, column = 0.0, f = 1.0;
      for (Eigen::Index k = 0; k < a.rows(); ++k) {
        if (k == i) continue;
        row += std::abs(a(i, k));
        column += std::abs(a(k, i));
      }
      if (!(column > 0.0 && row > 0.0) || !std::isfinite(column + row)) continue;
      const double sum = column + row;
      for (; column < 0.5 * row; column *= 4.0) f *= 2.0;
      for (; column > 2.0 * row; column *= 0.25) f *= 0.5;
      if (!(column + row < 0.95 * sum * f)) continue;
      a.col(i) *= f;
      a.row(i) /= f;
      scaled = true;
    }
  }
}

}  // namespace

Spectrum::Spectrum(const Blocks& blocks) : blocks_(&blocks), rates_(blocks.indices.size()) {
  int n = 0;
  for (const auto& indices : blocks.indices) {
    const int m = static_cast<int>(indices.size());
    n += m;
    block_.emplace_back(m, m);
    factors_.emplace_back();
    solver_.push_back(m > 2 ? std::make_unique<Eigen::EigenSolver<Matrix>>(m) : nullptr);
  }
  eigenvalues_ = Eigen::VectorXcd::Zero(n);
}

bool Spectrum::compute(MatrixIn jacobian) {
  int first = 0;
  for (std::size_t k = 0; k < block_.size(); ++k) {
    const auto& indices = blocks_->indices[k];
    const int m = static_cast<int>(indices.size());
    Matrix& a = block_[k];
    double* to = a.data();
    double largest = 0.0;
    if (block_.size() == 1) {  // no symmetry: everything, in order
      const double* from = jacobian.data();
      const auto skip = jacobian.outerStride() - m;
      for (int j = 0; j < m; ++j, from += skip)
        for (int i = 0; i < m; ++i) *to++ = *from++;
    } else {
      for (const int j : indices)
        for (const int i : indices) *to++ = jacobian(i, j);
    }
    if (m == 1) eigenvalues_[first] = a(0, 0);
    if (m == 2) two_by_two(a, eigenvalues_[first], eigenvalues_[first + 1]);
    const bool few = m == 3 || m == 4;
    if (m > 2 && !(few && factors_[k].eigenvalues(a, eigenvalues_.data() + first))) {
      balance(a);
      solver_[k]->compute(a, false);
      if (solver_[k]->info() != Eigen::Success) return false;
      eigenvalues_.segment(first, m) = solver_[k]->eigenvalues();
      if (few) factors_[k].restart(eigenvalues_.data() + first, m);
    }
    for (int i = 0; i < m * m; ++i) largest = std::max(largest, std::abs(a.data()[i]));
    rates_[k].clear(m * largest);
    for (int i = first; i < first + m; ++i) {
      const std::complex<double> z = eigenvalues_[i];
      if (!std::isfinite(z.real() + z.imag())) return false;
      rates_[k].add(z.real());
    }
    if (m > 1) rates_[k].set_pair(nearest_pair(first, m));
    first += m;
  }
  return true;
}

// Of |z|^2 of complex pairs and of products of neighbours on the real axis the one nearest to zero. The real ones next to zero are enough.
double Spectrum::nearest_pair(int first, int count) const {
  constexpr double none = std::numeric_limits<double>::infinity();
  double nearest = none, below[2] = {-none, -none}, above[2] = {none, none};
  for (int i = first; i < first + count; ++i) {
    const double x = eigenvalues_[i].real(), y = eigenvalues_[i].imag();
    if (y > 0.0) nearest = std::min(nearest, x * x + y * y);
    if (y != 0.0) continue;
    if (x <= 0.0 && x > below[1]) below[1] = std::min(x, below[0]), below[0] = std::max(x, below[0]);
    if (x > 0.0 && x < above[1]) above[1] = std::max(x, above[0]), above[0] = std::min(x, above[0]);
  }
  for (const double product : {below[0] * below[1], above[0] * above[1], below[0] * above[0]})
    if (std::abs(product) < std::abs(nearest)) nearest = product;
  return nearest;
}

int Spectrum::unstable() const {
  int sum = 0;
  for (const auto& r : rates_) sum += r.positive();
  return sum;
}

int Spectrum::clearly_unstable() const {
  int count = 0;
  for (const auto& z : eigenvalues_) count += z.real() > 1e-9 * std::abs(z) ? 1 : 0;
  return count;
}

double Spectrum::kappa(int block) const {
  std::size_t first = 0;
  for (int k = 0; k < block; ++k) first += blocks_->indices[static_cast<std::size_t>(k)].size();
  double nearest = std::numeric_limits<double>::infinity(), kappa = 0.0;
  for (std::size_t i = first; i < first + blocks_->indices[static_cast<std::size_t>(block)].size(); ++i) {
    const std::complex<double> z = eigenvalues_[static_cast<Eigen::Index>(i)];
    if (!(z.imag() > 0.0) || std::abs(z.real()) >= nearest) continue;
    nearest = std::abs(z.real());
    kappa = z.imag() * z.imag();
  }
  return kappa;
}

}  // namespace whirl::continuation
