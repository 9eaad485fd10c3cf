#include "continuation/deflation.hpp"

#include <Eigen/LU>

namespace whirl::continuation {
namespace {

Vector mirror(const Reflection& r, Vector u) {
  u.head(r.signs.size()).array() *= r.signs.array();
  return u;
}

// Newton's step dx of the plain residual becomes dx / (1 - grad(log m)' dx): the deflated Jacobian is a rank-one change.
bool deflated_newton(const Problem& f, Vector& u, const std::vector<Vector>& known, double scale, const NewtonOptions& options) {
  const int n = f.size();
  Vector r(n), dx(n), slope(n);
  Matrix j(n, n + f.parameters());
  for (int i = 0; i < options.max_iterations; ++i) {
    f.linearise(u, r, j);
    if (!r.allFinite() || !j.allFinite()) return false;
    dx = j.leftCols(n).partialPivLu().solve(-r);
    if (!dx.allFinite()) return false;
    slope.setZero();  // of log m
    for (const auto& k : known) {
      const Vector d = (u.head(n) - k.head(n)) / scale;
      const double q = d.squaredNorm();
      if (q == 0.0) return false;
      slope -= 2.0 * d / (scale * q * (1.0 + q));
    }
    const double stretch = 1.0 / (1.0 - slope.dot(dx));
    if (!std::isfinite(stretch)) return false;
    dx *= stretch;
    const double longest = 2.0 * (scale + u.head(n).norm());
    if (dx.norm() > longest) dx *= longest / dx.norm();
    u.head(n) += dx;
    if (dx.norm() < 1e-8 * (scale + u.head(n).norm())) return true;
  }
  return false;
}

}  // namespace

std::vector<Vector> deflated_solutions(const Problem& f, std::vector<Vector> known, const std::vector<Vector>& starts, const DeflationOptions& o) {
  o.newton.validate();
  if (!(o.scale > 0.0)) throw std::invalid_argument("deflation: the scale of the unknowns must be > 0");
  const int n = f.size();
  std::vector<Vector> deflated;  // known ones and their mirror images
  const auto add = [&](const Vector& u) {
    deflated.push_back(u);
    for (const auto& r : f.reflections())
      if ((mirror(r, u) - u).norm() > 0.0) deflated.push_back(mirror(r, u));
  };
  for (const auto& u : known) add(u);
  for (const auto& start : starts)
    for (bool found = true; found && static_cast<int>(known.size()) < o.max_solutions;) {
      Vector u = start;
      found = deflated_newton(f, u, deflated, o.scale, o.newton);
      if (!found) break;
      const NewtonResult polished = newton(f, u, {.tolerance = o.newton.tolerance, .max_iterations = 20});
      found = polished.ok();
      for (const auto& k : deflated) found = found && (polished.x.head(n) - k.head(n)).norm() > o.same * (o.scale + k.head(n).norm());
      if (!found) break;
      known.push_back(polished.x);
      add(polished.x);
    }
  return known;
}

}  // namespace whirl::continuation
