#pragma once
/// Eigenvalues of r_x, block by block, without allocation after construction.

#include <Eigen/Eigenvalues>
#include <memory>

#include "continuation/blocks.hpp"
#include "continuation/characteristic.hpp"
#include "continuation/growth_rates.hpp"

namespace whirl::continuation {

class Spectrum {
 public:
  explicit Spectrum(const Blocks& blocks);

  /// Eigenvalues of the leading n x n part of `jacobian`; false if they could not be computed.
  [[nodiscard]] bool compute(MatrixIn jacobian);

  const Eigen::VectorXcd& eigenvalues() const { return eigenvalues_; }  ///< block after block
  /// Real parts next to zero of a block: the test functions that announce events.
  const GrowthRates& rates(int block) const { return rates_[static_cast<std::size_t>(block)]; }
  int unstable() const;          ///< eigenvalues with positive real part
  int clearly_unstable() const;  ///< those whose real part is above 1e-9 of their modulus, what an error of the point makes
  /// Squared imaginary part of the complex pair nearest the imaginary axis in the block; 0 without one.
  double kappa(int block) const;

 private:
  double nearest_pair(int first, int count) const;
  const Blocks* blocks_;
  std::vector<Matrix> block_;
  std::vector<std::unique_ptr<Eigen::EigenSolver<Matrix>>> solver_;
  std::vector<RealFactors> factors_;  // of blocks of size 3 and 4, from the point before
  Eigen::VectorXcd eigenvalues_;
  std::vector<GrowthRates> rates_;
};

}  // namespace whirl::continuation
