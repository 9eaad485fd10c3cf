#include "studies/basins_study.hpp"

#include <fmt/format.h>

#include <chrono>
#include <numbers>

#include "models/basins.hpp"
#include "models/sweeps.hpp"
#include "studies/common_keys.hpp"
#include "studies/integration_output.hpp"

namespace whirl::studies {
namespace {

using namespace models;

Schema schema() {
  Schema s("basins", "basins of attraction: which motion each start of a plane of initial conditions settles on, on all cores");
  add_forced_system_keys(s);
  s.add({.name = "basins.omega",
         .unit = "rad/s",
         .description = "excitation frequency",
         .default_value = 0.0,
         .required = true,
         .lower = 0.0,
         .example = Value{2.15}});
  s.add({.name = "basins.axes",
         .description = "the two states that vary, such as q1, q2, q1', q2'; left out: the first coordinates out of plane and in plane, or the "
                        "only coordinate and its velocity",
         .default_value = std::vector<std::string>{},
         .max_items = 2,
         .example = Value{std::vector<std::string>{"q1", "q2"}}});
  for (const char* axis : {"x", "y"})
    s.add({.name = fmt::format("basins.{}_range", axis),
           .description = fmt::format("ends of the {} axis, both among the starts", axis == std::string("x") ? "first" : "second"),
           .default_value = std::vector<double>{-12.0, 12.0},
           .min_items = 2,
           .max_items = 2});
  s.add({.name = "basins.resolution",
         .description = "starts along the first and the second axis",
         .default_value = std::vector<double>{121.0, 121.0},
         .lower = 1.0,
         .upper = 1e4,
         .closed_lower = true,
         .closed_upper = true,
         .min_items = 2,
         .max_items = 2});
  s.add({.name = "basins.at",
         .description = "coordinates and velocities of every start, those of the axes not used; empty: zero",
         .default_value = std::vector<double>{}});
  s.add({.name = "basins.start_phase_deg",
         .description = "phase of the excitation at the start",
         .default_value = 0.0,
         .lower = -360.0,
         .upper = 360.0});
  s.add({.name = "basins.perturbation",
         .description = "added to what a reflection turns where a start is its own mirror image",
         .default_value = 1e-6,
         .lower = 0.0,
         .closed_lower = true});
  s.add({.name = "basins.check_share",
         .description = "share of the integrated starts done again at the fine tolerance and followed to the end",
         .default_value = 0.02,
         .lower = 0.0,
         .upper = 1.0,
         .closed_lower = true,
         .closed_upper = true});
  s.add({.name = "basins.use_symmetry", .description = "integrate half of a plane that a reflection maps to itself", .default_value = true});
  s.add({.name = "basins.threads",
         .description = "0: all cores; the result is the same",
         .default_value = std::int64_t{0},
         .lower = 0,
         .upper = 4096,
         .closed_lower = true});
  add_integration_keys(s);
  return s;
}

struct Setup {
  ForcedSystem forced;
  double omega = 0.0;
  std::vector<Reflection> reflections;
  BasinOptions options;
};

BasinAxis axis_of(const Configuration& c, const ForcedSystem& s, std::size_t k) {
  const auto names = state_names(s);
  const auto leading = leading_coordinates(s);
  const auto& given = c.texts("basins.axes");
  if (given.size() == 1) throw c.error("basins.axes", "must name two states");
  const int usual = leading[k] + (k == 1 && leading[0] == leading[1] ? static_cast<int>(s.coordinates.size()) : 0);
  const std::string name = given.empty() ? names[static_cast<std::size_t>(usual)] : given[k];
  const auto at = std::find(names.begin(), names.end(), name);
  if (at == names.end()) {
    std::string all;
    for (const auto& n : names) all += (all.empty() ? "" : ", ") + n;
    throw c.error("basins.axes", fmt::format("'{}' is not one of the states {}", name, all));
  }
  const std::string key = k == 0 ? "basins.x_range" : "basins.y_range";
  const auto& range = c.numbers(key);
  if (!(range[0] < range[1])) throw c.error(key, "must be increasing");
  const double points = c.numbers("basins.resolution")[k];
  if (points != std::floor(points)) throw c.error("basins.resolution", "must hold whole numbers");
  return {static_cast<int>(at - names.begin()), range[0], range[1], static_cast<int>(points)};
}

Setup setup(const Configuration& c) {
  Setup s{forced_system_of(c, {"omega"}), c.number("basins.omega"), {}, {}};
  const auto states = static_cast<Eigen::Index>(2 * s.forced.coordinates.size());
  s.reflections = state_reflections(s.forced);
  BasinOptions& o = s.options;
  o.x = axis_of(c, s.forced, 0);
  o.y = axis_of(c, s.forced, 1);
  if (o.x.state == o.y.state) throw c.error("basins.axes", "must name two different states");
  o.base = Vector::Zero(states);
  const auto& at = c.numbers("basins.at");
  if (!at.empty() && static_cast<Eigen::Index>(at.size()) != states)
    throw c.error("basins.at", fmt::format("must hold {} values (coordinates, velocities)", states));
  for (std::size_t i = 0; i < at.size(); ++i) o.base[static_cast<Eigen::Index>(i)] = at[i];
  o.phase = c.number("basins.start_phase_deg") * std::numbers::pi / 180.0;
  o.perturbation = c.number("basins.perturbation");
  o.check_share = c.number("basins.check_share");
  o.use_symmetry = c.flag("basins.use_symmetry");
  o.threads = static_cast<unsigned>(c.integer("basins.threads"));
  o.settle = attractor_options_of(c);
  return s;
}

std::vector<std::string> check(const Configuration& c) {
  (void)setup(c);
  return check_forced_system(c);
}

void write_map(ResultFile& file, const BasinMap& map, const Setup& s) {
  const auto names = state_names(s.forced);
  const BasinAxis &x = s.options.x, &y = s.options.y;
  std::vector<Column> table{{"x", state_unit(s.forced, x.state), "start, first axis: " + names[static_cast<std::size_t>(x.state)], {}},
                            {"y", state_unit(s.forced, y.state), "start, second axis: " + names[static_cast<std::size_t>(y.state)], {}},
                            {"attractor", "-", "number of the attractor; 0 unsettled, -1 diverging, -2 not computed", {}},
                            {"periods", "-", "excitation periods until decided", {}}};
  for (int j = 0; j < y.points; ++j)
    for (int i = 0; i < x.points; ++i) {
      const double values[] = {x.at(i), y.at(j), map.cell(j, i) + 1.0, double(map.periods(j, i))};
      for (std::size_t k = 0; k < 4; ++k) table[k].values.push_back(values[k]);
    }
  file.table("/basins/map", table);
  file.attribute("/basins", "axes", std::vector<std::string>{names[static_cast<std::size_t>(x.state)], names[static_cast<std::size_t>(y.state)]});
  file.attribute("/basins", "resolution", std::vector<double>{double(x.points), double(y.points)});
  file.attribute("/basins", "omega", s.omega);
  file.attribute("/basins", "symmetry", map.symmetry);
}

void write_attractors(ResultFile& file, const std::vector<AttractorRow>& rows, const BasinMap& map, const Setup& s) {
  auto columns = attractor_columns(rows, s.forced);
  Column number{"number", "-", "as in the map", {}}, share{"share", "-", "of the starts decided", {}}, cells{"cells", "-", "starts", {}};
  const auto names = state_names(s.forced);
  std::vector<Column> points{{"attractor", "-", "number", {}}};
  for (std::size_t k = 0; k < names.size(); ++k)
    points.push_back({names[k], state_unit(s.forced, static_cast<int>(k)), "stroboscopic point at omega t = 0", {}});
  for (std::size_t i = 0; i < rows.size(); ++i) {
    number.values.push_back(static_cast<double>(i) + 1.0);
    share.values.push_back(map.share(static_cast<int>(i)));
    cells.values.push_back(static_cast<double>(map.cells[i]));
    const Matrix& p = rows[i].attractor->points;
    for (Eigen::Index j = 0; j < p.cols(); ++j) {
      points[0].values.push_back(static_cast<double>(i) + 1.0);
      for (Eigen::Index k = 0; k < p.rows(); ++k) points[static_cast<std::size_t>(k) + 1].values.push_back(p(k, j));
    }
  }
  columns.insert(columns.begin(), {number, share, cells});
  file.table("/basins/attractors", columns, attractor_texts(rows));
  file.table("/basins/points", points);
  for (const auto& r : rows) write_motion_tables(file, fmt::format("/basins/{}", r.name), r, s.forced);
}

void write_accuracy(ResultFile& file, const BasinMap& map, double seconds) {
  const double rate = static_cast<double>(map.integrated) / std::max(seconds, 1e-9);
  file.scalar("/basins", "integrated", static_cast<double>(map.integrated), "-", "starts integrated, those that follow by symmetry left out");
  file.scalar("/basins", "checked", static_cast<double>(map.checked), "-", "starts integrated again at the fine tolerance and followed to the end");
  file.scalar("/basins", "disagreed", static_cast<double>(map.disagreed), "-", "of them, starts that went elsewhere than the map says");
  file.scalar("/basins", "seconds", seconds, "s", "wall time of the map with its checks");
  file.scalar("/basins", "starts_per_second", rate, "1/s", "integrated starts per second of wall time, on all threads, checks included");
}

void report(Json& results, const std::vector<AttractorRow>& rows, const BasinMap& map, const Setup& s, double seconds) {
  Json attractors = Json::array();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    Json o = Json::object();
    o.put("number", i + 1).put("share", map.share(static_cast<int>(i))).put("cells", map.cells[i]);
    put_attractor(o, rows[i], s.forced);
    attractors.add(std::move(o));
  }
  const auto count = [&](int value) { return (map.cell.array() == value).count(); };
  results.put("attractors", std::move(attractors)).put("cells", map.cell.size()).put("integrated", map.integrated);
  results.put("unsettled", count(BasinMap::unsettled)).put("diverging", count(BasinMap::diverging));
  results.put("not_computed", count(BasinMap::not_computed)).put("checked", map.checked).put("disagreed", map.disagreed);
  results.put("seconds", seconds);
}

ExitStatus run(const Configuration& c, RunContext& context) {
  Setup s = setup(c);
  for (const auto& w : check_forced_system(c)) context.warn(w);
  ResultFile file(context.output);
  write_study(file, c);
  write_forced_system(file, context, c);
  file.flush();
  const auto begin = std::chrono::steady_clock::now();
  const auto elapsed = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(); };
  s.options.progress = [&](long done, long total, int attractors) {
    constexpr int width = 30;
    const int bar = static_cast<int>(width * done / total);
    context.progress.show(fmt::format("basins [{:#<{}}{:.<{}}] {} of {} starts, {} attractors, {:.0f} s left", "", bar, "", width - bar, done, total,
                                      attractors, elapsed() * static_cast<double>(total - done) / static_cast<double>(done)));
  };
  const auto system = s.forced.at(Vector::Constant(1, s.omega));
  const BasinMap map = basins(system, s.reflections, s.options);
  const double seconds = elapsed();
  context.progress.clear();
  AttractorFinder finder(system, s.options.settle);
  std::vector<AttractorRow> rows;
  for (std::size_t i = 0; i < map.attractors.size(); ++i) {
    const Attractor& a = map.attractors[i];
    rows.push_back({s.omega, &a, finder.motion(a, 128, 128), fmt::format("A{}", i + 1), a.mirror_of >= 0 ? fmt::format("A{}", a.mirror_of + 1) : ""});
  }
  write_map(file, map, s);
  if (!rows.empty()) write_attractors(file, rows, map, s);
  write_accuracy(file, map, seconds);
  const auto unsettled = (map.cell.array() == BasinMap::unsettled).count();
  report(context.report, rows, map, s, seconds);
  std::vector<std::vector<std::string>> shares;
  for (std::size_t i = 0; i < rows.size(); ++i) shares.push_back({fmt::format("{:.2f} %", 100.0 * map.share(static_cast<int>(i)))});
  context.print(attractor_text(rows, s.forced, {"share"}, shares));
  context.print(fmt::format("{} starts, {} integrated in {:.1f} s ({:.0f} per second); {} checked again, {} of them went elsewhere\n",
                            map.cell.size(), map.integrated, seconds, static_cast<double>(map.integrated) / seconds, map.checked, map.disagreed));
  if (unsettled > 0) context.warn(fmt::format("{} starts did not settle within {} excitation periods", unsettled, s.options.settle.max_periods));
  if (unsettled > 0) return finish(file, context, ExitStatus::numerical_failure, {context.warnings.back()});
  return rows.empty() ? finish(file, context, ExitStatus::numerical_failure, {"no start settled on an attractor"})
                      : finish(file, context, ExitStatus::ok);
}

}  // namespace

StudyKind basins_study() { return {schema(), run, check}; }

}  // namespace whirl::studies
