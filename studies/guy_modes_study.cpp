#include "studies/guy_modes_study.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "core/quadrature.hpp"
#include "models/guy/linear_guy.hpp"
#include "models/guy/mode_count.hpp"
#include "models/guy/transverse_modes.hpp"
#include "studies/common_keys.hpp"
#include "studies/guy_keys.hpp"

namespace whirl::studies {
namespace {

using namespace models::guy;
using std::numbers::pi;

Schema schema() {
  Schema s("guy-modes", "modes of a guy held at both ends: transverse with linear tension, the string's, and those of the full linear problem");
  add_guy_keys(s);
  s.add_count("modes.count", "how many of each kind", 8, 1, 100);
  s.add_count("modes.shape_points", "points along the guy at which shapes are written", 201, 3, 100001);
  s.add({.name = "scan.tension_range",
         .unit = "N",
         .description = "horizontal tensions over which the frequencies are followed; empty: none",
         .default_value = std::vector<double>{},
         .lower = 0.0,
         .max_items = 2});
  s.add_count("scan.points", "tensions of the scan, equally spaced in their logarithm", 121, 2, 10000);
  return s;
}

// A problem resolved far enough to hold `count` modes of both planes.
LinearGuy resolved(const Statics& exact, int count) {
  double top = (count + 1.5) * string_frequency(exact, 1);
  for (;; top *= 1.25) {
    LinearGuy guy(exact, top);
    const auto enough = [&](Plane plane) { return guy.poles(plane).size() >= static_cast<std::size_t>(count); };
    if (enough(Plane::in_plane) && enough(Plane::out_of_plane)) return guy;
  }
}

struct Setup {
  GuyInput guy;
  int count;
  std::vector<double> sigma, tensions;
};

Setup setup(const Configuration& c) {
  Setup s{.guy = guy_of(c), .count = static_cast<int>(c.integer("modes.count")), .sigma = {}, .tensions = {}};
  const auto points = c.integer("modes.shape_points");
  for (std::int64_t i = 0; i < points; ++i) s.sigma.push_back(static_cast<double>(i) / static_cast<double>(points - 1));
  blame(c, "modes.count", [&] {
    (void)suitable_degree(s.guy.exact, (s.count + 1.5) * string_frequency(s.guy.exact, 1));
    (void)resolved(s.guy.exact, s.count);
  });
  const auto& range = c.numbers("scan.tension_range");
  if (range.empty()) return s;
  if (range.size() != 2 || !(range[0] < range[1])) throw c.error("scan.tension_range", "must be two increasing numbers");
  for (const double H : range) blame(c, "scan.tension_range", [&] { (void)resolved(at_horizontal_tension(s.guy.rest.guy, H), s.count); });
  const auto n = c.integer("scan.points");
  for (std::int64_t i = 0; i < n; ++i)
    s.tensions.push_back(range[0] * std::pow(range[1] / range[0], static_cast<double>(i) / static_cast<double>(n - 1)));
  return s;
}

std::vector<std::string> check(const Configuration& c) { return guy_warnings(setup(c).guy); }

void write_transverse(ResultFile& file, const Setup& s) {
  const TransverseModes modes(s.guy.rest);
  std::vector<TransverseMode> mode;
  for (int i = 1; i <= s.count; ++i) mode.push_back(modes.mode(i));
  const std::size_t n = mode.size();
  const auto number = [](std::size_t i) { return static_cast<int>(i) + 1; };
  const bool level = modes.k() == 1.0;
  file.table(
      "/modes/transverse",
      {column("mode", "-", "number", n, [&](auto i) { return number(i); }),
       column("omega", "rad/s", "linear tension, Bessel functions", n, [&](auto i) { return mode[i].frequency(); }),
       column("frequency", "Hz", "omega / 2 pi", n, [&](auto i) { return mode[i].frequency() / (2.0 * pi); }),
       column("period", "s", "2 pi / omega", n, [&](auto i) { return 2.0 * pi / mode[i].frequency(); }),
       column("omega_string", "rad/s", "constant mean tension along the chord", n, [&](auto i) { return string_frequency(s.guy.rest, number(i)); }),
       column("phase_number", "-", "X = (k - 1) z", n, [&](auto i) { return mode[i].phase_number(); }),
       column("root", "-", "z of the frequency equation; 0 for a level guy", n, [&](auto i) { return level ? 0.0 : mode[i].root(); }),
       column("root_asymptotic", "-", "McMahon's expansion, three terms; 0 for a level guy", n,
              [&](auto i) { return level ? 0.0 : mcmahon_root(number(i), modes.k(), 3); }),
       column("norm", "-", "root mean square of the unscaled mode", n, [&](auto i) { return mode[i].printed_norm(); }),
       column("slope_lower", "-", "of the normalised mode at the anchor, per s/L", n, [&](auto i) { return mode[i].slope(0.0); }),
       column("slope_upper", "-", "at the mast", n, [&](auto i) { return mode[i].slope(1.0); })});
  std::vector<Column> shapes{column("sigma", "-", "s/L from the anchor", s.sigma.size(), [&](auto i) { return s.sigma[i]; })};
  for (int i = 1; i <= s.count; ++i) {
    shapes.push_back(column(fmt::format("guy_{}", i), "-", "normalised mode, linear tension", s.sigma.size(),
                            [&](auto j) { return mode[i - 1].value(s.sigma[j]); }));
    shapes.push_back(column(fmt::format("string_{}", i), "-", "normalised mode of the string", s.sigma.size(),
                            [&](auto j) { return std::sqrt(2.0) * std::sin(i * pi * s.sigma[j]); }));
  }
  file.table("/modes/transverse_shapes", shapes);
  double worst = 0.0;  // of the orthonormality relation, by Gauss quadrature between nodes
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      double product = 0.0;
      for (std::size_t piece = 0; piece < n; ++piece) {
        const double width = 1.0 / static_cast<double>(n), from = width * static_cast<double>(piece);
        product += integrate<double, 20>([&](double x) { return mode[i].value(x) * mode[j].value(x); }, from, from + width);
      }
      worst = std::max(worst, std::abs(product - (i == j ? 1.0 : 0.0)));
    }
  file.attribute("/modes/transverse", "orthonormality_error", worst);
}

void write_full(ResultFile& file, const Setup& s, const LinearGuy& full, Plane plane) {
  auto poles = full.poles(plane);
  poles.resize(static_cast<std::size_t>(s.count));
  const std::string name = plane == Plane::in_plane ? "/modes/in_plane" : "/modes/out_of_plane";
  std::vector<Column> columns{column("mode", "-", "number", poles.size(), [](auto i) { return static_cast<double>(i + 1); }),
                              column("omega", "rad/s", "full linear problem", poles.size(), [&](auto i) { return poles[i].frequency; }),
                              column("frequency", "Hz", "omega / 2 pi", poles.size(), [&](auto i) { return poles[i].frequency / (2.0 * pi); }),
                              column("period", "s", "2 pi / omega", poles.size(), [&](auto i) { return 2.0 * pi / poles[i].frequency; })};
  if (plane == Plane::in_plane) {
    columns.push_back(
        column("strength_xx", "N/m", "of the pole in the horizontal stiffness", poles.size(), [&](auto i) { return poles[i].strength_xx; }));
    columns.push_back(
        column("strength_yy", "N/m", "of the pole in the vertical stiffness", poles.size(), [&](auto i) { return poles[i].strength_yy; }));
  } else {
    columns.push_back(
        column("strength_zz", "N/m", "of the pole in the stiffness out of plane", poles.size(), [&](auto i) { return poles[i].strength_zz; }));
  }
  file.table(name, columns);
  std::vector<Column> shapes{column("sigma", "-", "s/L0 from the anchor", s.sigma.size(), [&](auto i) { return s.sigma[i]; })};
  for (int i = 1; i <= s.count; ++i) {
    const auto shape = full.shape(plane, i, s.sigma);
    const auto angle = [&](std::size_t j) { return std::atan(curve_at(s.guy.exact, s.sigma[j] * s.guy.exact.unstressed_length).slope); };
    if (plane == Plane::out_of_plane) {
      shapes.push_back(column(fmt::format("z_{}", i), "-", "largest 1", s.sigma.size(), [&](auto j) { return shape[j].z; }));
      continue;
    }
    shapes.push_back(column(fmt::format("normal_{}", i), "-", "across the guy, upwards; largest displacement 1", s.sigma.size(),
                            [&](auto j) { return shape[j].y * std::cos(angle(j)) - shape[j].x * std::sin(angle(j)); }));
    shapes.push_back(column(fmt::format("tangential_{}", i), "-", "along the guy, towards the mast", s.sigma.size(),
                            [&](auto j) { return shape[j].x * std::cos(angle(j)) + shape[j].y * std::sin(angle(j)); }));
  }
  file.table(name + "_shapes", shapes);
}

// Are the poles complete? Counted independently just above the last.
bool counted(const Setup& s, const LinearGuy& full, Plane plane, RunContext& context) {
  const double last = full.poles(plane)[static_cast<std::size_t>(s.count) - 1].frequency;
  const int count = modes_below(s.guy.exact, plane, last * (1.0 + 1e-9));
  if (count == s.count) return true;
  context.warn(fmt::format("{} modes {}: {} counted, {} found", s.count, plane == Plane::in_plane ? "in plane" : "out of plane", count, s.count));
  return false;
}

void write_scan(ResultFile& file, const Setup& s, RunContext& context) {
  if (s.tensions.empty()) return;
  std::vector<Statics> states;
  std::vector<std::vector<Pole>> in, out;
  for (const double H : s.tensions) {
    if (interrupted) return;
    context.progress.show(fmt::format("scan: H = {:.6g} N", H));
    states.push_back(at_horizontal_tension(s.guy.rest.guy, H));
    const LinearGuy full = resolved(states.back(), s.count);
    in.push_back(full.poles(Plane::in_plane));
    out.push_back(full.poles(Plane::out_of_plane));
  }
  context.progress.clear();
  const std::size_t n = states.size();
  std::vector<Column> columns{
      column("horizontal_tension", "N", "H", n, [&](auto i) { return states[i].horizontal_tension; }),
      column("irvine_lambda2", "-", "(w l / Tm)^2 AE / Tm", n, [&](auto i) { return states[i].irvine_lambda2(); }),
      column("omega_string", "rad/s", "first, mean tension along the chord", n, [&](auto i) { return string_frequency(states[i], 1); })};
  for (std::size_t k = 0; k < static_cast<std::size_t>(s.count); ++k) {
    columns.push_back(column(fmt::format("in_plane_{}", k + 1), "rad/s", "full linear problem", n, [&](auto i) { return in[i][k].frequency; }));
    columns.push_back(column(fmt::format("out_of_plane_{}", k + 1), "rad/s", "full linear problem", n, [&](auto i) { return out[i][k].frequency; }));
  }
  file.table("/scan", columns);
}

// Frequencies of the guy by number, and of its string.
void report(RunContext& context, const Setup& s, const LinearGuy& full) {
  const TransverseModes modes(s.guy.rest);
  const auto in = full.poles(Plane::in_plane), out = full.poles(Plane::out_of_plane);
  std::string text = fmt::format("\n{:<6} {:>18} {:>18} {:>18} {:>18}   [rad/s]\n", "mode", "in plane", "out of plane", "linear tension", "string");
  Json rows = Json::array();
  for (int i = 1; i <= s.count; ++i) {
    const double a = in[static_cast<std::size_t>(i) - 1].frequency, b = out[static_cast<std::size_t>(i) - 1].frequency;
    const double transverse = modes.frequency(i), string = string_frequency(s.guy.rest, i);
    Json o = Json::object();
    rows.add(std::move(o.put("mode", i).put("in_plane", a).put("out_of_plane", b).put("transverse", transverse).put("string", string)));
    text += fmt::format("{:<6} {:>18.12f} {:>18.12f} {:>18.12f} {:>18.12f}\n", i, a, b, transverse, string);
  }
  context.report.put("modes", std::move(rows));
  context.print(text);
}

ExitStatus run(const Configuration& c, RunContext& context) {
  const Setup s = setup(c);
  for (const auto& w : guy_warnings(s.guy)) context.warn(w);
  ResultFile file(context.output);
  write_study(file, c);
  context.report.put("special_points", Json::array()).put("branches", Json::array());
  write_guy(file, context, s.guy);
  write_transverse(file, s);
  const LinearGuy full = resolved(s.guy.exact, s.count);
  bool complete = true;
  for (const Plane plane : {Plane::in_plane, Plane::out_of_plane}) {
    write_full(file, s, full, plane);
    complete = counted(s, full, plane, context) && complete;
  }
  file.attribute("/modes/in_plane", "degree", full.degree());
  file.flush();
  write_scan(file, s, context);
  report(context, s, full);
  return finish(file, context, complete ? ExitStatus::ok : ExitStatus::numerical_failure,
                {complete ? "all modes found; an independent count agrees" : "a mode is missing"});
}

}  // namespace

StudyKind guy_modes_study() { return {schema(), run, check}; }

}  // namespace whirl::studies
