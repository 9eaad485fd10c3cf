#include "studies/integration_output.hpp"

#include <fmt/format.h>

#include <map>
#include <numbers>

#include "core/fourier.hpp"
#include "models/sweeps.hpp"

namespace whirl::studies {

using namespace models;

namespace {

constexpr int harmonics_written = 5;

// 0 .. 5 in steps of omega, and of omega/m where a motion of period mT is among the rows.
std::vector<std::pair<double, std::string>> harmonics_of(const std::vector<AttractorRow>& rows) {
  std::map<double, std::string> all;
  for (int h = 0; h <= harmonics_written; ++h) all[h] = fmt::format("{}", h);
  for (const auto& r : rows)
    for (int k = 1; r.attractor->multiple > 1 && k < harmonics_written * r.attractor->multiple; ++k)
      if (k % r.attractor->multiple != 0)
        all[static_cast<double>(k) / r.attractor->multiple] = fmt::format("{:.4g}", static_cast<double>(k) / r.attractor->multiple);
  return {all.begin(), all.end()};
}

// "1.5: 2.375, 0.5: 0.980": the strongest lines of a coordinate, at most three.
std::string strongest(const AttractorRow& r, int coordinate) {
  std::vector<std::pair<double, double>> lines;
  const int parts = std::max(1, r.attractor->multiple);
  for (int k = 0; k <= harmonics_written * parts; ++k)
    lines.emplace_back(std::abs(r.motion.harmonic(coordinate, static_cast<double>(k) / parts)), static_cast<double>(k) / parts);
  std::sort(lines.rbegin(), lines.rend());
  std::string out;
  for (std::size_t k = 0; k < 3 && lines[k].first > 1e-4; ++k)
    out += fmt::format("{}{:.4g}: {:.4f}", k == 0 ? "" : ", ", lines[k].second, lines[k].first);
  return out.empty() ? "at rest" : out;
}
constexpr double two_pi = 2.0 * std::numbers::pi;

Column column_of(const std::vector<AttractorRow>& rows, const std::string& name, const std::string& unit, const std::string& description,
                 const std::function<double(const AttractorRow&)>& value) {
  Column c{name, unit, description, {}};
  for (const auto& r : rows) c.values.push_back(value(r));
  return c;
}

double largest_multiplier(const AttractorRow& r) {
  return r.attractor->multipliers.size() > 0 ? std::abs(r.attractor->multipliers[0]) : std::nan("");
}

void add_lines(Table& table, const AttractorRow& row, int coordinate) {
  const auto add = [&](double harmonic, std::complex<double> amplitude) {
    const double values[] = {coordinate + 1.0, harmonic, std::abs(amplitude), std::arg(amplitude)};
    for (std::size_t k = 0; k < 4; ++k) table.columns[k].values.push_back(values[k]);
  };
  const SteadyMotion& m = row.motion;
  if (m.kind == MotionKind::periodic) {
    for (int k = 0; k <= 8 * m.multiple; ++k) add(static_cast<double>(k) / m.multiple, m.harmonic(coordinate, static_cast<double>(k) / m.multiple));
    return;
  }
  const Vector q = m.record.row(coordinate).transpose();
  const double samples = static_cast<double>(q.size()) / m.record_periods;
  add(0.0, q.mean());
  for (const auto& line : spectral_lines({q.data(), static_cast<std::size_t>(q.size())}, {.floor = 1e-3, .most = 40}))
    if (line.frequency * samples <= 8.0) add(line.frequency * samples, line.amplitude);
}

}  // namespace

void add_integration_keys(Schema& s) {
  s.add({.name = "integration.relative_tolerance",
         .description = "of the explicit integrator on the way to an attractor",
         .default_value = 1e-8,
         .lower = 1e-14,
         .upper = 1e-3});
  s.add({.name = "integration.absolute_tolerance",
         .description = "likewise, in the units of coordinates and velocities",
         .default_value = 1e-10,
         .lower = 0.0,
         .upper = 1.0});
  s.add({.name = "integration.fine_tolerance",
         .description = "relative, of attractors, exponents, recorded motions and checks; their absolute one is a hundredth",
         .default_value = 1e-11,
         .lower = 1e-14,
         .upper = 1e-6});
  s.add_count("integration.max_periods", "excitation periods after which a motion counts as unsettled", 4000, 1, 1e7);
  s.add_count("integration.max_multiple", "longest period looked for, in excitation periods", 12, 1, 1e7);
  s.add_count("integration.nonperiodic_after", "excitation periods after which a motion that is not periodic yet is asked for its Lyapunov exponent",
              400, 1, 1e7);
  s.add_count("integration.lyapunov_periods", "excitation periods of a Lyapunov exponent; points of the section of a motion without period", 800, 64,
              1e7);
}

AttractorOptions attractor_options_of(const Configuration& c) {
  AttractorOptions o;
  o.transient.relative_tolerance = c.number("integration.relative_tolerance");
  o.transient.absolute_tolerance = c.number("integration.absolute_tolerance");
  o.fine.relative_tolerance = c.number("integration.fine_tolerance");
  o.fine.absolute_tolerance = 0.01 * o.fine.relative_tolerance;
  o.max_periods = static_cast<int>(c.integer("integration.max_periods"));
  o.max_multiple = static_cast<int>(c.integer("integration.max_multiple"));
  o.nonperiodic_after = static_cast<int>(c.integer("integration.nonperiodic_after"));
  o.lyapunov_periods = static_cast<int>(c.integer("integration.lyapunov_periods"));
  o.interrupted = &interrupted;
  return o;
}

std::vector<Reflection> state_reflections(const ForcedSystem& s) {
  std::vector<Reflection> all;
  for (const auto& r : s.reflections) {
    const auto n = static_cast<Eigen::Index>(r.signs.size());
    Vector signs(2 * n);
    for (Eigen::Index i = 0; i < n; ++i) signs[i] = signs[n + i] = r.signs[static_cast<std::size_t>(i)];
    all.push_back({signs, r.subtype});
  }
  return all;
}

std::vector<std::string> state_names(const ForcedSystem& s) {
  std::vector<std::string> names = s.coordinates;
  for (const auto& q : s.coordinates) names.push_back(q + "'");
  return names;
}

std::string state_unit(const ForcedSystem& s, int state) {
  if (state < static_cast<int>(s.coordinates.size())) return s.length_unit;
  return s.length_unit == "-" ? "1/s" : s.length_unit + "/s";
}

Vector perturbed(Vector y, const std::vector<Reflection>& reflections, double amount) {
  for (const auto& r : reflections) {
    if ((y - r.signs.cwiseProduct(y)).norm() > 1e-12 * (1.0 + y.norm())) continue;
    for (Eigen::Index i = 0; i < y.size() / 2; ++i)
      if (r.signs[i] < 0.0) y[i] += amount;
  }
  return y;
}

std::vector<Column> attractor_columns(const std::vector<AttractorRow>& rows, const ForcedSystem& s) {
  std::vector<Column> table{
      column_of(rows, "omega", "rad/s", "excitation frequency", [](const auto& r) { return r.omega; }),
      column_of(rows, "multiple", "-", "period in excitation periods, 0 if not periodic", [](const auto& r) { return r.attractor->multiple; }),
      column_of(rows, "lyapunov", "1/s", "largest Lyapunov exponent; of a periodic motion from its multipliers",
                [](const auto& r) { return r.attractor->lyapunov; }),
      column_of(rows, "lyapunov_error", "1/s", "twice the standard error of stretches of the run",
                [](const auto& r) { return r.attractor->lyapunov_error; }),
      column_of(rows, "multiplier", "-", "largest modulus of a Floquet multiplier", largest_multiplier),
      column_of(rows, "second_frequency", "-", "over omega, modulo 1 and sign; 0 if there is none",
                [](const auto& r) { return r.attractor->second_frequency; }),
      column_of(rows, "residual", s.length_unit, "distance after the period; of one excitation period where there is none",
                [](const auto& r) { return r.attractor->residual; })};
  for (std::size_t i = 0; i < s.coordinates.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const std::string& q = s.coordinates[i];
    table.push_back(column_of(rows, q + "_max", s.length_unit, "largest " + q, [k](const auto& r) { return r.motion.record.row(k).maxCoeff(); }));
    table.push_back(column_of(rows, q + "_min", s.length_unit, "least " + q, [k](const auto& r) { return r.motion.record.row(k).minCoeff(); }));
    table.push_back(column_of(rows, q + "_crest", s.length_unit, "largest " + q + ", named as in periodic results",
                              [k](const auto& r) { return r.motion.record.row(k).maxCoeff(); }));
    table.push_back(column_of(rows, q + "_trough", s.length_unit, "least " + q + ", named as in periodic results",
                              [k](const auto& r) { return r.motion.record.row(k).minCoeff(); }));
    for (const auto& [h, name] : harmonics_of(rows))
      table.push_back(column_of(rows, fmt::format("{}_h{}", q, name), s.length_unit, fmt::format("amplitude of {} omega in {}", name, q),
                                [i, h = h](const auto& r) { return std::abs(r.motion.harmonic(static_cast<int>(i), h)); }));
  }
  return table;
}

std::vector<TextColumn> attractor_texts(const std::vector<AttractorRow>& rows) {
  std::vector<TextColumn> t{{"attractor", "name", {}},
                            {"motion", "periodic, quasi-periodic, chaotic, unsettled", {}},
                            {"mirror", "name of its mirror image, if that is another attractor", {}},
                            {"symmetry", "reflections that map it to itself", {}}};
  for (const auto& r : rows) {
    t[0].values.push_back(r.name);
    t[1].values.emplace_back(to_string(r.attractor->kind));
    t[2].values.push_back(r.mirror);
    std::string all;
    for (const auto& name : r.attractor->symmetries) all += (all.empty() ? "" : " ") + name;
    t[3].values.push_back(all);
  }
  return t;
}

std::string attractor_text(const std::vector<AttractorRow>& rows, const ForcedSystem& s, const std::vector<std::string>& extra_heads,
                           const std::vector<std::vector<std::string>>& extra) {
  std::string out = fmt::format("{:<5} {:>9} {:<16} {:>9} {:>8} {:>8} {:<7}", "name", "omega", "motion", "lyapunov", "+-", "|mu|", "mirror");
  for (const auto& h : extra_heads) out += fmt::format(" {:>9}", h);
  for (const auto& q : s.coordinates) out += fmt::format("  {:<40}", fmt::format("{}, multiple of omega: amplitude", q));
  out += '\n';
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto& r = rows[i];
    const std::string mu = r.attractor->multipliers.size() > 0 ? fmt::format("{:.5f}", largest_multiplier(r)) : std::string("-");
    out += fmt::format("{:<5} {:>9.5f} {:<16} {:>9.5f} {:>8.1e} {:>8} {:<7}", r.name, r.omega, name_of(r.attractor->kind, r.attractor->multiple),
                       r.attractor->lyapunov, r.attractor->lyapunov_error, mu, r.mirror.empty() ? "-" : r.mirror.c_str());
    if (i < extra.size())
      for (const auto& e : extra[i]) out += fmt::format(" {:>9}", e);
    for (int q = 0; q < static_cast<int>(s.coordinates.size()); ++q) out += fmt::format("  {:<40}", strongest(r, q));
    out += '\n';
  }
  return out;
}

void put_attractor(Json& o, const AttractorRow& r, const ForcedSystem& s) {
  o.put("attractor", r.name).put("omega", r.omega).put("motion", to_string(r.attractor->kind)).put("period", r.attractor->multiple);
  o.put("lyapunov", r.attractor->lyapunov).put("lyapunov_error", r.attractor->lyapunov_error);
  o.put("second_frequency", r.attractor->second_frequency).put("mirror", r.mirror).put("residual", r.attractor->residual);
  for (std::size_t q = 0; q < s.coordinates.size(); ++q) {
    const auto values = r.motion.record.row(static_cast<Eigen::Index>(q));
    o.put(s.coordinates[q] + "_crest", values.maxCoeff()).put(s.coordinates[q] + "_trough", values.minCoeff());
    for (const auto& [h, name] : harmonics_of({r}))
      o.put(fmt::format("{}_h{}", s.coordinates[q], name), std::abs(r.motion.harmonic(static_cast<int>(q), h)));
  }
}

void write_motion_tables(ResultFile& file, const std::string& group, const AttractorRow& row, const ForcedSystem& s) {
  const SteadyMotion& m = row.motion;
  const auto names = state_names(s);
  std::vector<Column> series{{"t", "s", "time from omega t = 0", {}}};
  const double step = two_pi / m.omega * m.record_periods / static_cast<double>(m.record.cols());
  for (Eigen::Index j = 0; j < m.record.cols(); ++j) series[0].values.push_back(step * static_cast<double>(j));
  for (std::size_t i = 0; i < names.size(); ++i) {
    const Vector v = m.record.row(static_cast<Eigen::Index>(i)).transpose();
    series.push_back({names[i], state_unit(s, static_cast<int>(i)), "settled motion", {v.begin(), v.end()}});
  }
  if (s.tension) {
    const auto tension = s.tension(Vector::Constant(1, m.omega));
    const auto n = static_cast<Eigen::Index>(s.coordinates.size());
    Column c{"tension", "N", "averaged along the chord", {}};
    for (Eigen::Index j = 0; j < m.record.cols(); ++j)
      c.values.push_back(tension(m.record.col(j).head(n), m.omega * series[0].values[static_cast<std::size_t>(j)]));
    series.push_back(std::move(c));
  }
  file.table(group + "/series", series);
  Table lines{{{"coordinate", "-", "1 for the first coordinate", {}},
               {"harmonic", "-", "frequency over omega", {}},
               {"amplitude", s.length_unit, "of the line", {}},
               {"phase", "rad", "of amplitude cos(harmonic omega t + phase)", {}}},
              {}};
  for (std::size_t i = 0; i < s.coordinates.size(); ++i) add_lines(lines, row, static_cast<int>(i));
  file.table(group + "/spectrum", lines.columns);
  if (m.kind != MotionKind::periodic) {
    std::vector<Column> whole{{"harmonic", "-", "frequency over omega", {}}};
    for (std::size_t i = 0; i < s.coordinates.size(); ++i) {
      const Vector q = m.record.row(static_cast<Eigen::Index>(i)).transpose();
      auto a = amplitude_spectrum({q.data(), static_cast<std::size_t>(q.size())});
      a.resize(std::min(a.size(), static_cast<std::size_t>(8 * m.record_periods) + 1));
      whole.push_back({s.coordinates[i], s.length_unit, "Hann-windowed amplitude", std::move(a)});
    }
    for (std::size_t k = 0; k < whole[1].values.size(); ++k) whole[0].values.push_back(static_cast<double>(k) / m.record_periods);
    file.table(group + "/amplitude_spectrum", whole);
  }
  file.attribute(group, "omega", row.omega);
  file.attribute(group, "attractor", row.name);
  file.attribute(group, "motion", std::string(to_string(m.kind)));
  file.attribute(group, "multiple", static_cast<double>(m.multiple));
}

void write_section(ResultFile& file, const std::string& group, const Matrix& points, const ForcedSystem& s) {
  std::vector<Column> table;
  const auto names = state_names(s);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const Vector v = points.row(static_cast<Eigen::Index>(i)).transpose();
    table.push_back({names[i], state_unit(s, static_cast<int>(i)), "stroboscopic points", {v.begin(), v.end()}});
  }
  file.table(group, table);
}

}  // namespace whirl::studies
