#include "studies/slow_flow_verification.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "core/parallel.hpp"
#include "studies/common_keys.hpp"

namespace whirl::studies {
namespace {

using models::Ansatz;
using models::MotionKind;
using models::SteadyMotion;

constexpr double two_pi = 2.0 * std::numbers::pi;

Vector one(double x) { return Vector::Constant(1, x); }

// Which coordinates move, and with fractions of omega or without: per coordinate, whole and fractional. Averaged and settled motion are compared
// only where these agree.
template <class Amplitude>
std::vector<bool> kind_of(const Ansatz& ansatz, int highest, const Amplitude& amplitude_at) {
  std::vector<double> share(2 * static_cast<std::size_t>(ansatz.coordinates()), 0.0);
  double largest = 0.0;
  for (int i = 0; i < ansatz.coordinates(); ++i)
    for (int k = 0; k <= highest; ++k) {
      double& part = share[2 * static_cast<std::size_t>(i) + (k % ansatz.nu != 0 ? 1 : 0)];
      part = std::max(part, amplitude_at(i, k));
      largest = std::max(largest, part);
    }
  std::vector<bool> kind;
  for (const double part : share) kind.push_back(part > 1e-3 * largest);
  return kind;
}

std::vector<bool> kind_of(const Ansatz& ansatz, const SteadyMotion& m) {
  return kind_of(ansatz, 5 * ansatz.nu, [&](int i, int k) { return amplitude_of(ansatz, m, i, k); });
}

// The stable averaged solution of the settled motion's kind whose amplitudes are nearest.
std::optional<AveragedSolution> nearest_stable(const Ansatz& ansatz, const std::vector<AveragedSolution>& solutions, const SteadyMotion& m) {
  std::optional<AveragedSolution> best;
  const std::vector<bool> kind = kind_of(ansatz, m);
  double least = 1e300;
  for (const auto& s : solutions) {
    const auto x = s.u.head(ansatz.size());
    if (!s.stable || kind_of(ansatz, ansatz.highest(), [&](int i, int k) { return std::abs(amplitude(ansatz, x, i, k)); }) != kind) continue;
    double distance = 0.0;
    for (int i = 0; i < ansatz.coordinates(); ++i)
      for (const int k : ansatz.harmonics[static_cast<std::size_t>(i)])
        distance += std::pow(std::abs(amplitude(ansatz, x, i, k)) - amplitude_of(ansatz, m, i, k), 2);
    if (distance < least) {
      least = distance;
      best = s;
    }
  }
  return best;
}

// A stable averaged solution is a motion of its own kind; amplitudes are of first order and decide between solutions only.
std::string contradiction_of(const Ansatz& ansatz, const IntegratedRun& run) {
  const SteadyMotion& m = run.motion;
  if (!run.told || !run.told->stable || m.record.cols() == 0) return "";
  if (m.kind == MotionKind::quasi_periodic || m.kind == MotionKind::chaotic) return fmt::format("settles on a {} motion", to_string(m.kind));
  if (m.kind != MotionKind::periodic) return "";  // has not settled, which is reported as such
  if (ansatz.nu % m.multiple != 0) return fmt::format("settles on a motion of {} excitation periods", m.multiple);
  if (!run.averaged) return "settles on a motion that no stable solution is like";
  return run.averaged->u != run.told->u ? fmt::format("settles nearer to another stable solution, of {}", run.averaged->branch) : "";
}

Matrix transient_of(const models::ModalSystem<double>& system, const Vector& start, const IntegrationOptions& o) {
  const int n = system.size(), total = o.transient_periods * IntegrationOptions::transient_samples;
  const auto flow = [&system](double t, std::span<const double> y, std::span<double> d) { system.flow<double>(system.omega * t, y, d); };
  Integrator run(flow, 0.0, start, o.settle.integrator);
  Matrix out(n, total + 1);
  out.col(0) = start.head(n);
  for (int j = 1; j <= total; ++j) {
    if (!run.advance(two_pi / system.omega * j / IntegrationOptions::transient_samples)) return out.leftCols(j);
    out.col(j) = run.state().head(n);
  }
  return out;
}

std::vector<Column> series(const ForcedSystem& forced, const std::string& what) {
  std::vector<Column> table{{"t", "s", "time", {}}};
  for (const auto& q : forced.coordinates) table.push_back({q, forced.length_unit, what, {}});
  return table;
}

template <class Value>
Column column_of(const std::vector<IntegratedRun>& runs, const std::string& name, const std::string& unit, const std::string& description,
                 const Value& value) {
  Column c{name, unit, description, {}};
  for (const auto& r : runs) c.values.push_back(static_cast<double>(value(r)));
  return c;
}

void write_motion(ResultFile& file, const ForcedSystem& forced, const IntegratedRun& run, std::size_t number) {
  const SteadyMotion& m = run.motion;
  const int n = static_cast<int>(forced.coordinates.size());
  const std::string groups[] = {fmt::format("/verification/series/run{}", number), fmt::format("/verification/spectra/run{}", number),
                                fmt::format("/verification/transients/run{}", number)};
  std::vector<Column> record = series(forced, "displacement after settling, integrated");
  for (Eigen::Index j = 0; j < m.record.cols(); ++j) {
    record[0].values.push_back(two_pi / m.omega * m.record_periods * static_cast<double>(j) / static_cast<double>(m.record.cols()));
    for (int i = 0; i < n; ++i) record[std::size_t(i + 1)].values.push_back(m.record(i, j));
  }
  file.table(groups[0], record);
  std::vector<Column> spectrum{{"harmonic", "-", "frequency over excitation frequency", {}}};
  for (const auto& q : forced.coordinates) spectrum.push_back({q, forced.length_unit, "amplitude", {}});
  const int parts = m.kind == MotionKind::periodic ? m.multiple : 8;
  for (int k = 0; k <= 5 * parts; ++k) {
    spectrum[0].values.push_back(static_cast<double>(k) / parts);
    for (int i = 0; i < n; ++i) spectrum[std::size_t(i + 1)].values.push_back(std::abs(m.harmonic(i, static_cast<double>(k) / parts)));
  }
  file.table(groups[1], spectrum);
  if (run.transient.cols() > 0) {
    std::vector<Column> start = series(forced, "displacement from the start on, integrated");
    for (Eigen::Index j = 0; j < run.transient.cols(); ++j) {
      start[0].values.push_back(two_pi / m.omega * static_cast<double>(j) / IntegrationOptions::transient_samples);
      for (int i = 0; i < n; ++i) start[std::size_t(i + 1)].values.push_back(run.transient(i, j));
    }
    file.table(groups[2], start);
  }
  for (const auto& group : groups) {
    if (&group == &groups[2] && run.transient.cols() == 0) continue;
    file.attribute(group, "omega", run.omega);
    file.attribute(group, "start", run.start_name);
    file.attribute(group, "motion", std::string(to_string(m.kind)));
    file.attribute(group, "multiple", static_cast<double>(m.multiple));
  }
}

// (coordinate, harmonic in omega/nu) of the `count` largest amplitudes, means left out, in the ansatz's order.
template <class Size>
std::vector<std::pair<int, int>> largest_harmonics(const Ansatz& a, std::size_t count, const Size& size) {
  std::vector<std::pair<int, int>> all;
  for (int i = 0; i < a.coordinates(); ++i)
    for (const int k : a.harmonics[static_cast<std::size_t>(i)])
      if (k > 0) all.emplace_back(i, k);
  const auto larger = [&](const auto& p, const auto& q) { return size(p.first, p.second) > size(q.first, q.second); };
  std::stable_sort(all.begin(), all.end(), larger);
  if (all.size() > count) all.resize(count);
  std::sort(all.begin(), all.end());
  return all;
}

}  // namespace

double amplitude_of(const Ansatz& ansatz, const SteadyMotion& motion, int i, int k) {
  if (motion.record.cols() == 0) return std::nan("");
  return std::abs(motion.harmonic(i, static_cast<double>(k) / ansatz.nu));
}

std::vector<IntegratedRun> integrate_beside(const ForcedSystem& forced, const AveragedEquations& averaged, const std::vector<double>& omegas,
                                            const std::vector<std::vector<AveragedSolution>>& solutions, const IntegrationOptions& o,
                                            RunContext& context) {
  const int n = static_cast<int>(forced.coordinates.size());
  std::vector<IntegratedRun> runs;
  std::vector<std::size_t> frequency;
  const auto add = [&](std::size_t w, const Vector& y, const std::string& name, bool at_rest) {
    runs.push_back({omegas[w], off_symmetry(forced, y, o.perturbation), name, at_rest, {}, std::nullopt, {}, std::nullopt, {}});
    frequency.push_back(w);
  };
  for (std::size_t w = 0; w < omegas.size(); ++w) {
    for (const auto& s : solutions[w]) {
      add(w, averaged.motion(s.u, 0.0), fmt::format("{} ({})", s.branch, s.stable ? "stable" : "unstable"), false);
      runs.back().told = s;
    }
    for (const auto& start : o.starts) {
      Vector y = Vector::Zero(2 * n);
      std::string name;
      for (int i = 0; i < n; ++i) {
        y[i] = start[std::size_t(i)];
        name += fmt::format("{}{} = {:g}", i > 0 ? ", " : "", forced.coordinates[std::size_t(i)], y[i]);
      }
      add(w, y, name, true);
    }
  }
  std::atomic<std::size_t> done{0};
  parallel_for(runs.size(), [&](std::size_t i) {
    if (interrupted) return;
    auto settle_options = o.settle;
    settle_options.interrupted = &interrupted;
    const auto system = forced.at(one(runs[i].omega));
    runs[i].motion = models::settle(system, runs[i].start, settle_options);
    if (runs[i].at_rest) runs[i].transient = transient_of(system, runs[i].start, o);
    if (runs[i].motion.record.cols() > 0) runs[i].averaged = nearest_stable(averaged.ansatz, solutions[frequency[i]], runs[i].motion);
    runs[i].contradiction = contradiction_of(averaged.ansatz, runs[i]);
    context.progress.show(fmt::format("verification: {} of {} runs", ++done, runs.size()));
  });
  std::erase_if(runs, [](const IntegratedRun& r) { return r.motion.record.cols() == 0 && r.motion.why.empty(); });  // not begun
  return runs;
}

void write_averaged(ResultFile& file, const ForcedSystem& forced, const AveragedEquations& averaged,
                    const std::vector<std::vector<AveragedSolution>>& solutions) {
  constexpr int samples = 128;  // per excitation period
  const int total = samples * averaged.ansatz.nu;
  for (const auto& at_omega : solutions)
    for (std::size_t k = 0; k < at_omega.size(); ++k) {
      const auto& s = at_omega[k];
      const double omega = s.u[s.u.size() - 1];
      std::vector<Column> table = series(forced, "displacement, averaged");
      for (int j = 0; j <= total; ++j) {
        const double t = two_pi / omega * j / samples;
        const Vector y = averaged.motion(s.u, t);
        table[0].values.push_back(t);
        for (std::size_t i = 0; i + 1 < table.size(); ++i) table[i + 1].values.push_back(y[static_cast<Eigen::Index>(i)]);
      }
      const std::string group = fmt::format("/verification/averaged/{}-{}", frequency_label(omega), k + 1);
      file.table(group, table);
      file.attribute(group, "omega", omega);
      file.attribute(group, "branch", s.branch);
      file.attribute(group, "stable", s.stable ? 1.0 : 0.0);
    }
}

void write_integrated(ResultFile& file, const ForcedSystem& forced, const AveragedEquations& averaged, const std::vector<IntegratedRun>& runs) {
  const Ansatz& a = averaged.ansatz;
  std::vector<Column> table{column_of(runs, "omega", "rad/s", "excitation frequency", [](const auto& r) { return r.omega; })};
  for (const bool integrated : {true, false})
    for (int i = 0; i < a.coordinates(); ++i)
      for (const int k : a.harmonics[static_cast<std::size_t>(i)]) {
        const std::string name = harmonic_name(forced.coordinates[static_cast<std::size_t>(i)], static_cast<double>(k) / a.nu);
        if (integrated)
          table.push_back(
              column_of(runs, name, forced.length_unit, "amplitude, integrated", [&](const auto& r) { return amplitude_of(a, r.motion, i, k); }));
        else
          table.push_back(column_of(
              runs, "averaged_" + name, forced.length_unit, "amplitude of the nearest stable averaged motion of this kind; NaN where there is none",
              [&](const auto& r) { return r.averaged ? std::abs(amplitude(a, r.averaged->u.head(a.size()), i, k)) : std::nan(""); }));
      }
  table.push_back(column_of(runs, "multiple", "-", "period of the motion in excitation periods, 0 if not periodic",
                            [](const auto& r) { return r.motion.multiple; }));
  table.push_back(column_of(runs, "periods", "-", "excitation periods integrated", [](const auto& r) { return r.motion.periods_integrated; }));
  table.push_back(column_of(runs, "distance", "-", "last stroboscopic distance", [](const auto& r) { return r.motion.distance; }));
  TextColumn start{"start", "where the run began", {}},
      branch{"branch", "branch of the nearest stable averaged motion of this kind; empty where there is none", {}},
      kind{"motion", "periodic, quasi-periodic, chaotic, unsettled or failed", {}};
  for (const auto& r : runs) {
    start.values.push_back(r.start_name);
    branch.values.push_back(r.averaged ? r.averaged->branch : "");
    kind.values.emplace_back(to_string(r.motion.kind));
  }
  file.table("/verification/runs", table, {start, branch, kind});
  for (std::size_t i = 0; i < runs.size(); ++i)
    if (runs[i].motion.record.cols() > 0) write_motion(file, forced, runs[i], i + 1);
}

std::vector<std::string> not_settled(const std::vector<IntegratedRun>& runs) {
  std::vector<std::string> failures;
  if (interrupted) return failures;
  for (const auto& r : runs)
    if (r.motion.kind == MotionKind::unsettled || r.motion.kind == MotionKind::failed || r.motion.kind == MotionKind::diverging)
      failures.push_back(fmt::format("omega = {:g}, {}: {}", r.omega, r.start_name, r.motion.why));
    else if (!r.contradiction.empty())
      failures.push_back(
          fmt::format("verification contradicts {} at omega = {:g}: the motion that starts there {}", r.start_name, r.omega, r.contradiction));
  return failures;
}

void report_integrated(Json& results, const ForcedSystem& forced, const AveragedEquations& averaged, const std::vector<IntegratedRun>& runs) {
  const Ansatz& a = averaged.ansatz;
  Json rows = Json::array();
  for (const auto& r : runs) {
    Json o = Json::object();
    o.put("omega", r.omega).put("start", r.start_name).put("motion", to_string(r.motion.kind)).put("period", r.motion.multiple);
    o.put("branch", r.averaged ? Json(r.averaged->branch) : Json()).put("why", r.motion.why);
    for (std::size_t i = 0; i < forced.coordinates.size(); ++i)
      for (int k = 0; k <= a.highest(); ++k) {
        const std::string name = harmonic_name(forced.coordinates[i], static_cast<double>(k) / a.nu);
        o.put(name, r.motion.record.cols() > 0 ? amplitude_of(a, r.motion, static_cast<int>(i), k) : std::nan(""));
      }
    rows.add(std::move(o));
  }
  results.put("verification", std::move(rows));
}

std::string integrated_text(const ForcedSystem& forced, const AveragedEquations& averaged, const std::vector<IntegratedRun>& runs) {
  const Ansatz& a = averaged.ansatz;
  const auto averaged_amplitude = [&](const IntegratedRun& r, int i, int k) { return std::abs(amplitude(a, r.averaged->u.head(a.size()), i, k)); };
  const auto shown = largest_harmonics(a, 4, [&](int i, int k) {
    double most = 0.0;  // fmax: a run that failed has no amplitude
    for (const auto& r : runs) most = std::fmax(most, std::fmax(amplitude_of(a, r.motion, i, k), r.averaged ? averaged_amplitude(r, i, k) : 0.0));
    return most;
  });
  std::size_t width = 20;
  for (const auto& r : runs) width = std::max(width, r.start_name.size());
  std::string out = fmt::format("{:>8} {:<{}} {:<14}", "omega", "start", width, "settles as");
  for (const auto& [i, k] : shown)
    out += fmt::format(" {:>17}", harmonic_name(forced.coordinates[static_cast<std::size_t>(i)], static_cast<double>(k) / a.nu) + " int/avg");
  out += "  nearest stable branch\n";
  for (const auto& r : runs) {
    if (r.motion.record.cols() == 0) {
      out += fmt::format("{:>8.4f} {:<{}} {}\n", r.omega, r.start_name, width, r.motion.why);
      continue;
    }
    const std::string kind = r.motion.multiple > 1 ? fmt::format("periodic {}T", r.motion.multiple) : to_string(r.motion.kind);
    out += fmt::format("{:>8.4f} {:<{}} {:<14}", r.omega, r.start_name, width, kind);
    for (const auto& [i, k] : shown) {
      const std::string avg = r.averaged ? fmt::format("{:.4f}", averaged_amplitude(r, i, k)) : "-";
      out += fmt::format(" {:>8.4f} {:>8}", amplitude_of(a, r.motion, i, k), avg);
    }
    out += fmt::format("  {}\n", r.averaged ? r.averaged->branch : "-");
  }
  return out;
}

}  // namespace whirl::studies
