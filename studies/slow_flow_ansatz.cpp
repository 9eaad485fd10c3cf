#include "studies/slow_flow_ansatz.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "models/slow_flow/combinatorial_printed.hpp"

namespace whirl::studies {

using namespace models;

namespace {

constexpr int listed_coordinates = 8;  // ansatz.q1 .. ansatz.q8

Ansatz listed_ansatz(const Configuration& c, int coordinates) {
  std::vector<std::vector<double>> lists;
  for (int i = 1; i <= listed_coordinates; ++i) {
    const std::string key = fmt::format("ansatz.q{}", i);
    if (i <= coordinates) lists.push_back(c.numbers(key));
    else if (!c.numbers(key).empty()) throw c.error(key, fmt::format("the model has {} coordinates", coordinates));
    try {
      if (!c.numbers(key).empty()) (void)Ansatz::list({c.numbers(key)});
    } catch (const std::invalid_argument& e) {
      throw c.error(key, e.what());
    }
  }
  if (std::all_of(lists.begin(), lists.end(), [](const auto& l) { return l.empty(); }))
    throw c.error("ansatz.kind", "needs a list of harmonics: set ansatz.q1 = [...] or another coordinate's");
  return Ansatz::list(lists, c.flag("ansatz.frozen"));
}

}  // namespace

void add_ansatz_keys(Schema& s, const std::string& own_default) {
  std::vector<std::string> kinds = {"auto", "complete", "list", "frozen", "combinatorial-32", "combinatorial-32-printed"};
  if (!own_default.empty()) kinds.insert(kinds.begin(), own_default);
  s.add({.name = "ansatz.kind",
         .description = "harmonics kept: auto is combinatorial-32 for two coordinates, else complete; 0..H of omega/nu in all coordinates, your "
                        "lists, n omega with the linear response frozen, or the paper's "
                        "combinatorial response (3,2) by exact projection or with its printed terms only",
         .default_value = own_default.empty() ? std::string("auto") : own_default,
         .choices = kinds});
  s.add({.name = "ansatz.motion",
         .description = "of the combinatorial response: q1 at 1/2, 3/2 and q2 at 0, 1, 2 (60), or q2 at 1/2, 1, 3/2 (70)",
         .default_value = std::string("coupled"),
         .choices = {"coupled", "in-plane"}});
  s.add_count("ansatz.harmonics", "H of the complete ansatz, in units of omega/nu", 8, 1, 200);
  s.add_count("ansatz.nu", "of the complete ansatz: the motion repeats after nu excitation periods", 1, 1, 16);
  s.add_count("ansatz.order", "n of the frozen ansatz", 2, 1, 50);
  s.add({.name = "ansatz.frozen",
         .description = "of a list: forced harmonics outside it stay in the motion as the linear response",
         .default_value = false});
  for (int i = 1; i <= listed_coordinates; ++i)
    s.add({.name = fmt::format("ansatz.q{}", i),
           .description = fmt::format("of a list: harmonics of coordinate {}, in multiples of omega, fractions allowed; 0 is the mean", i),
           .default_value = std::vector<double>{},
           .lower = 0.0,
           .upper = 200.0,
           .closed_lower = true});
}

std::string ansatz_kind(const Configuration& c, const ForcedSystem& forced) {
  const std::string& kind = c.text("ansatz.kind");
  if (kind != "auto") return kind;
  return forced.coordinates.size() == 2 ? "combinatorial-32" : "complete";
}

AveragedEquations averaged_of(const Configuration& c, const ForcedSystem& forced) {
  const int n = static_cast<int>(forced.coordinates.size());
  const std::string kind = ansatz_kind(c, forced);
  const bool coupled = c.text("ansatz.motion") == "coupled";
  AveragedEquations a;
  if (kind.starts_with("combinatorial") && n != 2) throw c.error("ansatz.kind", fmt::format("is for two coordinates, the model has {}", n));
  try {
    if (kind == "combinatorial-32-printed") {
      auto flow = std::make_unique<PrintedCombinatorialFlow>(forced.system, coupled ? CombinatorialMotion::coupled : CombinatorialMotion::in_plane);
      a.ansatz = flow->ansatz();
      a.balance_harmonics = a.ansatz.highest();
      const Ansatz ansatz = a.ansatz;
      const int size = ansatz.size();
      a.motion = [ansatz, size, &forced](In u, double t) { return motion_at(ansatz, u.head(size), forced.at(u.tail(1)).omega, t); };
      a.balance_state = [ansatz, size](In u) { return balance_state(ansatz, u.head(size), ansatz.highest()); };
      a.flow = std::move(flow);
      return a;
    }
    if (kind == "complete") a.ansatz = Ansatz::complete(n, static_cast<int>(c.integer("ansatz.harmonics")), static_cast<int>(c.integer("ansatz.nu")));
    else if (kind == "list") a.ansatz = listed_ansatz(c, n);
    else if (kind == "frozen") a.ansatz = Ansatz::superharmonic(n, static_cast<int>(c.integer("ansatz.order")));
    else a.ansatz = coupled ? Ansatz::combinatorial_coupled() : Ansatz::combinatorial_in_plane();
    auto flow = std::make_unique<SlowFlow>(forced.system, a.ansatz, forced.reflections);
    const SlowFlow* f = flow.get();
    a.motion = [f](In u, double t) { return f->motion(u, t); };
    a.balance_state = [f](In u) { return f->balance_state(u); };
    a.balance_harmonics = f->balance_harmonics();
    a.flow = std::move(flow);
  } catch (const std::invalid_argument& e) {
    throw c.error("ansatz.kind", e.what());
  }
  return a;
}

std::vector<PointColumn> harmonic_columns(const ForcedSystem& forced, const Ansatz& a) {
  std::vector<PointColumn> columns;
  const int size = a.size();
  const auto leading = leading_coordinates(forced);
  for (const bool phases : {false, true})
    for (int i = 0; i < a.coordinates(); ++i)
      for (const int k : a.harmonics[static_cast<std::size_t>(i)]) {
        if (phases && k == 0) continue;  // a mean has none
        const std::string& coordinate = forced.coordinates[static_cast<std::size_t>(i)];
        const double multiple = static_cast<double>(k) / a.nu;
        const std::string name = harmonic_name(coordinate, multiple), wave = fmt::format("cos({:g} omega t + phase) in {}", multiple, coordinate);
        const auto z = [a, size, i, k](In u) { return amplitude(a, u.head(size), i, k); };
        if (phases) columns.push_back({name + "_phase", "rad", "phase of " + wave, [z](In u) { return std::arg(z(u)); }});
        if (!phases && k > 0) columns.push_back({name, forced.length_unit, "amplitude of " + wave, [z](In u) { return std::abs(z(u)); }});
        if (!phases && k == 0) columns.push_back({name, forced.length_unit, "mean of " + coordinate, [z](In u) { return z(u).real(); }});
        // Of many coordinates the printed table has room for the two that show a motion best.
        columns.back().shown = !phases && k > 0 && k <= 2 * a.nu && a.coordinates() > 2 && (i == leading[0] || i == leading[1]);
      }
  return columns;
}

std::string motion_prefix(const ForcedSystem& forced, const Ansatz& a, const continuation::Branch& b) {
  const Vector x = b.u(b.points() / 2).head(a.size());
  bool subharmonic = false, flipped = false;
  for (int i = 0; i < a.coordinates(); ++i)
    for (const int k : a.harmonics[static_cast<std::size_t>(i)]) {
      const bool present = std::abs(amplitude(a, x, i, k)) > 1e-9 * x.norm();
      subharmonic = subharmonic || (present && k % a.nu != 0);
      flipped = flipped || (present && !forced.reflections.empty() && forced.reflections[0].signs[static_cast<std::size_t>(i)] < 0);
    }
  if (forced.reflections.empty()) return subharmonic ? "D" : "P";
  return std::string(flipped ? "W" : "IP") + (subharmonic ? "D" : "");
}

Vector symmetric_to_the_bit(const Problem& f, Vector u) {
  const double limit = 1e-9 * u.head(f.size()).lpNorm<Eigen::Infinity>();
  for (const auto& reflection : f.reflections()) {
    const auto odd = reflection.signs.array() < 0.0;
    if ((odd.cast<double>() * u.head(f.size()).array()).abs().maxCoeff() <= limit) u.head(f.size()).array() *= (!odd).cast<double>();
  }
  return u;
}

// Copies of one Floquet exponent stand omega/nu apart, so none needs a frequency above omega/(2 nu); averaging of first order holds for exponents
// well below that.
std::vector<continuation::Branch> with_fast_marked(const ForcedSystem& forced, const Ansatz& ansatz,
                                                   const std::vector<continuation::Branch>& branches, RunContext& context) {
  std::vector<continuation::Branch> marked = branches;
  int count = 0;
  for (auto& b : marked)
    for (auto& special : b.special) {
      const double omega = forced.at(special.u.tail(1)).omega;
      if (special.type != continuation::EventType::hopf || special.frequency <= 0.25 * omega / ansatz.nu) continue;
      special.subtype = "fast";
      ++count;
    }
  if (count > 0)
    context.warn(
        fmt::format("{} Hopf points marked \"fast\" have a frequency above omega/(4 nu): first-order averaging does not hold for them, trust "
                    "Floquet multipliers there",
                    count));
  return marked;
}

std::vector<std::string> dropped_forces(const ForcedSystem& forced, const Ansatz& ansatz) {
  std::vector<std::string> warnings;
  if (ansatz.frozen) return warnings;
  for (const auto& force : forced.at(Vector::Ones(static_cast<Eigen::Index>(forced.lens_units.size()))).forces) {
    const auto& kept = ansatz.harmonics[static_cast<std::size_t>(force.equation)];
    if (std::find(kept.begin(), kept.end(), force.harmonic * ansatz.nu) != kept.end()) continue;
    warnings.push_back(fmt::format("the force on {} at harmonic {} is outside the ansatz and left out",
                                   forced.coordinates[static_cast<std::size_t>(force.equation)], force.harmonic));
  }
  return warnings;
}

}  // namespace whirl::studies
