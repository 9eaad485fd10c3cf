#include "studies/compare_levels.hpp"

#include <fmt/format.h>

#include "core/kinsol.hpp"

namespace whirl::studies {

using namespace continuation;
using namespace models;

namespace {

// A name for what changes, the same at all levels: a torus of the motion is a Hopf point of its averaged equations.
std::string kind_of(const SpecialPoint& s) {
  if (s.type == EventType::branch_point) return s.subtype.empty() ? "BP" : s.subtype;
  if (s.type == EventType::hopf || s.type == EventType::torus) return "HB/TR";
  return to_string(s.type);
}

bool is_compared(const Branch& b, std::size_t i) {
  const SpecialPoint& s = b.special[i];
  if (s.type == EventType::user_value || s.type == EventType::peak || s.type == EventType::end) return false;
  return !(b.stop_reason == StopReason::symmetric_branch && i + 1 == b.special.size());  // an arrival stands on the other branch
}

std::unique_ptr<Network> network(const SlowFlow& flow, const NetworkOptions& options, RunContext& context, const std::string& words) {
  auto net = std::make_unique<Network>(flow, options);
  net->set_namer([](const Branch& b) { return b.active_reflections.empty() ? "W" : "IP"; });
  net->set_observer([&context, words](const Branch& b, int i) {
    if (i % 50 == 0) context.progress.show(fmt::format("{}: branch at {:.5g}, {} points", words, b.parameter(i), i));
    return !interrupted;
  });
  return net;
}

void seed(Network& net, const SlowFlow& flow, const Vector& start, const std::string& origin) {
  if (net.stopped()) return;
  NewtonResult at = newton(flow, start);
  if (!at.ok()) at = line_search_solve(flow, start);
  if (at.ok() && at.x.allFinite()) net.add_seed(at.x, origin);
}

double amplitude_of(const HarmonicBalance& hb, In u, int i, int order) {
  const int h = order * hb.nu();
  return h > hb.harmonics() ? 0.0 : std::hypot(u[hb.index(i, h)], u[hb.index(i, h) + 1]);
}

// The harmonics of an exact motion that the ansatz keeps, as a start.
Vector projected(const SlowFlow& flow, const HarmonicBalance& hb, In u) {
  const Ansatz& a = flow.ansatz();
  Vector x = Vector::Zero(flow.size() + flow.parameters());
  x.tail(flow.parameters()) = u.tail(flow.parameters());
  for (int i = 0; i < a.coordinates(); ++i)
    for (const int k : a.harmonics[static_cast<std::size_t>(i)]) {
      if (k * hb.nu() % a.nu != 0) continue;
      const int h = k * hb.nu() / a.nu, at = a.index(i, k);
      if (h > hb.harmonics()) continue;
      x[at] = u[hb.index(i, h)];
      if (k > 0) x[at + 1] = -u[hb.index(i, h) + 1];
    }
  return x;
}

void walk_averaged(AveragedLevel& level, const Levels& levels, const ClosedForms& closed_forms, RunContext& context) {
  const auto& walk = levels.options.orbits.network.walk;
  level.net = network(*level.flow, levels.options.orbits.network, context, level.name);
  const int grid = levels.options.orbits.seed_grid;
  for (int i = 0; i < grid; ++i) {
    const double p = walk.lower + (walk.upper - walk.lower) * (grid == 1 ? 0.5 : static_cast<double>(i) / (grid - 1));
    seed(*level.net, *level.flow, level.flow->linear_response(Vector::Constant(1, p)), fmt::format("linear response at {:.6g}", p));
    if (i == 0) level.net->switch_branches();
    if (closed_forms)
      for (const Vector& x : closed_forms(p)) {
        Vector u(x.size() + 1);
        u << x, p;
        seed(*level.net, *level.flow, u, fmt::format("closed form at {:.6g}", p));
      }
    for (const auto& motion : levels.exact->motions_at(p))
      if (motion.level == 0)
        seed(*level.net, *level.flow, projected(*level.flow, levels.exact->balance(0), motion.u), fmt::format("exact motion at {:.6g}", p));
  }
  level.net->switch_branches();
}

}  // namespace

Amplitudes AveragedLevel::amplitudes(In u, int order) const {
  const Ansatz& a = flow->ansatz();
  Amplitudes z(a.coordinates());
  for (int i = 0; i < a.coordinates(); ++i) z[i] = std::abs(amplitude(a, u.head(a.size()), i, order * a.nu));
  return z;
}

Amplitudes Levels::exact_amplitudes(In u) const {
  const HarmonicBalance& hb = exact->balance_of(u);
  Amplitudes z(hb.coordinates());
  for (int i = 0; i < hb.coordinates(); ++i) z[i] = amplitude_of(hb, u, i, options.order);
  return z;
}

Levels walk_levels(const ForcedSystem& source, const CompareOptions& options, const ClosedForms& closed_forms, RunContext& context,
                   bool with_complete) {
  Levels levels;
  levels.options = options;
  const int n = static_cast<int>(source.coordinates.size());
  levels.exact = std::make_unique<OrbitBranches>(source, options.orbits, context);
  levels.exact->find();
  levels.frozen = {"frozen", std::make_unique<SlowFlow>(source.system, Ansatz::superharmonic(n, options.order), source.reflections), nullptr};
  walk_averaged(levels.frozen, levels, closed_forms, context);
  if (!with_complete) return levels;
  const Ansatz complete = Ansatz::complete(n, std::max(options.complete_harmonics, options.order));
  levels.complete = {"complete", std::make_unique<SlowFlow>(source.system, complete, source.reflections), nullptr};
  walk_averaged(levels.complete, levels, {}, context);
  return levels;
}

std::vector<LevelPoint> points_of(const Levels& levels, const std::string& name) {
  std::vector<LevelPoint> found;
  const auto add = [&](const Branch& b, const auto& amplitudes) {
    for (std::size_t i = 0; i < b.special.size(); ++i)
      if (is_compared(b, i))
        found.push_back({name, b.name, fmt::format("{}:{}", b.name, kind_of(b.special[i])), kind_of(b.special[i]),
                         b.special[i].u[b.special[i].u.size() - 1], amplitudes(b.special[i].u)});
  };
  if (name == "exact") {
    for (const Branch& b : levels.exact->all()) add(b, [&](In u) { return levels.exact_amplitudes(u); });
    return found;
  }
  const AveragedLevel& level = name == "frozen" ? levels.frozen : levels.complete;
  if (level.net)
    for (const Branch& b : level.net->branches()) add(b, [&](In u) { return level.amplitudes(u, levels.options.order); });
  return found;
}

std::string Match::words() const {
  const int count = static_cast<int>(frozen.has_value()) + static_cast<int>(complete.has_value()) + static_cast<int>(exact.has_value());
  if (count == 3) return "all";
  if (count == 1) return frozen ? "only frozen" : complete ? "only complete" : "only exact";
  return !frozen ? "not frozen" : !complete ? "not complete" : "not exact";
}

namespace {

// Index in `others` of the partner of `point`, -1: none. Mutual nearest neighbours of one kind, moving out of plane or not alike.
using Distance = std::function<double(const LevelPoint&, const LevelPoint&)>;

int nearest_to(const LevelPoint& point, const std::vector<LevelPoint>& others, const Distance& distance) {
  int best = -1;
  for (std::size_t i = 0; i < others.size(); ++i)
    if (std::isfinite(distance(point, others[i])) &&
        (best < 0 || distance(point, others[i]) < distance(point, others[static_cast<std::size_t>(best)])))
      best = static_cast<int>(i);
  return best;
}

std::vector<int> partners(const std::vector<LevelPoint>& from, const std::vector<LevelPoint>& to, const Distance& distance, double reach) {
  std::vector<int> found(from.size(), -1);
  for (std::size_t i = 0; i < from.size(); ++i) {
    const int k = nearest_to(from[i], to, distance);
    if (k < 0 || distance(from[i], to[static_cast<std::size_t>(k)]) > reach) continue;
    if (nearest_to(to[static_cast<std::size_t>(k)], from, distance) == static_cast<int>(i)) found[i] = k;
  }
  return found;
}

}  // namespace

std::vector<Match> match_points(const Levels& levels, double reach) {
  const auto exact = points_of(levels, "exact"), frozen = points_of(levels, "frozen"), complete = points_of(levels, "complete");
  // A tenth of the frequency weighs as much as the whole amplitude.
  const Distance distance = [](const LevelPoint& a, const LevelPoint& b) {
    if (a.kind != b.kind) return std::numeric_limits<double>::infinity();
    const double size = std::max({a.amplitudes.norm(), b.amplitudes.norm(), 1e-300});
    return std::hypot(10.0 * (a.p - b.p) / std::max(std::abs(a.p), std::abs(b.p)), (a.amplitudes - b.amplitudes).norm() / size);
  };
  const auto to_frozen = partners(exact, frozen, distance, reach), to_complete = partners(exact, complete, distance, reach);
  std::vector<bool> frozen_used(frozen.size()), complete_used(complete.size());
  std::vector<Match> matches;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    Match m{exact[i].kind, std::nullopt, std::nullopt, exact[i]};
    if (to_frozen[i] >= 0) {
      m.frozen = frozen[static_cast<std::size_t>(to_frozen[i])];
      frozen_used[static_cast<std::size_t>(to_frozen[i])] = true;
    }
    if (to_complete[i] >= 0) {
      m.complete = complete[static_cast<std::size_t>(to_complete[i])];
      complete_used[static_cast<std::size_t>(to_complete[i])] = true;
    }
    matches.push_back(std::move(m));
  }
  for (std::size_t i = 0; i < frozen.size(); ++i)
    if (!frozen_used[i]) matches.push_back({frozen[i].kind, frozen[i], std::nullopt, std::nullopt});
  for (std::size_t i = 0; i < complete.size(); ++i)
    if (!complete_used[i]) matches.push_back({complete[i].kind, std::nullopt, complete[i], std::nullopt});
  return matches;
}

namespace {

// Those that whirling moves; the first where no reflection tells.
std::vector<int> coordinates_out_of_plane(const ForcedSystem& s) {
  std::vector<int> odd;
  for (const auto& r : s.reflections)
    for (std::size_t i = 0; r.subtype == "WH" && i < r.signs.size(); ++i)
      if (r.signs[i] < 0) odd.push_back(static_cast<int>(i));
  return odd.empty() ? std::vector<int>{0} : odd;
}

}  // namespace

CellError error_at(const Levels& levels, double p) {
  const int order = levels.options.order;
  const AveragedLevel& level = levels.frozen;
  std::vector<Amplitudes> averaged, exact;
  for (const auto& [branch, u] : level.net->solutions_at(p))
    if (level.net->unstable_at(branch, u) == 0) averaged.push_back(level.amplitudes(u, order));
  for (const auto& motion : levels.exact->motions_at(p))
    if (motion.stable) exact.push_back(levels.exact_amplitudes(motion.u));
  CellError cell{std::nan(""), 0.0, false};
  const auto out_of_plane = coordinates_out_of_plane(levels.exact->source());
  const auto moving = [&](const std::vector<Amplitudes>& all) {
    return std::count_if(all.begin(), all.end(),
                         [&](const auto& z) { return std::any_of(out_of_plane.begin(), out_of_plane.end(), [&](int i) { return z[i] > 1e-9; }); });
  };
  cell.same_kinds = averaged.size() == exact.size() && moving(averaged) == moving(exact);
  for (const auto& z : exact) {
    double nearest = z.norm();  // no stable averaged motion at all: an error of one
    for (const auto& a : averaged) nearest = std::min(nearest, (a - z).norm());
    const double error = z.norm() > 0.0 ? nearest / z.norm() : 0.0;
    if (!(error <= cell.error)) cell = {error, z.norm(), cell.same_kinds};
  }
  return cell;
}

}  // namespace whirl::studies
