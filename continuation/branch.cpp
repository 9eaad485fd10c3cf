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

Branch::Branch(int n, int spectrum_size, int capacity)
    : u_(n + 1, capacity),
      tangent_(n + 1, capacity),
      eigenvalues_(spectrum_size, spectrum_size > 0 ? capacity : 0),
      arclength_(capacity),
      residual_(capacity),
      step_(capacity),
      iterations_(capacity),
      unstable_(capacity) {}

void Branch::append(In u, In tangent, double arclength, double residual, double step, int iterations, int unstable,
                    const Eigen::VectorXcd* eigenvalues) {
  assert(points_ < capacity());
  u_.col(points_) = u;
  tangent_.col(points_) = tangent;
  if (has_spectrum() && eigenvalues) eigenvalues_.col(points_) = *eigenvalues;
  arclength_[points_] = arclength;
  residual_[points_] = residual;
  step_[points_] = step;
  iterations_[points_] = iterations;
  unstable_[points_] = unstable;
  ++points_;
}

void Branch::sort_special() {
  std::stable_sort(special.begin(), special.end(), [](const SpecialPoint& a, const SpecialPoint& b) { return a.arclength < b.arclength; });
}

Branch Branch::reversed() const {
  Branch r(size(), spectrum_size(), points_);  // not a copy: the storage may be far larger than what is used
  r.points_ = points_;
  r.special = special;
  r.start_reason = start_reason;
  r.stop_reason = stop_reason;
  r.name = name;
  r.born_at = born_at;
  r.isola = isola;
  r.active_reflections = active_reflections;
  for (int i = 0; i < points_; ++i) {
    const int j = points_ - 1 - i;
    r.u_.col(i) = u_.col(j);
    r.tangent_.col(i) = -tangent_.col(j);
    if (has_spectrum()) r.eigenvalues_.col(i) = eigenvalues_.col(j);
    r.arclength_[i] = -arclength_[j];
    r.residual_[i] = residual_[j];
    r.step_[i] = step_[j];
    r.iterations_[i] = iterations_[j];
    r.unstable_[i] = unstable_[j];
  }
  std::reverse(r.special.begin(), r.special.end());
  for (auto& s : r.special) {
    s.arclength = -s.arclength;
    s.tangent = -s.tangent;
    std::swap(s.unstable_before, s.unstable_after);
  }
  std::swap(r.start_reason, r.stop_reason);
  return r;
}

Branch Branch::joined(const Branch& backward, const Branch& forward) {
  const Branch first = backward.reversed();
  const int shared = first.points() > 0 ? 1 : 0;  // the common first point stands once
  Branch r(forward.size(), forward.spectrum_size(), first.points() - shared + forward.points());
  const auto copy = [&r](const Branch& b, int from, int to) {
    for (int i = from; i < to; ++i) {
      Eigen::VectorXcd e;
      if (b.has_spectrum()) e = b.eigenvalues(i);
      r.append(b.u(i), b.tangent(i), b.arclength(i), b.residual(i), b.step(i), b.iterations(i), b.n_unstable(i), &e);
    }
  };
  copy(first, 0, first.points() - shared);
  copy(forward, 0, forward.points());
  r.special = first.special;
  r.special.insert(r.special.end(), forward.special.begin(), forward.special.end());
  r.start_reason = first.start_reason;
  r.stop_reason = forward.stop_reason;
  r.name = forward.name;
  r.born_at = forward.born_at;
  r.isola = forward.isola;
  r.active_reflections = forward.active_reflections;
  return r;
}

}  // namespace whirl::continuation
