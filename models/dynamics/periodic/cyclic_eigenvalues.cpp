#include "models/dynamics/periodic/cyclic_eigenvalues.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <complex>

namespace whirl::models {
namespace {

constexpr double well_scaled = 1e8;  // spread of the product up to which eight digits of its smallest eigenvalue are left

bool larger(const std::complex<double>& a, const std::complex<double>& b) {
  return std::abs(a) != std::abs(b) ? std::abs(a) > std::abs(b) : a.imag() > b.imag();
}

}  // namespace

Eigen::VectorXcd cyclic_eigenvalues(const std::vector<Matrix>& factors) {
  const auto n = factors.front().rows(), m = static_cast<Eigen::Index>(factors.size());
  Matrix product = Matrix::Identity(n, n);
  double growth = 1.0;
  for (const Matrix& a : factors) {
    product = a * product;
    growth *= std::max(a.norm(), 1e-300);
  }
  Eigen::VectorXcd mu = Eigen::EigenSolver<Matrix>(product, false).eigenvalues();
  std::sort(mu.begin(), mu.end(), larger);
  if (m == 1 || !(growth > well_scaled * std::max(std::abs(mu[n - 1]), 1e-300))) return mu;
  Matrix cyclic = Matrix::Zero(n * m, n * m);
  for (Eigen::Index i = 0; i < m; ++i) cyclic.block(((i + 1) % m) * n, i * n, n, n) = factors[static_cast<std::size_t>(i)];
  // Each eigenvalue of the product comes as m roots: all of a cluster of powers.
  std::vector<std::complex<double>> logs;
  const Eigen::VectorXcd roots = Eigen::EigenSolver<Matrix>(cyclic, false).eigenvalues();
  for (const auto& root : roots)
    logs.emplace_back(static_cast<double>(m) * std::log(std::max(std::abs(root), 1e-300)),
                      std::arg(std::pow(root / std::max(std::abs(root), 1e-300), static_cast<int>(m))));
  std::sort(logs.begin(), logs.end(), [](const auto& a, const auto& b) { return a.real() > b.real(); });
  std::vector<bool> used(logs.size(), false);
  for (Eigen::Index found = 0; found < n; ++found) {
    std::size_t first = 0;
    while (used[first]) ++first;
    const auto apart = [&](std::size_t i) {
      return std::abs(logs[i].real() - logs[first].real()) + std::abs(std::polar(1.0, logs[i].imag()) - std::polar(1.0, logs[first].imag()));
    };
    std::vector<std::size_t> order;
    for (std::size_t i = first; i < logs.size(); ++i)
      if (!used[i]) order.push_back(i);
    std::partial_sort(order.begin(), order.begin() + m, order.end(), [&](std::size_t a, std::size_t b) { return apart(a) < apart(b); });
    double size = 0.0;
    std::complex<double> direction = 0.0;
    for (Eigen::Index k = 0; k < m; ++k) {
      const std::size_t i = order[static_cast<std::size_t>(k)];
      used[i] = true;
      size += logs[i].real() / static_cast<double>(m);
      direction += std::polar(1.0 / static_cast<double>(m), logs[i].imag());
    }
    if (std::abs(direction.imag()) < 1e-8) direction = direction.real() > 0.0 ? 1.0 : -1.0;  // real, up to rounding
    mu[found] = std::polar(std::exp(size), std::arg(direction));
    if (direction.imag() == 0.0) mu[found].imag(0.0);
  }
  return mu;
}

}  // namespace whirl::models
