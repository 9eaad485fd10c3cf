#include "studies/compare_study.hpp"

#include <fmt/format.h>

#include <numeric>

#include "core/parallel.hpp"
#include "models/closed_forms.hpp"
#include "models/sweeps.hpp"
#include "studies/branch_output.hpp"
#include "studies/common_keys.hpp"
#include "studies/compare_levels.hpp"

namespace whirl::studies {
namespace {

using namespace models;
using continuation::Branch;

struct Setup {
  CompareOptions levels;
  int sweep_points = 0;
  double sweep_tolerance = 1e-4;
  std::string second;  // of the map
  std::vector<double> second_values;
  int map_points = 25;
  double tolerance = 0.1;
};

Schema schema() {
  Schema s("compare", "averaged, exact and integrated motions side by side: special points matched, and how far the averaged curve can be trusted");
  add_forced_system_keys(s);
  add_continuation_keys(s, "omega");
  s.add_count("response.order", "superharmonic order n: amplitudes of n omega are compared", 2, 1, 50);
  s.add_count("compare.harmonics", "harmonics 0..H of the complete ansatz", 8, 1, 60);
  s.add({.name = "compare.tolerance",
         .description = "relative error up to which the averaged amplitude counts as trustworthy",
         .default_value = 0.1,
         .lower = 0.0,
         .upper = 10.0});
  s.add_count("seeds.grid", "frequencies at which motions of one level start branches of another", 13, 1, 10000);
  s.add_count("sweep.points", "frequencies of the integrated sweeps up and down; 0: none", 61, 0, 100000);
  s.add({.name = "sweep.tolerance",
         .unit = "rad/s",
         .description = "width to which an integrated jump is bisected",
         .default_value = 1e-4,
         .lower = 0.0,
         .upper = 1.0});
  s.add({.name = "map.parameter", .description = "second parameter of the map of errors", .default_value = std::string("support_motion.amplitude")});
  s.add({.name = "map.values", .description = "its values, rising; empty: no map", .default_value = std::vector<double>{}});
  s.add_count("map.points", "frequencies of the map", 41, 2, 100000);
  return s;
}

Setup setup(const Configuration& c) {
  Setup s;
  s.levels.orbits.network = network_of(c);
  const auto& walk = s.levels.orbits.network.walk;
  if (c.text("continuation.parameter") != "omega")
    throw c.error("continuation.parameter", "must be omega: the levels are compared along the frequency");
  check_forced_lens(c, "continuation.parameter", "omega", "continuation.range", walk.lower, walk.upper);
  s.levels.order = static_cast<int>(c.integer("response.order"));
  s.levels.complete_harmonics = static_cast<int>(c.integer("compare.harmonics"));
  s.levels.orbits.seed_grid = static_cast<int>(c.integer("seeds.grid"));
  s.levels.orbits.check.starts = 0;  // the sweep is the check by integration here
  s.tolerance = c.number("compare.tolerance");
  s.sweep_points = static_cast<int>(c.integer("sweep.points"));
  s.sweep_tolerance = c.number("sweep.tolerance");
  s.second_values = c.numbers("map.values");
  s.map_points = static_cast<int>(c.integer("map.points"));
  if (s.second_values.empty()) return s;
  s.second = c.text("map.parameter");
  for (std::size_t i = 1; i < s.second_values.size(); ++i)
    if (!(s.second_values[i - 1] < s.second_values[i])) throw c.error("map.values", "must rise");
  if (s.second == "omega") throw c.error("map.parameter", "must differ from omega");
  check_forced_lens(c, "map.parameter", s.second, "map.values", s.second_values.front(), s.second_values.back());
  return s;
}

std::vector<std::string> check(const Configuration& c) {
  (void)setup(c);
  return check_forced_system(c);
}

// All averaged states of a two-mode cable at a frequency; nothing for another model.
ClosedForms closed_forms(const Configuration& c, int order, const std::string& second, double value) {
  if (!c.has("cable.chord_length") || order < 2 || forced_system_of(c, {"omega"}).coordinates.size() != 2) return {};
  auto stay = stay_of(c);
  if (!second.empty()) Lens(second).set(stay, value);
  const auto flow = std::make_shared<SuperharmonicFlow>(stay, SuperharmonicOptions{order, coefficients_of(c)}, std::vector{Lens("omega")});
  return [flow](double omega) {
    std::vector<Vector> states;
    const auto k = flow->model().coefficients<double>(std::array<double, 1>{omega});
    for (const auto& found : {in_plane_states(k), coupled_states(k)}) states.insert(states.end(), found.begin(), found.end());
    return states;
  };
}

// ---- branches of the levels -------------------------------------------------------------------------------------------------

void write_level(ResultFile& file, const ForcedSystem& source, const Setup& s, const std::string& name, const std::vector<Branch>& branches,
                 const std::function<Amplitudes(In)>& amplitudes) {
  BranchOutput out;
  out.parameter = "omega";
  out.parameter_unit = "rad/s";
  out.multipliers = name == "exact";
  for (std::size_t i = 0; i < source.coordinates.size(); ++i)
    out.columns.push_back({fmt::format("{}_h{}", source.coordinates[i], s.levels.order), source.length_unit,
                           fmt::format("amplitude of cos({} omega t + phase) in {}", s.levels.order, source.coordinates[i]),
                           [&amplitudes, i](In u) { return amplitudes(u)[static_cast<Eigen::Index>(i)]; }});
  for (Branch b : branches) {
    b.name = name + "-" + b.name;
    out.write_branch(file, b);
    file.attribute("/branches/" + b.name, "level", name);
  }
  file.flush();
}

std::vector<Branch> write_levels(ResultFile& file, const ForcedSystem& source, const Setup& s, const Levels& levels) {
  std::vector<Branch> all;
  const auto add = [&](const std::string& name, std::vector<Branch> branches, const std::function<Amplitudes(In)>& amplitudes) {
    write_level(file, source, s, name, branches, amplitudes);
    for (auto& b : branches) {
      b.name = name + "-" + b.name;
      all.push_back(std::move(b));
    }
  };
  add("frozen", levels.frozen.net->branches(), [&](In u) { return levels.frozen.amplitudes(u, s.levels.order); });
  add("complete", levels.complete.net->branches(), [&](In u) { return levels.complete.amplitudes(u, s.levels.order); });
  add("exact", levels.exact->all(), [&](In u) { return levels.exact_amplitudes(u); });
  return all;
}

// ---- integrated -------------------------------------------------------------------------------------------------------------

struct Integrated {
  Sweep up, down;
};

Integrated integrate(const ForcedSystem& source, const Setup& s, RunContext& context) {
  Integrated result;
  if (s.sweep_points < 2) return result;
  const auto& walk = s.levels.orbits.network.walk;
  std::vector<double> up;
  for (int i = 0; i < s.sweep_points; ++i) up.push_back(walk.lower + (walk.upper - walk.lower) * i / (s.sweep_points - 1));
  const std::vector<double> down(up.rbegin(), up.rend());
  parallel_for(2, [&](std::size_t i) {
    SweepOptions o;
    o.tolerance = s.sweep_tolerance;
    o.observer = [&, i](double p) {
      context.progress.show(fmt::format("sweep {}: omega = {:.5g}", i == 0 ? "up" : "down", p));
      return !interrupted;
    };
    const Vector rest = Vector::Zero(2 * static_cast<Eigen::Index>(source.coordinates.size()));
    (i == 0 ? result.up : result.down) = sweep([&](double p) { return source.at(Vector::Constant(1, p)); }, i == 0 ? up : down, rest, o);
  });
  context.progress.clear();
  return result;
}

void write_integrated(ResultFile& file, const ForcedSystem& source, const Setup& s, const Integrated& integrated) {
  for (const auto& [way, sweep] : {std::pair<std::string, const Sweep&>{"up", integrated.up}, {"down", integrated.down}}) {
    if (sweep.points.empty()) continue;
    std::vector<Column> table{{"omega", "rad/s", "excitation frequency", {}},
                              {"multiple", "-", "period in excitation periods, 0 if not periodic", {}}};
    for (const auto& q : source.coordinates)
      table.push_back({fmt::format("{}_h{}", q, s.levels.order), source.length_unit, "amplitude of n omega", {}});
    for (const auto& p : sweep.points) {
      table[0].values.push_back(p.p);
      table[1].values.push_back(p.motion.multiple);
      for (std::size_t i = 0; i < source.coordinates.size(); ++i)
        table[i + 2].values.push_back(std::abs(p.motion.harmonic(static_cast<int>(i), s.levels.order)));
    }
    file.table("/sweep/" + way, table);
  }
  file.flush();
}

// Of each exact point the transition of a sweep that is nearest to it and to no other point, up to 0.01 rad/s away: a sweep jumps a little late.
std::vector<std::optional<double>> transitions_of(const std::vector<Match>& matches, const Integrated& integrated) {
  std::vector<std::optional<double>> found(matches.size());
  std::vector<double> apart(matches.size(), 0.01);
  for (const Sweep* sweep : {&integrated.up, &integrated.down})
    for (const auto& t : sweep->transitions) {
      const double at = 0.5 * (t.before + t.after);
      std::size_t nearest = matches.size();
      for (std::size_t i = 0; i < matches.size(); ++i)
        if (matches[i].exact && (nearest == matches.size() || std::abs(matches[i].exact->p - at) < std::abs(matches[nearest].exact->p - at)))
          nearest = i;
      if (nearest == matches.size() || std::abs(matches[nearest].exact->p - at) >= apart[nearest]) continue;
      apart[nearest] = std::abs(matches[nearest].exact->p - at);
      found[nearest] = at;
    }
  return found;
}

// ---- table ------------------------------------------------------------------------------------------------------------------

void write_matches(ResultFile& file, const ForcedSystem& source, const Setup& s, const std::vector<Match>& matches, const Integrated& integrated) {
  TextColumn kinds{"kind", "LP fold, WH whirling, HB/TR Hopf point of the averaged equations or torus point of the motion, PD period doubling", {}},
      words{"found", "levels that have the point", {}}, branches{"branch", "branch of the best level that has it", {}};
  std::vector<Column> table;
  const std::size_t n = source.coordinates.size();
  for (const char* level : {"exact", "frozen", "complete"}) {
    table.push_back({fmt::format("omega_{}", level), "rad/s", "NaN: not there", {}});
    for (const auto& q : source.coordinates)
      table.push_back({fmt::format("{}_h{}_{}", q, s.levels.order, level), source.length_unit, "amplitude of n omega", {}});
  }
  for (const char* level : {"frozen", "complete"}) {
    table.push_back({fmt::format("shift_{}", level), "rad/s", "omega minus the exact one", {}});
    table.push_back({fmt::format("amplitude_error_{}", level), "-", "distance of the amplitudes over the exact ones", {}});
  }
  table.push_back({"omega_integrated", "rad/s", "middle of the bracket of a sweep's transition there", {}});
  const auto transitions = transitions_of(matches, integrated);
  for (std::size_t row = 0; row < matches.size(); ++row) {
    const Match& m = matches[row];
    std::size_t k = 0;
    const auto put = [&](double x) { table[k++].values.push_back(x); };
    for (const auto* p : {&m.exact, &m.frozen, &m.complete}) {
      put(*p ? (*p)->p : std::nan(""));
      for (std::size_t i = 0; i < n; ++i) put(*p ? (*p)->amplitudes[static_cast<Eigen::Index>(i)] : std::nan(""));
    }
    for (const auto* p : {&m.frozen, &m.complete}) {
      const bool both = m.exact && *p;
      put(both ? (*p)->p - m.exact->p : std::nan(""));
      put(both && m.exact->amplitudes.norm() > 0.0 ? ((*p)->amplitudes - m.exact->amplitudes).norm() / m.exact->amplitudes.norm() : std::nan(""));
    }
    put(transitions[row].value_or(std::nan("")));
    kinds.values.push_back(m.kind);
    words.values.push_back(m.words());
    branches.values.push_back((m.exact ? m.exact : m.complete ? m.complete : m.frozen)->branch);
  }
  file.table("/compare/points", table, {kinds, words, branches});
  file.flush();
}

std::string number(bool known, double x) { return known ? fmt::format("{:>12.7f}", x) : fmt::format("{:>12}", "-"); }
std::string change(bool known, double x) { return known ? fmt::format("{:>+10.2e}", x) : fmt::format("{:>10}", "-"); }

std::string points_text(const std::vector<Match>& matches, const Integrated& integrated) {
  std::string out = fmt::format("{:<6} {:<7} {:>12} {:>12} {:>10} {:>8} {:>12} {:>10} {:>8} {:>12}  {}\n", "point", "branch", "exact", "frozen",
                                "shift", "amp.", "complete", "shift", "amp.", "integrated", "found");
  const auto transitions = transitions_of(matches, integrated);
  for (std::size_t row = 0; row < matches.size(); ++row) {
    const Match& m = matches[row];
    const auto error = [&](const std::optional<LevelPoint>& p) {
      if (!p || !m.exact || !(m.exact->amplitudes.norm() > 0.0)) return fmt::format("{:>8}", "-");
      return fmt::format("{:>7.1f}%", 100.0 * (p->amplitudes - m.exact->amplitudes).norm() / m.exact->amplitudes.norm());
    };
    const auto& best = m.exact ? m.exact : m.complete ? m.complete : m.frozen;
    out += fmt::format("{:<6} {:<7} {} {} {} {} {} {} {} {}  {}\n", m.kind, best->branch, number(m.exact.has_value(), m.exact ? m.exact->p : 0.0),
                       number(m.frozen.has_value(), m.frozen ? m.frozen->p : 0.0),
                       change(m.frozen && m.exact, m.frozen && m.exact ? m.frozen->p - m.exact->p : 0.0), error(m.frozen),
                       number(m.complete.has_value(), m.complete ? m.complete->p : 0.0),
                       change(m.complete && m.exact, m.complete && m.exact ? m.complete->p - m.exact->p : 0.0), error(m.complete),
                       number(transitions[row].has_value(), transitions[row].value_or(0.0)), m.words());
  }
  return out;
}

// ---- map --------------------------------------------------------------------------------------------------------------------

// The system with its second parameter held.
struct Held {
  ParametricSystem wide;
  double second;
  template <class S>
  void operator()(std::span<const S> p, ModalSystem<S>& out) const {
    const std::array<S, 2> both{p[0], S(second)};
    wide.at(std::span<const S>(both), out);
  }
};

struct Row {
  double second = 0.0;
  std::vector<double> omega;
  std::vector<CellError> cells;
  double worst() const {
    double w = 0.0;
    for (const auto& cell : cells) w = std::max(w, std::isnan(cell.error) ? 0.0 : cell.error);
    return w;
  }
};

std::vector<Row> map_errors(const Configuration& c, const Setup& s, RunContext& context) {
  std::vector<Row> rows(s.second_values.size());
  if (rows.empty()) return rows;
  const ForcedSystem wide = forced_system_of(c, {"omega", s.second});
  const auto& walk = s.levels.orbits.network.walk;
  std::atomic<int> done{0};
  parallel_for(rows.size(), [&](std::size_t i) {
    if (interrupted) return;
    Row& row = rows[i];
    row.second = s.second_values[i];
    ForcedSystem held{ParametricSystem(Held{wide.system, row.second}, {"omega"}, Vector::Constant(1, 0.5 * (walk.lower + walk.upper))),
                      wide.reflections,
                      wide.coordinates,
                      wide.length_unit,
                      {"rad/s"}};
    CompareOptions o = s.levels;
    o.orbits.period_doublings = 0;
    o.orbits.averaged_seeds = false;
    o.orbits.truncation_tolerance = 1e-6;
    RunContext quiet;
    const Levels levels = walk_levels(held, o, closed_forms(c, o.order, s.second, row.second), quiet, false);
    for (int k = 0; k < s.map_points && !interrupted; ++k) {
      row.omega.push_back(walk.lower + (walk.upper - walk.lower) * k / (s.map_points - 1));
      row.cells.push_back(error_at(levels, row.omega.back()));
    }
    context.progress.show(fmt::format("map of errors, {} of {}", ++done, rows.size()));
  });
  context.progress.clear();
  return rows;
}

// The largest second parameter up to which every row stays within the tolerance; NaN: none.
double trusted_up_to(const std::vector<Row>& rows, double tolerance) {
  double last = std::nan("");
  for (const Row& row : rows) {
    if (row.cells.empty() || row.worst() > tolerance) break;
    last = row.second;
  }
  return last;
}

std::string sentence(const Setup& s, const std::vector<Row>& rows) {
  const double limit = trusted_up_to(rows, s.tolerance);
  const auto& walk = s.levels.orbits.network.walk;
  if (std::isnan(limit))
    return fmt::format("nowhere from {} = {:g} on does the averaged amplitude stay within {:g} % of the exact one over [{:g}, {:g}] rad/s", s.second,
                       rows.front().second, 100.0 * s.tolerance, walk.lower, walk.upper);
  const bool everywhere = limit == rows.back().second;
  return fmt::format(
      "trust the averaged curve {} {} = {:g}: there its amplitude at {} omega is within {:g} % of the exact one over [{:g}, {:g}] rad/s",
      everywhere ? "up to the largest value tried," : "below", s.second, limit, s.levels.order, 100.0 * s.tolerance, walk.lower, walk.upper);
}

void write_map(ResultFile& file, const Configuration& c, const Setup& s, const std::vector<Row>& rows) {
  const std::string unit = forced_system_of(c, {"omega", s.second}).lens_units[1];
  std::vector<Column> table{{"omega", "rad/s", "excitation frequency", {}},
                            {s.second, unit, "second parameter", {}},
                            {"error", "-", "largest relative error of a stable motion's averaged amplitude; NaN: no stable periodic motion", {}},
                            {"amplitude", "", "exact amplitude of that motion", {}},
                            {"same_kinds", "-", "1: as many stable motions, at rest and moving out of plane, at both levels", {}}};
  for (const Row& row : rows)
    for (std::size_t k = 0; k < row.cells.size(); ++k) {
      const double values[] = {row.omega[k], row.second, row.cells[k].error, row.cells[k].amplitude, row.cells[k].same_kinds ? 1.0 : 0.0};
      for (std::size_t i = 0; i < table.size(); ++i) table[i].values.push_back(values[i]);
    }
  file.table("/compare/map", table);
  file.attribute("/compare", "trusted_up_to", trusted_up_to(rows, s.tolerance));
  file.attribute("/compare", "sentence", sentence(s, rows));
  file.flush();
}

std::string json(const std::vector<Match>& matches, const std::string& words) {
  std::string points;
  const auto value = [](const std::optional<LevelPoint>& p) { return p ? fmt::format("{:.17g}", p->p) : std::string("null"); };
  for (const Match& m : matches)
    points += fmt::format(R"({}    {{"kind": "{}", "found": "{}", "exact": {}, "frozen": {}, "complete": {}}})", points.empty() ? "\n" : ",\n",
                          m.kind, m.words(), value(m.exact), value(m.frozen), value(m.complete));
  return fmt::format("{{\n  \"points\": [{}\n  ],\n  \"sentence\": \"{}\"\n}}\n", points, words);
}

ExitStatus run(const Configuration& c, RunContext& context) {
  const Setup s = setup(c);
  for (const auto& w : check_forced_system(c)) context.warn(w);
  ResultFile file(context.output);
  write_study(file, c);
  write_forced_system(file, c);
  const ForcedSystem source = forced_system_of(c, {"omega"});
  const Levels levels = walk_levels(source, s.levels, closed_forms(c, s.levels.order, "", 0.0), context);
  context.progress.clear();
  const std::vector<Branch> branches = write_levels(file, source, s, levels);
  const Integrated integrated = interrupted ? Integrated{} : integrate(source, s, context);
  write_integrated(file, source, s, integrated);
  const auto matches = match_points(levels);
  write_matches(file, source, s, matches, integrated);
  if (!context.quiet) fmt::print(stderr, "{}", points_text(matches, integrated));
  std::string words;
  if (!s.second_values.empty() && !interrupted) {
    const auto rows = map_errors(c, s, context);
    if (!interrupted) {
      write_map(file, c, s, rows);
      words = sentence(s, rows);
      if (!context.quiet) fmt::print(stderr, "\n{}\n", words);
    }
  }
  if (context.json) fmt::print("{}", json(matches, words));
  return finish(file, context, branches);
}

}  // namespace

StudyKind compare_study() { return {schema(), run, check}; }

}  // namespace whirl::studies
