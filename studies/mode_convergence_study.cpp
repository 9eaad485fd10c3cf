#include "studies/mode_convergence_study.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <limits>

#include "continuation/walker.hpp"
#include "models/statics.hpp"
#include "studies/cable_model_keys.hpp"
#include "studies/common_keys.hpp"
#include "studies/whirl_threshold.hpp"

namespace whirl::studies {
namespace {

using namespace models;
using namespace continuation;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

Schema schema() {
  Schema s("mode-convergence", "whirling threshold and peak amplitude of a cable against the number of modes");
  add_stay_keys(s, true);
  add_model_keys(s);
  s.add({.name = "convergence.counts",
         .description = "numbers of modes in each plane, a model each",
         .default_value = std::vector<double>{1, 2, 3, 4, 6},
         .lower = 1,
         .upper = 30,
         .closed_lower = true,
         .closed_upper = true,
         .min_items = 1});
  s.add({.name = "convergence.longitudinal",
         .description = "treatments of the stretching to compare",
         .default_value = std::vector<std::string>{"galerkin", "quasi-static"},
         .min_items = 1,
         .choices = {"galerkin", "quasi-static"}});
  s.add_count("convergence.harmonics", "of the periodic motion, at least; more where the highest mode needs them", 12, 2, 100);
  const auto range = [&](const char* name, const char* unit, const char* description, std::vector<double> value) {
    s.add({.name = name, .unit = unit, .description = description, .default_value = std::move(value), .lower = 0.0, .min_items = 2, .max_items = 2});
  };
  range("threshold.omega", "rad/s", "frequencies between which whirling points of planar motion are looked for", {1.4, 1.75});
  range("threshold.amplitude", "m", "amplitudes between which their curve is followed; support_motion.amplitude, where the search starts, within",
        {0.1, 0.6});
  s.add({.name = "peak.amplitude", .unit = "m", .description = "support amplitude of the peak", .default_value = 0.15, .lower = 0.0});
  range("peak.omega", "rad/s", "frequencies between which the peak of planar motion is looked for", {1.5, 1.75});
  s.add_count("peak.harmonic", "harmonic of the excitation whose amplitude is meant", 2, 1, 50);
  s.add({.name = "peak.station", .description = "where, x/L", .default_value = 0.5, .lower = 0.0, .upper = 1.0});
  return s;
}

struct Setup {
  CableModel base;
  std::vector<int> counts;
  std::vector<Longitudinal> treatments;
  int harmonics = 0, harmonic = 0;
  double omega[2], amplitude[2], peak_omega[2], peak_amplitude = 0.0, station = 0.5;
};

Setup setup(const Configuration& c) {
  Setup s;
  s.base = cable_model_of(c);
  for (const double n : c.numbers("convergence.counts")) {
    if (n != std::floor(n)) throw c.error("convergence.counts", "must hold whole numbers");
    s.counts.push_back(static_cast<int>(n));
  }
  for (const auto& name : c.texts("convergence.longitudinal"))
    s.treatments.push_back(name == "galerkin" ? Longitudinal::galerkin : Longitudinal::quasi_static);
  s.harmonics = static_cast<int>(c.integer("convergence.harmonics"));
  s.harmonic = static_cast<int>(c.integer("peak.harmonic"));
  s.peak_amplitude = c.number("peak.amplitude");
  s.station = c.number("peak.station");
  const auto copy = [&](const char* name, double* to) {
    const auto& range = c.numbers(name);
    if (!(range[0] < range[1])) throw c.error(name, "must be increasing");
    to[0] = range[0];
    to[1] = range[1];
  };
  copy("threshold.omega", s.omega);
  copy("threshold.amplitude", s.amplitude);
  copy("peak.omega", s.peak_omega);
  if (!(s.base.stay.support_amplitude > s.amplitude[0] && s.base.stay.support_amplitude < s.amplitude[1]))
    throw c.error("threshold.amplitude", fmt::format("must contain support_motion.amplitude = {:g}", s.base.stay.support_amplitude));
  if (s.harmonic > s.harmonics) throw c.error("peak.harmonic", "must not exceed convergence.harmonics");
  if (s.base.direction == Direction::out_of_plane) throw c.error("support_motion.direction", "must lie in the plane of the cable for planar motion");
  return s;
}

std::vector<std::string> check(const Configuration& c) {
  (void)setup(c);
  return check_cable(c);
}

struct Row {
  int modes = 0;  ///< in each plane
  int harmonics = 0;
  Longitudinal treatment = Longitudinal::galerkin;
  double threshold = nan, threshold_omega = nan, peak = nan, peak_omega = nan, tail = nan, seconds = 0.0;
  std::size_t terms = 0;
  std::vector<std::string> notes;
};

CableModel with(const Setup& s, int modes, Longitudinal treatment, bool planar) {
  CableModel m = s.base;
  m.longitudinal = treatment;
  m.in_plane = lowest_half_waves(modes);
  m.out_of_plane = planar ? std::vector<int>{} : lowest_half_waves(modes);
  return m;
}

Vector first_point(const HarmonicBalance& balance, double omega) {
  const NewtonResult at = newton(balance, balance.linear_response(Vector::Constant(1, omega)), {.max_iterations = 30});
  return at.ok() ? at.x : Vector();
}

HarmonicBalanceOptions balance_options(int harmonics, const CableModel& m) {
  HarmonicBalanceOptions o;
  o.harmonics = harmonics;
  o.reflections = cable_reflections(m);
  return o;
}

WalkOptions between(const double (&range)[2]) {
  WalkOptions walk;
  walk.lower = range[0];
  walk.upper = range[1];
  return walk;
}

// Amplitude of harmonic k of the displacement at the station.
double amplitude_at(const HarmonicBalance& balance, const Vector& shapes, int k, In u) {
  std::complex<double> sum = 0.0;
  for (int i = 0; i < balance.coordinates(); ++i) {
    const double b = k > 0 ? u[balance.index(i, k) + 1] : 0.0;
    sum += shapes[i] * std::complex<double>(u[balance.index(i, k)], -b);
  }
  return std::abs(sum);
}

const Observer unless_interrupted = [](const Branch&, int) { return !interrupted; };

void find_peak(const Setup& s, Row& row) {
  CableModel m = with(s, row.modes, row.treatment, true);
  m.stay.support_amplitude = s.peak_amplitude;
  const HarmonicBalance balance(cable_system(m, {Lens("omega")}), balance_options(row.harmonics, m));
  const Vector start = first_point(balance, s.peak_omega[0]), shapes = shapes_at(m, s.station);
  if (start.size() == 0) {
    row.notes.emplace_back("no periodic motion at the lower end of peak.omega");
    return;
  }
  WalkOptions walk = between(s.peak_omega);
  walk.peaks = {{"amplitude", [&](In u) { return amplitude_at(balance, shapes, s.harmonic, u); }}};
  const Branch branch = Walker(balance, walk).walk(start, unless_interrupted);
  for (const auto& p : branch.special) {
    const double a = amplitude_at(balance, shapes, s.harmonic, p.u);
    if (p.type == EventType::peak && !(a <= row.peak)) {
      row.peak = a;
      row.peak_omega = p.u[balance.size()];
      row.tail = balance.tail(p.u);
    }
  }
  if (std::isnan(row.peak)) row.notes.emplace_back("no peak within peak.omega");
}

void find_threshold(const Setup& s, Row& row) {
  const CableModel m = with(s, row.modes, row.treatment, false);
  row.terms = cable_equations(m).terms.size();
  WhirlThresholdOptions o;
  o.harmonics = row.harmonics;
  o.omega = {s.omega[0], s.omega[1]};
  o.amplitude = {s.amplitude[0], s.amplitude[1]};
  o.interrupted = [] { return interrupted.load(); };
  const WhirlThreshold t = whirl_threshold(m, o);
  if (t.ok) {
    row.threshold = t.amplitude;
    row.threshold_omega = t.omega;
  } else {
    row.notes.push_back(t.why);
  }
}

// Mode k moves at about k w1: harmonics beyond the highest mode's frequency, and some more.
int harmonics_for(const Setup& s, int modes) {
  const double highest = modes * models::modes(s.base.stay.cable).omega1;
  return std::max(s.harmonics, static_cast<int>(std::ceil(highest / std::min(s.omega[0], s.peak_omega[0]))) + 6);
}

const char* name_of(Longitudinal t) { return t == Longitudinal::galerkin ? "galerkin" : "quasi-static"; }

void write_rows(ResultFile& file, const std::vector<Row>& rows) {
  TextColumn treatment{"longitudinal", "treatment of the stretching", {}};
  std::vector<Column> columns;
  const auto add = [&](const char* name, const char* unit, const char* description, auto value) {
    Column column{name, unit, description, {}};
    for (const Row& r : rows) column.values.push_back(value(r));
    columns.push_back(std::move(column));
  };
  for (const Row& r : rows) treatment.values.emplace_back(name_of(r.treatment));
  add("modes", "-", "modes in each plane", [](const Row& r) { return r.modes; });
  add("threshold", "m", "least support amplitude at which planar motion starts to whirl", [](const Row& r) { return r.threshold; });
  add("threshold_omega", "rad/s", "where", [](const Row& r) { return r.threshold_omega; });
  add("peak", "m", "peak of the harmonic's amplitude at the station, planar motion", [](const Row& r) { return r.peak; });
  add("peak_omega", "rad/s", "where", [](const Row& r) { return r.peak_omega; });
  add("harmonics", "-", "of the periodic motion", [](const Row& r) { return r.harmonics; });
  add("tail", "-", "largest of the last harmonics over the largest of all, at the peak", [](const Row& r) { return r.tail; });
  add("terms", "-", "terms of the equations", [](const Row& r) { return static_cast<double>(r.terms); });
  add("seconds", "s", "computing time of the row", [](const Row& r) { return r.seconds; });
  file.table("/convergence", columns, {treatment});
}

// The fewest modes from which on threshold and peak stay within a per cent of the richest model of the treatment; 0: none.
int enough(const std::vector<Row>& rows, Longitudinal t) {
  const Row* last = nullptr;
  for (const Row& r : rows)
    if (r.treatment == t && (!last || r.modes > last->modes)) last = &r;
  int least = 0;
  for (const Row& r : rows) {
    if (!last || r.treatment != t) continue;
    const auto near = [](double a, double b) { return std::isnan(b) ? std::isnan(a) : std::abs(a / b - 1.0) < 0.01; };
    const bool good = near(r.threshold, last->threshold) && near(r.peak, last->peak);
    if (!good) least = 0;
    else if (least == 0) least = r.modes;
  }
  return least;
}

std::string text(const std::vector<Row>& rows) {
  std::string out = fmt::format("{:<13} {:>6} {:>14} {:>14} {:>12} {:>14} {:>9} {:>7} {:>8}\n", "longitudinal", "modes", "threshold [m]",
                                "at [rad/s]", "peak [m]", "at [rad/s]", "tail", "terms", "time [s]");
  for (const Row& r : rows) {
    out += fmt::format("{:<13} {:>6} {:>14.9f} {:>14.8f} {:>12.8f} {:>14.8f} {:>9.1e} {:>7} {:>8.2f}", name_of(r.treatment), r.modes, r.threshold,
                       r.threshold_omega, r.peak, r.peak_omega, r.tail, r.terms, r.seconds);
    for (const auto& note : r.notes) out += "; " + note;
    out += "\n";
  }
  return out;
}

Json json(const std::vector<Row>& rows) {
  Json list = Json::array();
  for (const Row& r : rows) {
    Json o = Json::object();
    o.put("longitudinal", name_of(r.treatment)).put("modes", r.modes).put("threshold", r.threshold).put("threshold_omega", r.threshold_omega);
    list.add(std::move(o.put("peak", r.peak).put("peak_omega", r.peak_omega)));
  }
  return list;
}

ExitStatus run(const Configuration& c, RunContext& context) {
  const Setup s = setup(c);
  for (const auto& w : check(c)) context.warn(w);
  ResultFile file(context.output);
  write_study(file, c);
  write_cable_numbers(file, context, s.base.stay.cable);
  std::vector<Row> rows;
  for (const Longitudinal t : s.treatments)
    for (const int n : s.counts) {
      if (interrupted) break;
      context.progress.show(fmt::format("{}, {} modes in each plane", name_of(t), n));
      Row row;
      row.modes = n;
      row.treatment = t;
      row.harmonics = harmonics_for(s, n);
      const auto before = std::chrono::steady_clock::now();
      find_peak(s, row);
      find_threshold(s, row);
      row.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count();
      for (const auto& note : row.notes) context.warn(fmt::format("{}, {} modes: {}", name_of(t), n, note));
      rows.push_back(std::move(row));
      write_rows(file, rows);
      file.flush();
    }
  context.progress.clear();
  bool whole = true;
  std::string advice;
  for (const Row& r : rows) whole = whole && r.notes.empty();
  for (const Longitudinal t : s.treatments)
    if (const int n = enough(rows, t); n > 0)
      advice += fmt::format("{}{}: from {} mode{} in each plane on, threshold and peak are within 1 % of the richest model here.",
                            advice.empty() ? "" : " ", name_of(t), n, n == 1 ? "" : "s");
  file.attribute("/convergence", "advice", advice);
  context.report.put("convergence", json(rows)).put("advice", advice);
  context.print(text(rows) + advice + "\n");
  return finish(file, context, whole ? ExitStatus::ok : ExitStatus::numerical_failure);
}

}  // namespace

StudyKind mode_convergence_study() { return {schema(), run, check}; }

}  // namespace whirl::studies
