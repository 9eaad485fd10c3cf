#include "studies/integrate_study.hpp"

#include <fmt/format.h>

#include <numbers>

#include "core/parallel.hpp"
#include "models/sweeps.hpp"
#include "studies/common_keys.hpp"
#include "studies/integration_output.hpp"

namespace whirl::studies {
namespace {

using namespace models;
constexpr double pi2 = 2.0 * std::numbers::pi;

Schema schema() {
  Schema s("integrate", "time integration: what motions settle on, Poincare sections, spectra, sweeps up and down with their jumps");
  add_forced_system_keys(s);
  s.add({.name = "integrate.omega",
         .unit = "rad/s",
         .description = "frequencies at which to integrate",
         .default_value = std::vector<double>{},
         .lower = 0.0,
         .example = Value{std::vector<double>{1.65, 2.15}}});
  s.add({.name = "integrate.starts",
         .description = "starts at rest: a value for every coordinate, start after start; left out: 3 in the first coordinate, and 10 in the first "
                        "out of plane and in plane",
         .default_value = std::vector<double>{},
         .example = Value{std::vector<double>{3.0, 0.0, 10.0, 10.0}}});
  s.add({.name = "integrate.states",
         .description = "further starts: coordinates and velocities, start after start",
         .default_value = std::vector<double>{}});
  s.add({.name = "integrate.perturbation",
         .description = "added to what a reflection turns where a start is its own mirror image, because such a start stays so for ever",
         .default_value = 1e-3,
         .lower = 0.0,
         .closed_lower = true});
  s.add_count("integrate.transient_periods", "excitation periods of the recorded beginning of each motion; 0: none", 40, 0, 1e6);
  s.add_count("integrate.samples", "per excitation period of recorded motions; a power of two serves the spectra best", 128, 8, 1e6);
  s.add_count("integrate.record_periods", "excitation periods recorded where a motion has no period", 128, 8, 1e6);
  s.add({.name = "integrate.section_phase_deg",
         .description = "phase of the excitation at which the stroboscopic points are taken",
         .default_value = 0.0,
         .lower = -360.0,
         .upper = 360.0});
  s.add({.name = "sweep.parameter", .description = "what the sweeps vary: omega or any numeric key", .default_value = std::string("omega")});
  s.add({.name = "sweep.range",
         .description = "lower and upper end; without it there are no sweeps",
         .default_value = std::vector<double>{},
         .max_items = 2,
         .example = Value{std::vector<double>{1.4, 2.3}}});
  s.add_count("sweep.points", "values from end to end", 91, 2, 1e6);
  s.add({.name = "sweep.directions",
         .description = "which sweeps to make",
         .default_value = std::vector<std::string>{"up", "down"},
         .choices = {"up", "down"}});
  s.add({.name = "sweep.tolerance",
         .description = "width to which transitions are bisected, in the parameter's unit",
         .default_value = 1e-5,
         .lower = 0.0});
  s.add({.name = "sweep.start", .description = "coordinates at rest from which a sweep begins; empty: zero", .default_value = std::vector<double>{}});
  s.add_count("sweep.max_periods", "as integration.max_periods, for each value of a sweep", 1500, 1, 1e6);
  add_integration_keys(s);
  return s;
}

struct Setup {
  ForcedSystem forced;
  std::vector<Reflection> reflections;
  std::vector<double> omegas;
  std::vector<std::pair<std::string, Vector>> starts;
  AttractorOptions settle;
  std::vector<double> sweep_values;
  Vector sweep_start;
  std::string parameter;
};

std::string start_name(const ForcedSystem& s, const Vector& y) {
  std::string name;
  const auto names = state_names(s);
  for (Eigen::Index i = 0; i < y.size(); ++i)
    if (y[i] != 0.0) name += fmt::format("{}{} = {:g}", name.empty() ? "" : ", ", names[static_cast<std::size_t>(i)], y[i]);
  return name.empty() ? "rest" : name;
}

Setup setup(const Configuration& c) {
  Setup s{forced_system_of(c, {"omega"}), {}, {}, {}, {}, {}, {}, {}};
  const auto n = static_cast<Eigen::Index>(s.forced.coordinates.size());
  s.reflections = state_reflections(s.forced);
  s.omegas = c.numbers("integrate.omega");
  std::vector<double> usual(static_cast<std::size_t>(2 * n), 0.0);
  const auto leading = leading_coordinates(s.forced);
  usual[static_cast<std::size_t>(leading[0])] = 3.0;
  for (const int i : leading) usual[static_cast<std::size_t>(n + i)] = 10.0;
  const auto take = [&](const std::string& key, Eigen::Index size) {
    const auto& values = key == "integrate.starts" && !c.is_given(key) ? usual : c.numbers(key);
    if (static_cast<Eigen::Index>(values.size()) % size != 0) throw c.error(key, fmt::format("must hold {} values for every start", size));
    for (std::size_t k = 0; k < values.size(); k += static_cast<std::size_t>(size)) {
      Vector y = Vector::Zero(2 * n);
      for (Eigen::Index i = 0; i < size; ++i) y[i] = values[k + static_cast<std::size_t>(i)];
      const Vector y0 = perturbed(y, s.reflections, c.number("integrate.perturbation"));
      if (std::none_of(s.starts.begin(), s.starts.end(), [&](const auto& start) { return start.second == y0; }))
        s.starts.emplace_back(start_name(s.forced, y), y0);
    }
  };
  take("integrate.starts", n);
  take("integrate.states", 2 * n);
  s.settle = attractor_options_of(c);
  s.parameter = c.text("sweep.parameter");
  const auto& range = c.numbers("sweep.range");
  if (range.size() == 1 || (range.size() == 2 && !(range[0] < range[1]))) throw c.error("sweep.range", "must hold two increasing values");
  if (range.size() == 2) {
    const auto points = c.integer("sweep.points");
    for (int i = 0; i < points; ++i) s.sweep_values.push_back(range[0] + (range[1] - range[0]) * i / static_cast<double>(points - 1));
    if (s.parameter == "omega" && !(range[0] > 0.0)) throw c.error("sweep.range", "must be > 0 [rad/s]");
    if (s.parameter != "omega") {
      (void)forced_system_of(c, {s.parameter, "omega"});
      if (!c.has("omega")) throw c.error("sweep.parameter", "needs the excitation frequency: set omega [rad/s]");
    }
  }
  s.sweep_start = Vector::Zero(2 * n);
  const auto& start = c.numbers("sweep.start");
  if (!start.empty() && static_cast<Eigen::Index>(start.size()) != n) throw c.error("sweep.start", fmt::format("must hold {} values", n));
  for (std::size_t i = 0; i < start.size(); ++i) s.sweep_start[static_cast<Eigen::Index>(i)] = start[i];
  if (s.omegas.empty() && s.sweep_values.empty()) throw InputError(fmt::format("{}: nothing to do: give integrate.omega or sweep.range", c.source()));
  if (!s.omegas.empty() && s.starts.empty()) throw c.error("integrate.starts", "must hold at least one start");
  return s;
}

std::vector<std::string> check(const Configuration& c) {
  (void)setup(c);
  return check_forced_system(c);
}

struct Run {
  double omega;
  std::string start;
  Vector y0;
  Settled settled;
  Matrix transient;  // 1 + 2 n rows: t, states
  int attractor = -1;
  bool done = false;
};

// The beginning of the motion as a user would plot it.
Matrix record_transient(const ModalSystem<double>& system, const StroboscopeOptions& o, const Vector& y0, int periods, int samples) {
  Stroboscope strobe(system, o);
  Matrix m(y0.size() + 1, periods * samples + 1);
  Vector y = y0;
  for (int j = 0; j <= periods * samples; ++j) {
    m(0, j) = strobe.period() * j / samples;
    m.col(j).tail(y.size()) = y;
    if (j < periods * samples && !strobe.advance(y, strobe.period() * (j % samples) / samples, strobe.period() * (j % samples + 1) / samples)) {
      m.conservativeResize(Eigen::NoChange, j + 1);
      break;
    }
  }
  return m;
}

std::vector<Run> integrate_all(const Configuration& c, const Setup& s, RunContext& context) {
  std::vector<Run> runs;
  for (const double omega : s.omegas)
    for (const auto& [name, y0] : s.starts) runs.push_back({omega, name, y0, {}, {}, -1, false});
  std::atomic<std::size_t> done{0};
  parallel_for(runs.size(), [&](std::size_t i) {
    Run& r = runs[i];
    if (interrupted) return;
    const auto system = s.forced.at(Vector::Constant(1, r.omega));
    r.settled = AttractorFinder(system, s.settle).settle(r.y0, AttractorSet());
    if (const int periods = static_cast<int>(c.integer("integrate.transient_periods")); periods > 0)
      r.transient = record_transient(system, s.settle.fine, r.y0, periods, static_cast<int>(c.integer("integrate.samples")));
    r.done = r.settled.why != "interrupted";
    context.progress.show(fmt::format("integrate: {} of {} runs", ++done, runs.size()));
  });
  std::erase_if(runs, [](const Run& r) { return !r.done; });
  return runs;
}

void write_transients(ResultFile& file, const std::vector<Run>& runs, const Setup& s) {
  const auto names = state_names(s.forced);
  for (std::size_t k = 0; k < runs.size(); ++k) {
    if (runs[k].transient.cols() == 0) continue;
    std::vector<Column> table;
    for (Eigen::Index i = 0; i < runs[k].transient.rows(); ++i) {
      const Vector v = runs[k].transient.row(i).transpose();
      const std::string name = i == 0 ? std::string("t") : names[static_cast<std::size_t>(i) - 1];
      table.push_back({name, i == 0 ? "s" : state_unit(s.forced, static_cast<int>(i) - 1), "beginning of the motion", {v.begin(), v.end()}});
    }
    const std::string group = fmt::format("/integrate/run{}", k + 1);
    file.table(group, table);
    file.attribute(group, "omega", runs[k].omega);
    file.attribute(group, "start", runs[k].start);
    file.attribute(group, "motion", std::string(to_string(runs[k].settled.kind)));
  }
}

void write_runs(ResultFile& file, const std::vector<Run>& runs, const std::vector<AttractorRow>& rows) {
  std::vector<Column> table{{"omega", "rad/s", "excitation frequency", {}},
                            {"periods", "-", "excitation periods until decided", {}},
                            {"distance", "-", "last stroboscopic distance seen", {}}};
  std::vector<TextColumn> texts{
      {"start", "where the run began", {}}, {"motion", "what it is", {}}, {"attractor", "what it settled on", {}}, {"why", "if it did not", {}}};
  for (const Run& r : runs) {
    table[0].values.push_back(r.omega);
    table[1].values.push_back(r.settled.periods);
    table[2].values.push_back(r.settled.distance);
    texts[0].values.push_back(r.start);
    texts[1].values.emplace_back(to_string(r.settled.kind));
    texts[2].values.push_back(r.attractor >= 0 ? rows[static_cast<std::size_t>(r.attractor)].name : "");
    texts[3].values.push_back(r.settled.why);
  }
  file.table("/integrate/runs", table, texts);
}

// Poincare points at the phase asked for.
Matrix section_of(AttractorFinder& finder, const Attractor& a, double phase) {
  Matrix points = a.points;
  for (Eigen::Index j = 0; phase != 0.0 && j < points.cols(); ++j) {
    Vector y = points.col(j);
    if (finder.fine().advance(y, 0.0, phase / finder.fine().omega())) points.col(j) = y;
  }
  return points;
}

// Attractors of all runs, frequency by frequency, with their tables.
void collect(const Configuration& c, const Setup& s, std::vector<Run>& runs, std::vector<std::unique_ptr<AttractorSet>>& sets,
             std::vector<AttractorRow>& rows, ResultFile& file) {
  const double phase = c.number("integrate.section_phase_deg") / 360.0 * pi2;
  for (const double omega : s.omegas) {
    if (interrupted) break;
    auto& set = *sets.emplace_back(std::make_unique<AttractorSet>(s.reflections));
    std::vector<int> row_of;
    for (Run& r : runs) {
      if (r.omega != omega || !r.settled.fresh) continue;
      const int known = set.size();
      const int index = set.add(*r.settled.fresh, r.settled.capture);
      if (set.size() > known) row_of.resize(static_cast<std::size_t>(set.size()), -1);
      r.attractor = index;
    }
    for (Run& r : runs) {
      if (r.omega != omega || r.attractor < 0) continue;
      int& row = row_of[static_cast<std::size_t>(r.attractor)];
      if (row < 0) {
        AttractorFinder finder(s.forced.at(Vector::Constant(1, omega)), s.settle);
        const Attractor& a = set[r.attractor];
        row = static_cast<int>(rows.size());
        rows.push_back({omega, &a,
                        finder.motion(a, static_cast<int>(c.integer("integrate.samples")), static_cast<int>(c.integer("integrate.record_periods"))),
                        fmt::format("A{}", rows.size() + 1), ""});
        write_motion_tables(file, fmt::format("/integrate/{}", rows.back().name), rows.back(), s.forced);
        write_section(file, fmt::format("/integrate/{}/section", rows.back().name), section_of(finder, a, phase), s.forced);
        file.flush();
      }
      r.attractor = row;
    }
    for (std::size_t i = 0; i < row_of.size(); ++i) {
      if (row_of[i] < 0) continue;
      const int mirror = set[static_cast<int>(i)].mirror_of;
      const int mirror_row = mirror >= 0 ? row_of[static_cast<std::size_t>(mirror)] : -1;
      std::string& link = rows[static_cast<std::size_t>(row_of[i])].mirror;
      if (mirror >= 0) link = mirror_row >= 0 ? rows[static_cast<std::size_t>(mirror_row)].name : std::string("not met");
    }
  }
}

void write_sweep(ResultFile& file, const std::string& way, const Sweep& sweep, const Setup& s, const std::string& unit) {
  std::vector<Column> table{{s.parameter, unit, "swept parameter", {}},
                            {"multiple", "-", "period in excitation periods, 0 if not periodic", {}},
                            {"lyapunov", "1/s", "largest exponent", {}}};
  for (const auto& q : s.forced.coordinates) {
    table.push_back({q + "_rms", s.forced.length_unit, "root mean square about the mean", {}});
    for (int h = 0; h <= 4; ++h) table.push_back({fmt::format("{}_h{}", q, h), s.forced.length_unit, fmt::format("amplitude of {} omega", h), {}});
  }
  TextColumn kinds{"motion", "periodic, quasi-periodic, chaotic, unsettled", {}};
  for (const auto& p : sweep.points) {
    std::size_t k = 0;
    table[k++].values.push_back(p.p);
    table[k++].values.push_back(p.motion.multiple);
    table[k++].values.push_back(p.motion.lyapunov);
    for (int i = 0; i < static_cast<int>(s.forced.coordinates.size()); ++i) {
      table[k++].values.push_back(p.rms[i]);
      for (int h = 0; h <= 4; ++h) table[k++].values.push_back(std::abs(p.motion.harmonic(i, h)));
    }
    kinds.values.emplace_back(to_string(p.settled.kind));
  }
  file.table(fmt::format("/sweep/{}", way), table, {kinds});
  std::vector<Column> marks{{"before", unit, "last value of the motion before", {}},
                            {"after", unit, "first value of the motion after", {}},
                            {"jump", "-", "1 if the amplitude jumps", {}}};
  for (const auto& q : s.forced.coordinates)
    for (const char* side : {"before", "after"}) marks.push_back({fmt::format("{}_rms_{}", q, side), s.forced.length_unit, "root mean square", {}});
  TextColumn what{"what", "kind of transition", {}};
  for (const auto& t : sweep.transitions) {
    std::size_t k = 0;
    for (const double v : {t.before, t.after, t.jump ? 1.0 : 0.0}) marks[k++].values.push_back(v);
    for (Eigen::Index i = 0; i < t.rms_before.size(); ++i)
      for (const double v : {t.rms_before[i], t.rms_after[i]}) marks[k++].values.push_back(v);
    what.values.push_back(t.what);
  }
  file.table(fmt::format("/sweep/transitions_{}", way), marks, {what});
  file.attribute(fmt::format("/sweep/{}", way), "stopped", sweep.why);
}

struct Swept {
  std::string way;
  Sweep sweep;
};

std::vector<Swept> run_sweeps(const Configuration& c, const Setup& s, ResultFile& file, RunContext& context) {
  std::vector<Swept> swept;
  if (s.sweep_values.empty()) return swept;
  for (const auto& way : c.texts("sweep.directions")) swept.push_back({way, {}});
  const bool omega_swept = s.parameter == "omega";
  const ForcedSystem forced = omega_swept ? s.forced : forced_system_of(c, {s.parameter, "omega"});
  const auto at = [&](double p) { return forced.at(omega_swept ? Vector(Vector::Constant(1, p)) : Vector(Eigen::Vector2d(p, c.number("omega")))); };
  parallel_for(swept.size(), [&](std::size_t i) {
    auto values = s.sweep_values;
    if (swept[i].way == "down") std::reverse(values.begin(), values.end());
    SweepOptions o;
    o.tolerance = c.number("sweep.tolerance");
    o.names = s.forced.coordinates;
    o.settle = s.settle;
    o.settle.max_periods = static_cast<int>(c.integer("sweep.max_periods"));
    o.observer = [&, i](double p) {
      context.progress.show(fmt::format("sweep {}: {} = {:.5g}", swept[i].way, s.parameter, p));
      return !interrupted;
    };
    swept[i].sweep = sweep(at, values, s.sweep_start, o);
  });
  for (const auto& w : swept) write_sweep(file, w.way, w.sweep, s, omega_swept ? "rad/s" : forced.lens_units.front());
  file.flush();
  return swept;
}

std::string text_of(const std::vector<Run>& runs, const std::vector<AttractorRow>& rows, const std::vector<Swept>& swept, const Setup& s) {
  std::string out;
  if (!runs.empty()) out += fmt::format("{:>9} {:<28} {:<16} {:>8}  {}\n", "omega", "start", "settles as", "periods", "on");
  for (const Run& r : runs)
    out += fmt::format("{:>9.5f} {:<28} {:<16} {:>8}  {}\n", r.omega, r.start, to_string(r.settled.kind), r.settled.periods,
                       r.attractor >= 0 ? rows[static_cast<std::size_t>(r.attractor)].name : r.settled.why);
  if (!rows.empty()) out += fmt::format("\n{}", attractor_text(rows, s.forced));
  for (const auto& w : swept) {
    out += fmt::format("\nsweep {}: {} values{}\n", w.way, w.sweep.points.size(), w.sweep.why.empty() ? "" : ", " + w.sweep.why);
    for (const auto& t : w.sweep.transitions)
      out += fmt::format("  {} = {:.7g} ({:.1e} wide): {}\n", s.parameter, 0.5 * (t.before + t.after), std::abs(t.after - t.before), t.what);
  }
  return out;
}

void report(Json& results, const std::vector<Run>& runs, const std::vector<AttractorRow>& rows, const std::vector<Swept>& swept, const Setup& s) {
  Json begun = Json::array(), attractors = Json::array(), transitions = Json::array();
  for (const Run& r : runs) {
    Json o = Json::object();
    o.put("omega", r.omega).put("start", r.start).put("motion", to_string(r.settled.kind)).put("periods", r.settled.periods);
    o.put("attractor", r.attractor >= 0 ? rows[static_cast<std::size_t>(r.attractor)].name : "");
    begun.add(std::move(o.put("why", r.settled.why)));
  }
  for (const auto& row : rows) {
    Json o = Json::object();
    put_attractor(o, row, s.forced);
    attractors.add(std::move(o));
  }
  for (const auto& w : swept)
    for (const auto& t : w.sweep.transitions) {
      Json o = Json::object();
      o.put("sweep", w.way).put(s.parameter, 0.5 * (t.before + t.after)).put("bracket", Json::array(std::vector<double>{t.before, t.after}));
      transitions.add(std::move(o.put("jump", t.jump).put("what", t.what)));
    }
  results.put("runs", std::move(begun)).put("attractors", std::move(attractors)).put("transitions", std::move(transitions));
}

ExitStatus run(const Configuration& c, RunContext& context) {
  const Setup s = setup(c);
  for (const auto& w : check_forced_system(c)) context.warn(w);
  ResultFile file(context.output);
  write_study(file, c);
  write_forced_system(file, context, c);
  auto runs = integrate_all(c, s, context);
  write_transients(file, runs, s);
  std::vector<std::unique_ptr<AttractorSet>> sets;
  std::vector<AttractorRow> rows;
  rows.reserve(runs.size());
  collect(c, s, runs, sets, rows, file);
  if (!runs.empty()) write_runs(file, runs, rows);
  if (!rows.empty()) file.table("/integrate/attractors", attractor_columns(rows, s.forced), attractor_texts(rows));
  file.flush();
  const auto swept = run_sweeps(c, s, file, context);
  context.progress.clear();
  std::vector<std::string> failures;
  for (const Run& r : runs)
    if (r.settled.kind == MotionKind::unsettled || r.settled.kind == MotionKind::failed) {
      failures.push_back(fmt::format("omega = {:g}, {}: {}", r.omega, r.start, r.settled.why));
    }
  for (const auto& w : swept)
    if (!w.sweep.why.empty() && !interrupted) {
      failures.push_back(fmt::format("sweep {} ended early: {}", w.way, w.sweep.why));
    }
  for (const auto& f : failures) context.warn(f);
  report(context.report, runs, rows, swept, s);
  context.print(text_of(runs, rows, swept, s));
  return finish(file, context, failures.empty() ? ExitStatus::ok : ExitStatus::numerical_failure, failures);
}

}  // namespace

StudyKind integrate_study() { return {schema(), run, check}; }

}  // namespace whirl::studies
