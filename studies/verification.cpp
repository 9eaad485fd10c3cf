#include "studies/verification.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "core/parallel.hpp"
#include "models/nielsen_kirkegaard.hpp"

namespace whirl::studies {
namespace {

using models::MotionKind;
using models::SteadyMotion;

constexpr int harmonics_written = 5;  // 0 .. 5 of each coordinate

models::ModalSystem<double> system_at(const VerificationOptions& o, double omega) {
  auto stay = o.stay;
  stay.omega = omega;
  return models::nielsen_kirkegaard(stay, models::stay_model(stay.cable, o.coefficients), o.terms);
}

// The stable averaged solution nearest in (A, B) to a settled motion.
std::optional<AveragedState> nearest_stable(const models::SuperharmonicFlow& flow, const std::vector<AveragedState>& states, const SteadyMotion& m,
                                            int order) {
  std::optional<AveragedState> best;
  double distance = 1e300;
  for (const auto& s : states) {
    if (!s.stable) continue;
    const auto o = flow.observe(s.u);
    const double d = std::hypot(o.A - std::abs(m.harmonic(0, order)), o.B - std::abs(m.harmonic(1, order)));
    if (d < distance) {
      distance = d;
      best = s;
    }
  }
  return best;
}

// The averaged state is a motion of the excitation's period, in plane or whirling. Amplitudes are of first order: they decide between states only.
std::string contradiction_of(const models::SuperharmonicFlow& flow, const AveragedState& told, const std::vector<AveragedState>& states,
                             const SteadyMotion& m, int order) {
  constexpr double moves = 1e-3;  // of the larger amplitude
  if (!told.stable || m.record.cols() == 0) return "";
  if (m.kind == MotionKind::periodic && m.multiple > 1) return fmt::format("settles on a motion of {} excitation periods", m.multiple);
  if (m.kind == MotionKind::quasi_periodic || m.kind == MotionKind::chaotic) return fmt::format("settles on a {} motion", to_string(m.kind));
  if (m.kind != MotionKind::periodic) return "";  // has not settled, which is reported as such
  const auto whirls = [&](const Vector& q) { return q[0] > moves * q.maxCoeff(); };
  const auto o = flow.observe(told.u);
  const bool told_whirling = whirls(Eigen::Vector2d(o.A, o.B)), whirling = whirls(m.record.topRows(2).rowwise().lpNorm<Eigen::Infinity>());
  if (told_whirling != whirling) return whirling ? "settles whirling" : "settles in plane";
  const auto nearest = nearest_stable(flow, states, m, order);
  return nearest && nearest->u != told.u ? fmt::format("settles nearer to another stable state, of {}", nearest->branch) : "";
}

std::vector<Column> harmonic_columns(const std::vector<VerificationRun>& runs) {
  std::vector<Column> table;
  for (int i = 0; i < 2; ++i)
    for (int k = 0; k <= harmonics_written; ++k) {
      Column c{fmt::format("q{}_h{}", i + 1, k), "m", fmt::format("amplitude of harmonic {} of q{}, integrated", k, i + 1), {}};
      for (const auto& r : runs) c.values.push_back(r.motion.record.cols() > 0 ? std::abs(r.motion.harmonic(i, k)) : std::nan(""));
      table.push_back(std::move(c));
    }
  return table;
}

Column column_of(const std::vector<VerificationRun>& runs, const std::string& name, const std::string& unit, const std::string& description,
                 const std::function<double(const VerificationRun&)>& value) {
  Column c{name, unit, description, {}};
  for (const auto& r : runs) c.values.push_back(value(r));
  return c;
}

TextColumn kinds_of(const std::vector<VerificationRun>& runs) {
  TextColumn c{"motion", "periodic, quasi-periodic, chaotic, unsettled or failed", {}};
  for (const auto& r : runs) c.values.emplace_back(to_string(r.motion.kind));
  return c;
}

}  // namespace

std::vector<VerificationRun> verify(const models::SuperharmonicFlow& flow, const std::vector<double>& omegas,
                                    const std::vector<std::vector<AveragedState>>& states, const VerificationOptions& o, RunContext& context) {
  std::vector<VerificationRun> runs;
  std::vector<std::size_t> frequency;
  for (std::size_t w = 0; w < omegas.size(); ++w) {
    for (const auto& s : states[w]) {
      Vector y = flow.motion(s.u, 0.0);
      y[0] += o.perturbation;
      runs.push_back({omegas[w], y, fmt::format("{} ({})", s.branch, s.stable ? "stable" : "unstable"), s, {}});
      frequency.push_back(w);
    }
    for (std::size_t i = 0; i + 1 < o.starts.size(); i += 2) {
      const Eigen::Vector4d y(o.starts[i] + o.perturbation, o.starts[i + 1], 0.0, 0.0);
      runs.push_back({omegas[w], y, fmt::format("q1 = {:g}, q2 = {:g}", o.starts[i], o.starts[i + 1]), std::nullopt, {}});
      frequency.push_back(w);
    }
  }
  std::atomic<std::size_t> done{0};
  parallel_for(runs.size(), [&](std::size_t i) {
    if (interrupted) return;
    auto settle_options = o.settle;
    settle_options.interrupted = &interrupted;
    runs[i].motion = models::settle(system_at(o, runs[i].omega), runs[i].start, settle_options);
    if (runs[i].averaged) runs[i].contradiction = contradiction_of(flow, *runs[i].averaged, states[frequency[i]], runs[i].motion, o.order);
    else if (runs[i].motion.record.cols() > 0) runs[i].averaged = nearest_stable(flow, states[frequency[i]], runs[i].motion, o.order);
    context.progress.show(fmt::format("verification: {} of {} runs", ++done, runs.size()));
  });
  std::erase_if(runs, [](const VerificationRun& r) { return r.motion.record.cols() == 0 && r.motion.why.empty(); });  // not begun
  return runs;
}

std::vector<VerificationRun> sweep(const std::vector<double>& omegas, const VerificationOptions& o, RunContext& context) {
  std::vector<VerificationRun> runs;
  Vector y(4);
  y << o.perturbation, 0.0, 0.0, 0.0;
  for (const double omega : omegas) {
    if (interrupted) break;
    auto settle_options = o.settle;
    settle_options.interrupted = &interrupted;
    VerificationRun run{omega, y, "sweep", std::nullopt, models::settle(system_at(o, omega), y, settle_options)};
    y = run.motion.state;
    y[0] += o.perturbation;
    runs.push_back(std::move(run));
    if (runs.back().motion.kind == MotionKind::failed) break;
    context.progress.show(fmt::format("sweep: omega = {:.4f} rad/s", omega));
  }
  return runs;
}

std::vector<std::string> not_settled(const std::vector<VerificationRun>& runs) {
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

void write_averaged_orbit(ResultFile& file, const std::string& group, const models::SuperharmonicFlow& flow, const AveragedState& state) {
  constexpr int samples = 256;
  Column t{"t", "s", "time over one excitation period", {}}, q1{"q1", "m", "out-of-plane displacement at midspan, averaged", {}},
      q2{"q2", "m", "in-plane displacement at midspan, averaged", {}};
  const double period = 2.0 * std::numbers::pi / state.u[4];
  for (int i = 0; i <= samples; ++i) {
    const double time = period * i / samples;
    const Vector y = flow.motion(state.u, time);
    t.values.push_back(time);
    q1.values.push_back(y[0]);
    q2.values.push_back(y[1]);
  }
  file.table(group, {t, q1, q2});
  file.attribute(group, "omega", state.u[4]);
  file.attribute(group, "branch", state.branch);
  file.attribute(group, "stable", state.stable ? 1.0 : 0.0);
}

void write_motion(ResultFile& file, const std::string& series_group, const std::string& spectrum_group, const VerificationRun& run) {
  const SteadyMotion& m = run.motion;
  if (m.record.cols() == 0) return;
  Column t{"t", "s", "time", {}}, q1{"q1", "m", "out-of-plane displacement at midspan, integrated", {}},
      q2{"q2", "m", "in-plane displacement at midspan, integrated", {}};
  const double span = 2.0 * std::numbers::pi / m.omega * m.record_periods;
  for (Eigen::Index j = 0; j < m.record.cols(); ++j) {
    t.values.push_back(span * static_cast<double>(j) / static_cast<double>(m.record.cols()));
    q1.values.push_back(m.record(0, j));
    q2.values.push_back(m.record(1, j));
  }
  file.table(series_group, {t, q1, q2});
  Column h{"harmonic", "-", "frequency over excitation frequency", {}}, a1{"q1", "m", "amplitude", {}}, a2{"q2", "m", "amplitude", {}};
  const int parts = m.kind == MotionKind::periodic ? m.multiple : 8;
  for (int k = 0; k <= 8 * parts; ++k) {
    const double harmonic = static_cast<double>(k) / parts;
    h.values.push_back(harmonic);
    a1.values.push_back(std::abs(m.harmonic(0, harmonic)));
    a2.values.push_back(std::abs(m.harmonic(1, harmonic)));
  }
  file.table(spectrum_group, {h, a1, a2});
  for (const auto& group : {series_group, spectrum_group}) {
    file.attribute(group, "omega", run.omega);
    file.attribute(group, "start", run.start_name);
    file.attribute(group, "motion", std::string(to_string(m.kind)));
    file.attribute(group, "multiple", static_cast<double>(m.multiple));
  }
}

void write_runs(ResultFile& file, const std::vector<VerificationRun>& runs, const models::SuperharmonicFlow& flow, int order) {
  std::vector<Column> table{column_of(runs, "omega", "rad/s", "excitation frequency", [](const auto& r) { return r.omega; })};
  const auto observed = [&](const VerificationRun& r) { return r.averaged ? flow.observe(r.averaged->u) : models::Superharmonic{}; };
  for (auto& c : harmonic_columns(runs)) table.push_back(std::move(c));
  table.push_back(column_of(runs, "multiple", "-", "period of the motion in excitation periods, 0 if not periodic",
                            [](const auto& r) { return r.motion.multiple; }));
  table.push_back(column_of(runs, "periods", "-", "excitation periods integrated", [](const auto& r) { return r.motion.periods_integrated; }));
  table.push_back(column_of(runs, "distance", "-", "last stroboscopic distance", [](const auto& r) { return r.motion.distance; }));
  table.push_back(column_of(runs, "lyapunov", "1/s", "largest Lyapunov exponent where computed", [](const auto& r) { return r.motion.lyapunov; }));
  table.push_back(column_of(runs, "averaged_A", "m", "amplitude of q1 at the superharmonic, averaged", [&](const auto& r) { return observed(r).A; }));
  table.push_back(column_of(runs, "averaged_B", "m", "amplitude of q2 at the superharmonic, averaged", [&](const auto& r) { return observed(r).B; }));
  table.push_back(
      column_of(runs, "averaged_B0", "m", "amplitude of q2 at the excitation frequency, averaged", [&](const auto& r) { return observed(r).B0; }));
  const auto integrated = [&](const VerificationRun& r, int i) {
    return r.motion.record.cols() > 0 ? std::abs(r.motion.harmonic(i, order)) : std::nan("");
  };
  table.push_back(column_of(runs, "error_A", "m", "averaged minus integrated", [&](const auto& r) { return observed(r).A - integrated(r, 0); }));
  table.push_back(column_of(runs, "error_B", "m", "averaged minus integrated", [&](const auto& r) { return observed(r).B - integrated(r, 1); }));
  TextColumn start{"start", "where the run began", {}}, branch{"branch", "averaged branch compared with", {}};
  for (const auto& r : runs) {
    start.values.push_back(r.start_name);
    branch.values.push_back(r.averaged ? r.averaged->branch : "");
  }
  file.table("/verification/runs", table, {start, branch, kinds_of(runs)});
  for (std::size_t i = 0; i < runs.size(); ++i)
    write_motion(file, fmt::format("/verification/series/run{}", i + 1), fmt::format("/verification/spectra/run{}", i + 1), runs[i]);
}

void write_sweep(ResultFile& file, const std::string& group, const std::vector<VerificationRun>& runs) {
  std::vector<Column> table{column_of(runs, "omega", "rad/s", "excitation frequency", [](const auto& r) { return r.omega; })};
  for (auto& c : harmonic_columns(runs)) table.push_back(std::move(c));
  table.push_back(column_of(runs, "multiple", "-", "period of the motion in excitation periods, 0 if not periodic",
                            [](const auto& r) { return r.motion.multiple; }));
  file.table(group, table, {kinds_of(runs)});
}

void report_runs(Json& results, const std::vector<VerificationRun>& runs, const models::SuperharmonicFlow& flow, int order) {
  Json rows = Json::array();
  for (const auto& r : runs) {
    Json o = Json::object();
    o.put("omega", r.omega).put("start", r.start_name).put("motion", to_string(r.motion.kind)).put("period", r.motion.multiple);
    o.put("branch", r.averaged ? Json(r.averaged->branch) : Json()).put("why", r.motion.why);
    const auto integrated = [&](int i) { return r.motion.record.cols() > 0 ? std::abs(r.motion.harmonic(i, order)) : std::nan(""); };
    const auto averaged = r.averaged ? flow.observe(r.averaged->u) : models::Superharmonic{};
    o.put("A", integrated(0)).put("B", integrated(1));
    o.put("averaged_A", r.averaged ? Json(averaged.A) : Json()).put("averaged_B", r.averaged ? Json(averaged.B) : Json());
    rows.add(std::move(o));
  }
  results.put("verification", std::move(rows));
}

std::string runs_text(const std::vector<VerificationRun>& runs, const models::SuperharmonicFlow& flow, int order) {
  std::string out = fmt::format("{:>8} {:<20} {:<16} {:>9} {:>9} {:>9} {:>9}  {}\n", "omega", "start", "settles as", "A int", "A avg", "B int",
                                "B avg", "averaged branch");
  for (const auto& r : runs) {
    if (r.motion.record.cols() == 0) {
      out += fmt::format("{:>8.4f} {:<20} {}\n", r.omega, r.start_name, r.motion.why);
      continue;
    }
    const auto o = r.averaged ? flow.observe(r.averaged->u) : models::Superharmonic{};
    const std::string kind = r.motion.multiple > 1 ? fmt::format("periodic {}T", r.motion.multiple) : to_string(r.motion.kind);
    out += fmt::format("{:>8.4f} {:<20} {:<16} {:>9.4f} {:>9.4f} {:>9.4f} {:>9.4f}  {}\n", r.omega, r.start_name, kind,
                       std::abs(r.motion.harmonic(0, order)), o.A, std::abs(r.motion.harmonic(1, order)), o.B, r.averaged ? r.averaged->branch : "-");
  }
  return out;
}

}  // namespace whirl::studies
