#include "studies/orbit_output.hpp"

#include <fmt/format.h>

#include <memory>
#include <numbers>
#include <optional>

#include "core/parallel.hpp"

namespace whirl::studies {

using namespace models;

namespace {

constexpr int samples = 512;  // of a period, for peaks and series

// Amplitude and phase of harmonic k omega in coordinate i; zero where the motion's balance has no such harmonic.
std::complex<double> amplitude(const HarmonicBalance& hb, In u, int i, double k) {
  const double multiple = k * hb.nu();
  const int h = static_cast<int>(std::lround(multiple));
  if (std::abs(multiple - h) > 1e-9 || h > hb.harmonics()) return 0.0;
  if (h == 0) return u[hb.index(i, 0)];
  return {u[hb.index(i, h)], -u[hb.index(i, h) + 1]};
}

// cos(2 pi j / samples); the sine stands a quarter of the table before.
const std::array<double, samples>& cosines() {
  static const auto table = [] {
    std::array<double, samples> t{};
    for (int j = 0; j < samples; ++j) t[static_cast<std::size_t>(j)] = std::cos(2.0 * std::numbers::pi * j / samples);
    return t;
  }();
  return table;
}

// Coordinate i at sample m of the base period.
double displacement(const HarmonicBalance& hb, In u, int i, int m) {
  const auto& cosine = cosines();
  double q = u[hb.index(i, 0)];
  for (int k = 1; k <= hb.harmonics(); ++k) {
    const int at = (k * m) % samples;
    q += u[hb.index(i, k)] * cosine[static_cast<std::size_t>(at)] +
         u[hb.index(i, k) + 1] * cosine[static_cast<std::size_t>((at + 3 * samples / 4) % samples)];
  }
  return q;
}

// The largest of periodic samples, by a parabola through it and its neighbours: the error falls with the fourth power of the spacing.
double top_of_samples(const Vector& f) {
  Eigen::Index at = 0;
  const auto n = f.size();
  const double top = f.maxCoeff(&at), before = f[(at + n - 1) % n], after = f[(at + 1) % n], bend = before - 2.0 * top + after;
  return bend < 0.0 ? top - 0.125 * (after - before) * (after - before) / bend : top;
}

// Largest tension over the period, at every fourth sample and a parabola through the largest.
double largest_tension(const ForcedSystem& source, const HarmonicBalance& hb, In u) {
  constexpr int every = 4, count = samples / every;
  const auto tension = source.tension(u.tail(hb.parameters()));
  Vector q(hb.coordinates()), T(count);
  for (int m = 0; m < count; ++m) {
    for (int i = 0; i < hb.coordinates(); ++i) q[i] = displacement(hb, u, i, every * m);
    T[m] = tension(q, 2.0 * std::numbers::pi * hb.nu() * m / count);
  }
  return top_of_samples(T);
}

double farthest(const Eigen::VectorXcd& from, const Eigen::VectorXcd& to) {
  double worst = 0.0;
  for (const auto& a : from) worst = std::max(worst, (to.array() - a).abs().minCoeff() / std::max(1.0, std::abs(a)));
  return worst;
}

}  // namespace

Extremes extremes(const HarmonicBalance& hb, In u, int coordinate) {
  Vector q(samples);
  for (int m = 0; m < samples; ++m) q[m] = displacement(hb, u, coordinate, m);
  const double highest = top_of_samples(q), lowest = 0.0 - top_of_samples(-q);  // 0, not -0, at rest
  return {highest, lowest};
}

double peak(const HarmonicBalance& hb, In u, int coordinate) { return extremes(hb, u, coordinate).largest(); }

namespace {

// Extremes of the coordinates of the point last asked about: three columns want those of each.
class ExtremesOfPoint {
 public:
  explicit ExtremesOfPoint(const OrbitBranches& orbits) : orbits_(orbits) {}
  const Extremes& at(In u, int coordinate) {
    if (point_.size() != u.size() || point_ != u) {
      point_ = u;
      known_.assign(static_cast<std::size_t>(orbits_.balance_of(u).coordinates()), std::nullopt);
    }
    auto& known = known_[static_cast<std::size_t>(coordinate)];
    if (!known) known = extremes(orbits_.balance_of(u), u, coordinate);
    return *known;
  }

 private:
  const OrbitBranches& orbits_;
  Vector point_;
  std::vector<std::optional<Extremes>> known_;
};

}  // namespace

BranchOutput orbit_output(const OrbitBranches& orbits, const std::string& parameter, int harmonics) {
  BranchOutput out;
  const ForcedSystem& source = orbits.source();
  out.parameter = parameter;
  out.parameter_unit = source.lens_units.front();
  out.multipliers = true;
  out.period_of = [&orbits](In u) { return static_cast<double>(orbits.balance_of(u).nu()); };
  const int finest = orbits.period(orbits.levels() - 1);
  const auto at = std::make_shared<ExtremesOfPoint>(orbits);
  for (std::size_t c = 0; c < source.coordinates.size(); ++c) {
    const int i = static_cast<int>(c);
    const std::string& q = source.coordinates[c];
    const auto add = [&](const char* name, const std::string& description, auto value) {
      out.columns.push_back({q + name, source.length_unit, description, [at, i, value](In u) { return value(at->at(u, i)); }});
    };
    add("_max", "largest |" + q + "| over the period", [](const Extremes& e) { return e.largest(); });
    add("_crest", "largest " + q + " over the period, with its sign", [](const Extremes& e) { return e.highest; });
    add("_trough", "least " + q + " over the period, with its sign", [](const Extremes& e) { return e.lowest; });
    for (int h = 0; h <= harmonics * finest; ++h) {
      const double k = static_cast<double>(h) / finest;
      const std::string name = harmonic_name(q, k);
      out.columns.push_back({name, source.length_unit, fmt::format("amplitude of cos({:g} omega t + phase) in {}", k, q), [&orbits, i, k](In u) {
                               return k == 0.0 ? amplitude(orbits.balance_of(u), u, i, k).real() : std::abs(amplitude(orbits.balance_of(u), u, i, k));
                             }});
      if (h > 0)
        out.columns.push_back(
            {name + "_phase", "rad", "its phase", [&orbits, i, k](In u) { return std::arg(amplitude(orbits.balance_of(u), u, i, k)); }});
    }
  }
  if (source.tension)
    out.columns.push_back({"tension_max", "N", "largest tension over the period: averaged along the chord, T + AE (mean strain)",
                           [&orbits](In u) { return largest_tension(orbits.source(), orbits.balance_of(u), u); }});
  if (parameter == "omega")
    out.columns.push_back({"frequency", "Hz", "omega / 2 pi", [](In u) { return u[u.size() - 1] / (2.0 * std::numbers::pi); }});
  // The printed table: peaks and first harmonics of the leading coordinates.
  for (auto& column : out.columns)
    for (const int c : leading_coordinates(source)) {
      const std::string& q = source.coordinates[static_cast<std::size_t>(c)];
      column.shown = column.shown || column.name == q + "_max" || column.name == q + "_h1";
    }
  return out;
}

void write_orbit(ResultFile& file, const std::string& group, const OrbitBranches& orbits, const OrbitBranches::Motion& motion) {
  const HarmonicBalance& hb = orbits.balance(motion.level);
  const ForcedSystem& source = orbits.source();
  const double period = 2.0 * std::numbers::pi * hb.nu() / hb.system_at(motion.u).omega;
  const auto n = source.coordinates.size();
  std::vector<Column> table{{"t", "s", "time, cos(omega t) = 1 at t = 0", {}}};
  for (const auto& q : source.coordinates) table.push_back({q, source.length_unit, "displacement", {}});
  for (const auto& q : source.coordinates) table.push_back({q + "_rate", source.length_unit == "m" ? "m/s" : "1/s", "velocity", {}});
  ForcedSystem::Tension tension;
  if (source.tension) {
    tension = source.tension(motion.u.tail(hb.parameters()));
    table.push_back({"tension", "N", "averaged along the chord", {}});
  }
  for (int m = 0; m <= 256; ++m) {
    const double t = period * m / 256;
    const Vector y = hb.state_at(motion.u, t);
    table[0].values.push_back(t);
    for (std::size_t i = 0; i < 2 * n; ++i) table[i + 1].values.push_back(y[static_cast<Eigen::Index>(i)]);
    if (tension) table.back().values.push_back(tension(y.head(static_cast<Eigen::Index>(n)), 2.0 * std::numbers::pi * hb.nu() * m / 256));
  }
  file.table(group, table);
  file.attribute(group, "branch", motion.branch);
  file.attribute(group, "stable", motion.stable ? 1.0 : 0.0);
  file.attribute(group, "period", static_cast<double>(hb.nu()));
  file.attribute(group, "omega", hb.system_at(motion.u).omega);
}

std::vector<OrbitCheck> check_orbits(const OrbitBranches& orbits, const std::vector<double>& values, RunContext& context) {
  std::vector<OrbitCheck> checks;
  for (const double p : values)
    for (auto& motion : orbits.motions_at(p)) checks.push_back({p, motion, 0.0, 0.0, false});
  std::atomic<int> done{0};
  parallel_for(checks.size(), [&](std::size_t i) {
    if (interrupted) return;
    OrbitCheck& check = checks[i];
    HarmonicBalance hb = orbits.balance(check.motion.level);  // scratch of its own
    const Vector start = hb.state_at(check.motion.u, 0.0);
    const IntegratedPeriod period = monodromy_by_integration(hb.system_at(check.motion.u), start, hb.nu(), 1e-11);
    check.ok = period.ok;
    if (!period.ok) return;
    check.defect = (period.end - start).norm() / (start.norm() > 0.0 ? start.norm() : 1.0);
    const Eigen::VectorXcd integrated = period.monodromy.eigenvalues();
    check.multiplier = farthest(hb.floquet(check.motion.u).multipliers, integrated);
    const double sure = 10.0 * check.multiplier + 1e-7;  // a multiplier nearer to the unit circle is on neither side
    for (const auto& mu : integrated) {
      check.least_unstable += std::abs(mu) > 1.0 + sure ? 1 : 0;
      check.most_unstable += std::abs(mu) > 1.0 - sure ? 1 : 0;
    }
    context.progress.show(fmt::format("checking motions by integration, {} of {}", ++done, checks.size()));
  });
  context.progress.clear();
  return checks;
}

std::vector<std::string> contradictions(const std::vector<OrbitCheck>& checks, const std::string& parameter, double tolerance) {
  std::vector<std::string> lines;
  for (const auto& c : checks) {
    const std::string where = fmt::format("{} at {} = {:g}", c.motion.branch, parameter, c.p);
    if (!c.ok) continue;
    if (c.motion.told >= 0 && (c.motion.told < c.least_unstable || c.motion.told > c.most_unstable))
      lines.push_back(fmt::format("verification contradicts {}: told with {} unstable directions, integrated it has {}", where, c.motion.told,
                                  c.motion.told < c.least_unstable ? c.least_unstable : c.most_unstable));
    if (c.motion.stable && c.defect > tolerance)
      lines.push_back(fmt::format("verification contradicts {}: integrated over its period it misses its start by {:.1e}", where, c.defect));
  }
  return lines;
}

void write_checks(ResultFile& file, const OrbitBranches& orbits, const std::vector<OrbitCheck>& checks) {
  std::vector<Column> table{{"parameter", orbits.source().lens_units.front(), "continuation parameter", {}},
                            {"period", "-", "in excitation periods", {}},
                            {"stable", "-", "1: no multiplier outside the unit circle", {}},
                            {"defect", "-", "|x(nu T) - x(0)| / |x(0)|, CVODE at 1e-11", {}},
                            {"multiplier_error", "-", "largest distance of a multiplier from the nearest integrated one, relative above 1", {}},
                            {"truncation_error", "-", "bound on what the harmonics left out change", {}}};
  TextColumn branch{"branch", "branch the motion lies on", {}};
  for (const auto& c : checks) {
    const double numbers[] = {c.p,
                              static_cast<double>(orbits.period(c.motion.level)),
                              c.motion.stable ? 1.0 : 0.0,
                              c.ok ? c.defect : std::nan(""),
                              c.ok ? c.multiplier : std::nan(""),
                              orbits.balance(c.motion.level).truncation(c.motion.u).error};
    for (std::size_t i = 0; i < table.size(); ++i) table[i].values.push_back(numbers[i]);
    branch.values.push_back(c.motion.branch);
  }
  file.table("/verification/orbits", table, {branch});
}

std::string checks_text(const OrbitBranches& orbits, const std::vector<OrbitCheck>& checks, const std::string& parameter) {
  std::string out =
      fmt::format("{:>12} {:<7} {:>6} {:>7} {:>12} {:>12} {:>12}\n", parameter, "branch", "period", "stable", "defect", "multipliers", "truncation");
  for (const auto& c : checks)
    out += fmt::format("{:>12.6g} {:<7} {:>6} {:>7} {:>12.1e} {:>12.1e} {:>12.1e}\n", c.p, c.motion.branch, orbits.period(c.motion.level),
                       c.motion.stable ? "yes" : "no", c.ok ? c.defect : std::nan(""), c.ok ? c.multiplier : std::nan(""),
                       orbits.balance(c.motion.level).truncation(c.motion.u).error);
  return out;
}

}  // namespace whirl::studies
