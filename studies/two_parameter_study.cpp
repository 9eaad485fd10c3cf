#include "studies/two_parameter_study.hpp"

#include <fmt/format.h>

#include <cmath>

#include "continuation/two_parameter.hpp"
#include "models/closed_forms.hpp"
#include "studies/branch_output.hpp"
#include "studies/common_keys.hpp"

namespace whirl::studies {
namespace {

using namespace models;
using namespace continuation;

struct Setup {
  StayParameters<double> stay;
  SuperharmonicOptions flow;
  std::string first, second;
  NetworkOptions network;
  TwoParameterOptions follow;
  std::vector<std::string> curves;
};

Schema schema() {
  Schema s("two-parameter", "curves of folds, whirling points and Hopf points in two parameters, with their codimension-2 points and thresholds");
  add_stay_keys(s);
  s.add({.name = "response.order",
         .description = "superharmonic order n",
         .default_value = std::int64_t{2},
         .lower = 2,
         .upper = 50,
         .closed_lower = true,
         .closed_upper = true});
  add_continuation_keys(s, "omega");
  s.add({.name = "second.parameter",
         .description = "the other parameter of the chart; its value in this file is where the special points are looked for first",
         .default_value = std::string("support_motion.amplitude")});
  s.add({.name = "second.range",
         .description = "its lower and upper end",
         .default_value = std::vector<double>{},
         .required = true,
         .min_items = 2,
         .max_items = 2,
         .example = Value{std::vector<double>{0.05, 0.8}}});
  s.add({.name = "second.curves",
         .description = "which special points to follow",
         .default_value = std::vector<std::string>{"LP", "BP", "HB"},
         .choices = {"LP", "BP", "HB"}});
  return s;
}

Setup setup(const Configuration& c) {
  Setup s;
  s.stay = stay_of(c);
  s.flow = {static_cast<int>(c.integer("response.order")), coefficients_of(c)};
  s.first = c.text("continuation.parameter");
  s.second = c.text("second.parameter");
  s.network = network_of(c);
  check_lens_range(c, s.first, s.network.walk);
  const auto& range = c.numbers("second.range");
  if (!(range[0] < range[1])) throw c.error("second.range", "must be increasing");
  try {
    const Lens lens(s.second);
    if (lens.get(s.stay) < range[0] || lens.get(s.stay) > range[1])
      throw c.error("second.range", fmt::format("must contain the value {:g} that {} has in this file", lens.get(s.stay), s.second));
  } catch (const std::invalid_argument& e) {
    const std::string guess = nearest(s.second, Lens::names());
    throw c.error("second.parameter", guess.empty() ? e.what() : fmt::format("no such parameter, did you mean {}?", guess));
  }
  if (s.first == s.second) throw c.error("second.parameter", "must differ from continuation.parameter");
  s.follow.walk = s.network.walk;
  s.follow.walk.user_values.clear();
  for (int i = 0; i < 2; ++i) {
    s.follow.range1[i] = i == 0 ? s.network.walk.lower : s.network.walk.upper;
    s.follow.range2[i] = range[static_cast<std::size_t>(i)];
  }
  s.curves = c.texts("second.curves");
  return s;
}

std::vector<std::string> check(const Configuration& c) {
  (void)setup(c);
  return check_cable(c);
}

void write_curve(ResultFile& file, const Setup& s, const SuperharmonicFlow& flow2, const DefiningCurve& curve) {
  const int n = 4;
  const auto column = [&](const std::string& name, const std::string& unit, const std::string& description, auto value) {
    Column c{name, unit, description, {}};
    for (Eigen::Index i = 0; i < curve.u.cols(); ++i) c.values.push_back(value(i));
    return c;
  };
  const std::string group = "/curves/" + curve.name;
  file.table(group, {column(s.first, std::string(Lens(s.first).unit()), "first parameter", [&](auto i) { return curve.u(n, i); }),
                     column(s.second, std::string(Lens(s.second).unit()), "second parameter", [&](auto i) { return curve.u(n + 1, i); }),
                     column(fmt::format("q1_h{}", s.flow.order), "m", "A", [&](auto i) { return flow2.observe(curve.u.col(i)).A; }),
                     column(fmt::format("q2_h{}", s.flow.order), "m", "B", [&](auto i) { return flow2.observe(curve.u.col(i)).B; }),
                     column("coefficient", "-", "normal-form coefficient", [&](auto i) { return curve.coefficient[i]; }),
                     column("frequency", "rad/s", "Hopf curves", [&](auto i) { return curve.frequency[i]; }),
                     column("residual", "-", "largest residual of the defining system", [&](auto i) { return curve.residual[i]; })});
  file.attribute(group, "type", std::string(to_string(curve.type)));
  file.attribute(group, "subtype", curve.subtype);
  file.attribute(group, "born_at", curve.born_at);
  file.attribute(group, "start_reason", std::string(to_string(curve.start_reason)));
  file.attribute(group, "stop_reason", std::string(to_string(curve.stop_reason)));
}

// Is the special point on a curve already followed?
bool on_known_curve(const std::vector<DefiningCurve>& curves, const SpecialPoint& p, double p2, const Setup& s) {
  const double w1 = s.follow.range1[1] - s.follow.range1[0], w2 = s.follow.range2[1] - s.follow.range2[0];
  for (const auto& c : curves) {
    if (c.type != p.type || c.subtype != p.subtype) continue;
    for (Eigen::Index i = 0; i + 1 < c.u.cols(); ++i) {
      const Vector a = c.u.col(i), b = c.u.col(i + 1);
      if ((a[5] - p2) * (b[5] - p2) > 0.0 || a[5] == b[5]) continue;
      const double t = (p2 - a[5]) / (b[5] - a[5]), chord = std::hypot((b[4] - a[4]) / w1, (b[5] - a[5]) / w2);
      const Vector at = a + t * (b - a);
      // Up to the bend of the curve between two of its points, and up to the mirror image.
      const double apart = std::hypot(std::hypot(std::abs(at[0]) - std::abs(p.u[0]), std::abs(at[1]) - std::abs(p.u[1])),
                                      (at.segment(2, 2) - p.u.segment(2, 2)).norm());
      if (std::abs(at[4] - p.u[4]) / w1 < 0.1 * chord + 1e-9 && apart < 0.2 * (b - a).head(4).norm() + 1e-6) return true;
    }
  }
  return false;
}

std::string json(const Setup& s, const std::vector<DefiningCurve>& curves) {
  std::string points, summary;
  for (const auto& c : curves) {
    for (const auto& z : c.special)
      points += fmt::format(R"({}    {{"curve": "{}", "type": "{}", "{}": {:.17g}, "{}": {:.17g}, "residual": {:.3g}}})",
                            points.empty() ? "\n" : ",\n", c.name, z.type, s.first, z.u[4], s.second, z.u[5], z.residual);
    summary += fmt::format(
        R"({}    {{"name": "{}", "type": "{}", "subtype": "{}", "born_at": "{}", "points": {}, "start_reason": "{}", "stop_reason": "{}"}})",
        summary.empty() ? "\n" : ",\n", c.name, to_string(c.type), c.subtype, c.born_at, c.u.cols(), to_string(c.start_reason),
        to_string(c.stop_reason));
  }
  return fmt::format("{{\n  \"special_points\": [{}\n  ],\n  \"curves\": [{}\n  ]\n}}\n", points, summary);
}

std::string text(const Setup& s, const std::vector<DefiningCurve>& curves) {
  std::string out = fmt::format("{:<8} {:<6} {:>22} {:>26} {:>9}\n", "curve", "point", fmt::format("{} [{}]", s.first, Lens(s.first).unit()),
                                fmt::format("{} [{}]", s.second, Lens(s.second).unit()), "residual");
  for (const auto& c : curves)
    for (const auto& z : c.special) out += fmt::format("{:<8} {:<6} {:>22.11f} {:>26.11f} {:>9.1e}\n", c.name, z.type, z.u[4], z.u[5], z.residual);
  for (const auto& c : curves)
    out += fmt::format("curve {:<8} {:>5} points, born at {}, ends: {}, {}\n", c.name, c.u.cols(), c.born_at, to_string(c.start_reason),
                       to_string(c.stop_reason));
  return out;
}

ExitStatus run(const Configuration& c, RunContext& context) {
  const Setup s = setup(c);
  for (const auto& w : check(c)) context.warn(w);
  const SuperharmonicFlow flow(s.stay, s.flow, {Lens(s.first)}), flow2(s.stay, s.flow, {Lens(s.first), Lens(s.second)});
  ResultFile file(context.output);
  write_study(file, c);
  write_cable_numbers(file, s.stay.cable);
  const Observer observer = [](const Branch&, int) { return !interrupted; };
  Network net(flow, s.network);
  net.set_namer([](const Branch& b) { return b.active_reflections.empty() ? "W" : "IP"; });
  net.set_observer(observer);
  for (int i = 0; i <= 60 && !net.stopped(); ++i) {
    const double p = s.network.walk.lower + (s.network.walk.upper - s.network.walk.lower) * i / 60.0;
    const auto k = flow.model().coefficients<double>(std::array<double, 1>{p});
    for (const auto& states : {in_plane_states(k), coupled_states(k)})
      for (const auto& x : states) {
        Vector u(5);
        u << x, p;
        net.add_seed(u, fmt::format("closed form at {} = {:.6g}", s.first, p));
        net.switch_branches();
      }
  }
  const double p2 = Lens(s.second).get(s.stay);
  std::vector<DefiningCurve> curves;
  int number = 0;
  for (const auto& b : net.branches())
    for (std::size_t i = 0; i < b.special.size() && !interrupted; ++i) {
      const auto& point = b.special[i];
      const bool wanted = std::find(s.curves.begin(), s.curves.end(), to_string(point.type)) != s.curves.end();
      if (!wanted || on_known_curve(curves, point, p2, s)) continue;
      SpecialPoint seed = point;
      if (seed.type == EventType::branch_point && b.active_reflections.empty()) continue;  // the same point stands on the in-plane branch
      DefiningCurve curve;
      try {
        curve = follow(flow2, seed, p2, s.follow, observer);
      } catch (const std::invalid_argument& e) {
        context.warn(fmt::format("{} on {}: {}", label(b, i), b.name, e.what()));
        continue;
      }
      curve.name = fmt::format("{}{}", point.subtype.empty() ? to_string(point.type) : point.subtype.c_str(), ++number);
      curve.born_at = fmt::format("{}:{}", b.name, label(b, i));
      write_curve(file, s, flow2, curve);
      file.flush();
      context.progress.show(fmt::format("curve {}", curve.name));
      curves.push_back(std::move(curve));
    }
  context.progress.clear();
  std::vector<Column> table{{s.first, std::string(Lens(s.first).unit()), "first parameter", {}},
                            {s.second, std::string(Lens(s.second).unit()), "second parameter", {}},
                            {"residual", "-", "of the defining system", {}}};
  TextColumn names{"curve", "curve the point lies on", {}},
      types{
          "type", "CP cusp, BT Bogdanov-Takens, ZH zero-Hopf, GH generalised Hopf, DP degenerate pitchfork, MIN and MAX of the second parameter", {}};
  for (const auto& curve : curves)
    for (const auto& z : curve.special) {
      table[0].values.push_back(z.u[4]);
      table[1].values.push_back(z.u[5]);
      table[2].values.push_back(z.residual);
      names.values.push_back(curve.name);
      types.values.push_back(z.type);
    }
  file.table("/special_points", table, {names, types});
  if (context.json) fmt::print("{}", json(s, curves));
  if (!context.quiet) fmt::print(stderr, "{}", text(s, curves));
  return finish(file, context, net.branches());
}

}  // namespace

StudyKind two_parameter_study() { return {schema(), run, check}; }

}  // namespace whirl::studies
