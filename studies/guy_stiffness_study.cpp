#include "studies/guy_stiffness_study.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "models/guy/mode_count.hpp"
#include "studies/common_keys.hpp"
#include "studies/guy_stiffness_output.hpp"

namespace whirl::studies {
namespace {

using namespace models::guy;

using Setup = GuyStiffnessSetup;

Schema schema() {
  Schema s("guy-stiffness", "dynamic stiffness of a guy at the mast against frequency: the full linear problem beside the closed forms");
  add_guy_keys(s);
  add_guy_damping_keys(s);
  s.add({.name = "stiffness.range",
         .unit = "rad/s",
         .description = "frequencies, lower and upper end",
         .default_value = std::vector<double>{},
         .required = true,
         .lower = 0.0,
         .min_items = 2,
         .max_items = 2,
         .example = Value{std::vector<double>{0.02, 9.0}}});
  s.add_count("stiffness.points", "frequencies", 2000, 2, 1e6);
  s.add({.name = "stiffness.at",
         .unit = "rad/s",
         .description = "frequencies within the range at which the stiffness is printed and stands in a table of its own",
         .default_value = std::vector<double>{},
         .lower = 0.0});
  s.add({.name = "stiffness.closed_forms",
         .description = "closed forms of the horizontal modulus to compare with",
         .default_value = std::vector<std::string>{"classical", "completed", "sarvi", "sarvi-modal"},
         .choices = {"classical", "completed-massless", "completed", "sarvi", "sarvi-modal"}});
  s.add({.name = "stiffness.alpha",
         .description = "softening factor of Sarvi's forms; 0: his, the static tangent over the taut modulus",
         .default_value = 0.0,
         .lower = 0.0,
         .upper = 10.0,
         .closed_lower = true});
  s.add_count("stiffness.degree", "polynomial degree of the full problem; 0: chosen", 0, 0, largest_degree);
  s.add_count("level.guys", "equal guys, equally spread, whose stiffness is summed; 0: none", 0, 0, 100);
  s.add({.name = "level.azimuths_deg",
         .unit = "deg",
         .description = "or their azimuths from the mast to the anchors",
         .default_value = std::vector<double>{},
         .max_items = 100});
  s.add({.name = "convergence.omega",
         .unit = "rad/s",
         .description = "frequency at which the error against the degree is measured; default: the upper end, or what degree 125 resolves",
         .optional = true,
         .lower = 0.0,
         .example = Value{3.14}});
  return s;
}

Setup setup(const Configuration& c) {
  Setup s{.guy = guy_of(c),
          .omega = grid_of(c, "stiffness.range", static_cast<int>(c.integer("stiffness.points"))),
          .at = c.numbers("stiffness.at"),
          .azimuths = c.numbers("level.azimuths_deg"),
          .forms = {}};
  s.damping_rate = damping_rate_of(c, s.guy.first_order);
  s.alpha = c.number("stiffness.alpha");
  s.degree = static_cast<int>(c.integer("stiffness.degree"));
  if (s.degree == 1) throw c.error("stiffness.degree", "must be 0, or 2 and more");
  for (const ClosedForm form : all_closed_forms)
    if (const auto& names = c.texts("stiffness.closed_forms"); std::find(names.begin(), names.end(), to_string(form)) != names.end())
      s.forms.push_back(form);
  for (const double omega : s.at)
    if (omega > s.omega.back()) throw c.error("stiffness.at", fmt::format("must not lie above stiffness.range, got {:g}", omega));
  const auto guys = c.integer("level.guys");
  if (guys > 0 && !s.azimuths.empty()) throw c.error("level.guys", "is given beside level.azimuths_deg: give one of them");
  for (int j = 0; j < guys; ++j) s.azimuths.push_back(360.0 * j / static_cast<double>(guys));
  s.convergence_omega = s.omega.back();
  if (c.has("convergence.omega")) s.convergence_omega = c.number("convergence.omega");
  else
    while (suitable_degree(s.guy.exact, s.convergence_omega) > 125 && s.convergence_omega > s.omega.front()) s.convergence_omega *= 0.8;
  if (s.convergence_omega > s.omega.back()) throw c.error("convergence.omega", "must lie within stiffness.range");
  blame(c, s.degree > 0 ? "stiffness.degree" : "stiffness.range", [&] { (void)LinearGuy(s.guy.exact, s.omega.back(), s.degree); });
  return s;
}

std::vector<std::string> warnings_of(const Setup& s) {
  auto warnings = guy_warnings(s.guy);
  if (s.degree > 0 && s.degree < suitable_degree(s.guy.exact, s.omega.back()))
    warnings.push_back(fmt::format("stiffness.degree = {} is below the {} that resolves the range to rounding", s.degree,
                                   suitable_degree(s.guy.exact, s.omega.back())));
  return warnings;
}

std::vector<std::string> check(const Configuration& c) { return warnings_of(setup(c)); }

ExitStatus run(const Configuration& c, RunContext& context) {
  const Setup s = setup(c);
  for (const auto& w : warnings_of(s)) context.warn(w);
  ResultFile file(context.output);
  write_study(file, c);
  write_guy(file, context, s.guy);
  const LinearGuy full(s.guy.exact, s.omega.back(), s.degree);
  write_horizontal(file, s, full);
  write_matrix(file, s, full);
  const auto listed = poles_and_zeros(full);
  write_listed(file, s, listed);
  file.flush();
  bool complete = true;
  for (const Plane plane : {Plane::in_plane, Plane::out_of_plane}) {
    const int counted = modes_below(s.guy.exact, plane, s.omega.back()), found = static_cast<int>(full.poles(plane).size());
    file.attribute("/poles_and_zeros", plane == Plane::in_plane ? "counted_in_plane" : "counted_out_of_plane", counted);
    if (counted == found) continue;
    context.warn(fmt::format("poles {}: {} counted, {} found", plane == Plane::in_plane ? "in plane" : "out of plane", counted, found));
    complete = false;
  }
  write_longitudinal(file, s);
  write_convergence(file, s);
  report_stiffness(context.report, s, listed);
  context.print(stiffness_text(s, listed));
  write_stiffness_at(file, context, stiffness_at(s, full));
  return finish(file, context, complete ? ExitStatus::ok : ExitStatus::numerical_failure,
                {complete ? "horizontal: range end; all poles found, an independent count agrees" : "a pole is missing"});
}

}  // namespace

StudyKind guy_stiffness_study() { return {schema(), run, check}; }

}  // namespace whirl::studies
