#include "models/sweeps.hpp"

#include <fmt/format.h>

#include <cmath>

namespace whirl::models {
namespace {

class Sweeper {
 public:
  Sweeper(const std::function<ModalSystem<double>(double)>& at, const SweepOptions& o) : at_(at), o_(o) {}

  SweepPoint settle(double p, const Vector& from) const {
    AttractorFinder finder(at_(p), o_.settle);
    Vector y = from;
    const Eigen::Index n = y.size() / 2;
    for (Eigen::Index i = 0; i < n; ++i)
      if (std::abs(y[i]) < o_.perturbation && std::abs(y[n + i]) < o_.perturbation) y[i] += o_.perturbation;
    SweepPoint point;
    point.p = p;
    point.settled = finder.settle(y, AttractorSet());
    Attractor a;
    if (point.settled.fresh) a = *point.settled.fresh;
    else {
      a.kind = point.settled.kind;
      a.points = point.settled.state;
    }
    point.rms = Vector::Constant(n, std::nan(""));
    if (a.kind == MotionKind::diverging || a.kind == MotionKind::failed) return point;
    point.motion = finder.motion(a, o_.samples, o_.periods);
    const auto q = point.motion.record.topRows(n);
    point.rms = ((q.colwise() - q.rowwise().mean()).rowwise().squaredNorm() / static_cast<double>(q.cols())).cwiseSqrt();
    return point;
  }

  // What cannot change smoothly: kind, multiple, coordinates at rest.
  static bool alike(const SweepPoint& a, const SweepPoint& b) {
    if (a.settled.kind != b.settled.kind || a.motion.multiple != b.motion.multiple) return false;
    for (Eigen::Index i = 0; i < a.rms.size(); ++i)
      if (at_rest(a, i) != at_rest(b, i)) return false;
    return true;
  }
  static bool at_rest(const SweepPoint& a, Eigen::Index i) { return a.rms[i] < 1e-5 * (1e-3 + a.rms.maxCoeff()); }
  std::string name_of_coordinate(Eigen::Index i) const {
    return static_cast<std::size_t>(i) < o_.names.size() ? o_.names[static_cast<std::size_t>(i)] : fmt::format("q{}", i + 1);
  }
  static double apart(const SweepPoint& a, const SweepPoint& b) {
    return (a.rms - b.rms).norm() / std::max({a.rms.maxCoeff(), b.rms.maxCoeff(), 1e-300});
  }
  static bool ended(const SweepPoint& p) { return p.settled.kind == MotionKind::diverging || p.settled.kind == MotionKind::failed; }
  bool changed(const SweepPoint& a, const SweepPoint& b) const { return !alike(a, b) || apart(a, b) > o_.jump; }

  // Halves [a, b] from the motion at a; what is left decides whether there is a jump at all.
  std::optional<SweepTransition> locate(SweepPoint a, SweepPoint b) const {
    const double width = std::abs(b.p - a.p), gap = apart(a, b);
    while (std::abs(b.p - a.p) > o_.tolerance) {
      const double p = 0.5 * (a.p + b.p);
      if (p == a.p || p == b.p || (o_.settle.interrupted && *o_.settle.interrupted)) break;
      SweepPoint middle = settle(p, a.settled.state);
      if (middle.settled.kind == MotionKind::unsettled) break;  // critically slow: the bracket stays as wide as what could be decided
      const bool before = !ended(middle) && alike(a, middle) && (!alike(b, middle) || apart(a, middle) <= apart(b, middle));
      (before ? a : b) = std::move(middle);
    }
    if (!ended(b) && !changed(a, b)) return std::nullopt;  // steep, not broken
    // Where a motion is born its amplitude grows as the root of the distance; a jump is as large in a bracket ten times narrower.
    const bool lasts = apart(a, b) > o_.jump && apart(a, b) > 0.5 * gap && std::abs(b.p - a.p) < 0.1 * width;
    SweepTransition t{a.p, b.p, ended(b) || lasts, "", a.rms, b.rms};
    t.what = t.jump ? "jump" : "change";
    const std::string from = name_of(a.settled.kind, a.motion.multiple), to = name_of(b.settled.kind, b.motion.multiple);
    t.what += from == to ? ", " + from : fmt::format(", {} -> {}", from, to);
    for (Eigen::Index i = 0; i < a.rms.size() && !ended(b); ++i)
      if (at_rest(a, i) != at_rest(b, i)) t.what += fmt::format(", {} {}", name_of_coordinate(i), at_rest(a, i) ? "starts" : "stops");
    return t;
  }

 private:
  const std::function<ModalSystem<double>(double)>& at_;
  const SweepOptions& o_;
};

}  // namespace

std::string name_of(MotionKind kind, int multiple) {
  return multiple > 1 ? fmt::format("{} {}T", to_string(kind), multiple) : std::string(to_string(kind));
}

void SweepOptions::validate() const {
  settle.validate();
  if (!(tolerance > 0.0) || !(jump > 0.0) || !(perturbation >= 0.0) || samples < 8 || periods < 1)
    throw std::invalid_argument("a sweep needs tolerance, jump > 0, perturbation >= 0, samples >= 8, periods >= 1");
}

Sweep sweep(const std::function<ModalSystem<double>(double)>& at, const std::vector<double>& values, const Vector& start, const SweepOptions& o) {
  o.validate();
  const Sweeper sweeper(at, o);
  Sweep s;
  Vector from = start;
  for (const double p : values) {
    if (o.observer && !o.observer(p)) {
      s.why = "stopped";
      break;
    }
    SweepPoint point = sweeper.settle(p, from);
    if (point.settled.why == "interrupted") {
      s.why = "stopped";
      break;
    }
    if (!s.points.empty() && sweeper.changed(s.points.back(), point))
      if (auto t = sweeper.locate(s.points.back(), point)) s.transitions.push_back(std::move(*t));
    if (Sweeper::ended(point)) {
      s.why = fmt::format("{} at {:g}: {}", to_string(point.settled.kind), p, point.settled.why);
      break;
    }
    from = point.settled.state;
    s.points.push_back(std::move(point));
  }
  return s;
}

}  // namespace whirl::models
