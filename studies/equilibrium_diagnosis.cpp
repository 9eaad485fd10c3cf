#include "studies/equilibrium_diagnosis.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <tuple>

namespace whirl::studies {
namespace {

using namespace continuation;
using models::EquilibriumModel;
using models::Symmetry;

struct Limits {
  double regular = 1e-6;    // reciprocal condition of f_x above which nothing is neutral
  double singular = 1e-10;  // of the singular values of f_x, against the largest: zero
  double shift = 1e-3;      // along the null vector, against 1 + |x|: where another solution is looked for
  double residual = 1e-12;  // of a solution, against the size of f_x times that of x
  double moved = 1e-6;      // g(x) of a symmetry, against 1 + |x|: it moves the solution
  double at_corner = 1e-6;  // distance from a corner, against 1: zero
  double standing = 1e-8;   // change of the parameter against that of the state: none
  double one_place = 1e-5;  // events nearer than this, against 1 + |u|, are one corner
};
constexpr Limits limits;
constexpr const char* corner = "corner";

using Svd = Eigen::JacobiSVD<Matrix>;

Svd decompose(const Problem& f, In u) {
  Matrix j(f.size(), f.size() + f.parameters());
  f.jacobian(u, j);
  return Svd(j.leftCols(f.size()), Eigen::ComputeFullU | Eigen::ComputeFullV);
}

// Newton at fixed p in the directions that f_x does not annihilate: it comes to rest on a curve of solutions beside where it began.
bool settle_on_curve(const Problem& f, Vector& u) {
  const int n = f.size();
  Vector r(n);
  for (int i = 0; i < 20; ++i) {
    f.residual(u, r);
    Svd svd = decompose(f, u);
    svd.setThreshold(1e-7);
    if (!r.allFinite()) return false;
    if (r.norm() <= limits.residual * (1.0 + svd.singularValues()[0] * u.head(n).norm())) return true;
    u.head(n) -= svd.solve(r);
  }
  return false;
}

std::string direction_text(const Vector& v, const std::vector<std::string>& variables) {
  constexpr int most = 6;
  const Eigen::Index largest = [&] {
    Eigen::Index at = 0;
    v.cwiseAbs().maxCoeff(&at);
    return at;
  }();
  std::string text;
  int count = 0;
  for (Eigen::Index i = 0; i < v.size(); ++i) {
    const double part = v[i] / v[largest];
    if (std::abs(part) < 1e-6) continue;
    if (++count > most) return text + " ...";
    text += fmt::format("{}{:.4g} {}", text.empty() ? (part < 0.0 ? "-" : "") : (part < 0.0 ? " - " : " + "), std::abs(part),
                        variables[static_cast<std::size_t>(i)]);
  }
  return text;
}

std::string corner_text(models::Step::Op op) {
  using Op = models::Step::Op;
  if (op == Op::max || op == Op::min) return fmt::format("both values of a {}(...) of the equations are equal", op == Op::max ? "max" : "min");
  return op == Op::sign ? "a sign(...) of the equations jumps" : "an abs(...) of the equations is zero";
}

// Which corner of the equations u lies on: "an abs(...) of the equations is zero"; "" if on none.
std::string corner_at(const models::VectorField& field, In u) {
  const auto corners = field.corners(std::span<const double>(u.data(), static_cast<std::size_t>(u.size())));
  const auto it = std::find_if(corners.begin(), corners.end(), [](const auto& c) { return std::abs(c.distance) < limits.at_corner; });
  return it == corners.end() ? "" : corner_text(it->op);
}

// A walk steps over a jump where solutions on both sides lie near each other: they are two pieces of a branch, not one.
void warn_of_jumps(const models::VectorField& field, const std::string& parameter, const Branch& b, RunContext& context) {
  const auto signs_at = [&](int i) {
    std::vector<double> signs;
    const Vector u = b.u(i);
    for (const auto& c : field.corners(std::span<const double>(u.data(), static_cast<std::size_t>(u.size()))))
      if (c.op == models::Step::Op::sign) signs.push_back(c.distance);
    return signs;
  };
  for (int i = 1; i < b.points(); ++i) {
    const auto before = signs_at(i - 1), after = signs_at(i);
    if (before.empty()) return;
    for (std::size_t k = 0; k < after.size(); ++k)
      if (before[k] * after[k] < 0.0) {
        context.warn(
            fmt::format("branch {}: a sign(...) of the equations jumps between {} = {:.10g} and {:.10g}: the pieces beside it are not connected",
                        b.name, parameter, b.parameter(i - 1), b.parameter(i)));
        return;
      }
  }
}

// Does the branch end where the parameter stands still?
void warn_if_upright(const EquilibriumModel& model, const std::string& parameter, const Branch& b, RunContext& context) {
  if (b.points() < 3) return;
  const int n = model.size(), last = b.points() - 1;
  for (const auto& [reason, end, before] : {std::tuple{b.start_reason, 0, 2}, std::tuple{b.stop_reason, last, last - 2}}) {
    const Vector step = b.u(end) - b.u(before);
    const bool stands = reason == StopReason::min_step || reason == StopReason::unbounded;
    if (!stands || std::abs(step[n]) > limits.standing * step.norm()) continue;
    context.warn(fmt::format("branch {}: rest points at {} = {:.10g} are not isolated: they go on along {}", b.name, parameter, b.parameter(end),
                             direction_text(step.head(n), model.variables)));
    return;
  }
}

}  // namespace

std::string why_not_isolated(const Problem& f, In u, const std::vector<std::string>& variables, const std::vector<Symmetry>& symmetries) {
  const int n = f.size();
  const double size = 1.0 + u.head(n).norm();
  Matrix j(n, n + f.parameters());
  f.jacobian(u, j);
  if (j.leftCols(n).partialPivLu().rcond() > limits.regular) return "";
  Vector at = u;
  if (!settle_on_curve(f, at)) return "";
  const Svd svd = decompose(f, at);
  if (!(svd.singularValues()[n - 1] <= limits.singular * svd.singularValues()[0])) return "";
  for (const Symmetry& g : symmetries) {
    const Vector motion = g.field(at.head(n));
    if (motion.norm() < limits.moved * size) continue;
    Eigen::Index most = 0;
    motion.cwiseAbs().maxCoeff(&most);
    return fmt::format("rest points are not isolated: {} takes one into others; equilibrium_model.phase = \"{}\" pins one of each",
                       describe(g, variables), variables[static_cast<std::size_t>(most)]);
  }
  const Vector neutral = svd.matrixV().col(n - 1);
  for (const double sign : {1.0, -1.0}) {  // a fold or a pitchfork has solutions on neither side
    Vector beside = at;
    beside.head(n) += sign * limits.shift * size * neutral;
    const Vector aimed = beside;
    if (!settle_on_curve(f, beside) || (beside - aimed).norm() > 0.1 * limits.shift * size) return "";
    const Vector values = decompose(f, beside).singularValues();
    if (!(values[n - 1] <= 1e-7 * values[0])) return "";
  }
  return fmt::format(
      "rest points are not isolated: they go on along {} with a neutral direction; hold what the equations conserve with equilibrium_model.conserved "
      "= "
      "[\"...\"], or pin a variable that a symmetry leaves free with equilibrium_model.phase",
      direction_text(neutral, variables));
}

std::vector<Branch> with_corners_marked(const EquilibriumModel& model, const std::string& parameter, const std::vector<Branch>& branches,
                                        RunContext& context) {
  std::vector<Branch> marked = branches;
  for (const Branch& b : branches) warn_if_upright(model, parameter, b, context);
  const models::VectorField field = models::bound(model, model.rhs, {parameter});
  const std::vector<double> anywhere(static_cast<std::size_t>(field.inputs()), 0.0);
  if (field.corners(anywhere).empty()) return marked;
  for (Branch& b : marked) {
    if (b.points() == 0) continue;
    warn_of_jumps(field, parameter, b, context);
    int count = 0;
    std::string first;
    std::vector<SpecialPoint> kept;
    for (SpecialPoint& s : b.special) {
      const std::string where = s.type == EventType::unresolved ? corner_at(field, s.u) : "";
      if (!where.empty()) {
        if (first.empty()) first = where;
        const bool known = std::any_of(kept.begin(), kept.end(), [&](const SpecialPoint& k) {
          return k.subtype == corner && (k.u - s.u).norm() < limits.one_place * (1.0 + s.u.norm());
        });
        if (known) continue;
        s.type = EventType::gave_up;
        s.subtype = corner;
        ++count;
      }
      kept.push_back(std::move(s));
    }
    b.special = std::move(kept);
    if (count > 0)
      context.warn(fmt::format("branch {}: {} where {}: they have no derivative there", b.name,
                               count == 1 ? "a corner" : fmt::format("{} corners", count), first));
    for (const auto& [reason, u] : {std::pair{b.start_reason, b.u(0)}, std::pair{b.stop_reason, b.u(b.points() - 1)}})
      if (const std::string where = corner_at(field, u); reason == StopReason::min_step && !where.empty())
        context.warn(fmt::format("branch {} ends at a corner: {} there, and more than one branch may go on", b.name, where));
  }
  return marked;
}

}  // namespace whirl::studies
