#include "studies/two_parameter_study.hpp"

#include <fmt/format.h>

#include <cmath>

#include "continuation/two_parameter.hpp"
#include "studies/branch_output.hpp"
#include "studies/common_keys.hpp"
#include "studies/equilibrium_source.hpp"

namespace whirl::studies {
namespace {

using namespace continuation;

struct Setup {
  std::unique_ptr<EquilibriumSource> source;
  std::string first, second;
  NetworkOptions network;
  TwoParameterOptions follow;
  std::vector<std::string> curves;
};

Schema schema() {
  Schema s("two-parameter",
           "curves of folds, branch points, Hopf points and peaks in two parameters, with their codimension-2 points and thresholds");
  add_equilibrium_source_keys(s);
  add_continuation_keys(s, "omega");
  s.add({.name = "continuation.peaks",
         .description = "variables or amplitudes whose extrema along the branches are special points (RP)",
         .default_value = std::vector<std::string>{}});
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
         .default_value = std::vector<std::string>{"LP", "BP", "HB", "RP"},
         .choices = {"LP", "BP", "HB", "RP"}});
  return s;
}

Setup setup(const Configuration& c) {
  Setup s;
  s.source = equilibrium_source(c);
  s.first = c.text("continuation.parameter");
  check_parameter_given(c, "continuation.parameter");
  check_parameter_given(c, "second.parameter");
  s.second = c.text("second.parameter");
  s.network = network_of(c);
  s.source->check_lens("continuation.parameter", s.first, "continuation.range", s.network.walk.lower, s.network.walk.upper);
  s.network.walk.peaks = peaks_of(c, *s.source);
  const auto& range = c.numbers("second.range");
  if (!(range[0] < range[1])) throw c.error("second.range", "must be increasing");
  s.source->check_lens("second.parameter", s.second, "second.range", range[0], range[1]);
  const double value = s.source->value(s.second);
  if (value < range[0] || value > range[1])
    throw c.error("second.range", fmt::format("must contain the value {:g} that {} has in this file", value, s.second));
  if (s.first == s.second) throw c.error("second.parameter", "must differ from continuation.parameter");
  s.follow.walk = s.network.walk;
  for (int i = 0; i < 2; ++i) {
    s.follow.range1[i] = i == 0 ? s.network.walk.lower : s.network.walk.upper;
    s.follow.range2[i] = range[static_cast<std::size_t>(i)];
  }
  s.curves = c.texts("second.curves");
  return s;
}

std::vector<std::string> check(const Configuration& c) { return setup(c).source->warnings(); }

void write_curve(ResultFile& file, const Setup& s, const Problem& flow2, const DefiningCurve& curve) {
  const int n = flow2.size();
  const auto column = [&](const std::string& name, const std::string& unit, const std::string& description, auto value) {
    Column c{name, unit, description, {}};
    for (Eigen::Index i = 0; i < curve.u.cols(); ++i) c.values.push_back(value(i));
    return c;
  };
  const std::string group = "/curves/" + curve.name;
  std::vector<Column> table = {column(s.first, s.source->unit(s.first), "first parameter", [&](auto i) { return curve.u(n, i); }),
                               column(s.second, s.source->unit(s.second), "second parameter", [&](auto i) { return curve.u(n + 1, i); })};
  for (const auto& c : s.source->columns(flow2))
    table.push_back(column(c.name, c.unit, c.description, [&](auto i) { return c.value(curve.u.col(i)); }));
  table.push_back(column("coefficient", "-", "normal-form coefficient", [&](auto i) { return curve.coefficient[i]; }));
  table.push_back(column("frequency", "rad/s", "Hopf curves", [&](auto i) { return curve.frequency[i]; }));
  table.push_back(column("residual", "-", "largest residual of the defining system", [&](auto i) { return curve.residual[i]; }));
  file.table(group, table);
  file.attribute(group, "type", std::string(to_string(curve.type)));
  file.attribute(group, "subtype", curve.subtype);
  file.attribute(group, "born_at", curve.born_at);
  file.attribute(group, "start_reason", std::string(to_string(curve.start_reason)));
  file.attribute(group, "stop_reason", std::string(to_string(curve.stop_reason)));
}

// Distance of two states up to the mirror images under the problem's reflections.
double apart_up_to_mirror(const Problem& f, In a, In b) {
  const int n = f.size();
  double least = (a.head(n) - b.head(n)).norm();
  for (const auto& r : f.reflections()) least = std::min(least, (a.head(n) - r.signs.cwiseProduct(b.head(n))).norm());
  return least;
}

// Is the special point on a curve already followed?
bool on_known_curve(const Problem& f, const std::vector<DefiningCurve>& curves, const SpecialPoint& p, double p2, const Setup& s) {
  const int n = f.size();
  const double w1 = s.follow.range1[1] - s.follow.range1[0], w2 = s.follow.range2[1] - s.follow.range2[0];
  for (const auto& c : curves) {
    if (c.type != p.type || c.subtype != p.subtype) continue;
    for (Eigen::Index i = 0; i + 1 < c.u.cols(); ++i) {
      const Vector a = c.u.col(i), b = c.u.col(i + 1);
      if ((a[n + 1] - p2) * (b[n + 1] - p2) > 0.0 || a[n + 1] == b[n + 1]) continue;
      const double t = (p2 - a[n + 1]) / (b[n + 1] - a[n + 1]), chord = std::hypot((b[n] - a[n]) / w1, (b[n + 1] - a[n + 1]) / w2);
      const Vector at = a + t * (b - a);
      // Up to the bend of the curve between two of its points, and up to the mirror image.
      if (std::abs(at[n] - p.u[n]) / w1 < 0.1 * chord + 1e-9 && apart_up_to_mirror(f, at, p.u) < 0.2 * (b - a).head(n).norm() + 1e-6) return true;
    }
  }
  return false;
}

// Does a curve lie on one followed before? Where most of its points do.
bool repeats(const Problem& f, const std::vector<DefiningCurve>& curves, const DefiningCurve& curve, const Setup& s) {
  const int n = f.size();
  int known = 0, asked = 0;
  for (int part = 1; part < 6; ++part, ++asked) {
    const Vector u = curve.u.col(part * (curve.u.cols() - 1) / 6);
    SpecialPoint at;
    at.type = curve.type;
    at.subtype = curve.subtype;
    at.u = u.head(n + 1);
    known += on_known_curve(f, curves, at, u[n + 1], s) ? 1 : 0;
  }
  return 2 * known > asked;
}

void report(Json& results, const Setup& s, int n, const std::vector<PointColumn>& columns, const std::vector<DefiningCurve>& curves) {
  Json points = Json::array(), summary = Json::array();
  for (const auto& c : curves) {
    for (const auto& z : c.special) {
      Json o = Json::object();
      o.put("curve", c.name).put("type", z.type).put(s.first, z.u[n]).put(s.second, z.u[n + 1]);
      for (const auto& column : columns)
        if (const double x = column.value(z.u); std::isfinite(x)) o.put(column.name, x);
      points.add(std::move(o.put("residual", z.residual)));
    }
    Json o = Json::object();
    o.put("name", c.name).put("type", to_string(c.type)).put("subtype", c.subtype).put("born_at", c.born_at).put("points", c.u.cols());
    summary.add(std::move(o.put("start_reason", to_string(c.start_reason)).put("stop_reason", to_string(c.stop_reason))));
  }
  results.put("special_points", std::move(points)).put("curves", std::move(summary));
}

std::string text(const Setup& s, int n, const std::vector<DefiningCurve>& curves) {
  std::string out = fmt::format("{:<8} {:<6} {:>22} {:>26} {:>9}\n", "curve", "point", fmt::format("{} [{}]", s.first, s.source->unit(s.first)),
                                fmt::format("{} [{}]", s.second, s.source->unit(s.second)), "residual");
  for (const auto& c : curves)
    for (const auto& z : c.special)
      out += fmt::format("{:<8} {:<6} {:>22.11f} {:>26.11f} {:>9.1e}\n", c.name, z.type, z.u[n], z.u[n + 1], z.residual);
  for (const auto& c : curves)
    out += fmt::format("curve {:<8} {:>5} points, born at {}, ends: {}, {}\n", c.name, c.u.cols(), c.born_at, to_string(c.start_reason),
                       to_string(c.stop_reason));
  return out;
}

ExitStatus run(const Configuration& c, RunContext& context) {
  const Setup s = setup(c);
  for (const auto& w : s.source->warnings()) context.warn(w);
  const auto f = s.source->problem({s.first}), f2 = s.source->problem({s.first, s.second});
  const int n = f->size();
  ResultFile file(context.output);
  write_study(file, c);
  s.source->write(file, context);
  const Observer observer = [](const Branch&, int) { return !interrupted; };
  Network net(*f, s.network);
  net.set_namer(s.source->namer());
  net.set_observer(observer);
  for (const Start& start : s.source->starts(*f, s.first, s.network.walk.lower, s.network.walk.upper)) {
    if (net.stopped()) break;
    try_seed(net, start.u, start.origin, context);
    net.switch_branches();
  }
  std::vector<DefiningCurve> curves;
  const auto follow_from = [&](const SpecialPoint& point, double p2, const std::string& origin, bool told) {
    const bool wanted = std::find(s.curves.begin(), s.curves.end(), to_string(point.type)) != s.curves.end();
    if (interrupted || !wanted || on_known_curve(*f, curves, point, p2, s)) return;
    DefiningCurve curve;
    try {
      curve = follow(*f2, point, p2, s.follow, observer);
    } catch (const std::invalid_argument& e) {
      if (told) context.warn(fmt::format("{}: {}", origin, e.what()));
      return;
    }
    if (!told && repeats(*f, curves, curve, s)) return;
    curve.name = fmt::format("{}{}", point.subtype.empty() ? to_string(point.type) : point.subtype.c_str(), curves.size() + 1);
    curve.born_at = origin;
    write_curve(file, s, *f2, curve);
    file.flush();
    context.progress.show(fmt::format("curve {}", curve.name));
    curves.push_back(std::move(curve));
  };
  for (const auto& b : net.branches())
    for (std::size_t i = 0; i < b.special.size(); ++i) {
      const auto& point = b.special[i];
      // The same point stands on the branch whose symmetry breaks there.
      const bool arrival =
          point.type == EventType::branch_point && point.block == 0 && i + 1 == b.special.size() && b.stop_reason == StopReason::symmetric_branch;
      if (!arrival) follow_from(point, s.source->value(s.second), fmt::format("{}:{}", b.name, label(b, i)), true);
    }
  for (std::size_t k = 0; k < curves.size(); ++k) {  // curves met on the way lead to further ones
    const std::vector<CodimensionTwo> met = curves[k].special;
    for (const auto& z : met)
      for (const SpecialPoint& start : curves_through(*f2, curves[k], z))
        follow_from(start, z.u[n + 1], fmt::format("{}:{}", curves[k].name, z.type), false);
  }
  context.progress.clear();
  std::vector<Column> table{{s.first, s.source->unit(s.first), "first parameter", {}},
                            {s.second, s.source->unit(s.second), "second parameter", {}},
                            {"residual", "-", "of the defining system", {}}};
  TextColumn names{"curve", "curve the point lies on", {}},
      types{"type",
            "CP cusp, BT Bogdanov-Takens, ZH zero-Hopf, GH generalised Hopf, HH double Hopf, "
            "DP degenerate pitchfork, FP fold and pitchfork, PP two pitchforks, MIN and MAX of the second parameter",
            {}};
  for (const auto& curve : curves)
    for (const auto& z : curve.special) {
      table[0].values.push_back(z.u[n]);
      table[1].values.push_back(z.u[n + 1]);
      table[2].values.push_back(z.residual);
      names.values.push_back(curve.name);
      types.values.push_back(z.type);
    }
  for (const auto& coordinate : s.source->columns(*f2)) {
    Column state{coordinate.name, coordinate.unit, coordinate.description, {}};
    for (const auto& curve : curves)
      for (const auto& z : curve.special) state.values.push_back(coordinate.value(z.u));
    table.push_back(std::move(state));
  }
  file.table("/special_points", table, {names, types});
  report(context.report, s, n, s.source->columns(*f2), curves);
  context.print(text(s, n, curves));
  return finish(file, context, net.branches());
}

}  // namespace

StudyKind two_parameter_study() { return {schema(), run, check}; }

}  // namespace whirl::studies
