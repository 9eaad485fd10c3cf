#include "models/equilibrium_symmetry.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace whirl::models {
namespace {

constexpr double singular = 1e-10;  // a pivot this small against the largest is none
constexpr double rounding = 1e-8;   // what counts as zero in a sum against its parts, at points not used to find it

// The nearest fraction with a small denominator where there is one within 1e-9: symmetries and totals mostly have such numbers.
double simple(double x) {
  for (int q = 1; q <= 12; ++q)
    if (const double p = std::round(x * q); std::abs(x * q - p) < 1e-9 * q * std::max(1.0, std::abs(x))) return p == 0.0 ? 0.0 : p / q;
  return x;
}

// Reduced row echelon form of a basis given as columns: one vector a row, as few entries as possible, each led by 1.
Matrix tidy(const Matrix& columns) {
  Matrix m = columns.transpose();
  Eigen::Index row = 0;
  for (Eigen::Index c = 0; c < m.cols() && row < m.rows(); ++c) {
    Eigen::Index pivot = 0;
    const double size = m.col(c).tail(m.rows() - row).cwiseAbs().maxCoeff(&pivot);
    if (size < 1e-7 * m.bottomRows(m.rows() - row).cwiseAbs().maxCoeff()) continue;
    m.row(row).swap(m.row(row + pivot));
    m.row(row) /= m(row, c);
    for (Eigen::Index r = 0; r < m.rows(); ++r)
      if (r != row) m.row(r) -= m(r, c) * m.row(row);
    ++row;
  }
  return m.topRows(row).unaryExpr(&simple);
}

// Columns of equal size, so that the units of the variables do not matter.
Matrix kernel(Matrix rows) {
  Vector size = rows.colwise().norm();
  for (double& s : size) s = s > 0.0 ? s : 1.0;
  rows = rows * size.cwiseInverse().asDiagonal();
  Eigen::FullPivLU<Matrix> lu(rows);
  lu.setThreshold(singular);
  if (lu.dimensionOfKernel() == 0) return Matrix(rows.cols(), 0);
  return size.cwiseInverse().asDiagonal() * lu.kernel();
}

// "S + I - 2*R"; "0" for none.
std::string linear_text(const Vector& weights, double constant, const std::vector<std::string>& names) {
  std::string text;
  const auto add = [&](double w, const std::string& name) {
    if (w == 0.0) return;
    const std::string size = std::abs(w) == 1.0 && !name.empty() ? name
                             : name.empty()                      ? fmt::format("{}", std::abs(w))
                                                                 : fmt::format("{}*{}", std::abs(w), name);
    text += text.empty() ? (w < 0.0 ? "-" : "") + size : (w < 0.0 ? " - " : " + ") + size;
  };
  for (Eigen::Index i = 0; i < weights.size(); ++i) add(weights[i], names[static_cast<std::size_t>(i)]);
  add(constant, "");
  return text.empty() ? "0" : text;
}

EquilibriumModel plain(EquilibriumModel m) {
  m.mirrors.clear();
  m.conserved.clear();
  return m;
}

// What of Df g - A f is left, against its parts.
double defect(const EquilibriumFlow& flow, const Vector& u, const Symmetry& s) {
  const int n = flow.size();
  Vector f(n);
  Matrix j(n, n + flow.parameters());
  flow.linearise(u, f, j);
  const Vector x = u.head(n), g = s.field(x);
  const double parts = (j.leftCols(n).cwiseAbs() * (s.a.cwiseAbs() * x.cwiseAbs() + s.b.cwiseAbs()) + s.a.cwiseAbs() * f.cwiseAbs()).norm();
  return (j.leftCols(n) * g - s.a * f).norm() / (parts > 0.0 ? parts : 1.0);
}

}  // namespace

std::vector<std::string> linear_invariants(const EquilibriumModel& model, const std::vector<std::string>& lenses) {
  const int n = model.size();
  const EquilibriumFlow flow(plain(model), lenses);
  const auto points = sample_points(model, lenses, 4 * n + 8);
  Matrix f(static_cast<Eigen::Index>(points.size()), n);
  for (std::size_t i = 0; i < points.size(); ++i) {
    Vector r(n);
    flow.residual(points[i], r);
    f.row(static_cast<Eigen::Index>(i)) = r.normalized();
  }
  if (f.rows() < 2 * n) return {};
  const Matrix weights = tidy(kernel(f.topRows(f.rows() / 2)));
  // Those given already take their directions at the start.
  Vector start(n + static_cast<int>(lenses.size()));
  for (int i = 0; i < n; ++i) start[i] = model.initial[static_cast<std::size_t>(i)];
  for (std::size_t k = 0; k < lenses.size(); ++k) start[n + static_cast<int>(k)] = model.parameter(lenses[k]);
  Matrix gradients(static_cast<Eigen::Index>(model.conserved.size()), n);
  if (!model.conserved.empty()) {
    const VectorField c = bound(model, model.conserved, lenses);
    using D = Dual<double, 1>;
    for (int j = 0; j < n; ++j) {
      std::vector<D> in(start.begin(), start.end()), out(model.conserved.size());
      in[static_cast<std::size_t>(j)].d[0] = 1.0;
      c.evaluate<D>(in, out);
      for (std::size_t k = 0; k < out.size(); ++k) gradients(static_cast<Eigen::Index>(k), j) = out[k].d[0];
    }
  }
  std::vector<std::string> found;
  for (Eigen::Index k = 0; k < weights.rows(); ++k) {
    const Vector w = weights.row(k);
    const Vector sums = (f * w).cwiseAbs(), parts = f.cwiseAbs() * w.cwiseAbs();
    if ((sums.array() > rounding * parts.array()).any()) continue;
    Matrix with(gradients.rows() + 1, n);
    with << gradients, w.transpose();
    Eigen::FullPivLU<Matrix> lu(with);
    lu.setThreshold(rounding);
    if (lu.rank() <= gradients.rows()) continue;
    gradients = with;
    found.push_back(linear_text(w, 0.0, model.variables));
  }
  return found;
}

// Df (A x + b) - A f = 0 at enough points, linear in the entries of A (row by row) and b:
//
//   sum_kl f_r,k x_l A_kl + sum_k f_r,k b_k - sum_l f_l A_rl = 0,   r = 1 ... n
std::vector<Symmetry> continuous_symmetries(const EquilibriumModel& model, const std::vector<std::string>& lenses, int largest) {
  const int n = model.size();
  if (n > largest) return {};
  const EquilibriumFlow flow(plain(model), lenses);
  const auto points = sample_points(model, lenses, 3 * n + 8);
  const int used = static_cast<int>(points.size()) * 2 / 3;
  if (used < n + 2) return {};
  Matrix rows = Matrix::Zero(used * n, n * n + n);
  for (int i = 0; i < used; ++i) {
    const Vector& u = points[static_cast<std::size_t>(i)];
    Vector f(n);
    Matrix j(n, n + flow.parameters());
    flow.linearise(u, f, j);
    for (int r = 0; r < n; ++r) {
      auto row = rows.row(i * n + r);
      for (int k = 0; k < n; ++k) {
        row.segment(k * n, n) += j(r, k) * u.head(n).transpose();
        row[n * n + k] = j(r, k);
      }
      row.segment(r * n, n) -= f.transpose();
      if (const double size = row.norm(); size > 0.0) row /= size;
    }
  }
  const Matrix found = tidy(kernel(rows));
  std::vector<Symmetry> all;
  for (Eigen::Index i = 0; i < found.rows(); ++i) {
    Symmetry s{Matrix(n, n), found.row(i).tail(n)};
    for (int k = 0; k < n; ++k) s.a.row(k) = found.row(i).segment(k * n, n);
    if (std::all_of(points.begin() + used, points.end(), [&](const Vector& u) { return defect(flow, u, s) < rounding; })) all.push_back(std::move(s));
  }
  return all;
}

// What f(x + 2 pi e_i) - f(x) is at every point, if it is the same at all: what f gains by a turn of variable i. So it is for variables that f holds
// as angles, linearly, or both.
//
//   f(x + 2 pi k) = f(x) + sum_i k_i gain_i for whole k: the turns are the whole vectors that the gains annihilate
std::vector<Turn> turns(const EquilibriumModel& model, const std::vector<std::string>& lenses) {
  constexpr int points = 12, largest = 40;
  const VectorField f = bound(model, model.rhs, lenses);
  const auto samples = sample_points(model, lenses, points);
  const int n = static_cast<int>(model.variables.size());
  if (samples.empty() || n > largest) return {};
  const auto value = [&](const Vector& u) {
    Vector r(f.equations());
    f.evaluate<double>({u.data(), static_cast<std::size_t>(u.size())}, {r.data(), static_cast<std::size_t>(r.size())});
    return r;
  };
  const auto gain = [&](const Vector& u, const Vector& by) {
    Vector moved = u;
    moved.head(n) += by;
    return Vector(value(moved) - value(u));
  };
  // The largest difference between two gains, against f.
  const auto change = [&](const Vector& by, const Vector& expected) {
    double most = 0.0;
    for (const Vector& u : samples) {
      const double apart = ((gain(u, by) - expected).array().abs() / (1.0 + value(u).array().abs())).maxCoeff();
      most = std::isfinite(apart) ? std::max(most, apart) : std::numeric_limits<double>::infinity();
    }
    return most;
  };
  const double turn = 2.0 * std::numbers::pi;
  std::vector<int> candidates;
  std::vector<Vector> gains;
  for (int i = 0; i < n; ++i) {
    Vector at = gain(samples[0], turn * Vector::Unit(n, i));
    if (!(change(turn * Vector::Unit(n, i), at) < rounding)) continue;
    candidates.push_back(i);
    gains.push_back(at.unaryExpr([](double x) { return std::abs(x) < rounding ? 0.0 : x; }));
  }
  std::vector<Turn> found;
  if (candidates.empty()) return found;
  Matrix columns(f.equations(), static_cast<Eigen::Index>(candidates.size()));
  for (std::size_t c = 0; c < candidates.size(); ++c) columns.col(static_cast<Eigen::Index>(c)) = gains[c];
  const Matrix basis = tidy(kernel(columns));
  for (Eigen::Index r = 0; r < basis.rows(); ++r) {
    Vector k = Vector::Zero(n);
    for (std::size_t c = 0; c < candidates.size(); ++c) k[candidates[c]] = basis(r, static_cast<Eigen::Index>(c));
    int scale = 1;
    while (scale < 12 && (scale * k - (scale * k).array().round().matrix()).norm() > rounding) ++scale;
    k = (scale * k).array().round();
    const Vector none = Vector::Zero(f.equations());
    if (change(k, none) > 1e-3 && change(turn * k, none) < rounding) found.push_back({k});
  }
  return found;
}

Turn turn_of(const EquilibriumModel& model, const std::vector<Turn>& turns, const std::string& variable) {
  const auto i = std::find(model.variables.begin(), model.variables.end(), variable) - model.variables.begin();
  Turn best{Vector::Unit(model.size(), i)};
  bool found = false;
  for (const Turn& t : turns) {
    if (std::abs(t.k[i]) != 1.0 || (found && (t.k.array() != 0.0).count() >= (best.k.array() != 0.0).count())) continue;
    best.k = t.k[i] * t.k;
    found = true;
  }
  return best;
}

std::string describe(const Turn& turn, const std::vector<std::string>& variables) { return linear_text(turn.k, 0.0, variables); }

std::string describe(const Symmetry& s, const std::vector<std::string>& variables) {
  if (s.a.isZero(0.0)) return "a translation along " + linear_text(s.b, 0.0, variables);
  std::vector<std::string> moved;
  for (Eigen::Index i = 0; i < s.b.size(); ++i)
    if (s.a.row(i).any() || s.b[i] != 0.0) moved.push_back(variables[static_cast<std::size_t>(i)]);
  const bool turns = (s.a + s.a.transpose()).isZero(0.0);
  return fmt::format("a {} ({})", turns ? "rotation of" : "linear motion of", fmt::join(moved, ", "));
}

EquilibriumModel pinned(const EquilibriumModel& model, const std::string& variable, const std::vector<std::string>& lenses) {
  constexpr int largest = 40;
  const auto it = std::find(model.variables.begin(), model.variables.end(), variable);
  if (it == model.variables.end())
    throw std::invalid_argument(fmt::format("'{}' is no variable; the variables are {}", variable, fmt::join(model.variables, ", ")));
  if (model.size() < 2) throw std::invalid_argument("pins the only variable: nothing is left to be solved for");
  const auto k = it - model.variables.begin();
  const auto moves = [&](const Symmetry& s) { return s.a.row(k).any() || s.b[k] != 0.0; };
  auto all = continuous_symmetries(model, lenses, largest);
  std::erase_if(all, [&](const Symmetry& s) { return !moves(s); });
  if (all.empty())
    throw std::invalid_argument(fmt::format("the equations have no translation or rotation that moves {}: its value is not free", variable));
  const auto entries = [](const Symmetry& s) { return (s.a.array() != 0.0).count() + (s.b.array() != 0.0).count(); };
  const Symmetry g = *std::min_element(all.begin(), all.end(), [&](const auto& a, const auto& b) { return entries(a) < entries(b); });

  EquilibriumModel reduced = model;
  const auto component = [&](Eigen::Index i) { return linear_text(g.a.row(i), g.b[i], model.variables); };
  const std::string drift = fmt::format("({})/({})", model.rhs[static_cast<std::size_t>(k)], component(k));
  for (int j = 0; j < model.size(); ++j)
    if (const std::string g_j = component(j); g_j != "0") reduced.rhs[static_cast<std::size_t>(j)] += fmt::format(" - ({})*({})", drift, g_j);
  reduced.variables.erase(reduced.variables.begin() + k);
  reduced.rhs.erase(reduced.rhs.begin() + k);
  reduced.initial.erase(reduced.initial.begin() + k);
  reduced.parameters.push_back({variable, model.initial[static_cast<std::size_t>(k)]});
  reduced.pinned.push_back({variable, drift});
  std::erase(reduced.angles, variable);
  for (auto& mirror : reduced.mirrors) std::erase(mirror.variables, variable);
  std::erase_if(reduced.mirrors, [](const Mirror& m) { return m.variables.empty(); });
  for (auto& a : reduced.amplitudes) std::erase(a.variables, variable);
  std::erase_if(reduced.amplitudes, [](const Amplitude& a) { return a.variables.empty(); });
  return reduced;
}

}  // namespace whirl::models
