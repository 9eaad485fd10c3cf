#include "studies/catenary_forced_study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/parallel.hpp"
#include "models/catenary/forced.hpp"
#include "studies/catenary_keys.hpp"
#include "studies/common_keys.hpp"

namespace whirl::studies {
namespace {

using namespace models::catenary;
using Complex = std::complex<double>;

constexpr const char* directions[] = {"tangential", "normal", "out_of_plane", "horizontal", "vertical"};

struct Setup {
  HangingCable cable;
  CoreCable core;
  double unit;                       // sqrt(g/a)
  std::vector<EndMotion> harmonics;  // of the base frequency, in a
  std::vector<double> sweep, at;     // rad/s
  std::vector<double> places;        // arc length from the lower end [m]
};

Schema schema() {
  Schema s("catenary-forced", "a hanging cable of any sag whose end moves periodically: motion and tension along it, resonances");
  add_hanging_cable_keys(s, true);
  s.add({.name = "end_motion.end", .description = "the end that moves", .default_value = std::string("upper"), .choices = {"lower", "upper"}});
  for (const char* d : directions) {
    s.add({.name = fmt::format("end_motion.{}", d),
           .unit = "m",
           .description = fmt::format("amplitude of its {} motion at the frequency, at twice it, ...", d),
           .default_value = std::vector<double>{},
           .lower = -1e9,
           .upper = 1e9,
           .example = std::string_view(d) == "horizontal" ? std::optional<Value>(std::vector<double>{0.5}) : std::nullopt});
    s.add({.name = fmt::format("end_motion.{}_phase_deg", d),
           .unit = "deg",
           .description = "phase of each of these: amplitude cos(k omega t + phase)",
           .default_value = std::vector<double>{}});
  }
  s.add({.name = "response.range",
         .unit = "rad/s",
         .description = "frequencies of the resonance diagram",
         .default_value = std::vector<double>{},
         .required = true,
         .lower = 0.0,
         .closed_lower = true,
         .min_items = 2,
         .max_items = 2,
         .example = Value{std::vector<double>{0.0, 4.0}}});
  s.add_count("response.points", "evenly spaced frequencies", 400, 2, 1e6);
  s.add({.name = "response.refine",
         .description = "more frequencies about the natural ones, as close as the drag makes the resonance narrow: 50 each or so",
         .default_value = true});
  s.add({.name = "response.at",
         .unit = "rad/s",
         .description = "frequencies at which the motion along the cable is written",
         .default_value = std::vector<double>{},
         .lower = 0.0,
         .closed_lower = true});
  s.add({.name = "response.places",
         .unit = "m",
         .description = "places along the cable, arc length from its lower end, at which motion and tension are tabulated against the frequency",
         .default_value = std::vector<double>{},
         .lower = 0.0,
         .closed_lower = true});
  s.add_count("response.cable_points", "points along the cable in these tables", 201, 2, 100000);
  return s;
}

std::vector<EndMotion> harmonics_of(const Configuration& c, const HangingCable& cable) {
  const bool upper = c.text("end_motion.end") == "upper";
  const double x = upper ? cable.shape.x2 : cable.shape.x1;
  std::vector<EndMotion> harmonics;
  for (int d = 0; d < 5; ++d) {
    const std::string key = fmt::format("end_motion.{}", directions[d]);
    const auto& amplitude = c.numbers(key);
    const auto& phase = c.numbers(key + "_phase_deg");
    if (phase.size() > amplitude.size()) throw c.error(key + "_phase_deg", fmt::format("has more entries than {}", key));
    if (amplitude.size() > harmonics.size()) harmonics.resize(amplitude.size());
    for (std::size_t k = 0; k < amplitude.size(); ++k) {
      const Complex a = std::polar(1.0, k < phase.size() ? phase[k] * std::numbers::pi / 180.0 : 0.0) * amplitude[k] / cable.shape.a;
      EndMotion& e = harmonics[k];
      const TangentNormal tn = d == 0 ? TangentNormal{a, 0.0} : d == 1 ? TangentNormal{0.0, a} : turned(x, d == 3 ? a : 0.0, d == 4 ? a : 0.0);
      if (d == 2) (upper ? e.W2 : e.W1) += a;
      else {
        (upper ? e.U2 : e.U1) += tn.tangential;
        (upper ? e.V2 : e.V1) += tn.normal;
      }
    }
  }
  if (harmonics.empty())
    throw InputError(fmt::format("{}: [end_motion] needs an amplitude: tangential, normal, out_of_plane, horizontal or vertical", c.source()));
  return harmonics;
}

Setup setup(const Configuration& c) {
  const HangingCable cable = hanging_cable_of(c);
  Setup s{cable, core_of(cable), frequency_unit(cable), harmonics_of(c, cable), {}, c.numbers("response.at"), c.numbers("response.places")};
  for (const double place : s.places)
    if (place > cable.shape.length)
      throw c.error("response.places", fmt::format("must lie within the cable's length {:.10g} m, got {:g}", cable.shape.length, place));
  const auto& range = c.numbers("response.range");
  if (!(range[0] < range[1])) throw c.error("response.range", "must be increasing");
  const auto points = static_cast<int>(c.integer("response.points"));
  for (int i = 0; i < points; ++i) s.sweep.push_back(range[0] + (range[1] - range[0]) * i / (points - 1));
  const double highest = highest_frequency(s.core) * s.unit, times = static_cast<double>(s.harmonics.size());
  const auto check_resolved = [&](const std::string& key, double omega, double multiple) {
    if (omega * multiple >= highest)
      throw c.error(key, fmt::format("must lie below {:.6g} rad/s{}: motion is too short in waves there", highest / multiple,
                                     multiple > 1.0 ? fmt::format(" with {:g} harmonics", multiple) : ""));
  };
  check_resolved("response.range", range[1], 1.0);
  for (const double w : s.at) check_resolved("response.at", w, times);
  return s;
}

std::vector<std::string> check(const Configuration& c) { return hanging_cable_warnings(setup(c).cable); }

struct Resonance {
  double omega, decay;  // rad/s, 1/s
};

// Rayleigh's estimate of how fast drag lets a mode decay [sqrt(g/a)].
double decay_of(const CoreCable& c, const Mode& mode, bool lateral) {
  if (lateral) return 0.5 * c.eta3;
  const Vector x = Vector::LinSpaced(2000, c.x1, c.x2), weight = x.array().cosh();
  const Matrix f = mode.field.at(x);
  const double along = weight.dot(f.col(0).cwiseAbs2()), across = weight.dot(f.col(1).cwiseAbs2());
  return 0.5 * (c.eta1 * along + c.eta2 * across) / (along + across);
}

// All modes up to a frequency [sqrt(g/a)], and one beyond, as many as it takes: what the solver resolves it can list.
ModeSet modes_up_to(const CoreCable& c, double omega, bool lateral, bool shapes) {
  ModeSet set;
  for (int count = 8;; count = std::min(2 * count, ModeOptions::most)) {
    const ModeOptions options{.count = count, .shapes = shapes, .verify = false};
    set = lateral ? out_of_plane_modes(c, options) : in_plane_modes(c, options);
    if (set.modes.back().omega > omega || count == ModeOptions::most) return set;
  }
}

// Natural frequencies within the sweep.
std::vector<Resonance> natural(const Setup& s, bool lateral, RunContext& context) {
  const ModeSet set = modes_up_to(s.core, s.sweep.back() / s.unit, lateral, !lateral);
  if (!(set.modes.back().omega * s.unit > s.sweep.back()))
    context.warn(fmt::format("natural frequencies {} beyond the {}th, {:.6g} rad/s, are not listed", lateral ? "out of plane" : "in plane",
                             set.modes.size(), set.modes.back().omega * s.unit));
  std::vector<Resonance> found;
  for (const auto& mode : set.modes) {
    const double w = mode.omega * s.unit;
    if (w <= s.sweep.back() && w >= s.sweep.front()) found.push_back({w, decay_of(s.core, mode, lateral) * s.unit});
  }
  return found;
}

// Without drag motion has no bound at a resonance: nothing is gained closer than this, relative.
constexpr double closest = 3e-4;

void refine(Setup& s, const std::vector<Resonance>& resonances) {
  constexpr double farthest = 0.03;  // relative; and no farther than half way to the next resonance
  const double first = s.sweep.front(), last = s.sweep.back();
  for (std::size_t i = 0; i < resonances.size(); ++i) {
    const auto& [omega, decay] = resonances[i];
    const double low = i > 0 ? 0.5 * (omega + resonances[i - 1].omega) : first;
    const double high = i + 1 < resonances.size() ? 0.5 * (omega + resonances[i + 1].omega) : last;
    const double width = decay > 0.0 ? std::min(closest, 0.25 * decay / omega) : closest;
    if (decay > 0.0 && width < closest) s.sweep.push_back(omega);
    for (double d = width; d < farthest; d *= d < closest ? 2.0 : 1.6)
      for (const double near : {omega * (1.0 - d), omega * (1.0 + d)})
        if (near > low && near < high) s.sweep.push_back(near);
  }
  std::sort(s.sweep.begin(), s.sweep.end());
}

// Tangential, normal, out of plane [a], tension [H] at a place.
using AtPlace = std::array<Complex, 4>;

struct Row {
  Peak T, U, V, W;
  TotalTension total;
  double T_lower, T_upper;
  std::vector<AtPlace> places;
};

double place_of(const Setup& s, double arc) {
  return std::clamp(std::asinh(std::sinh(s.cable.shape.x1) + arc / s.cable.shape.a), s.cable.shape.x1, s.cable.shape.x2);
}

AtPlace at_place(const ForcedMotion& m, double x) {
  return {m.in_plane.at(x, Quantity::U), m.in_plane.at(x, Quantity::V), m.lateral.at(x, Quantity::W), m.in_plane.at(x, Quantity::T)};
}

Row row_of(const Setup& s, const PeakFinder& peaks, const ForcedMotion& m) {
  const auto& f = m.in_plane;
  std::vector<AtPlace> places;
  for (const double arc : s.places) places.push_back(at_place(m, place_of(s, arc)));
  return {peaks.largest(f, Quantity::T),
          peaks.largest(f, Quantity::U),
          peaks.largest(f, Quantity::V),
          peaks.largest(m.lateral, Quantity::W),
          peaks.total_tension(f),
          std::abs(f.at(f.coordinate.x1(), Quantity::T)),
          std::abs(f.at(f.coordinate.x2(), Quantity::T)),
          std::move(places)};
}

double arc(const Setup& s, double x) { return s.cable.shape.a * (std::sinh(x) - std::sinh(s.cable.shape.x1)); }

// First-harmonic response over the sweep.
std::vector<Row> write_resonance(ResultFile& file, const Setup& s, const ForcedSolver& solver, RunContext& context) {
  const PeakFinder peaks(solver.mesh());
  std::vector<Row> rows(s.sweep.size());
  std::atomic<std::size_t> done{0};
  parallel_for(rows.size(), [&](std::size_t i) {
    if (!interrupted) rows[i] = row_of(s, peaks, solver.at(s.sweep[i] / s.unit, s.harmonics[0]));
    context.progress.show(fmt::format("{} of {} frequencies", ++done, rows.size()));
  });
  const double a = s.cable.shape.a, H = horizontal_tension(s.cable);
  std::vector<Column> t;
  const auto add = [&](const char* name, const char* unit, const char* description, auto value) {
    Column c{name, unit, description, {}};
    for (std::size_t i = 0; i < rows.size(); ++i) c.values.push_back(value(i));
    t.push_back(std::move(c));
  };
  add("omega", "rad/s", "frequency of the end motion", [&](auto i) { return s.sweep[i]; });
  add("frequency", "Hz", "omega / 2 pi", [&](auto i) { return s.sweep[i] / (2.0 * std::numbers::pi); });
  add("omega_ratio", "-", "omega / sqrt(g/a)", [&](auto i) { return s.sweep[i] / s.unit; });
  add("tension", "N", "largest dynamic tension along the cable", [&](auto i) { return H * rows[i].T.value; });
  add("tension_at", "m", "where, arc length from the lower end", [&](auto i) { return arc(s, rows[i].T.x); });
  add("tension_lower", "N", "dynamic tension at the lower end", [&](auto i) { return H * rows[i].T_lower; });
  add("tension_upper", "N", "dynamic tension at the upper end", [&](auto i) { return H * rows[i].T_upper; });
  add("total_max", "N", "largest static and dynamic tension", [&](auto i) { return H * rows[i].total.largest.value; });
  add("total_min", "N", "smallest static less dynamic tension; below 0 the cable goes slack",
      [&](auto i) { return H * rows[i].total.smallest.value; });
  add("U", "m", "largest tangential displacement", [&](auto i) { return a * rows[i].U.value; });
  add("V", "m", "largest normal displacement", [&](auto i) { return a * rows[i].V.value; });
  add("W", "m", "largest displacement out of plane", [&](auto i) { return a * rows[i].W.value; });
  file.table("/resonance", t);
  return rows;
}

void add_amplitude(std::vector<Column>& t, const char* name, const char* unit, const char* description, const Eigen::VectorXcd& v) {
  t.push_back({name, unit, fmt::format("amplitude of {}", description), to_std(v.cwiseAbs())});
  t.push_back({fmt::format("{}_phase", name), "rad", "phase: amplitude cos(omega t + phase)", to_std(v.array().arg().matrix())});
}

// "U", "V", "W", "tension": amplitudes and phases at each place over the sweep.
void write_places(ResultFile& file, const Setup& s, const std::vector<Row>& rows) {
  static constexpr std::pair<const char*, const char*> quantities[] = {
      {"U", "tangential displacement"}, {"V", "normal displacement"}, {"W", "displacement out of plane"}, {"tension", "dynamic tension"}};
  const double a = s.cable.shape.a, H = horizontal_tension(s.cable);
  for (std::size_t j = 0; j < s.places.size(); ++j) {
    std::vector<Column> t{{"omega", "rad/s", "frequency of the end motion", s.sweep}};
    for (std::size_t q = 0; q < 4; ++q) {
      Eigen::VectorXcd values(static_cast<Eigen::Index>(rows.size()));
      for (std::size_t i = 0; i < rows.size(); ++i)
        values[static_cast<Eigen::Index>(i)] = (q < 3 ? a : H) * (rows[i].places.empty() ? Complex(std::nan("")) : rows[i].places[j][q]);
      add_amplitude(t, quantities[q].first, q < 3 ? "m" : "N", quantities[q].second, values);
    }
    const std::string group = fmt::format("/places/place{}", j + 1);
    file.table(group, t);
    file.attribute(group, "s", s.places[j]);
  }
}

// The motion along the cable at one base frequency: each harmonic, and what they add up to over a period. The least total tension [N].
double write_motion(ResultFile& file, const Setup& s, const ForcedSolver& solver, double omega, int points) {
  const Along line = along(s.cable, points);
  const double a = s.cable.shape.a, H = horizontal_tension(s.cable);
  const Vector c = line.x.array().cosh();
  const std::string group = fmt::format("/motions/w{}", omega);
  std::vector<ForcedMotion> parts;
  for (std::size_t k = 0; k < s.harmonics.size(); ++k) {
    const ForcedMotion m = solver.at(double(k + 1) * omega / s.unit, s.harmonics[k]);
    parts.push_back(m);
    auto t = line.columns;
    const Eigen::MatrixXcd f = m.in_plane.at(line.x), lateral = m.lateral.at(line.x);
    add_amplitude(t, "U", "m", "tangential displacement", a * f.col(0));
    add_amplitude(t, "V", "m", "normal displacement", a * f.col(1));
    add_amplitude(t, "W", "m", "displacement out of plane", a * lateral.col(0));
    add_amplitude(t, "rotation", "rad", "change of slope", f.col(2).cwiseQuotient(c.cast<Complex>()));
    add_amplitude(t, "tension", "N", "dynamic tension", H * f.col(3));
    const std::string path = fmt::format("{}/h{}", group, k + 1);
    file.table(path, t);
    file.attribute(path, "omega", double(k + 1) * omega);
  }
  constexpr int samples = 256;
  const double period = omega > 0.0 ? 2.0 * std::numbers::pi * s.unit / omega : 1.0;
  const Vector times = Vector::LinSpaced(samples + 1, 0.0, period);
  const Matrix T = H * history(parts, Quantity::T, line.x, times);
  auto t = line.columns;
  t.push_back({"static_tension", "N", "H cosh x", to_std(H * c)});
  t.push_back({"total_max", "N", "largest tension over a period, 256 instants", to_std(H * c + T.rowwise().maxCoeff())});
  t.push_back({"total_min", "N", "smallest tension over a period", to_std(H * c + T.rowwise().minCoeff())});
  file.table(group + "/envelope", t);
  file.attribute(group, "omega", omega);
  file.table(group + "/history", {{"t", "s", "time", to_std(times / s.unit)},
                                  {"tension_lower", "N", "dynamic tension at the lower end", to_std(T.row(0).transpose())},
                                  {"tension_upper", "N", "dynamic tension at the upper end", to_std(T.row(T.rows() - 1).transpose())}});
  return (H * c + T.rowwise().minCoeff()).minCoeff();
}

void write_natural(ResultFile& file, const std::vector<Resonance> resonances[2]) {
  std::vector<Column> t{{"omega", "rad/s", "natural frequency without drag within the range", {}}};
  TextColumn plane{"plane", "in_plane or out_of_plane", {}};
  for (int lateral = 0; lateral < 2; ++lateral)
    for (const auto& [omega, decay] : resonances[lateral]) {
      t[0].values.push_back(omega);
      plane.values.emplace_back(lateral ? "out_of_plane" : "in_plane");
    }
  file.table("/natural", t, {plane});
}

// A largest value over the sweep, between its points too.
struct Largest {
  double omega = 0.0;
  Peak peak;
};

// What is made largest: the dynamic tension, or the displacement out of plane.
struct Sought {
  const Setup& s;
  const ForcedSolver& solver;
  const PeakFinder& peaks;
  bool bounded, lateral;
  Peak in(const Row& row) const { return lateral ? row.W : row.T; }
  Peak at(double omega) const {
    const ForcedMotion m = solver.at(omega / s.unit, s.harmonics[0]);
    return lateral ? peaks.largest(m.lateral, Quantity::W) : peaks.largest(m.in_plane, Quantity::T);
  }
};

Largest largest_of(const Setup& s, const std::vector<Row>& rows, const Sought& value) {
  std::size_t top = 0;
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (std::isfinite(value.in(rows[i]).value) && !(value.in(rows[i]).value <= value.in(rows[top]).value)) top = i;
  const Largest sampled{s.sweep[top], value.in(rows[top])};
  if (!value.bounded || top == 0 || top + 1 == rows.size() || !(sampled.peak.value > 0.0)) return sampled;
  // About the sampled frequency, for a resonance may be narrower than rounding in the frequency itself allows to halve.
  const auto below = [&](double offset) { return -value.at(sampled.omega + offset).value; };
  const auto found = boost::math::tools::brent_find_minima(below, s.sweep[top - 1] - sampled.omega, s.sweep[top + 1] - sampled.omega, 26);
  const double omega = sampled.omega + found.first;
  return -found.second > sampled.peak.value ? Largest{omega, value.at(omega)} : sampled;
}

bool moves_in_plane(const EndMotion& e) { return e.U1 != 0.0 || e.V1 != 0.0 || e.U2 != 0.0 || e.V2 != 0.0; }
bool moves_laterally(const EndMotion& e) { return e.W1 != 0.0 || e.W2 != 0.0; }

// The natural frequency of an undamped plane that this harmonic meets, if it meets one.
std::optional<double> unbounded_at(const CoreCable& c, const EndMotion& e, double omega) {
  const auto meets = [&](const ModeSet& set) {
    return std::any_of(set.modes.begin(), set.modes.end(), [&](const Mode& m) { return std::abs(omega / m.omega - 1.0) < 1e-8; });
  };
  if (moves_in_plane(e) && c.eta1 == 0.0 && c.eta2 == 0.0 && meets(modes_up_to(c, omega, false, false))) return omega;
  if (moves_laterally(e) && c.eta3 == 0.0 && meets(modes_up_to(c, omega, true, false))) return omega;
  return std::nullopt;
}

std::string list(const std::vector<Resonance>& resonances) {
  std::string out;
  for (const auto& r : resonances) out += fmt::format("{}{:.8g}", out.empty() ? "" : ", ", r.omega);
  return out.empty() ? "none in the range" : out;
}

// The largest dynamic tension and the largest displacement out of plane; `largest` is the one of the motion asked for.
void report_largest(RunContext& context, const Setup& s, const Largest& T, const Largest& W, bool bounded) {
  const EndMotion& first = s.harmonics[0];
  const bool in_plane = moves_in_plane(first), lateral = moves_laterally(first);
  const double H = horizontal_tension(s.cable), a = s.cable.shape.a;
  const auto told = [&](const Largest& largest) {
    Json o = Json::object();
    o.put("omega", largest.omega).put("s", arc(s, largest.peak.x)).put("bounded", bounded);
    return o;
  };
  Json either = told(in_plane || !lateral ? T : W);
  either.put("tension", H * T.peak.value);
  if (lateral) either.put("W", a * W.peak.value);
  context.report.put("largest", std::move(either));
  if (in_plane) context.report.put("largest_tension", std::move(told(T).put("tension", H * T.peak.value)));
  if (lateral) context.report.put("largest_out_of_plane", std::move(told(W).put("W", a * W.peak.value)));
  const char* scope = bounded ? "" : " of the frequencies computed";
  if (in_plane)
    context.print(fmt::format("largest dynamic tension{} {:.6g} N at {:.10g} rad/s, {:.4g} m from the lower end; static at the upper end {:.6g} N\n",
                              scope, H * T.peak.value, T.omega, arc(s, T.peak.x), H * std::cosh(s.cable.shape.x2)));
  if (lateral)
    context.print(fmt::format("largest displacement out of plane{} {:.6g} m at {:.10g} rad/s, {:.4g} m from the lower end\n", scope, a * W.peak.value,
                              W.omega, arc(s, W.peak.x)));
}

// The first harmonic at the frequencies of response.at: largest values along the cable and what happens at each of the places.
void report_at(RunContext& context, const Setup& s, const ForcedSolver& solver, const PeakFinder& peaks) {
  const EndMotion& first = s.harmonics[0];
  const double H = horizontal_tension(s.cable), a = s.cable.shape.a;
  Json rows = Json::array();
  std::string text;
  for (const double w : s.at) {
    const ForcedMotion m = solver.at(w / s.unit, first);
    const Peak T = peaks.largest(m.in_plane, Quantity::T), W = peaks.largest(m.lateral, Quantity::W);
    Json o = Json::object(), places = Json::array();
    o.put("omega", w).put("tension", H * T.value).put("s", arc(s, T.x)).put("W", a * W.value).put("W_s", arc(s, W.x));
    if (moves_in_plane(first))
      text += fmt::format("at {:.10g} rad/s: dynamic tension up to {:.8g} N, {:.4g} m from the lower end\n", w, H * T.value, arc(s, T.x));
    if (moves_laterally(first))
      text += fmt::format("at {:.10g} rad/s: displacement out of plane up to {:.8g} m, {:.4g} m from the lower end\n", w, a * W.value, arc(s, W.x));
    for (const double place : s.places) {
      const auto [U, V, lateral, tension] = at_place(m, place_of(s, place));
      Json p = Json::object();
      p.put("s", place).put("U", a * std::abs(U)).put("V", a * std::abs(V)).put("W", a * std::abs(lateral)).put("tension", H * std::abs(tension));
      places.add(std::move(p));
      text += fmt::format("  at {:.6g} m: along {:.8g} m, across {:.8g} m, out of plane {:.8g} m, dynamic tension {:.8g} N\n", place, a * std::abs(U),
                          a * std::abs(V), a * std::abs(lateral), H * std::abs(tension));
    }
    rows.add(std::move(o.put("places", std::move(places))));
  }
  context.report.put("at", std::move(rows));
  context.print(text);
}

void report(RunContext& context, const Setup& s, const ForcedSolver& solver, const PeakFinder& peaks, const std::vector<Resonance> resonances[2],
            const Largest& T, const Largest& W, bool bounded, std::size_t points) {
  const char* keys[] = {"natural", "natural_out_of_plane"};
  const bool moves[] = {moves_in_plane(s.harmonics[0]), moves_laterally(s.harmonics[0])};
  for (const int lateral : {0, 1}) {
    Json omegas = Json::array();
    for (const auto& r : resonances[lateral]) omegas.add(r.omega);
    context.report.put(keys[lateral], std::move(omegas));
    if (moves[lateral])
      context.print(fmt::format("natural frequencies {} [rad/s]: {}\n", lateral == 0 ? "in plane" : "out of plane", list(resonances[lateral])));
  }
  report_largest(context, s, T, W, bounded);
  report_at(context, s, solver, peaks);
  context.report.put("points", points);
}

ExitStatus run(const Configuration& c, RunContext& context) {
  Setup s = setup(c);
  for (const auto& w : hanging_cable_warnings(s.cable)) context.warn(w);
  const std::vector<Resonance> resonances[2] = {natural(s, false, context), natural(s, true, context)};
  const EndMotion& first = s.harmonics[0];
  const bool in_plane = moves_in_plane(first), lateral = moves_laterally(first);
  if (c.flag("response.refine")) {
    if (in_plane) refine(s, resonances[0]);
    if (lateral) refine(s, resonances[1]);
  }
  double top = s.sweep.back();
  for (const double w : s.at) top = std::max(top, w * static_cast<double>(s.harmonics.size()));
  const ForcedSolver solver(s.core, top / s.unit);
  const PeakFinder peaks(solver.mesh());
  ResultFile file(context.output);
  write_study(file, c);
  write_hanging_cable(file, context, s.cable);
  write_natural(file, resonances);
  std::vector<std::string> failures;
  if (!in_plane && !lateral) context.warn("the first harmonic of the end motion is zero, and so is the resonance diagram, which shows it alone");
  const auto rows = write_resonance(file, s, solver, context);
  write_places(file, s, rows);
  file.flush();
  context.progress.clear();
  std::size_t slack = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!std::isfinite(rows[i].T.value) || !std::isfinite(rows[i].W.value))
      failures.push_back(fmt::format("no finite motion at {:.10g} rad/s: a natural frequency without drag", s.sweep[i]));
    if (rows[i].total.smallest.value < 0.0) ++slack;
  }
  if (slack > 0) context.warn(fmt::format("the cable would go slack at {} of {} frequencies: linear theory ends there", slack, rows.size()));
  // Undamped, the largest value is that of the sampled frequency nearest to a resonance, and says nothing.
  const bool bounded =
      (!in_plane || s.core.eta1 > 0.0 || s.core.eta2 > 0.0 || resonances[0].empty()) && (!lateral || s.core.eta3 > 0.0 || resonances[1].empty());
  if (!bounded) context.warn("without drag motion is unbounded at the natural frequencies: largest values are those of the frequencies computed");
  const Largest T = largest_of(s, rows, {s, solver, peaks, bounded, false}), W = largest_of(s, rows, {s, solver, peaks, bounded, true});
  for (const double w : s.at) {
    if (interrupted) break;
    const double least = write_motion(file, s, solver, w, int(c.integer("response.cable_points")));
    if (least < 0.0) context.warn(fmt::format("at {:.10g} rad/s the cable would go slack: linear theory ends there", w));
    for (std::size_t k = 0; k < s.harmonics.size(); ++k)
      if (const auto omega = unbounded_at(s.core, s.harmonics[k], double(k + 1) * w / s.unit))
        failures.push_back(
            fmt::format("{:.10g} rad/s is a natural frequency without drag: motion is unbounded, what is written is rounding", *omega * s.unit));
  }
  report(context, s, solver, peaks, resonances, T, W, bounded, rows.size());
  return finish_tables(file, context, failures);
}

}  // namespace

StudyKind catenary_forced_study() { return {schema(), run, check}; }

}  // namespace whirl::studies
