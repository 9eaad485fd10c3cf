#pragma once
/// One solution curve of r(x, p) = 0: the corrector, the tangent and the signature of a point. No step control, no events.
///
///     [ r_x  r_p ] [du]   [ -r              ]          [ J  ]     [0]
///     [   c' W   ]        [ -c'W (u - anchor)]         [c'W ] t = [1],  t normalised in the metric W
///
/// Where symmetries split the Jacobian into blocks only block 0 is solved: r, steps and tangents are zero in the others.
///
/// A point costs two linearisations, one LU and the residual to show: Newton from the predicted point, a chord step with the same factors, the
/// tangent by refinement
///
///     t <- t + LU^-1 (e - B t),   B the bordered matrix at the point, LU of the one a correction earlier.
///
/// W is diagonal: lengths are measured in units of the parameter range and of the size of x, so that steps need no tuning.

#include <algorithm>
#include <array>

#include "continuation/multiplier_pairs.hpp"
#include "continuation/spectrum.hpp"
#include "core/dense_lu.hpp"
#include "core/orbit_problem.hpp"

namespace whirl::continuation {

/// What can change at a special point: the sense of the parameter, and per block the number of unstable directions and the sign of det r_x.
/// Of a periodic motion the multipliers are counted per group of directions (orbit_problem.hpp), the determinants per block.
struct Signature {
  static constexpr int max_blocks = OrbitProblem::max_groups;
  bool forward = true;  ///< parameter increases along the tangent
  std::array<int, max_blocks> unstable{};
  std::array<bool, max_blocks> negative{};  ///< det of the block < 0
  std::array<int, max_blocks> above{};      ///< periodic motion: real multipliers > 1
  std::array<int, max_blocks> flips{};      ///< periodic motion: real multipliers < -1
  bool operator==(const Signature& other) const {
    int different = forward != other.forward ? 1 : 0;
    for (std::size_t k = 0; k < max_blocks; ++k)
      different |=
          (unstable[k] ^ other.unstable[k]) | (above[k] ^ other.above[k]) | (flips[k] ^ other.flips[k]) | (negative[k] != other.negative[k] ? 1 : 0);
    return different == 0;
  }
  int total_unstable() const {
    int sum = 0;
    for (int count : unstable) sum += count;
    return sum;
  }
};

/// Two multipliers that meet, whose places among the pairs of a point are `first` and `second`: a pair at 1 or at -1, or two pairs on either side.
struct Collision {
  enum class Kind { at_one, at_minus_one, of_two_pairs } kind;
  int first, second;  // the same where a pair meets itself
  bool operator==(const Collision& other) const = default;
};

struct Sample {
  Vector u, tangent;
  Signature signature;
  double residual = 0.0;
  int iterations = 0;
  std::array<GrowthRates, Signature::max_blocks> rates{};  ///< per block real parts, of a periodic motion per group |mu| - 1
  std::array<double, Signature::max_blocks> kappa{};  ///< per block, squared imaginary part of the complex pair nearest the imaginary axis; 0: none
  std::vector<MultiplierPair> pairs = {};             ///< periodic motion: by group and angle
  std::vector<Collision> settled = {};                ///< collisions of these pairs that lie behind the point and have been searched
};

struct CurveOptions {
  double tolerance = 1e-11;  ///< on the predicted size of the next step, in the metric
  double last_step = 1e-9;   ///< largest last step: the Jacobian, and with it tangent and eigenvalues, is that before it
  int max_iterations = 8;
};

class Curve {
 public:
  struct Report {
    bool ok = false;
    int iterations = 0;
    double first_step = 0.0;   ///< length of the first correction
    double contraction = 0.0;  ///< second over first
    double residual = 0.0;     ///< largest |r_i| at the point
  };

  Curve(const Problem& f, Blocks blocks, const CurveOptions& options);
  Curve(const Curve&) = delete;

  const Problem& problem() const { return f_; }
  const Blocks& blocks() const { return blocks_; }

  /// Metric: x in units of x_scale, p in units of p_scale.
  void set_scales(double x_scale, double p_scale);
  double x_scale() const { return x_scale_; }
  double p_scale() const { return p_scale_; }
  template <class A, class B>
  double dot(const Eigen::MatrixBase<A>& a, const Eigen::MatrixBase<B>& b) const {
    return (a.array() * weight_.array() * b.array()).sum();
  }
  template <class A>
  double length(const Eigen::MatrixBase<A>& a) const {
    return std::sqrt((a.array().square() * weight_.array()).sum());
  }

  /// Newton onto the curve within the plane through `anchor` normal to `normal`. On success Jacobian and factors are kept for `tangent`.
  /// `strict`: the Jacobian is that of the point to rounding, as signs beside a branch point need it.
  Report correct(Out u, In normal, In anchor, bool strict = false);
  /// Tangent at the point just corrected, positive along the normal of `correct`. False if singular or non-finite.
  bool tangent(Out tangent);
  /// Spectrum and signature there; false if they cannot be computed.
  bool classify(In u, In tangent, Signature& signature);
  bool complete(In u, Out t, Signature& signature) { return tangent(t) && classify(u, t, signature); }

  /// Eigenvalues of r_x or Floquet multipliers at the point last classified; empty if the problem has neither.
  const Eigen::VectorXcd& eigenvalues() const { return f_.is_flow() ? spectrum_.eigenvalues() : eigenvalues_; }
  /// Unstable directions of the point last classified; what is neutral but for rounding is not.
  int unstable(const Signature& signature) const { return f_.is_flow() ? spectrum_.clearly_unstable() : signature.total_unstable(); }
  /// Test functions of the point last classified.
  void copy_spectrum(Sample& to) const;  ///< rates, kappa and pairs of the last point classified
  void copy_rates(Sample& to) const { std::copy_n(rates_.begin(), parts_, to.rates.begin()); }
  static int spectrum_size(const Problem& f);
  /// The problem as one of periodic motions; null if it is none.
  const OrbitProblem* orbit() const { return orbit_; }
  int parts() const { return parts_; }  ///< of the spectrum: the blocks, or the groups of multipliers met so far

  /// Corrected and completed point near `guess`, in the plane through it normal to `normal`.
  bool sample(In guess, In normal, Sample& out);
  /// Point between two samples, at fraction sigma of the chord.
  bool between(const Sample& a, const Sample& b, double sigma, Sample& out);
  /// The same of rest points without a correction: on the cubic through both ends, off the curve by the fourth power of their distance.
  /// For looking about; what shows is to be corrected.
  bool peek(const Sample& a, const Sample& b, double sigma, Sample& out);
  /// Of that only u and the tangent.
  void guess(const Sample& a, const Sample& b, double sigma, Sample& out) const;

 private:
  void interpolate(const Sample& a, const Sample& b, double sigma, Vector& u) const;
  void border();
  void spread(const Vector& from, double scale, Out answer) const;
  void add(const Vector& answer, Out u) const;
  double length_of(const Vector& from) const;
  void subtract_product(const Vector& x, Vector& y) const;
  void right_side(Out u, In anchor);
  bool settle(Out u, In anchor, double previous, double last_step, Report& report);
  bool refine_tangent();
  void block_determinants(Signature& signature, bool forward);
  bool count_multipliers(In u, Signature& signature);

  const Problem& f_;
  const OrbitProblem* orbit_;
  Blocks blocks_;
  CurveOptions options_;
  Spectrum spectrum_;
  Eigen::VectorXcd eigenvalues_;  // of a periodic motion
  Eigen::VectorXi group_;         // of each multiplier
  int parts_;
  std::array<GrowthRates, Signature::max_blocks> rates_{};
  MultiplierPairs pairing_;
  std::vector<MultiplierPair> pairs_;
  Vector weight_, r_, normal_;                        // normal_: weighted
  bool whole_;                                        // no symmetry: block 0 is everything, in order
  int state_;                                         // size of block 0
  Vector solution_, rhs_, refined_, last_, tangent_;  // last_: the unit vector of the plane
  Matrix bordered_, own_jacobian_;                    // at the point
  MatrixOut jacobian_;                                // without symmetry the upper rows of the bordered matrix itself
  DenseLu lu_;                                        // of it, or of the one a correction earlier
  std::vector<Matrix> block_;
  std::vector<DenseLu> block_lu_;
  double x_scale_ = 1.0, p_scale_ = 1.0;
};

}  // namespace whirl::continuation
