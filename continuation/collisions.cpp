#include "continuation/collisions.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "continuation/parabola.hpp"
#include "continuation/turning.hpp"

namespace whirl::continuation {
namespace {

using Kind = Collision::Kind;
constexpr double pi = std::numbers::pi;
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

double meeting_angle(Kind kind) { return kind == Kind::at_minus_one ? pi : 0.0; }

// Where the parabola through (-behind, f0), (0, f1), (ahead, f2) is zero, next to `s`; without f0 the chord.
double root_near(double s, double behind, double ahead, double f0, double f1, double f2) {
  if (!std::isfinite(f0) || !(behind > 0.0)) return f1 * ahead / (f1 - f2);
  const double left = (f1 - f0) / behind, right = (f2 - f1) / ahead, curvature = (right - left) / (behind + ahead), slope = right - curvature * ahead;
  for (int i = 0; i < 4; ++i) s -= (f1 + s * (slope + s * curvature)) / (slope + 2.0 * s * curvature);
  return s;
}

template <class Knots>
Parabola through(const Knots& k) {
  return {k[0].s, k[0].value, k[1].s, k[1].value, k[2].s, k[2].value};
}

const MultiplierPair& pair_of(const Sample& s, int i) { return s.pairs[static_cast<std::size_t>(i)]; }

}  // namespace

void CollisionSearch::follow(const Sample& before, const Sample& a, Sample& b) {
  pairing_.follow(a.pairs, stretch_of_turn(curve_, before, a, b), b.pairs);
  b.settled.clear();
}

// Distance of the two, squared; negative: they have met and stand so far apart on the axis.
double CollisionSearch::gap_squared(const Suspect& c, const MultiplierPair& p, const MultiplierPair& q) const {
  const double gap = c.kind == Kind::of_two_pairs ? p.angle - q.angle : p.angle - meeting_angle(c.kind);
  return c.kind != Kind::of_two_pairs && gap == 0.0 ? -p.split * p.split : gap * gap;
}

double CollisionSearch::value(const Suspect& c, const MultiplierPair& p, const MultiplierPair& q) const {
  const double gap = gap_squared(c, p, q), sum = p.growth + q.growth;
  if (c.kind != Kind::of_two_pairs) return p.growth * p.growth + gap;
  return 4.0 * p.growth * q.growth * (1.0 + gap / (sum * sum));
}

double CollisionSearch::value_at(const Suspect& c, const Sample& s, int Track::*point) const {
  if (c.first.*point < 0 || c.second.*point < 0) return unknown;
  return value(c, pair_of(s, c.first.*point), pair_of(s, c.second.*point));
}

bool CollisionSearch::suspects(const Sample& before, const Sample& a, const Sample& b, bool last) {
  steps_ = {&before, &a, &b, curve_.length(a.u - before.u), curve_.length(b.u - a.u)};
  suspects_.clear();
  if (steps_.ahead > 0.0) list_suspects(last);
  return !suspects_.empty();
}

void CollisionSearch::list_suspects(bool last) {
  const auto& pairs = steps_.b->pairs;
  const auto track = [&](std::size_t j) {
    const int from = pairs[j].from;
    return Track{from < 0 ? -1 : pair_of(*steps_.a, from).from, from, static_cast<int>(j)};
  };
  for (std::size_t j = 0; j < pairs.size(); ++j) {
    const Track t = track(j);
    if (t.a < 0 || std::abs(pairs[j].growth) < options_.neutral) continue;
    suspect_pair(t, Kind::at_one, last);
    suspect_pair(t, Kind::at_minus_one, last);
    for (std::size_t k = j + 1; k < pairs.size() && pairs[k].group == pairs[j].group; ++k)
      if (const Track u = track(k); u.a >= 0 && std::abs(pairs[k].growth) >= options_.neutral) suspect_two(t, u, last);
  }
}

// Of one sign at all three points and nearest to zero at a, nearer than it moves.
bool CollisionSearch::turns(const Suspect& c, double moved_before, double moved_behind) const {
  const double past = value_at(c, *steps_.before, &Track::before), from = value_at(c, *steps_.a, &Track::a), to = value_at(c, *steps_.b, &Track::b);
  if (!(past * from > 0.0 && from * to > 0.0 && std::abs(from) <= std::abs(past) && std::abs(from) <= std::abs(to))) return false;
  if (from < 0.0) return -from < std::max(std::abs(from - past), std::abs(to - from));
  const double gap = gap_squared(c, pair_of(*steps_.a, c.first.a), pair_of(*steps_.a, c.second.a)),
               moved = std::max(std::abs(moved_before), std::abs(moved_behind));
  return gap <= moved * moved;
}

void CollisionSearch::suspect_pair(const Track& t, Kind kind, bool last) {
  const MultiplierPair &p = pair_of(*steps_.a, t.a), &q = pair_of(*steps_.b, t.b);
  Suspect c{kind, t, t, unknown};
  // Angles in the direction in which they go on at a; the first one to meet at, on the way or, if it turned there, behind.
  const double way = q.reached - p.angle, half_turn = kind == Kind::at_minus_one ? 1.0 : 0.0;
  const auto next = [&](double from, double to) {  // angle 2 pi k + theta_c between the two
    const double k = to > from ? std::ceil((from / pi - half_turn) / 2.0) : std::floor((from / pi - half_turn) / 2.0),
                 at = (2.0 * k + half_turn) * pi;
    return (at - from) * (at - to) < 0.0 ? at : unknown;
  };
  const double before = t.before < 0 ? unknown : p.angle - p.last_turn, met = next(p.angle, q.reached), was_met = next(p.angle, before);
  const double at = std::isfinite(met) ? met : was_met;
  if (std::isfinite(at)) {
    const double linear = std::isfinite(met) ? steps_.ahead * (at - p.angle) / way : steps_.behind * (at - p.angle) / p.last_turn;
    c.guess = root_near(linear, steps_.behind, steps_.ahead, before - at, p.angle - at, q.reached - at);
  }
  const double from = value_at(c, *steps_.a, &Track::a), to = value_at(c, *steps_.b, &Track::b);
  const bool known = std::find(steps_.a->settled.begin(), steps_.a->settled.end(), Collision{kind, t.a, t.a}) != steps_.a->settled.end();
  const bool passes = std::isfinite(met) && !p.real() && !q.real() && from > 0.0 && to > 0.0;
  const bool may_have = last && from * to > 0.0 && gap_squared(c, q, q) < q.last_turn * q.last_turn;
  if (passes || may_have || (!known && turns(c, p.last_turn, q.last_turn))) suspects_.push_back(c);
}

void CollisionSearch::suspect_two(const Track& t, const Track& u, bool last) {
  const MultiplierPair &p = pair_of(*steps_.a, t.a), &q = pair_of(*steps_.a, u.a), &r = pair_of(*steps_.b, t.b), &s = pair_of(*steps_.b, u.b);
  if (p.real() || q.real() || r.real() || s.real()) return;
  Suspect c{Kind::of_two_pairs, t, u, unknown};
  const double from = p.angle - q.angle, to = r.angle - s.angle;
  const bool has_before = t.before >= 0 && u.before >= 0;
  const double past = has_before ? pair_of(*steps_.before, t.before).angle - pair_of(*steps_.before, u.before).angle : unknown;
  const double h1 = steps_.behind, h2 = steps_.ahead, moved = std::abs(to - from);
  const bool crosses = from * to < 0.0,
             known = std::find(steps_.a->settled.begin(), steps_.a->settled.end(), Collision{c.kind, t.a, u.a}) != steps_.a->settled.end();
  if (crosses) c.guess = root_near(h2 * from / (from - to), h1, h2, past, from, to);
  else if (past * from < 0.0) c.guess = root_near(h1 * from / (past - from), h1, h2, past, from, to);
  const bool stable = value_at(c, *steps_.a, &Track::a) > 0.0 && value_at(c, *steps_.b, &Track::b) > 0.0;
  const bool may_have = last && stable && std::abs(to) < 0.5 * moved;
  if ((crosses && stable) || may_have || (!known && turns(c, from - past, moved))) suspects_.push_back(c);
}

// Root of half the second derivative of F: how fast the two approach.
double CollisionSearch::speed(const Suspect& c) const {
  const MultiplierPair &p = pair_of(*steps_.a, c.first.a), &q = pair_of(*steps_.a, c.second.a), &r = pair_of(*steps_.b, c.first.b),
                       &s = pair_of(*steps_.b, c.second.b);
  const bool two = c.kind == Kind::of_two_pairs;
  const double ahead = std::abs(r.last_turn - (two ? s.last_turn : 0.0)) / steps_.ahead;
  const double behind = steps_.behind > 0.0 ? std::abs(p.last_turn - (two ? q.last_turn : 0.0)) / steps_.behind : 0.0;
  const double share = two ? 2.0 * std::sqrt(std::abs(p.growth * q.growth)) / std::abs(p.growth + q.growth) : 1.0;
  const double fast = std::max(ahead, behind), slow = std::min(ahead, behind);
  return share * (slow > 0.5 * fast ? 0.5 * (slow + fast) : fast);
}

// Where the pair of a track is among those of a point at part sigma of the step between two points.
int CollisionSearch::find(const Track& track, const Sample& from, const Sample& to, bool ahead, double sigma, const Sample& at) {
  const int end = ahead ? track.b : track.a, group = pair_of(to, end).group;
  std::size_t which = 0;
  expected_.clear();
  for (std::size_t i = 0; i < to.pairs.size(); ++i) {
    const MultiplierPair& p = to.pairs[i];
    if (p.group != group || p.from < 0) continue;
    if (static_cast<int>(i) == end) which = expected_.size();
    const double start = pair_of(from, p.from).angle;
    expected_.push_back(start + sigma * (p.reached - start));
  }
  return pairing_.find(expected_, which, group, at.pairs);
}

bool CollisionSearch::evaluate(const Suspect& c, double s, Knot& out) {
  const bool ahead = s > 0.0;
  const Sample &from = ahead ? *steps_.a : *steps_.before, &to = ahead ? *steps_.b : *steps_.a;
  const double length = ahead ? steps_.ahead : steps_.behind, sigma = ahead ? s / length : 1.0 + s / length;
  out.s = s;
  ++samples_;
  curve_.guess(from, to, sigma, guess_);
  if (!curve_.between(from, to, sigma, out.sample) || curve_.length(out.sample.u - guess_.u) > options_.off_curve * length) {
    passed_over_ = passed_over_ || ahead;
    return false;
  }
  const int p = find(c.first, from, to, ahead, sigma, out.sample);
  const int q = c.kind == Kind::of_two_pairs ? find(c.second, from, to, ahead, sigma, out.sample) : p;
  if (p < 0 || q < 0) return false;
  out.value = value(c, pair_of(out.sample, p), pair_of(out.sample, q));
  out.gap = std::sqrt(std::max(0.0, gap_squared(c, pair_of(out.sample, p), pair_of(out.sample, q))));
  return true;
}

void CollisionSearch::insert(Knot&& knot) {
  const auto place = std::find_if(knots_.begin(), knots_.end(), [&](const Knot& k) { return k.s > knot.s; });
  knots_.insert(place, std::move(knot));
}

// From the samples so far, the best one first: to one side, then on a parabola of known curvature, then on one through three.
CollisionSearch::Place CollisionSearch::next_place(double speed) const {
  const Place& best = places_[0];
  if (places_.size() == 1) {
    const double away = std::max(best.gap, 0.3 * std::sqrt(best.value)) / speed;
    return {best.s + (best.s + away < knots_.back().s ? away : -away), unknown, 0.0};
  }
  const Place& second = places_[1];
  if (places_.size() == 2) {
    const double s = 0.5 * (best.s + second.s) - 0.5 * (second.value - best.value) / (speed * speed * (second.s - best.s));
    return {s, best.value - std::pow(speed * (best.s - s), 2), 0.0};
  }
  std::array<Place, 3> near{best, second, places_[2]};
  std::sort(near.begin(), near.end(), [](const Place& a, const Place& b) { return a.s < b.s; });
  const Parabola f(near[0].s, near[0].value, near[1].s, near[1].value, near[2].s, near[2].value);
  if (const double s = f.turn(); std::isfinite(s) && f.at(s) <= best.value) return {s, f.at(s), 0.0};
  return {best.s + (best.s < second.s ? -1.0 : 1.0) * std::abs(best.s - second.s), unknown, 0.0};
}

CollisionSearch::Verdict CollisionSearch::minimise(const Suspect& c, double speed) {
  places_.clear();
  const double lower = knots_.front().s, upper = knots_.back().s;
  Place next{c.guess, unknown, 0.0};
  if (knots_.size() == 3) {
    const Parabola f = through(knots_);
    if (!(next.s > lower && next.s < upper)) next.s = f.turn();
    next.value = sign_ * f.at(f.turn());
  }
  if (!(next.s > lower && next.s < upper)) next.s = 0.5 * upper;
  int outside = 0;
  for (int i = 0; i < options_.most_samples; ++i) {
    Knot knot{};
    if (!evaluate(c, next.s, knot)) return Verdict::undecided;
    const Place now{knot.s, sign_ * knot.value, knot.gap};
    insert(std::move(knot));
    if (now.value < 0.0) {
      places_.insert(places_.begin(), now);
      return Verdict::events;
    }
    places_.insert(std::find_if(places_.begin(), places_.end(), [&](const Place& p) { return p.value > now.value; }), now);
    if (now.s == places_[0].s && std::abs(now.value - next.value) <= options_.agreement * now.value) return Verdict::none;
    next = next_place(speed);
    const double same = options_.nothing_new * std::sqrt(places_[0].value) / speed;
    if (std::abs(next.s - places_[0].s) < same && next.value > 0.5 * places_[0].value) return Verdict::none;
    if (next.s > lower && next.s < upper) continue;
    if (++outside > 2) return Verdict::elsewhere;
    const double end = next.s >= upper ? upper : lower;
    next = {0.5 * (places_[0].s + end), unknown, 0.0};
  }
  return Verdict::undecided;
}

// The point on which F has changed its sign, and on either side the nearest where it has not: as near as the parabola says, lest other events
// come between.
void CollisionSearch::keep_sides(const Suspect& c, double speed) {
  const Place inside = places_[0];
  const double half = std::sqrt(std::abs(inside.value)) / speed;
  const auto at_inside = [&] { return std::find_if(knots_.begin(), knots_.end(), [&](const Knot& k) { return k.s == inside.s; }); };
  keep(*at_inside());
  for (const double side : {-1.0, 1.0}) {
    double away = 2.0 * half;
    for (int i = 0; i < options_.most_samples; ++i, away *= 2.0) {
      auto neighbour = at_inside();
      do side < 0.0 ? --neighbour : ++neighbour;
      while (sign_ * neighbour->value < 0.0);  // the ends have the sign of a
      const double s = inside.s + side * away;
      Knot knot{};
      if (side * (neighbour->s - s) < away || s * inside.s <= 0.0 || !evaluate(c, s, knot)) {
        keep(*neighbour);
        break;
      }
      insert(std::move(knot));
    }
  }
}

void CollisionSearch::keep(const Knot& knot) {
  if (knot.s <= -steps_.behind || knot.s == 0.0 || knot.s >= steps_.ahead) return;
  kept_.emplace_back(knot.s, knot.sample);
}

// What has met behind b goes away from there now.
void CollisionSearch::settle(const Suspect& c, Sample& b) const {
  b.settled.push_back({c.kind, c.first.b, c.second.b});
  double& turn = b.pairs[static_cast<std::size_t>(c.first.b)].last_turn;
  if (c.kind == Kind::at_one) turn = std::abs(turn);
  if (c.kind == Kind::at_minus_one) turn = -std::abs(turn);
}

void CollisionSearch::search(const Sample& before, const Sample& a, Sample& b, bool last) {
  behind_.clear();
  ahead_.clear();
  kept_.clear();
  passed_over_ = false;
  if (!suspects(before, a, b, last)) return;
  for (const Suspect& c : suspects_) {
    knots_.clear();
    sign_ = value_at(c, a, &Track::a) > 0.0 ? 1.0 : -1.0;
    if (const double past = value_at(c, before, &Track::before); sign_ * past > 0.0) knots_.push_back({-steps_.behind, past, 0.0, {}});
    knots_.push_back({0.0, value_at(c, a, &Track::a), 0.0, {}});
    knots_.push_back({steps_.ahead, value_at(c, b, &Track::b), 0.0, {}});
    double fast = speed(c);
    if (fast == 0.0 && knots_.size() == 3) fast = std::sqrt(std::max(0.0, sign_ * through(knots_).curvature()));  // on the axis all along
    if (!(fast > 0.0)) continue;
    switch (minimise(c, fast)) {
      case Verdict::events:
        keep_sides(c, fast);
        [[fallthrough]];
      case Verdict::none:
        settle(c, b);
        break;
      case Verdict::undecided:
        ++undecided_;
        break;
      case Verdict::elsewhere:
        break;
    }
    if (passed_over_) break;
  }
  std::sort(kept_.begin(), kept_.end(), [](const auto& p, const auto& q) { return p.first < q.first; });
  for (auto& [s, sample] : kept_) (s < 0.0 ? behind_ : ahead_).push_back(std::move(sample));
}

}  // namespace whirl::continuation
