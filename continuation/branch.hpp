#pragma once
/// What a walk leaves behind: points in columns, special points, and why it ended. Plain values; nothing here computes.

#include <complex>
#include <span>
#include <string>
#include <vector>

#include "core/problem.hpp"

namespace whirl::continuation {

/// Special points, in the field's letters.
enum class EventType {
  fold,             ///< LP
  branch_point,     ///< BP; subtype says which ("WH" where a reflection breaks into whirling, "PF" pitchfork, "TC" transcritical)
  hopf,             ///< HB
  period_doubling,  ///< PD, a multiplier leaves through -1
  torus,            ///< TR, a complex pair of multipliers leaves the unit circle
  end,              ///< EP
  gave_up,          ///< MX
  user_value,       ///< UZ
  peak,             ///< RP, an observable has an extremum
  unresolved        ///< a change in the number of unstable directions that no located event explains
};
const char* to_string(EventType type);

enum class StopReason {
  parameter_bound,     ///< reached lower or upper end of the parameter range, exactly
  closed_loop,         ///< came back to its first point
  symmetric_branch,    ///< reached a branch point on a symmetric branch; the rest is the mirror image
  known_branch_point,  ///< started at a branch point
  strong_resonance,    ///< a curve of torus points ends: its multipliers meet at 1 or -1
  bogdanov_takens,     ///< a curve of Hopf points ends: its frequency is zero
  unbounded,           ///< the state grows beyond any size at a finite parameter value
  max_points,
  min_step,  ///< the corrector failed at the smallest step
  observer,  ///< the observer asked to stop
  none
};
const char* to_string(StopReason reason);

struct SpecialPoint {
  EventType type = EventType::end;
  std::string subtype;
  Vector u;                  ///< (x, p), size n + 1
  Vector tangent;            ///< of the branch, same size
  Vector null_vector;        ///< of r_x where singular (Hopf: real part), size n, else empty
  Vector null_vector_im;     ///< Hopf: imaginary part
  double frequency = 0.0;    ///< Hopf: imaginary part of the critical eigenvalue
  double coefficient = 0.0;  ///< normal-form coefficient: fold quadratic, pitchfork cubic, Hopf first Lyapunov; see normal_form.hpp
  bool has_coefficient = false;
  double residual = 0.0;           ///< of the defining system, largest entry
  double bracket[2] = {0.0, 0.0};  ///< parameter values on the branch between which the test function changes
  double arclength = 0.0;
  int unstable_before = 0, unstable_after = 0;  ///< along the walk
  int block = 0;                                ///< symmetry block in which r_x is singular; 0 is the block of the motion itself
  bool stable_before() const { return unstable_before == 0; }
  bool stable_after() const { return unstable_after == 0; }
};

/// Points of one branch, at most `capacity` of them. Storage doubles when it is full; the first one holds some hundred points of a small problem.
class Branch {
 public:
  Branch() = default;
  Branch(int n, int spectrum_size, int capacity);

  int points() const { return points_; }
  int capacity() const { return capacity_; }
  int size() const { return n_; }
  int spectrum_size() const { return spectrum_; }  ///< eigenvalues, or Floquet multipliers, of a point
  bool has_spectrum() const { return spectrum_ > 0; }

  Eigen::Map<const Vector> u(int i) const { return {column(i), n_ + 1}; }
  Eigen::Map<const Vector> tangent(int i) const { return {column(i) + n_ + 1, n_ + 1}; }
  double parameter(int i) const { return column(i)[n_]; }
  Eigen::Map<const Eigen::VectorXcd> eigenvalues(int i) const {
    return {reinterpret_cast<const std::complex<double>*>(column(i) + 2 * (n_ + 1)), spectrum_};
  }
  double arclength(int i) const { return scalar(i, 0); }
  double residual(int i) const { return scalar(i, 1); }
  double step(int i) const { return scalar(i, 2); }
  int iterations(int i) const { return static_cast<int>(scalar(i, 3)); }
  int n_unstable(int i) const { return static_cast<int>(scalar(i, 4)); }

  void append(In u, In tangent, double arclength, double residual, double step, int iterations, int unstable, const Eigen::VectorXcd* eigenvalues);
  /// Special points in order of arclength.
  void sort_special();
  void clear() {
    points_ = 0;
    special.clear();
  }

  /// This branch walked the other way: order of points and sense of tangents reversed.
  Branch reversed() const;
  /// `backward` (walked away from the common first point) followed by `forward`.
  static Branch joined(const Branch& backward, Branch forward);

  std::vector<SpecialPoint> special;  ///< in order of arclength
  StopReason start_reason = StopReason::none, stop_reason = StopReason::none;
  std::string name;
  std::string born_at;                  ///< "start", "seed", or the label of the branch point it leaves from
  bool isola = false;                   ///< closed, found from a seed, no branch point shared with a branch known before
  bool mirror_image = false;            ///< some reflection of the problem moves the branch: its image is a branch too, not followed
  std::vector<int> active_reflections;  ///< reflections of the problem that leave every point of this branch in place

 private:
  static constexpr int scalars = 5;  // arclength, residual, step, iterations, unstable
  const double* column(int i) const {
    assert(i >= 0 && i < points_);
    return record_.data() + i * record_.rows();
  }
  double scalar(int i, int which) const { return column(i)[2 * (n_ + 1) + 2 * spectrum_ + which]; }
  int n_ = 0, spectrum_ = 0, capacity_ = 0, points_ = 0;
  Matrix record_;  // a column a point: u, tangent, eigenvalues, scalars
};

}  // namespace whirl::continuation
