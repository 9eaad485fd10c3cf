#include "continuation/branch.hpp"

#include <algorithm>

namespace whirl::continuation {

const char* to_string(EventType type) {
  switch (type) {
    case EventType::fold:
      return "LP";
    case EventType::branch_point:
      return "BP";
    case EventType::hopf:
      return "HB";
    case EventType::period_doubling:
      return "PD";
    case EventType::torus:
      return "TR";
    case EventType::end:
      return "EP";
    case EventType::gave_up:
      return "MX";
    case EventType::user_value:
      return "UZ";
    case EventType::peak:
      return "RP";
    case EventType::unresolved:
      return "unresolved";
  }
  return "?";
}

const char* to_string(StopReason reason) {
  switch (reason) {
    case StopReason::parameter_bound:
      return "parameter_bound";
    case StopReason::closed_loop:
      return "closed_loop";
    case StopReason::symmetric_branch:
      return "symmetric_branch";
    case StopReason::known_branch_point:
      return "branch_point";
    case StopReason::strong_resonance:
      return "strong_resonance";
    case StopReason::bogdanov_takens:
      return "bogdanov_takens";
    case StopReason::unbounded:
      return "unbounded";
    case StopReason::max_points:
      return "max_points";
    case StopReason::min_step:
      return "min_step";
    case StopReason::observer:
      return "stopped_by_user";
    case StopReason::none:
      return "none";
  }
  return "?";
}

Branch::Branch(int n, int spectrum_size, int capacity) : n_(n), spectrum_(spectrum_size), capacity_(capacity) {
  constexpr int first = 12000;  // numbers: below what a C library takes from the system each time anew
  const int rows = 2 * (n + 1) + 2 * spectrum_size + scalars;
  record_.resize(rows, std::min(capacity, std::max(64, first / rows)));
}

void Branch::append(In u, In tangent, double arclength, double residual, double step, int iterations, int unstable,
                    const Eigen::VectorXcd* eigenvalues) {
  assert(points_ < capacity());
  if (points_ == record_.cols()) record_.conservativeResize(Eigen::NoChange, std::min<Eigen::Index>(capacity_, 2 * record_.cols()));
  double* to = record_.data() + points_ * record_.rows();
  to = std::copy_n(u.data(), n_ + 1, to);
  to = std::copy_n(tangent.data(), n_ + 1, to);
  if (has_spectrum() && eigenvalues) std::copy_n(reinterpret_cast<const double*>(eigenvalues->data()), 2 * spectrum_, to);
  to += 2 * spectrum_;
  to[0] = arclength;
  to[1] = residual;
  to[2] = step;
  to[3] = iterations;
  to[4] = unstable;
  ++points_;
}

void Branch::sort_special() {
  std::stable_sort(special.begin(), special.end(), [](const SpecialPoint& a, const SpecialPoint& b) { return a.arclength < b.arclength; });
}

Branch Branch::reversed() const {
  Branch r(n_, spectrum_, points_);
  r.record_ = record_.leftCols(points_).rowwise().reverse();
  r.record_.middleRows(n_ + 1, n_ + 1) *= -1.0;
  r.record_.row(2 * (n_ + 1) + 2 * spectrum_) *= -1.0;  // arclength
  r.points_ = points_;
  r.special = special;
  r.start_reason = start_reason;
  r.stop_reason = stop_reason;
  r.name = name;
  r.born_at = born_at;
  r.isola = isola;
  r.active_reflections = active_reflections;
  std::reverse(r.special.begin(), r.special.end());
  for (auto& s : r.special) {
    s.arclength = -s.arclength;
    s.tangent = -s.tangent;
    std::swap(s.unstable_before, s.unstable_after);
  }
  std::swap(r.start_reason, r.stop_reason);
  return r;
}

Branch Branch::joined(const Branch& backward, Branch forward) {
  if (backward.points() <= 1 && backward.special.empty()) {  // nothing lies behind the common first point
    forward.start_reason = backward.stop_reason;
    return forward;
  }
  Branch r = backward.reversed();
  const int shared = r.points() > 0 ? 1 : 0, first = r.points() - shared;
  r.capacity_ = r.points_ = first + forward.points();
  r.record_.conservativeResize(Eigen::NoChange, r.points_);
  r.record_.rightCols(forward.points()) = forward.record_.leftCols(forward.points());
  r.special.insert(r.special.end(), forward.special.begin(), forward.special.end());
  r.stop_reason = forward.stop_reason;
  r.name = forward.name;
  r.born_at = forward.born_at;
  r.isola = forward.isola;
  r.active_reflections = forward.active_reflections;
  return r;
}

}  // namespace whirl::continuation
