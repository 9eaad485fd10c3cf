#include "models/catenary/modes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "core/symmetric_pencil.hpp"
#include "models/catenary/largest.hpp"

namespace whirl::models::catenary {
namespace {

constexpr double small_tail = 1e-9;  // a frequency is off by its square
constexpr int finer = 8;             // functions the count has beyond the solution
constexpr int extra = 4;             // frequencies beyond those wanted, so that a gap is found
constexpr int everything = 1 << 30;

void check(const CoreCable& c) {
  if (!(c.x1 < c.x2)) throw std::invalid_argument(fmt::format("the ends of a cable must satisfy x1 < x2, got {:g} and {:g}", c.x1, c.x2));
  if (!(c.kappa >= 0.0 && std::isfinite(c.kappa))) throw std::invalid_argument(fmt::format("kappa must be >= 0, got {:g}", c.kappa));
  for (const double eta : {c.eta1, c.eta2, c.eta3})
    if (!(eta >= 0.0 && std::isfinite(eta))) throw std::invalid_argument(fmt::format("a drag must be >= 0, got {:g}", eta));
}

// A discretisation with its matrices: functions of order k up to functions().
struct InPlaneSystem {
  static constexpr int kinds = 2;
  InPlaneSystem(const CoreCable& c, int n) : kappa(c.kappa), g(c.x1, c.x2, n, c.kappa > 0.0), K(g.stiffness(kappa)), M(g.mass(kappa)) {}
  std::vector<int> indices(Parity parity, int largest_k) const { return g.indices(kappa, parity, largest_k); }
  int order(int i) const { return g.order(i); }
  double kappa;
  InPlaneGalerkin g;
  Matrix K, M;
};

struct LateralSystem {
  static constexpr int kinds = 1;
  LateralSystem(const CoreCable& c, int n) : g(c.x1, c.x2, n), K(g.stiffness()), M(g.mass()) {}
  std::vector<int> indices(Parity parity, int largest_k) const { return g.indices(parity, largest_k); }
  int order(int i) const { return i; }
  LateralGalerkin g;
  Matrix K, M;
};

template <class System>
std::vector<Parity> parities(const System& system) {
  if (system.g.mesh().coordinate.level()) return {Parity::symmetric, Parity::antisymmetric};
  return {Parity::both};
}

struct Solution {
  Vector omega;  // all parities together, increasing, some more than vectors
  Matrix q;      // coefficients in all functions, one column a mode
};

// The lowest modes in the functions of order up to n.
template <class System>
Solution solve(const System& system, int n, int count) {
  struct Place {
    double omega;
    std::size_t part;
    Eigen::Index column;
  };
  std::vector<PencilModes> parts;
  std::vector<std::vector<int>> where;
  std::vector<Place> order;
  for (const Parity parity : parities(system)) {
    where.push_back(system.indices(parity, n));
    parts.push_back(lowest_modes(pick(system.K, where.back()), pick(system.M, where.back()), count, true, extra));
    for (Eigen::Index i = 0; i < parts.back().omega.size(); ++i)
      if (std::isfinite(parts.back().omega[i])) order.push_back({parts.back().omega[i], parts.size() - 1, i});
  }
  std::sort(order.begin(), order.end(), [](const Place& a, const Place& b) { return a.omega < b.omega; });
  if (order.size() > std::size_t(count + extra)) order.resize(std::size_t(count + extra));
  Solution s{Vector(order.size()), Matrix::Zero(system.K.rows(), std::min<Eigen::Index>(count, Eigen::Index(order.size())))};
  for (std::size_t j = 0; j < order.size(); ++j) {
    s.omega[Eigen::Index(j)] = order[j].omega;
    if (Eigen::Index(j) >= s.q.cols()) continue;
    const auto& rows = where[order[j].part];
    for (std::size_t i = 0; i < rows.size(); ++i) s.q(rows[i], Eigen::Index(j)) = parts[order[j].part].vectors(Eigen::Index(i), order[j].column);
  }
  return s;
}

// Coefficients of the four highest orders up to n, relative to the whole.
template <class System>
double tail_of(const System& system, const Vector& q, int n) {
  double tail = 0.0;
  for (Eigen::Index i = 0; i < q.size(); ++i)
    if (const int k = system.order(int(i)); k > n - 4 && k <= n) tail += q[i] * q[i];
  return std::sqrt(tail) / q.norm();
}

// The first gap behind the wanted modes that a count can stand in.
int counted_modes(const Vector& omega, int wanted) {
  int k = wanted;
  while (k < omega.size() && omega[k] - omega[k - 1] < 1e-7 * omega[k]) ++k;
  return k;
}

// Counts in all functions, `finer` more than were solved in: those of high order, stiff, first.
template <class System>
void verify(ModeSet& set, const System& system, const Vector& omega, int count) {
  set.expected = counted_modes(omega, std::min<int>(count, int(omega.size())));
  const bool gap = set.expected < omega.size();
  set.counted_below = gap ? 0.5 * (omega[set.expected - 1] + omega[set.expected]) : omega[set.expected - 1] * (1.0 + 1e-7);
  for (const Parity parity : parities(system)) {
    auto rows = system.indices(parity, everything);
    std::stable_sort(rows.begin(), rows.end(), [&](int a, int b) { return system.order(a) > system.order(b); });
    const auto soft = std::count_if(rows.begin(), rows.end(), [&](int i) { return system.order(i) <= 2 * count + 4; });
    const Matrix A = pick(system.K, rows) - set.counted_below * set.counted_below * pick(system.M, rows);
    set.counted += negative_eigenvalues(A, A.rows() - soft);
  }
}

Mode in_plane_mode(const InPlaneSystem& system, const Mirror& mirror, double omega, const Vector& q) {
  const Mesh& mesh = system.g.mesh();
  const auto at = system.g.nodal<double>(system.kappa, q, Eigen::Vector4d::Zero());
  const double L = -omega * omega;
  Mode mode;
  mode.omega = omega;
  mode.field = field_of<double>(mesh, at, L, L);
  const double scale = sign_at_lower_end(at.V) / largest_displacement<double>(mesh, mode.field, at, system.kappa, L, L);
  mode.field.coefficients *= scale;
  mode.odd_share = mirror.odd_share(mode.field, Quantity::V);
  mode.kind = kind_of(mode.odd_share);
  mode.modal_mass = scale * scale;  // q' M q = 1
  if (system.kappa > 0.0) mode.elastic_share = 1.0 + mesh.weight.dot(at.N.cwiseAbs2()) / L;
  return mode;
}

Mode lateral_mode(const LateralSystem& system, const Mirror& mirror, double omega, const Vector& q) {
  const Mesh& mesh = system.g.mesh();
  const auto n = q.size();
  Matrix at(mesh.t.size(), 2);
  at.col(0) = system.g.W().leftCols(n) * q;
  at.col(1) = system.g.W_slope().leftCols(n) * q;
  Mode mode;
  mode.omega = omega;
  mode.field = {mesh.coordinate, mesh.project(at)};
  const double scale = sign_at_lower_end(at.col(0)) / largest_lateral(mesh, mode.field, at.col(0), -omega * omega);
  mode.field.coefficients *= scale;
  mode.odd_share = mirror.odd_share(mode.field, Quantity::W);
  mode.kind = kind_of(mode.odd_share);
  mode.modal_mass = scale * scale;
  return mode;
}

// Adds functions until the highest mode is resolved, then counts.
template <class System, class MakeMode>
ModeSet modes_of(const CoreCable& c, const ModeOptions& o, MakeMode&& make) {
  check(c);
  o.validate();
  ModeSet set;
  int n = o.functions > 0 ? std::max(o.functions, 6) : functions_for(c, o.count);
  for (int round = 0;; ++round, n += 8 + n / 4) {
    const System system(c, o.verify ? n + finer : n);
    const Solution s = solve(system, n, o.count);
    const auto last = s.q.cols() - 1;
    set.functions = n;
    set.tail = last >= 0 ? tail_of(system, s.q.col(last), n) : 1.0;
    set.resolved = last + 1 == o.count && set.tail < small_tail;
    if (!set.resolved && o.functions == 0 && round < 5) continue;
    if (o.verify && last >= 0) verify(set, system, s.omega, o.count);
    std::optional<Mirror> mirror;
    if (o.shapes) mirror.emplace(system.g.mesh());
    for (Eigen::Index j = 0; j <= last; ++j)
      if (o.shapes) set.modes.push_back(make(system, *mirror, s.omega[j], s.q.col(j)));
      else set.modes.emplace_back().omega = s.omega[j];
    return set;
  }
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
  if (count < 1 || count > most) throw std::invalid_argument(fmt::format("the number of modes must lie in [1, {}], got {}", most, count));
  if (functions < 0 || functions > 2000) throw std::invalid_argument(fmt::format("the number of functions must lie in [0, 2000], got {}", functions));
}

ModeSet in_plane_modes(const CoreCable& c, const ModeOptions& o) { return modes_of<InPlaneSystem>(c, o, in_plane_mode); }
ModeSet out_of_plane_modes(const CoreCable& c, const ModeOptions& o) { return modes_of<LateralSystem>(c, o, lateral_mode); }

}  // namespace whirl::models::catenary
