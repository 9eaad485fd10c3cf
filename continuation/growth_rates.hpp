#pragma once
/// The growth rates next to zero: real parts of eigenvalues, or |mu| - 1 of multipliers. A complex pair counts twice. In order of size they move
/// continuously along a curve, so that "the r-th largest" is a test function that neither jumps nor forgets whose it is.

#include <array>
#include <limits>
#include <utility>

namespace whirl::continuation {

class GrowthRates {
 public:
  GrowthRates() { clear(); }
  /// `size`: of the matrix they belong to; 1 for multipliers.
  void clear(double size = 1.0) {
    positive_ = count_ = 0;
    size_ = size;
    pair_ = std::numeric_limits<double>::infinity();
    above_.fill(std::numeric_limits<double>::infinity());
    below_.fill(-std::numeric_limits<double>::infinity());
  }
  void add(double rate) {
    ++count_;
    if (rate > 0.0) {
      ++positive_;
      for (double& other : above_)
        if (rate < other) std::swap(rate, other);
    } else {
      for (double& other : below_)
        if (rate > other) std::swap(rate, other);
    }
  }
  /// Product of the two eigenvalues, a complex pair or neighbours on the real axis, whose product is nearest to zero; infinite where there are no
  /// two. Where a pair meets the axis beside zero its real parts tell too late that one of them may pass: their product goes on smoothly.
  double pair() const { return pair_; }
  void set_pair(double product) { pair_ = product; }
  int positive() const { return positive_; }
  int count() const { return count_; }
  double size() const { return size_; }
  /// The r-th largest, r >= 1; infinite where there is none or more than three others stand between it and zero.
  double ranked(int r) const {
    const int up = positive_ - r, down = r - positive_ - 1;
    if (up >= 0) return up < kept ? above_[static_cast<std::size_t>(up)] : std::numeric_limits<double>::infinity();
    return down < kept ? below_[static_cast<std::size_t>(down)] : -std::numeric_limits<double>::infinity();
  }

 private:
  static constexpr int kept = 4;  // on either side: as many as two pairs that cross at once
  int positive_ = 0, count_ = 0;
  double size_ = 1.0, pair_ = std::numeric_limits<double>::infinity();
  std::array<double, kept> above_, below_;  // nearest first
};

}  // namespace whirl::continuation
