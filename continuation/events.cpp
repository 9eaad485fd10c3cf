#include "continuation/events.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "continuation/multiple_point.hpp"
#include "continuation/parabola.hpp"
#include "continuation/special_points.hpp"

namespace whirl::continuation {
namespace {

double fraction(const Curve& curve, const Sample& a, const Sample& b, In u) {
  const Vector chord = b.u - a.u;
  return curve.dot(chord, u - a.u) / curve.dot(chord, chord);
}

int unstable_pairs(const Eigen::VectorXcd& eigenvalues) {
  int count = 0;
  for (const auto& z : eigenvalues) count += z.real() > 0.0 && z.imag() > 0.0 ? 1 : 0;
  return count;
}

// What is known just before and just behind a point holds for one that coincides with it.
void copy_sides(const SpecialPoint& from, SpecialPoint& to) {
  to.unstable_before = from.unstable_before;
  to.unstable_after = from.unstable_after;
  to.bracket[0] = std::min(from.bracket[0], to.u[to.u.size() - 1]);
  to.bracket[1] = std::max(from.bracket[1], to.u[to.u.size() - 1]);
  to.tangent = from.tangent;
}

// May a function that has these values at the ends touch zero between them? It is nearer to zero than it moved there or lately.
bool may_touch(double from, double to, double past) {
  if (std::isinf(from) && std::isinf(to)) return false;  // there is none
  const double moved = std::max(std::abs(to - from), std::abs(from - past));
  return !(std::min(std::abs(from), std::abs(to)) >= moved) && from * to > 0.0;
}

}  // namespace

std::vector<EventKind> EventFinder::changes(const Signature& a, const Signature& b) const {
  std::vector<EventKind> kinds;
  const bool fold = a.forward != b.forward;
  if (fold) kinds.push_back({EventType::fold, 0});
  for (int k = 0; k < static_cast<int>(curve_.blocks().indices.size()); ++k) {
    const auto slot = static_cast<std::size_t>(k);
    if (neutral_[slot]) continue;
    const bool turned = a.negative[slot] != b.negative[slot];
    if (k == 0 ? turned != fold : turned) kinds.push_back({EventType::branch_point, k});
    const int pairs = (std::abs(b.unstable[slot] - a.unstable[slot]) - (turned ? 1 : 0)) / 2;
    if (pairs > 0 && !curve_.orbit()) kinds.push_back({EventType::hopf, k});
  }
  if (curve_.orbit()) multiplier_changes(a, b, kinds);
  return kinds;
}

// Multipliers of each group that left through -1, or in pairs. Real ones may meet and leave the axis, so only the parity of their number tells.
void EventFinder::multiplier_changes(const Signature& a, const Signature& b, std::vector<EventKind>& kinds) const {
  for (int g = 0; g < curve_.parts(); ++g) {
    const auto slot = static_cast<std::size_t>(g);
    const bool flipped = (b.flips[slot] - a.flips[slot]) % 2 != 0, left = (b.above[slot] - a.above[slot]) % 2 != 0;
    if (flipped) kinds.push_back({EventType::period_doubling, g});
    if (std::abs(b.unstable[slot] - a.unstable[slot]) - (flipped ? 1 : 0) - (left ? 1 : 0) >= 2) kinds.push_back({EventType::torus, g});
  }
}

// A search among signs that rounding makes would never end: what is left of it is told as unresolved.
bool EventFinder::between(const Sample& a, const Sample& b, double sigma, Sample& out) {
  constexpr int most_of_orbit = 100;  // a point of a periodic motion, and what is tried there, costs a thousand times as much
  const int most = curve_.orbit() ? std::min(most_of_orbit, options_.most_samples) : options_.most_samples;
  return ++samples_ <= most && curve_.between(a, b, sigma, out);
}

void EventFinder::follow(const Sample& before, const Sample& a, Sample& b) {
  if (curve_.orbit()) collisions_.follow(before, a, b);
}

std::vector<SpecialPoint>& EventFinder::find(const Sample& before, const Sample& a, Sample& b, bool last) {
  found_.clear();
  samples_ = 0;
  note_neutral(before, a, b);
  if (curve_.orbit()) collisions_.search(before, a, b, last);
  const bool turned = turns_at(before, a, b), was_changed = changed(before.signature, a.signature), is_changed = changed(a.signature, b.signature);
  const bool parted_behind = curve_.orbit() && !collisions_.behind().empty(), parted = curve_.orbit() && !collisions_.ahead().empty();
  // The neighbours of a step with an event are searched as it is itself: there two more may cancel, and nothing seems to turn.
  if (parted_behind) explain_parts(before, collisions_.behind(), a);
  else if (!was_changed && turned) look_closer(b, before, a, 0);  // b only tells how much things moved
  else if (!was_changed && is_changed && !quiet_beside(before, a, b)) look_closer(before, before, a, beside(), true);
  if (parted) explain_parts(a, collisions_.ahead(), b);
  else if (is_changed) explain(a, b, 1);
  else if (turned || last) look_closer(before, a, b, 0);
  else if (was_changed && !quiet_beside(b, a, before)) look_closer(a, a, b, beside(), true);
  std::sort(found_.begin(), found_.end(), [&](const auto& p, const auto& q) { return fraction(curve_, a, b, p.u) < fraction(curve_, a, b, q.u); });
  return found_;
}

// A step in parts whose ends differ where something lies between. What changed in a step behind has been explained when it was taken.
void EventFinder::explain_parts(const Sample& a, const std::vector<Sample>& between, const Sample& b) {
  const Sample* from = &a;
  for (const Sample& to : between) {
    if (changed(from->signature, to.signature)) explain(*from, to, 1);
    from = &to;
  }
  if (changed(from->signature, b.signature)) explain(*from, b, 1);
}

void EventFinder::explain(const Sample& a, const Sample& b, int depth) {
  const auto kinds = changes(a.signature, b.signature);
  if (kinds.empty()) {
    if (unstable_changed(a.signature, b.signature)) report_unresolved(a, b);
    // Beside an event two more may cancel: its own step is the last that looks here.
    else if (curve_.length(b.u - a.u) > 1e-5) look_closer(a, a, b, beside());
    return;
  }
  for (const auto& kind : kinds) {
    SpecialPoint point;
    if (locate(kind, a, b, point) && accept(kind, a, b, point, depth)) return;
  }
  if ((curve_.problem().size() <= always_asked || depth == options_.max_depth) && locate_multiple(a, b, depth)) return;
  Sample middle;
  if (depth < options_.max_depth && between(a, b, 0.5, middle)) {
    explain(a, middle, depth + 1);
    explain(middle, b, depth + 1);
    return;
  }
  report_unresolved(a, b);
}

bool EventFinder::unstable_changed(const Signature& a, const Signature& b) const {
  for (std::size_t k = 0; k < a.unstable.size(); ++k)
    if (a.unstable[k] != b.unstable[k] && !neutral_[k]) return true;
  return false;
}

void EventFinder::note_neutral(const Sample& before, const Sample& a, const Sample& b) {
  for (int k = 0; k < curve_.parts(); ++k) neutral_[static_cast<std::size_t>(k)] = neutral(before, k) && neutral(a, k) && neutral(b, k);
}

// Is a growth rate zero but for rounding? If it is so all along, as without damping, its changes of sign are no events.
bool EventFinder::neutral(const Sample& s, int block) const {
  if (!curve_.problem().is_flow()) return false;
  const auto slot = static_cast<std::size_t>(block);
  const auto& rates = s.rates[slot];
  // Of a pair next to its own frequency: beside a far faster eigenvalue the size of the matrix says little.
  const double pair = s.kappa[slot], nothing = pair > 0.0 ? std::min(1e-11 * rates.size(), 1e-9 * std::sqrt(pair)) : 1e-13 * rates.size();
  return std::min(std::abs(rates.ranked(rates.positive())), std::abs(rates.ranked(rates.positive() + 1))) < nothing;
}

// Several real eigenvalues through zero at one point: of two no determinant changes sign, of three no simple system is regular. What remains of the
// step on either side is explained in turn.
bool EventFinder::locate_multiple(const Sample& a, const Sample& b, int depth) {
  const Problem& f = curve_.problem();
  if (curve_.orbit() || f.derivatives() < 2) return false;
  const Vector chord = b.u - a.u;
  const double span = curve_.length(chord);
  const auto near = [&](double part) { return multiple_point_near(f, a.u + part * chord, curve_.x_scale(), curve_.p_scale()); };
  auto point = near(secant(a, b, crossing({EventType::branch_point, 0}, a, b)));
  if (!point && a.signature.forward != b.signature.forward) point = near(secant(a, b, {-1, 0}));  // where it turns
  if (!point) return false;
  const double part = fraction(curve_, a, b, point->u);
  constexpr double off_chord = 0.1, close = 1e-9;  // parts of the step; of the metric
  if (part < -close || part > 1.0 + close || curve_.length(point->u - a.u - part * chord) > off_chord * span + close) return false;
  for (double delta = std::min(1e-6, 0.01 * span); delta < 0.5 * span; delta *= 10.0) {
    Sample left, right;
    const Vector offset = (delta / span) * chord;
    if (!curve_.sample(point->u - offset, chord, left) || !curve_.sample(point->u + offset, chord, right)) continue;
    const int changed = std::abs(right.signature.total_unstable() - left.signature.total_unstable());
    const bool turns = left.signature.forward != right.signature.forward;  // a branch that only touches the point keeps its stability
    if ((changed < 2 && !turns) || changed > point->dimension) continue;
    SpecialPoint p;
    p.type = EventType::branch_point;
    p.subtype = "multiple";
    p.u = point->u;
    p.tangent = left.tangent;
    p.residual = point->residual;
    const double at = p.u[f.size()], before = left.u[f.size()], behind = right.u[f.size()];
    p.bracket[0] = std::min({at, before, behind});
    p.bracket[1] = std::max({at, before, behind});
    p.unstable_before = left.signature.total_unstable();
    p.unstable_after = right.signature.total_unstable();
    found_.push_back(p);
    explain_rest(a, left, right, b, depth + 1);
    return true;
  }
  return false;
}

void EventFinder::report_unresolved(const Sample& a, const Sample& b) {
  SpecialPoint p;
  p.type = EventType::unresolved;
  p.u = 0.5 * (a.u + b.u);
  p.tangent = a.tangent;
  p.residual = std::max(a.residual, b.residual);
  p.bracket[0] = std::min(a.u[a.u.size() - 1], b.u[b.u.size() - 1]);
  p.bracket[1] = std::max(a.u[a.u.size() - 1], b.u[b.u.size() - 1]);
  p.unstable_before = a.signature.total_unstable();
  p.unstable_after = b.signature.total_unstable();
  found_.push_back(p);
}

// Does something that decides over events come nearer to zero and recede again, nearer than it moved?
bool EventFinder::turns_at(const Sample& before, const Sample& a, const Sample& b) {
  note_neutral(before, a, b);
  return !all_next_to_zero(a, [&](const TestFunction& t) {
    const double past = value(before, t), from = value(a, t), to = value(b, t), p = std::abs(past), f = std::abs(from), q = std::abs(to);
    return !(f <= p && f <= q && f < std::max(std::abs(from - past), std::abs(to - from)) && past * from > 0.0 && from * to > 0.0);
  });
}

double EventFinder::value(const Sample& s, const TestFunction& t) const {
  if (t.part < 0) return s.tangent[curve_.problem().size()];
  const auto& rates = s.rates[static_cast<std::size_t>(t.part)];
  return t.rank == 0 ? rates.pair() : rates.ranked(t.rank);
}

// Where the chord of the test function passes zero, in parts of the way; half way if it does not.
double EventFinder::secant(const Sample& a, const Sample& b, const TestFunction& t) const {
  const double f = value(a, t), g = value(b, t), part = f / (f - g);
  return part > 0.0 && part < 1.0 ? part : 0.5;
}

EventFinder::TestFunction EventFinder::crossing(const EventKind& kind, const Sample& a, const Sample& b) const {
  if (kind.type == EventType::fold) return {-1, 0};
  const auto slot = static_cast<std::size_t>(kind.block);
  return {kind.block, std::min(a.rates[slot].positive(), b.rates[slot].positive()) + 1};
}

void EventFinder::look_closer(const Sample& before, const Sample& a, const Sample& b, int depth, bool anyway) {
  const bool near = anyway || !all_next_to_zero(a, [&](const TestFunction& t) { return !may_touch(value(a, t), value(b, t), value(before, t)); });
  const double chord = curve_.length(b.u - a.u);
  if (!near || depth >= options_.suspicion_depth || !(chord > 0.0)) return;  // no chord: the first step has no point before it
  // Over a short stretch the cubic through its ends is the curve, near enough to see whether there is something to see.
  const bool glance = curve_.problem().is_flow() && chord < 0.01;
  Sample middle, left, right;
  if (!(glance ? curve_.peek(a, b, 0.5, middle) : between(a, b, 0.5, middle))) return;
  if (changed(a.signature, middle.signature)) {
    if (glance && !(curve_.sample(a.u, a.tangent, left) && curve_.sample(b.u, b.tangent, right) && between(left, right, 0.5, middle))) return;
    explain(glance ? left : a, middle, depth + 1);
    explain(middle, glance ? right : b, depth + 1);
  } else if (depth + 1 < options_.suspicion_depth) {
    look_closer(&before == &a ? b : before, a, middle, depth + 1);  // without a point before a the one behind tells how much things move
    look_closer(a, middle, b, depth + 1);
  } else {
    look_at_extrema(a, middle, b, depth + 1);
  }
}

// Halving has come to where a parabola is trusted: does a test function change sign at its extremum? The parabola is drawn anew through the
// three nearest points until its extremum is settled.
void EventFinder::look_at_extrema(const Sample& a, const Sample& middle, const Sample& b, int depth) {
  struct Knot {
    double sigma, value;
  };
  all_next_to_zero(a, [&](const TestFunction& t) {
    Knot l{0.0, value(a, t)}, m{0.5, value(middle, t)}, r{1.0, value(b, t)};
    for (int i = 0; i < 8; ++i) {
      const Parabola parabola(l.sigma, l.value, m.sigma, m.value, r.sigma, r.value);
      const double sigma = parabola.turn(), extremum = parabola.at(sigma);
      if (!(sigma > l.sigma && sigma < r.sigma) || std::abs(sigma - m.sigma) < 1e-9) break;
      if (i > 0 && extremum * m.value > 0.0 && std::abs(extremum) > 0.5 * std::abs(m.value)) break;  // settled, away from zero
      Sample at;
      if (!between(a, b, sigma, at)) break;
      if (changed(a.signature, at.signature)) {
        explain(a, at, depth);
        explain(at, b, depth);
        return false;
      }
      const Knot now{sigma, value(at, t)};
      if (std::abs(now.value) < std::abs(m.value)) {
        (sigma < m.sigma ? r : l) = m;
        m = now;
      } else {
        (sigma < m.sigma ? l : r) = now;
      }
    }
    return true;
  });
}

// Newton from the secant guess, else from ever narrower brackets.
bool EventFinder::locate(const EventKind& kind, const Sample& a, const Sample& b, SpecialPoint& out) {
  const auto inside = [&](const SpecialPoint& p) {
    const double s = fraction(curve_, a, b, p.u), chord = curve_.length(b.u - a.u);
    return s > -1e-6 && s < 1.0 + 1e-6 && curve_.length(p.u - (a.u + s * (b.u - a.u))) < 0.5 * chord + 1e-12;
  };
  const auto has = [&](const Signature& s, const Signature& t) {
    const auto list = changes(s, t);
    return std::any_of(list.begin(), list.end(), [&](const EventKind& k) { return k.type == kind.type && k.block == kind.block; });
  };
  const bool has_system = curve_.problem().derivatives() >= 2;
  Sample middle;
  if (has_system && curve_.problem().is_flow()) {  // most often Newton needs no point of the curve to start from
    const double sigma = secant(a, b, crossing(kind, a, b));
    const bool ready = kind.type != EventType::hopf || curve_.peek(a, b, sigma, middle);
    if (kind.type != EventType::hopf) curve_.guess(a, b, sigma, middle);
    if (ready && special_point_near(curve_, kind, middle, out) && inside(out)) return true;
  }
  Sample lo = a, hi = b;
  double from = 0.0, to = 1.0;
  for (int i = 0; i < 48; ++i) {
    const double part = i % 3 == 2 ? 0.5 : std::clamp(secant(lo, hi, crossing(kind, lo, hi)), 0.05, 0.95);
    double sigma = from + part * (to - from);
    if (!between(a, b, sigma, middle)) {  // a secant may hit a branch point to the last digit, where no tangent is
      sigma = from + (part < 0.5 ? 1.1 : 0.9) * (sigma - from);
      if (!between(a, b, sigma, middle)) return false;
    }
    if (has_system && (i < 3 || i % 6 == 0) && special_point_near(curve_, kind, middle, out) && inside(out)) return true;
    if (has(lo.signature, middle.signature)) {
      hi = middle;
      to = sigma;
    } else {
      lo = middle;
      from = sigma;
    }
    const double width = curve_.length(hi.u - lo.u);
    if (width < 1e-13 || to - from < 1e-13) break;
  }
  if (has_system) return false;
  // No system of its own for want of second derivatives: the narrowed bracket is the answer.
  out = {};
  out.type = kind.type;
  out.block = kind.block;
  out.u = middle.u;
  out.tangent = middle.tangent;
  out.residual = middle.residual;
  out.subtype = kind.type == EventType::branch_point ? curve_.blocks().subtype[static_cast<std::size_t>(kind.block)] : "";
  return true;
}

// The event splits the step: signatures just before and behind it must show it, and what remains on either side is explained in turn.
bool EventFinder::accept(const EventKind& kind, const Sample& a, const Sample& b, SpecialPoint& point, int depth) {
  for (const auto& known : found_)
    if (known.type == point.type && known.block == point.block && curve_.length(known.u - point.u) < 1e-9) return false;
  const Vector chord = (b.u - a.u).normalized();
  const double unit = curve_.length(chord), span = curve_.length(b.u - a.u);
  for (double delta = std::min(1e-6, 0.01 * span); delta < 0.5 * span; delta *= 10.0) {
    Sample left, right;
    const Vector offset = (delta / unit) * chord;
    if (!curve_.sample(point.u - offset, chord, left)) continue;
    const int pairs_left = unstable_pairs(curve_.eigenvalues());
    if (!curve_.sample(point.u + offset, chord, right)) continue;
    const int pairs_right = unstable_pairs(curve_.eigenvalues());
    const auto shown = changes(left.signature, right.signature);
    const auto same = [&](const EventKind& k) { return k.type == kind.type && k.block == kind.block; };
    if (std::none_of(shown.begin(), shown.end(), same)) continue;
    point.unstable_before = left.signature.total_unstable();
    point.unstable_after = right.signature.total_unstable();
    // On a fold both sides lie on one side of it: the parameter itself closes the bracket.
    const double at = point.u[point.u.size() - 1], p = left.u[left.u.size() - 1], q = right.u[right.u.size() - 1];
    point.bracket[0] = std::min({at, p, q});
    point.bracket[1] = std::max({at, p, q});
    if (kind.type == EventType::fold) {
      point.tangent = (right.u - left.u) / curve_.length(right.u - left.u);
    } else {
      point.tangent = left.tangent;
    }
    found_.push_back(point);
    find_coincident(kind, point, left, right, delta, pairs_left, pairs_right);
    explain_rest(a, left, right, b, depth + 1);
    return true;
  }
  return false;
}

// Between far and near nothing changed, between near and beyond something passed zero. One look half way: what passed was on its way there all along,
// without a turn near zero, and the others come no nearer than they move.
bool EventFinder::quiet_beside(const Sample& far, const Sample& near, const Sample& beyond) {
  Sample middle;
  if (!look_half_way(far, near, middle) || changed(near.signature, middle.signature)) return false;
  const double way = curve_.length(near.u - far.u);
  return all_next_to_zero(near, [&](const TestFunction& t) {
    const Parabola f(0.0, value(far, t), 0.5 * way, value(middle, t), way, value(near, t));
    return value(near, t) * value(beyond, t) < 0.0 ? !f.turns_near_zero(0.0, way) : !f.comes_near_zero(0.0, way);
  });
}

// Half way between two points in either order; cheaply if it may be.
bool EventFinder::look_half_way(const Sample& a, const Sample& b, Sample& middle) {
  const bool onwards = curve_.dot(b.u - a.u, a.tangent) > 0.0;
  const Sample &first = onwards ? a : b, &last = onwards ? b : a;
  return curve_.problem().is_flow() ? curve_.peek(first, last, 0.5, middle) : between(first, last, 0.5, middle);
}

// What an event leaves of its step: from left of it back to a, from right of it on to b.
void EventFinder::explain_rest(const Sample& a, const Sample& left, const Sample& right, const Sample& b, int depth) {
  const double offset = 0.5 * curve_.length(right.u - left.u);
  const auto slope = [&](const TestFunction& t) { return (value(right, t) - value(left, t)) / (2.0 * offset); };
  if (changed(a.signature, left.signature)) explain(a, left, depth);
  else if (!quiet_rest(left, a, -offset, slope)) look_closer(a, a, left, beside(), true);
  if (changed(right.signature, b.signature)) explain(right, b, depth);
  else if (!quiet_rest(right, b, offset, slope)) look_closer(right, right, b, beside(), true);
}

// Between near, at `offset` from an event, and far nothing changed: one look half way. A function f that passes zero at the event must go on from
// there, f / (slope s), s the distance, keeping its sign and size, or it comes back. The others must not come nearer to zero than they move.
template <class Slope>
bool EventFinder::quiet_rest(const Sample& near, const Sample& far, double offset, const Slope& slope) {
  const double way = std::copysign(curve_.length(far.u - near.u), offset), s0 = offset, s1 = offset + 0.5 * way, s2 = offset + way;
  if (std::abs(way) < 1e-5) return true;
  Sample middle;
  if (!look_half_way(near, far, middle) || changed(near.signature, middle.signature)) return false;
  return all_next_to_zero(near, [&](const TestFunction& t) {
    const double at_event = value(near, t) - offset * slope(t), here = value(near, t), half = value(middle, t), there = value(far, t);
    if (std::abs(at_event) > 0.5 * std::abs(here))
      return !Parabola(s0, here, s1, half, s2, there).comes_near_zero(std::min(s0, s2), std::max(s0, s2));
    return Parabola(0.0, slope(t), s1, half / s1, s2, there / s2).keeps_size(std::min(0.0, s2), std::max(0.0, s2));
  });
}

// Other kinds at the same place: each has its own regular system.
void EventFinder::find_coincident(const EventKind& kind, const SpecialPoint& point, const Sample& left, const Sample& right, double delta,
                                  int pairs_left, int pairs_right) {
  const auto shown = changes(left.signature, right.signature);
  const auto is = [](const EventKind& k, EventType type) { return k.type == type; };
  const bool upright = turns_at_branch_point(shown, point);
  if (upright && is(kind, EventType::fold)) found_.pop_back();  // only the branch point itself is told
  for (const auto& other : shown) {
    SpecialPoint second;
    if ((other.type == kind.type && other.block == kind.block) || (upright && is(other, EventType::fold))) continue;
    if (special_point_near(curve_, other, left, second) && curve_.length(second.u - point.u) < 2.0 * delta) {
      copy_sides(point, second);
      found_.push_back(second);
    } else {
      report_unresolved(left, right);
    }
  }
  if (curve_.orbit()) return;
  // A real eigenvalue through zero changes the count by one and so hides a pair that crosses within the same delta.
  SpecialPoint pair;
  if (!is(kind, EventType::hopf) && pairs_left != pairs_right &&
      std::none_of(shown.begin(), shown.end(), [&](const EventKind& k) { return is(k, EventType::hopf); }) &&
      special_point_near(curve_, {EventType::hopf, kind.block}, left, pair) && curve_.length(pair.u - point.u) < 2.0 * delta) {
    copy_sides(point, pair);
    found_.push_back(pair);
  }
  if (is(kind, EventType::hopf)) find_further_pairs(kind, point, left, right, delta);
}

// A branch that leaves a pitchfork upright turns there: the parameter has an extremum, but r_p lies in the range of r_x. That is no fold.
bool EventFinder::turns_at_branch_point(const std::vector<EventKind>& shown, const SpecialPoint& point) const {
  const auto has = [&](EventType type) {
    return std::any_of(shown.begin(), shown.end(), [type](const EventKind& k) { return k.type == type && k.block == 0; });
  };
  return has(EventType::fold) && has(EventType::branch_point) && turns_upright(curve_, point);
}

void EventFinder::drop_turns_at_branch_points(std::vector<SpecialPoint>& special) const {
  constexpr double near = 1e-5;  // a hundredth of a short step
  std::vector<Vector> turns;
  for (const auto& p : special)
    if (p.type == EventType::branch_point && p.block == 0 &&
        std::any_of(special.begin(), special.end(), [&](const auto& q) { return q.type == EventType::fold && curve_.length(p.u - q.u) < near; }) &&
        turns_upright(curve_, p))
      turns.push_back(p.u);
  std::erase_if(special, [&](const SpecialPoint& q) {
    return q.type == EventType::fold && std::any_of(turns.begin(), turns.end(), [&](const Vector& u) { return curve_.length(u - q.u) < near; });
  });
}

// More than one pair crossed within delta: each has its own frequency. Pairs that share even that are told as unresolved.
void EventFinder::find_further_pairs(const EventKind& kind, const SpecialPoint& point, const Sample& left, const Sample& right, double delta) {
  const auto slot = static_cast<std::size_t>(kind.block);
  const bool turned = left.signature.negative[slot] != right.signature.negative[slot];
  int missing = (std::abs(right.signature.unstable[slot] - left.signature.unstable[slot]) - (turned ? 1 : 0)) / 2 - 1;
  if (missing <= 0) return;
  Matrix j(curve_.problem().size(), curve_.problem().size() + curve_.problem().parameters());
  curve_.problem().jacobian(point.u, j);
  const Indices& block = curve_.blocks().indices[slot];
  Eigen::VectorXcd z = Eigen::EigenSolver<Matrix>(Matrix(j(block, block)), false).eigenvalues();
  std::sort(z.begin(), z.end(), [](const auto& p, const auto& q) { return std::abs(p.real()) < std::abs(q.real()); });
  for (const auto& value : z) {
    SpecialPoint pair;
    if (missing == 0 || !(value.imag() > 0.0)) continue;
    if (!special_point_near(curve_, kind, left, pair, value.imag()) || curve_.length(pair.u - point.u) >= 2.0 * delta) continue;
    const bool known = std::any_of(found_.begin(), found_.end(), [&](const SpecialPoint& p) {
      return p.type == pair.type && p.block == pair.block && std::abs(p.frequency - pair.frequency) < 1e-6 * p.frequency &&
             curve_.length(p.u - pair.u) < 2.0 * delta;
    });
    if (known) continue;
    copy_sides(point, pair);
    found_.push_back(pair);
    --missing;
  }
  if (missing > 0) report_unresolved(left, right);
}

}  // namespace whirl::continuation
