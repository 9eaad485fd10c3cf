#include "studies/equilibrium_source.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <numbers>

#include "continuation/deflation.hpp"
#include "continuation/natural_size.hpp"
#include "core/kinsol.hpp"
#include "core/problem_in_units.hpp"
#include "models/closed_forms.hpp"
#include "studies/averaged_source.hpp"
#include "studies/cable_model_keys.hpp"
#include "studies/common_keys.hpp"
#include "studies/equilibrium_diagnosis.hpp"
#include "studies/equilibrium_model_input.hpp"
#include "studies/extremes.hpp"
#include "studies/slow_flow_ansatz.hpp"

namespace whirl::studies {
namespace {

using namespace models;
using namespace continuation;

constexpr const char* own_ansatz = "superharmonic";  // n omega in both modes with closed forms, response.order

/// Averaged superharmonic response of a stay.
class StaySource : public EquilibriumSource {
 public:
  explicit StaySource(const Configuration& c)
      : c_(c), stay_(stay_of(c)), options_{static_cast<int>(c.integer("response.order")), coefficients_of(c)}, warnings_(check_cable(c)) {}

  std::unique_ptr<Problem> problem(const std::vector<std::string>& names) const override {
    std::vector<Lens> lenses;
    for (const auto& name : names) lenses.emplace_back(name);
    return std::make_unique<SuperharmonicFlow>(stay_, options_, lenses);
  }
  double value(const std::string& lens) const override { return Lens(lens).get(stay_); }
  std::string unit(const std::string& lens) const override { return std::string(Lens(lens).unit()); }
  std::vector<std::string> warnings() const override { return warnings_; }

  void check_lens(const std::string& key, const std::string& name, const std::string& range_key, double lower, double upper) const override {
    if (key == "continuation.parameter") {
      WalkOptions walk;
      walk.lower = lower;
      walk.upper = upper;
      return check_lens_range(c_, name, walk);
    }
    try {
      const Lens lens(name);
      const auto outside = [&](double x) { return x < lens.lower() || x > lens.upper() || (x == lens.lower() && name == "omega"); };
      if (outside(lower) || outside(upper))
        throw c_.error(range_key, fmt::format("must lie in ({:g}, {:g}) [{}], the range of {}", lens.lower(), lens.upper(), lens.unit(), name));
    } catch (const std::invalid_argument& e) {
      const std::string guess = nearest(name, Lens::names());
      throw c_.error(key, guess.empty() ? e.what() : fmt::format("no such parameter, did you mean {}?", guess));
    }
  }

  std::vector<PointColumn> columns(const Problem& f) const override {
    const auto& flow = dynamic_cast<const SuperharmonicFlow&>(f);
    std::vector<PointColumn> all;
    const auto add = [&](const std::string& name, const std::string& unit, const std::string& description, auto value) {
      all.push_back({name, unit, description, [&flow, value](In u) { return value(flow.observe(u)); }});
    };
    add(amplitude(1), "m", "A: amplitude of cos(n omega t + phase) in q1, out of plane", [](const Superharmonic& o) { return o.A; });
    add(amplitude(2), "m", "B: amplitude of cos(n omega t + phase) in q2, in plane", [](const Superharmonic& o) { return o.B; });
    add("q2_h1", "m", "B0: amplitude of cos(omega t + phase) in q2, linear forced response", [](const Superharmonic& o) { return o.B0; });
    add(amplitude(1) + "_phase", "rad", "Psi1", [](const Superharmonic& o) { return o.Psi1; });
    add(amplitude(2) + "_phase", "rad", "Psi2", [](const Superharmonic& o) { return o.Psi2; });
    static constexpr const char* state[] = {"u1", "v1", "u2", "v2"};
    for (int i = 0; i < 4; ++i) all.push_back({state[i], "m", "Cartesian van der Pol coordinate", [i](In u) { return u[i]; }});
    return all;
  }
  std::vector<PointColumn> extremes(const Problem& f) const override {
    return extreme_columns(dynamic_cast<const SuperharmonicFlow&>(f), options_.order);
  }
  std::vector<Observable> observables() const override {
    return {{.name = amplitude(1), .form = QuadraticForm::square_sum(4, {0, 1})},
            {.name = amplitude(2), .form = QuadraticForm::square_sum(4, {2, 3})}};
  }
  Network::Namer namer() const override {
    return [](const Branch& b) { return b.active_reflections.empty() ? "W" : "IP"; };
  }

  // From rest, then every closed-form solution on a grid.
  std::vector<Start> starts(const Problem& f, const std::string& lens, double lower, double upper) const override {
    constexpr int grid = 60;
    const auto& flow = dynamic_cast<const SuperharmonicFlow&>(f);
    std::vector<Start> all;
    for (int i = 0; i <= grid; ++i) {
      const double p = lower + (upper - lower) * i / grid;
      const auto k = flow.model().coefficients<double>(std::array<double, 1>{p});
      for (const auto& states : {in_plane_states(k), coupled_states(k)})
        for (const auto& x : states) {
          Vector u(5);
          u << x, p;
          all.push_back({u, fmt::format("closed form at {} = {:.6g}", lens, p)});
        }
    }
    return all;
  }
  void write(ResultFile& file, RunContext& context) const override { write_cable_numbers(file, context, stay_.cable); }

 private:
  std::string amplitude(int coordinate) const { return fmt::format("q{}_h{}", coordinate, options_.order); }

  Configuration c_;
  StayParameters<double> stay_;
  SuperharmonicOptions options_;
  std::vector<std::string> warnings_;
};

/// Rest points of a system given as text.
class ExpressionSource : public EquilibriumSource {
 public:
  explicit ExpressionSource(const Configuration& c)
      : c_(c),
        model_(isolated_model_of(c, lenses_of(c), notes_)),
        symmetries_(continuous_symmetries(model_, free_of(c, model_))),
        turns_(model_.angles.empty() ? std::vector<Turn>{} : turns(model_, free_of(c, model_))) {}

  std::unique_ptr<Problem> problem(const std::vector<std::string>& lenses) const override {
    return std::make_unique<EquilibriumFlow>(model_, lenses);
  }
  double value(const std::string& lens) const override { return model_.parameter(lens); }
  std::string unit(const std::string&) const override { return "-"; }
  std::vector<std::string> warnings() const override { return notes_; }
  void check_lens(const std::string& key, const std::string& lens, const std::string&, double, double) const override {
    check_equilibrium_lens(c_, model_, key, lens);
  }

  std::vector<PointColumn> columns(const Problem& f) const override {
    std::vector<PointColumn> all;
    for (const auto& a : model_.amplitudes)
      all.push_back({a.name, "-", "root of the sum of squares of " + fmt::format("{}", fmt::join(a.variables, ", ")),
                     [of = indices(a)](In u) {
                       double sum = 0.0;
                       for (const int i : of) sum += u[i] * u[i];
                       return std::sqrt(sum);
                     },
                     true});
    for (int i = 0; i < model_.size(); ++i)
      all.push_back({model_.variables[static_cast<std::size_t>(i)], "-", "variable", [i](In u) { return u[i]; }, true});
    for (const auto& pin : model_.pinned) {
      const VectorField drift = bound(model_, {pin.drift}, f.parameter_names());
      all.push_back({pin.name, "-", "variable, pinned", [value = model_.parameter(pin.name)](In) { return value; }});
      all.push_back({pin.name + "_drift", "-", "speed along the symmetry that the pinned variable would have", [drift](In u) {
                       double speed = 0.0;
                       drift.evaluate<double>(std::span<const double>(u.data(), static_cast<std::size_t>(u.size())), std::span<double>(&speed, 1));
                       return speed;
                     }});
    }
    return all;
  }
  std::vector<Observable> observables() const override {
    std::vector<Observable> all;
    for (const auto& a : model_.amplitudes) all.push_back({.name = a.name, .form = QuadraticForm::square_sum(model_.size(), indices(a))});
    for (int i = 0; i < model_.size(); ++i)
      all.push_back({.name = model_.variables[static_cast<std::size_t>(i)], .form = QuadraticForm::coordinate(model_.size(), i)});
    return all;
  }
  Network::Namer namer() const override {
    return [](const Branch&) { return "B"; };
  }

  // Half a turn about the start both ways, a little off so that neither 0 nor half a turn stands on its edge.
  std::vector<AngleWindow> angles() const override {
    constexpr double off_centre = 0.37, overlap = 1e-4;
    std::vector<AngleWindow> windows;
    for (const auto& name : model_.angles) {
      const auto i = std::find(model_.variables.begin(), model_.variables.end(), name) - model_.variables.begin();
      const double centre = model_.initial[static_cast<std::size_t>(i)] + off_centre;
      const Vector turn = 2.0 * std::numbers::pi * turn_of(model_, turns_, name).k;
      const bool known = std::any_of(windows.begin(), windows.end(), [&](const AngleWindow& w) { return w.turn == turn; });
      if (!known) windows.push_back({{static_cast<int>(i), centre - std::numbers::pi, centre + std::numbers::pi + overlap}, turn});
    }
    return windows;
  }

  std::string not_isolated(const Problem& f, In u) const override { return why_not_isolated(f, u, model_.variables, symmetries_); }
  bool may_leave_isolation() const override { return !symmetries_.empty(); }
  std::vector<Branch> marked(const std::vector<Branch>& branches, RunContext& context) const override {
    return with_corners_marked(model_, c_.text("continuation.parameter"), branches, context);
  }

  // `initial` at the parameter's own value if that lies in the range, at the lower end and the upper, and only if there is no rest point at any of
  // them at values between (an isola, say); by deflation whatever else Newton reaches there from points around it.
  std::vector<Start> starts(const Problem& f, const std::string& lens, double lower, double upper) const override {
    std::vector<Start> all;
    const auto look = [&](double p) {
      for (const auto& u : rest_points(f, p, lower, upper)) all.push_back({u, fmt::format("{} = {:.6g}", lens, p)});
    };
    if (value(lens) >= lower && value(lens) <= upper) look(value(lens));
    look(lower);
    look(upper);
    for (int parts = 2; parts <= 32 && all.empty(); parts *= 2)
      for (int i = 1; i < parts; i += 2) look(lower + (upper - lower) * i / parts);
    return all;
  }
  void write(ResultFile& file, RunContext&) const override {
    for (const auto& p : model_.parameters) file.scalar("/model/parameters", p.name, p.value, "-", "parameter, as the study file gives it");
    std::vector<std::string> equations;
    for (std::size_t i = 0; i < model_.rhs.size(); ++i) equations.push_back(model_.variables[i] + "' = " + model_.rhs[i]);
    file.attribute("/model", "equations", equations);
  }

 private:
  static std::vector<std::string> free_of(const Configuration& c, const EquilibriumModel& model) {
    std::vector<std::string> names = lenses_of(c);
    const auto known = model.parameter_names();
    std::erase_if(names, [&](const std::string& name) { return std::find(known.begin(), known.end(), name) == known.end(); });
    if (names.size() == 2 && names[0] == names[1]) names.pop_back();
    return names;
  }
  static std::vector<std::string> lenses_of(const Configuration& c) {
    std::vector<std::string> names;
    for (const char* key : {"continuation.parameter", "second.parameter"})
      if (c.schema().find(key)) names.push_back(c.text(key));
    return names;
  }
  std::vector<Vector> rest_points(const Problem& f, double p, double lower, double upper) const {
    const int n = model_.size();
    Vector guess(n + 1);
    for (int i = 0; i < n; ++i) guess[i] = model_.initial[static_cast<std::size_t>(i)];
    guess[n] = p;
    Vector units = Vector::Ones(n + 1);
    units.head(n) = natural_sizes(f, guess, lower, upper);
    const ProblemInUnits scaled(f, units, row_sizes(f, guess, units));
    guess = guess.cwiseQuotient(units);
    NewtonResult first = newton(scaled, guess);
    if (!first.ok()) first = line_search_solve(scaled, guess);
    const Vector centre = first.ok() ? first.x : guess;
    std::vector<Vector> known, from = {guess};
    if (first.ok()) known.push_back(first.x);
    for (const double part : {0.3, -0.3, 1.0, -1.0, 3.0, -3.0}) {
      for (int i = 0; i <= n; ++i) {  // each coordinate, then all together
        Vector u = centre;
        for (int k = i < n ? i : 0; k < (i < n ? i + 1 : n); ++k) u[k] += part * std::max(1.0, std::abs(u[k]));
        from.push_back(u);
      }
    }
    auto found = deflated_solutions(scaled, known, from);
    for (auto& u : found) u.array() *= units.array();
    return found;
  }
  Indices indices(const Amplitude& a) const {
    Indices of;
    for (const auto& name : a.variables)
      of.push_back(static_cast<int>(std::find(model_.variables.begin(), model_.variables.end(), name) - model_.variables.begin()));
    return of;
  }

  Configuration c_;
  std::vector<std::string> notes_;
  EquilibriumModel model_;
  std::vector<Symmetry> symmetries_;
  std::vector<Turn> turns_;  // of the angles named
};

}  // namespace

void add_equilibrium_source_keys(Schema& s) {
  add_forced_system_keys(s);
  s.add_count("response.order", "superharmonic order n", 2, 2, 50);
  add_ansatz_keys(s, own_ansatz);
  s.add_free(equilibrium_model_section());
  s.add_alternative({.sections = {"cable", "model", "damping", "support_motion", "response", "ansatz"}, .free_sections = {"equilibrium_model"}});
  s.add_alternative({.sections = {"response"}, .free_sections = {"modal_model"}});
}

void check_parameter_given(const Configuration& c, const std::string& key) {
  if (!c.has("equilibrium_model") || c.is_given(key)) return;
  throw InputError(fmt::format("{}: {} is missing: one of {}", c.source(), key, fmt::join(equilibrium_model_of(c).parameter_names(), ", ")));
}

std::unique_ptr<EquilibriumSource> equilibrium_source(const Configuration& c) {
  if (c.has("equilibrium_model")) return std::make_unique<ExpressionSource>(c);
  if (c.text("ansatz.kind") != own_ansatz) return averaged_source(c);
  if (c.has("modal_model")) throw c.error("ansatz.kind", "is for a [cable]: choose the ansatz of the [modal_model], \"complete\" or \"list\" say");
  if (!is_plain_stay(c))
    throw c.error("ansatz.kind",
                  "has two modes, the upper end moved horizontally: choose another ansatz for what [model] or [support_motion] ask for");
  return std::make_unique<StaySource>(c);
}

std::vector<Observable> peaks_of(const Configuration& c, const EquilibriumSource& source) {
  const auto known = source.observables();
  std::vector<std::string> names;
  for (const auto& o : known) names.push_back(o.name);
  std::vector<Observable> wanted;
  for (const auto& name : c.texts("continuation.peaks")) {
    const auto it = std::find(names.begin(), names.end(), name);
    if (it == names.end()) throw c.error("continuation.peaks", fmt::format("each value must be one of {}", fmt::join(names, ", ")));
    wanted.push_back(known[static_cast<std::size_t>(it - names.begin())]);
  }
  return wanted;
}

Vector within_windows(Vector u, const std::vector<AngleWindow>& windows) {
  for (const auto& [bound, turn] : windows)
    if (const double x = u[bound.index]; x < bound.lower || x > bound.upper)
      u.head(turn.size()) -= turn * std::floor((x - bound.lower) / (2.0 * std::numbers::pi));
  return u;
}

void follow_angles(Network& net, const EquilibriumSource& source, RunContext& context) {
  const auto windows = source.angles();
  if (windows.empty()) return;
  for (std::size_t b = 0; b < net.branches().size(); ++b) {
    std::vector<Vector> beyond;  // by value: branches come to be while they are followed
    const Branch& branch = net.branches()[b];
    for (const int i : {0, branch.points() - 1})
      for (const auto& [bound, turn] : windows)
        if (branch.points() > 0 && (branch.u(i)[bound.index] == bound.lower || branch.u(i)[bound.index] == bound.upper)) {
          beyond.push_back(branch.u(i));
          beyond.back().head(turn.size()) += (branch.u(i)[bound.index] == bound.lower ? 1.0 : -1.0) * turn;
        }
    const std::string origin = branch.name + " a turn on";
    for (const Vector& u : beyond) {
      try_seed(net, u, origin, context);
      net.switch_branches();
    }
  }
}

void try_seed(Network& net, const Vector& u, const std::string& origin, RunContext& context) {
  const std::size_t before = net.notes().size();
  (void)net.add_seed(u, origin);
  for (std::size_t i = before; i < net.notes().size(); ++i) context.warn(net.notes()[i]);
}

}  // namespace whirl::studies
