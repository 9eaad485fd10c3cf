#include "models/catenary/modes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "core/symmetric_pencil.hpp"

namespace whirl::models::catenary {
namespace {

constexpr double small_tail = 1e-9;  // a frequency is off by its square
constexpr int finer = 12;            // functions the count has beyond the solution

void check(const CoreCable& c) {
  if (!(c.x1 < c.x2)) throw std::invalid_argument(fmt::format("the ends of a cable must satisfy x1 < x2, got {:g} and {:g}", c.x1, c.x2));
  if (!(c.kappa >= 0.0 && std::isfinite(c.kappa))) throw std::invalid_argument(fmt::format("kappa must be >= 0, got {:g}", c.kappa));
  for (const double eta : {c.eta1, c.eta2, c.eta3})
    if (!(eta >= 0.0 && std::isfinite(eta))) throw std::invalid_argument(fmt::format("a drag must be >= 0, got {:g}", eta));
}

bool level(const CoreCable& c) { return std::abs(c.x1 + c.x2) < 1e-14 * (c.x2 - c.x1); }

// Matrices of one parity with the functions they stand for.
struct Pencil {
  Matrix K, M;
  std::vector<int> indices;
};

struct Solution {
  Vector omega;  // all parities together, increasing
  Matrix q;      // coefficients in all functions, one column a mode
  std::vector<Pencil> pencils;
};

template <class MakePencil>
Solution solve(const CoreCable& c, int size, int count, MakePencil&& make) {
  Solution s;
  if (level(c)) s.pencils = {make(Parity::symmetric), make(Parity::antisymmetric)};
  else s.pencils = {make(Parity::both)};
  std::vector<PencilModes> parts;
  std::vector<std::pair<double, std::pair<int, int>>> order;
  for (const auto& p : s.pencils) {
    parts.push_back(lowest_modes(p.K, p.M, count));
    for (Eigen::Index i = 0; i < parts.back().omega.size(); ++i)
      if (std::isfinite(parts.back().omega[i])) order.push_back({parts.back().omega[i], {int(parts.size()) - 1, int(i)}});
  }
  std::sort(order.begin(), order.end());
  if (order.size() > std::size_t(count)) order.resize(std::size_t(count));
  s.omega.resize(Eigen::Index(order.size()));
  s.q = Matrix::Zero(size, s.omega.size());
  for (Eigen::Index j = 0; j < s.omega.size(); ++j) {
    const auto [part, column] = order[std::size_t(j)].second;
    s.omega[j] = order[std::size_t(j)].first;
    const auto& where = s.pencils[std::size_t(part)].indices;
    for (std::size_t i = 0; i < where.size(); ++i) s.q(where[i], j) = parts[std::size_t(part)].vectors(Eigen::Index(i), column);
  }
  return s;
}

// Largest of the last four coefficients of each kind of function, relative to the whole.
double tail_of(const Vector& q, int n) {
  double tail = q.segment(n - 4, 4).norm();
  if (q.size() > n) tail += q.segment(2 * n - 4, 4).norm();
  return tail / q.norm();
}

// The first gap behind the wanted modes that a count can stand in.
int counted_modes(const Vector& omega, int wanted) {
  int k = wanted;
  while (k < omega.size() && omega[k] - omega[k - 1] < 1e-7 * omega[k]) ++k;
  return k;
}

constexpr int extra = 4;  // modes beyond those wanted, so that a gap is found

// Adds functions until the highest mode is resolved; `at(n)` solves with n functions.
template <class SolveWith>
Solution resolve(ModeSet& set, const CoreCable& c, const ModeOptions& o, SolveWith&& at) {
  int n = o.functions > 0 ? std::max(o.functions, 6) : functions_for(0.5 * (c.x2 - c.x1), o.count);
  for (int round = 0;; ++round) {
    Solution s = at(n);
    set.functions = n;
    const auto last = std::min<Eigen::Index>(o.count, s.omega.size()) - 1;
    set.tail = last >= 0 ? tail_of(s.q.col(last), n) : 1.0;
    set.resolved = last + 1 == o.count && set.tail < small_tail;
    if (set.resolved || o.functions > 0 || round == 5) return s;
    n += 8 + n / 4;
  }
}

template <class CountBelow>
void verify(ModeSet& set, const Vector& omega, int count, CountBelow&& below) {
  set.expected = counted_modes(omega, std::min<int>(count, int(omega.size())));
  const bool gap = set.expected < omega.size();
  set.counted_below = gap ? 0.5 * (omega[set.expected - 1] + omega[set.expected]) : omega[set.expected - 1] * (1.0 + 1e-7);
  set.counted = below(set.counted_below);
}

// Largest displacement 1, V (or W) positive where the cable leaves its lower end.
double scale_of(const Vector& first, const Vector& second) {
  const double largest = std::sqrt((first.array().square() + second.array().square()).maxCoeff());
  Eigen::Index i = 0;
  while (i + 1 < second.size() && std::abs(second[i]) < 1e-3 * second.cwiseAbs().maxCoeff()) ++i;
  return (second[i] < 0.0 ? -1.0 : 1.0) / largest;
}

Mode in_plane_mode(const InPlaneGalerkin& g, const Mirror& mirror, double kappa, double omega, const Vector& q) {
  Mode mode;
  auto at = g.nodal<double>(kappa, q, Eigen::Vector4d::Zero());
  const double scale = scale_of(at.U, at.V);
  for (Vector* v : {&at.U, &at.V, &at.N}) *v *= scale;
  mode.omega = omega;
  mode.field = field_of<double>(g.mesh(), at, -omega * omega, -omega * omega);
  mode.odd_share = mirror.odd_share(mode.field, Quantity::V);
  mode.kind = kind_of(mode.odd_share);
  const Vector w = g.mesh().weight.cwiseProduct(g.mesh().c);
  mode.modal_mass = w.dot(at.U.cwiseAbs2()) + w.dot(at.V.cwiseAbs2());
  if (kappa > 0.0) mode.elastic_share = 1.0 - g.mesh().weight.dot(at.N.cwiseAbs2()) / (omega * omega * mode.modal_mass);
  return mode;
}

Mode lateral_mode(const LateralGalerkin& g, const Mirror& mirror, double omega, const Vector& q) {
  Mode mode;
  Vector W = g.W().leftCols(g.size()) * q, slope = g.W_slope().leftCols(g.size()) * q;
  const double scale = scale_of(Vector::Zero(W.size()), W);
  W *= scale;
  slope *= scale;
  mode.omega = omega;
  mode.field = {g.mesh().coordinate, Matrix(W.size(), 2)};
  mode.field.coefficients.col(0) = g.mesh().project(W);
  mode.field.coefficients.col(1) = g.mesh().project(slope);
  mode.odd_share = mirror.odd_share(mode.field, Quantity::W);
  mode.kind = kind_of(mode.odd_share);
  mode.modal_mass = g.mesh().weight.cwiseProduct(g.mesh().c).dot(W.cwiseAbs2());
  return mode;
}

}  // namespace

const char* to_string(ModeKind kind) {
  switch (kind) {
    case ModeKind::symmetric:
      return "symmetric";
    case ModeKind::antisymmetric:
      return "antisymmetric";
    case ModeKind::hybrid:
      return "hybrid";
  }
  return "";
}

ModeKind kind_of(double share) { return share < 0.05 ? ModeKind::symmetric : share > 0.95 ? ModeKind::antisymmetric : ModeKind::hybrid; }

void ModeOptions::validate() const {
  if (count < 1 || count > 400) throw std::invalid_argument(fmt::format("the number of modes must lie in [1, 400], got {}", count));
  if (functions < 0 || functions > 2000) throw std::invalid_argument(fmt::format("the number of functions must lie in [0, 2000], got {}", functions));
}

int functions_for(double m, int count) { return 24 + static_cast<int>(1.6 * count + (8.0 + 0.8 * m) * m); }

ModeSet in_plane_modes(const CoreCable& c, const ModeOptions& o) {
  check(c);
  o.validate();
  ModeSet set;
  std::optional<InPlaneGalerkin> g;
  const auto pencil_of = [&](const InPlaneGalerkin& galerkin) {
    return [&, K = galerkin.stiffness(c.kappa), M = galerkin.mass(c.kappa)](Parity parity) -> Pencil {
      const auto i = galerkin.indices(c.kappa, parity);
      if (parity == Parity::both) return {K, M, i};
      return {pick(K, i, i), pick(M, i, i), i};
    };
  };
  const Solution s = resolve(set, c, o, [&](int n) {
    g.emplace(c.x1, c.x2, n);
    return solve(c, g->size(c.kappa), o.count + extra, pencil_of(*g));
  });
  if (o.verify)
    verify(set, s.omega, o.count, [&](double omega) {
      const InPlaneGalerkin fine(c.x1, c.x2, set.functions + finer);
      const auto make = pencil_of(fine);
      if (!level(c)) return frequencies_below(fine.stiffness(c.kappa), fine.mass(c.kappa), omega);
      const Pencil even = make(Parity::symmetric), odd = make(Parity::antisymmetric);
      return frequencies_below(even.K, even.M, omega) + frequencies_below(odd.K, odd.M, omega);
    });
  std::optional<Mirror> mirror;
  if (o.shapes) mirror.emplace(g->mesh());
  for (Eigen::Index j = 0; j < std::min<Eigen::Index>(o.count, s.omega.size()); ++j)
    if (o.shapes) set.modes.push_back(in_plane_mode(*g, *mirror, c.kappa, s.omega[j], s.q.col(j)));
    else set.modes.emplace_back().omega = s.omega[j];
  return set;
}

ModeSet out_of_plane_modes(const CoreCable& c, const ModeOptions& o) {
  check(c);
  o.validate();
  ModeSet set;
  std::optional<LateralGalerkin> g;
  const auto pencil_of = [](const LateralGalerkin& galerkin) {
    return [&](Parity parity) -> Pencil {
      const auto i = galerkin.indices(parity);
      return {pick(galerkin.stiffness(), i, i), pick(galerkin.mass(), i, i), i};
    };
  };
  const Solution s = resolve(set, c, o, [&](int n) {
    g.emplace(c.x1, c.x2, n);
    return solve(c, n, o.count + extra, pencil_of(*g));
  });
  if (o.verify)
    verify(set, s.omega, o.count, [&](double omega) {
      const LateralGalerkin fine(c.x1, c.x2, set.functions + finer);
      return frequencies_below(fine.stiffness(), fine.mass(), omega);
    });
  std::optional<Mirror> mirror;
  if (o.shapes) mirror.emplace(g->mesh());
  for (Eigen::Index j = 0; j < std::min<Eigen::Index>(o.count, s.omega.size()); ++j)
    if (o.shapes) set.modes.push_back(lateral_mode(*g, *mirror, s.omega[j], s.q.col(j)));
    else set.modes.emplace_back().omega = s.omega[j];
  return set;
}

}  // namespace whirl::models::catenary
