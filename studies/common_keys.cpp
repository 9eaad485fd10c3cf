#include "studies/common_keys.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <numbers>

#include "studies/interruption.hpp"
#include "studies/open_results.hpp"

namespace whirl::studies {

using namespace models;

void add_stay_keys(Schema& s, bool any_motion) {
  append_fields(s, [](std::string_view name) { return name.starts_with("cable."); });
  s.add({.name = "cable.coefficients",
         .description = "modal coefficients by quadrature, or as the paper's closed forms print them",
         .default_value = std::string("exact"),
         .choices = {"exact", "as-printed"}});
  s.add({.name = "model.terms",
         .description = "coupling of the modal equations: the paper's reduced terms (35), or all of (23)",
         .default_value = std::string("reduced"),
         .choices = {"reduced", "full"}});
  append_fields(s, [](std::string_view name) { return !name.starts_with("cable.") && name != "omega"; });
  const std::vector<std::string> ends = {"upper", "lower"}, directions = {"horizontal", "vertical", "chord", "normal", "out-of-plane"};
  const auto choices = [any_motion](const std::vector<std::string>& all) { return any_motion ? all : std::vector{all.front()}; };
  s.add({.name = "support_motion.end", .description = "the support that moves", .default_value = ends.front(), .choices = choices(ends)});
  s.add({.name = "support_motion.direction",
         .description = "its direction; chord: lower to upper end, normal: across the chord, downwards",
         .default_value = directions.front(),
         .choices = choices(directions)});
  s.add({.name = "omega",
         .unit = "rad/s",
         .description = "excitation frequency, needed where the continuation parameter is another number",
         .optional = true,
         .lower = 0.0,
         .example = Value{1.65}});
}

void add_continuation_keys(Schema& s, const std::string& default_parameter) {
  s.add({.name = "continuation.parameter",
         .description = "what varies: omega, support_amplitude, damping, chord_tension, ... or any numeric key by its dotted name",
         .default_value = default_parameter});
  s.add({.name = "continuation.range",
         .description = "lower and upper end, in the parameter's unit",
         .default_value = std::vector<double>{},
         .required = true,
         .min_items = 2,
         .max_items = 2,
         .example = Value{std::vector<double>{1.2, 2.4}}});
  s.add({.name = "continuation.max_step",
         .description = "longest step, in units of the range and of the largest amplitude",
         .default_value = 0.04,
         .lower = 0.0,
         .upper = 1.0,
         .closed_upper = true});
  s.add({.name = "continuation.min_step",
         .description = "a step shorter than this ends the branch",
         .default_value = 1e-10,
         .lower = 0.0,
         .upper = 1e-3,
         .closed_upper = true});
  s.add_count("continuation.max_points", "of one branch in one direction", 4000, 2, 1e7);
  s.add_count("continuation.depth", "generations of branches followed at branch points; 0: none", 2, 0, 100);
  s.add(
      {.name = "continuation.user_values", .description = "parameter values to hit exactly, reported as UZ", .default_value = std::vector<double>{}});
}

void add_verification_keys(Schema& s) {
  s.add({.name = "verification.enabled", .description = "integrate the modal equations in time beside the branches", .default_value = true});
  s.add({.name = "verification.omega",
         .unit = "rad/s",
         .description = "frequencies at which to integrate",
         .default_value = std::vector<double>{},
         .lower = 0.0});
  s.add({.name = "verification.starts",
         .unit = "m",
         .description = "further starts at rest: all coordinates (q1, q2), start after start",
         .default_value = std::vector<double>{0.0, 0.0, 3.0, 0.0, 10.0, 10.0}});
  s.add({.name = "verification.perturbation",
         .unit = "m",
         .description = "added to the first coordinate out of plane (q1) of every start: motion in plane would stay there",
         .default_value = 1e-3,
         .lower = 0.0,
         .closed_lower = true});
  s.add({.name = "verification.max_periods",
         .description = "excitation periods after which a motion counts as not settled",
         .default_value = std::int64_t{3000},
         .lower = 1,
         .upper = 1e8,
         .closed_lower = true});
  s.add({.name = "verification.tolerance",
         .description = "of the settled stroboscopic point, relative",
         .default_value = 1e-8,
         .lower = 0.0,
         .upper = 1e-2});
  s.add({.name = "verification.relative_tolerance", .description = "of the integrator", .default_value = 1e-10, .lower = 0.0, .upper = 1e-3});
  s.add({.name = "verification.absolute_tolerance",
         .unit = "m",
         .description = "of the integrator",
         .default_value = 1e-12,
         .lower = 0.0,
         .upper = 1.0});
  s.add_count("verification.sweep_points", "frequencies of the sweeps up and down over continuation.range; 0: no sweeps", 0, 0, 100000);
}

StayParameters<double> stay_of(const Configuration& c) {
  StayParameters<double> initial{};
  initial.omega = 1.0;
  return stay_parameters(c, initial);
}

Coefficients coefficients_of(const Configuration& c) {
  return c.text("cable.coefficients") == "exact" ? Coefficients::exact : Coefficients::as_printed;
}
Terms terms_of(const Configuration& c) { return c.text("model.terms") == "full" ? Terms::full : Terms::reduced; }

continuation::NetworkOptions network_of(const Configuration& c) {
  continuation::NetworkOptions o;
  const auto& range = c.numbers("continuation.range");
  if (!(range[0] < range[1])) throw c.error("continuation.range", "must be increasing");
  o.walk.lower = range[0];
  o.walk.upper = range[1];
  o.walk.max_step = c.number("continuation.max_step");
  o.walk.min_step = c.number("continuation.min_step");
  o.walk.initial_step = std::clamp(o.walk.initial_step, o.walk.min_step, o.walk.max_step);
  if (o.walk.min_step > o.walk.max_step) throw c.error("continuation.min_step", "must not exceed continuation.max_step");
  o.walk.max_points = static_cast<int>(c.integer("continuation.max_points"));
  o.walk.user_values = c.numbers("continuation.user_values");
  for (const double p : o.walk.user_values)
    if (!(p >= range[0] && p <= range[1])) throw c.error("continuation.user_values", "each value must lie in continuation.range");
  o.depth = static_cast<int>(c.integer("continuation.depth"));
  return o;
}

SettleOptions settle_of(const Configuration& c) {
  SettleOptions o;
  o.tolerance = c.number("verification.tolerance");
  o.max_periods = static_cast<int>(c.integer("verification.max_periods"));
  o.integrator.relative_tolerance = c.number("verification.relative_tolerance");
  o.integrator.absolute_tolerance = c.number("verification.absolute_tolerance");
  if (c.numbers("verification.starts").size() % 2 != 0) throw c.error("verification.starts", "must hold pairs q1, q2: an even number of values");
  return o;
}

void check_lens_range(const Configuration& c, const std::string& parameter, const continuation::WalkOptions& walk) {
  try {
    const Lens lens(parameter);
    const auto outside = [&](double x) { return !(x > lens.lower() && x < lens.upper()) && !(x == lens.lower() && parameter != "omega"); };
    if (outside(walk.lower) || outside(walk.upper))
      throw c.error("continuation.range",
                    fmt::format("must lie in ({:g}, {:g}) [{}], the range of {}", lens.lower(), lens.upper(), lens.unit(), parameter));
    if (parameter != "omega" && !c.has("omega")) throw c.error("continuation.parameter", "needs the excitation frequency: set omega [rad/s]");
    if (parameter == "omega" && c.is_given("omega"))
      throw c.error("omega", "is the continuation parameter: remove it, or choose another continuation.parameter");
    if (lens.affects_cable()) {  // the model must hold over the whole range
      for (const double p : {walk.lower, walk.upper}) {
        auto record = stay_of(c);
        lens.set(record, p);
        (void)models::check(record.cable);
      }
    }
  } catch (const std::invalid_argument& e) {
    const std::string guess = nearest(parameter, Lens::names());
    const bool unknown = std::string_view(e.what()).starts_with("no parameter");
    throw c.error("continuation.parameter", unknown && !guess.empty() ? fmt::format("no such parameter, did you mean {}?", guess) : e.what());
  }
}

std::vector<std::string> check_cable(const Configuration& c) {
  try {
    return models::check(stay_of(c).cable);
  } catch (const std::invalid_argument& e) {
    throw c.error("cable.chord_tension", e.what());
  }
}

double largest_tension(const SuperharmonicFlow& flow, Coefficients choice, In u) {
  // strain = e1 + (f/L) 16 m2 a2 q2/L + (c1 m1 q1^2 + c2 m2 q2^2) / (2 L^2), mean along the chord
  auto stay = flow.model().stay();
  flow.model().lenses().front().set(stay, u[4]);
  const auto m = stay_model(stay.cable, choice);
  const auto& k = m.coefficients;
  const double L = stay.cable.chord_length, e1 = stay.support_amplitude / L * std::cos(stay.cable.inclination_deg * pi / 180.0);
  double largest = 0.0;
  for (int i = 0; i < 64; ++i) {
    const double t = 2.0 * std::numbers::pi / stay.omega * i / 64.0;
    const Vector q = flow.motion(u, t);
    const double strain = e1 * std::cos(stay.omega * t) + 16.0 * k.m2 * k.a2 * m.shape.sag_ratio * q[1] / L +
                          (k.c1 * k.m1 * q[0] * q[0] + k.c2 * k.m2 * q[1] * q[1]) / (2.0 * L * L);
    largest = std::max(largest, stay.cable.chord_tension + stay.cable.axial_stiffness * strain);
  }
  return largest;
}

void write_study(ResultFile& file, const Configuration& c) {
  file.attribute("/study", "kind", c.kind());
  file.attribute("/study", "outcome", std::string(ResultFile::unfinished));
  file.attribute("/study", "version", std::string(WHIRL_VERSION));
  file.attribute("/study", "git_hash", git_hash());
  file.attribute("/study", "libraries", library_versions());
  file.text("/study", "configuration", c.resolved_toml());
  c.each([&](const Key& key, const Value& value) {
    std::visit(
        [&](const auto& v) {
          using T = std::decay_t<decltype(v)>;
          if constexpr (std::is_same_v<T, bool> || std::is_same_v<T, std::int64_t>) file.attribute("/study", key.name, static_cast<double>(v));
          else file.attribute("/study", key.name, v);
        },
        value);
  });
}

std::string frequency_label(double omega) {
  const std::string short_label = fmt::format("w{:.4f}", omega);
  return std::stod(short_label.substr(1)) == omega ? short_label : fmt::format("w{}", omega);
}

void write_cable_numbers(ResultFile& file, RunContext& context, const Cable<double>& cable) {
  const auto p = parabola(cable);
  const auto m = modes(cable);
  const Numbers numbers{{"sag", "m", "f, midspan sag normal to the chord", p.sag},
                        {"sag_ratio", "-", "f/L", p.sag_ratio},
                        {"irvine_lambda2", "-", "(AE/T) 64 (f/L)^2 / (1 + (8/3)(f/L)^2)", p.irvine_lambda2},
                        {"frequency_number", "-", "W of the symmetric in-plane mode", m.frequency_number},
                        {"omega1", "rad/s", "first out-of-plane frequency", m.omega1},
                        {"omega2", "rad/s", "first symmetric in-plane frequency", m.omega2},
                        {"frequency1", "Hz", "first out-of-plane frequency", m.omega1 / (2.0 * std::numbers::pi)},
                        {"frequency2", "Hz", "first symmetric in-plane frequency", m.omega2 / (2.0 * std::numbers::pi)}};
  write_numbers(file, "/cable", numbers);
  context.report.put("cable", numbers_json(numbers));
}

namespace {

// One line each, the first few; all stand in the table of special points.
void warn_of_unresolved(const continuation::Branch& b, RunContext& context) {
  constexpr int most = 5;
  int count = 0;
  for (const auto& s : b.special) {
    if (s.type != continuation::EventType::unresolved || ++count > most) continue;
    context.warn(fmt::format("branch {}: a change of stability between {:.10g} and {:.10g} is unresolved", b.name, s.bracket[0], s.bracket[1]));
  }
  if (count > most) context.warn(fmt::format("branch {}: {} more changes of stability are unresolved", b.name, count - most));
}

// `why` a run that is not whole is not: its last line on standard error, whatever was warned of before.
ExitStatus end_run(ResultFile& file, RunContext& context, ExitStatus status, std::vector<std::string> reasons, const std::string& why) {
  end_begins();
  if (interrupted) status = ExitStatus::stopped_by_user;
  if (interrupted && reasons.empty()) reasons.emplace_back(interrupted_outcome);
  const std::string outcome = status == ExitStatus::ok ? "complete" : interrupted ? "interrupted" : "partial";
  context.report.put("stop_reasons", Json::array(reasons)).put("warnings", Json::array(context.warnings)).put("outcome", outcome);
  file.attribute("/study", "stop_reasons", reasons);
  file.attribute("/study", "warnings", context.warnings);
  file.attribute("/study", "outcome", outcome);
  file.flush();
  if (!published(file)) fmt::print(stderr, "{}: no result yet, an older one is left as it was\n", file.path().string());
  if (status == ExitStatus::numerical_failure) fmt::print(stderr, "error: the run is incomplete: {}\n", why);
  return status;
}

}  // namespace

ExitStatus finish(ResultFile& file, RunContext& context, const std::vector<continuation::Branch>& branches,
                  const std::vector<std::string>& failures) {
  ExitStatus status = ExitStatus::ok;
  std::vector<std::string> reasons;
  std::string why;
  for (const auto& b : branches) {
    reasons.push_back(fmt::format("{}: {}, {}", b.name, to_string(b.start_reason), to_string(b.stop_reason)));
    const auto early = [](continuation::StopReason r) {
      return r == continuation::StopReason::min_step || r == continuation::StopReason::max_points;
    };
    const bool alike = b.start_reason == b.stop_reason;
    if (early(b.start_reason))
      context.warn(fmt::format("branch {} ended early: {}{}", b.name, to_string(b.start_reason), alike ? " at both ends" : ""));
    if (early(b.stop_reason) && !alike) context.warn(fmt::format("branch {} ended early: {}", b.name, to_string(b.stop_reason)));
    if (early(b.start_reason) || early(b.stop_reason)) {
      status = ExitStatus::numerical_failure;
      if (why.empty()) why = fmt::format("branch {}", reasons.back());
    }
    warn_of_unresolved(b, context);
  }
  if (branches.empty()) {
    status = ExitStatus::numerical_failure;
    reasons.emplace_back("no branch: no start led to a solution");
    why = reasons.back();
  }
  for (const auto& failure : failures) {
    status = ExitStatus::numerical_failure;
    context.warn(failure);
    reasons.push_back(failure);
    why = failure;
  }
  return end_run(file, context, status, reasons, why);
}

ExitStatus finish(ResultFile& file, RunContext& context, ExitStatus status, const std::vector<std::string>& reasons) {
  const bool silent = status == ExitStatus::numerical_failure && reasons.empty();
  const std::vector<std::string> told = !silent ? reasons : context.warnings.empty() ? std::vector<std::string>{"no result"} : context.warnings;
  return end_run(file, context, status, told, told.empty() ? "" : told.back());
}

}  // namespace whirl::studies
