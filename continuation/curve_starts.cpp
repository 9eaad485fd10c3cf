/// curves_through: a circle about a codimension-2 point, on which the curves of each kind that may meet there are found.

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "continuation/chart_units.hpp"
#include "continuation/exchanged_problem.hpp"
#include "continuation/special_curve.hpp"
#include "continuation/switching.hpp"

namespace whirl::continuation {
namespace {

constexpr double eigenvalue_zero = 1e-5;  // relative to the largest: located to 1e-10, a double zero splits like the root of it

constexpr double least_apart = 1e-2;  // part of the slope of w'r_p times the distance: a curve of branch points satisfies the system of folds too

// f and its options in units of its own, in which x and the parameters are of order one (chart_units.hpp).
class Meeting {
 public:
  Meeting(const Problem& f, const CodimensionTwo& point, const TwoParameterOptions& options)
      : f_(f), n_(f.size()), options_(options), u_(point.u), blocks_(make_blocks(f, active_reflections(f, point.u.head(f.size())))), j_(n_, n_ + 2) {
    f.jacobian(u_, j_);
    for (const auto& block : blocks_.indices)  // a block is empty where every coordinate is odd
      eigenvalues_.push_back(block.empty() ? Eigen::VectorXcd() : Eigen::EigenSolver<Matrix>(Matrix(j_(block, block)), false).eigenvalues());
    size_ = j_.leftCols(n_).norm();  // not of the eigenvalues: all of them may be zero
  }

  void add_folds(int broken_block);
  void add_singular(int besides_block);
  void add_unmoved_by_first();
  void add_hopf_pairs(int own_block, double own_frequency);
  void add_double_zero_hopf();
  std::vector<CurveStart> starts;

 private:
  void add(EventType type, int block, double frequency) { add(type, block, frequency, u_); }
  void add(EventType type, int block, double frequency, const Vector& from);
  std::vector<Vector> on_circle(SpecialCurve& curve, const Vector& y0, double radius) const;
  Vector units(const SpecialCurve& curve, const Vector& y) const;

  const Problem& f_;
  int n_;
  const TwoParameterOptions& options_;
  Vector u_;
  Blocks blocks_;
  Matrix j_;
  std::vector<Eigen::VectorXcd> eigenvalues_;  // per block
  double size_ = 0.0;
};

Vector Meeting::units(const SpecialCurve& curve, const Vector& y) const {
  const auto states = curve.states();
  Vector all = y.cwiseAbs();
  all.head(states).setOnes();
  all[states] = options_.range1[1] - options_.range1[0];
  for (Eigen::Index i = states + 1; i < y.size(); ++i)
    if (all[i] < 1e-6 * size_ * size_) all[i] = std::max(size_ * size_, 1e-300);  // a squared frequency near zero
  all[y.size() - 1] = options_.range2[1] - options_.range2[0];
  return all;
}

// Newton on G(y) = 0, |y - y0| = radius in units, from points of the circle that the two least singular vectors span.
std::vector<Vector> Meeting::on_circle(SpecialCurve& curve, const Vector& y0, double radius) const {
  constexpr int directions = 16, most_steps = 40;
  const Vector unit = units(curve, y0);
  const int m = curve.system().size();
  Matrix j(m, m + 1), full(m + 1, m + 1);
  Vector r(m), rhs(m + 1);
  curve.system().jacobian(y0, j);
  if (!j.allFinite()) return {};
  const Matrix kernel = Eigen::JacobiSVD<Matrix>(j * unit.asDiagonal(), Eigen::ComputeFullV).matrixV().rightCols(std::min(m + 1, 2));
  std::vector<Vector> met;
  for (int k = 0; k < directions; ++k) {
    const double angle = 2.0 * std::numbers::pi * (k + 0.3) / directions;
    Vector z = radius * (std::cos(angle) * kernel.col(0) + (kernel.cols() > 1 ? std::sin(angle) : 0.0) * kernel.col(kernel.cols() - 1));
    bool done = false;
    for (int i = 0; i < most_steps && !done; ++i) {
      curve.system().linearise(y0 + unit.cwiseProduct(z), r, j);
      if (!r.allFinite() || !j.allFinite()) break;
      rhs << -r, 0.5 * (radius * radius - z.squaredNorm()) / radius;
      full << j * unit.asDiagonal(), z.transpose() / radius;
      Vector step = full.fullPivLu().solve(rhs);
      if (!step.allFinite()) break;
      if (step.norm() > 0.5 * radius) step *= 0.5 * radius / step.norm();
      z += step;
      done = step.norm() < 1e-9 * radius;
    }
    const Vector y = y0 + unit.cwiseProduct(z);
    if (done && std::none_of(met.begin(), met.end(), [&](const Vector& known) { return (known - y).cwiseQuotient(unit).norm() < 1e-2 * radius; }))
      met.push_back(y);
  }
  return met;
}

// Folds of the branch that breaks the symmetry of `broken_block`: off it by so little that Newton does not see it.
void Meeting::add_folds(int broken_block) {
  if (broken_block == 0) return add(EventType::fold, 0, 0.0);
  constexpr double off = 1e-7;
  const Indices& block = blocks_.indices[static_cast<std::size_t>(broken_block)];
  const Vector v = Eigen::JacobiSVD<Matrix>(Matrix(j_(block, block)), Eigen::ComputeFullV).matrixV().rightCols(1);
  Vector from = u_;
  for (std::size_t i = 0; i < block.size(); ++i) from[block[i]] += off * v[static_cast<Eigen::Index>(i)];
  add(EventType::fold, 0, 0.0, from);
}

void Meeting::add(EventType type, int block, double frequency, const Vector& from) {
  SpecialPoint point;
  point.type = type;
  point.block = block;
  point.frequency = frequency;
  point.u = from.head(n_ + 1);
  SpecialCurve curve(f_, point, u_[n_ + 1], options_);
  Vector y0 = curve.start();
  if (type == EventType::hopf && frequency == 0.0) y0[static_cast<Eigen::Index>(blocks_.indices[0].size()) + 1] = 0.0;  // of a double zero
  curve.update_borders(y0);
  for (const double radius : {1e-3, 1e-4, 1e-2}) {
    const std::size_t before = starts.size();
    const std::vector<Vector> met = on_circle(curve, y0, radius);
    for (const Vector& y : met) {
      if (curve.dissolved(y) || curve.kappa(y) <= 0.0 || curve.unmoved_by_first(y)) continue;
      if (type == EventType::fold && curve.apart_from_branch_points(y) < least_apart * radius * curve.branch_point_slope(y)) continue;
      const Vector u = curve.base(y);
      CurveStart start{point, u[n_ + 1]};
      start.point.u = u.head(n_ + 1);
      if (type == EventType::hopf) start.point.frequency = std::sqrt(curve.kappa(y));
      if (type == EventType::branch_point && block > 0) start.point.subtype = blocks_.subtype[static_cast<std::size_t>(block)];
      if (type == EventType::branch_point && block == 0) {
        start.point.tangent = Vector::Unit(n_ + 1, n_);
        const HeldProblem held(f_, start.p2);
        name_branch_point(held, start.point);
      }
      starts.push_back(std::move(start));
    }
    if (starts.size() > before) return;
  }
}

// The same where the second parameter alone moves the critical eigenvalue.
void Meeting::add_unmoved_by_first() {
  const ExchangedProblem other(f_);
  TwoParameterOptions options = options_;
  std::swap(options.range1, options.range2);
  CodimensionTwo point;
  point.u = ExchangedProblem::exchanged(u_);
  Meeting meeting(other, point, options);
  meeting.add(EventType::branch_point, 0, 0.0);
  for (CurveStart& start : meeting.starts) {
    std::swap(start.point.u[n_], start.p2);
    start.point.tangent.resize(0);
    starts.push_back(std::move(start));
  }
}

// Where r_x is singular in a block: branch points if they persist, else folds.
void Meeting::add_singular(int besides_block) {
  for (int k = 0; k < static_cast<int>(blocks_.indices.size()); ++k) {
    const auto& e = eigenvalues_[static_cast<std::size_t>(k)];
    if (k == besides_block || e.size() == 0 || e.cwiseAbs().minCoeff() > eigenvalue_zero * size_) continue;
    const std::size_t before = starts.size();
    add(EventType::branch_point, k, 0.0);
    if (k == 0 && starts.size() == before) add_unmoved_by_first();
    if (k == 0 && starts.size() == before) add_folds(0);
  }
}

// Pairs on the axis but for the curve's own.
void Meeting::add_hopf_pairs(int own_block, double own_frequency) {
  constexpr double on_axis = 1e-4, same = 0.02;
  for (int k = 0; k < static_cast<int>(eigenvalues_.size()); ++k)
    for (const auto& z : eigenvalues_[static_cast<std::size_t>(k)]) {
      const bool own = k == own_block && std::abs(z.imag() - own_frequency) < same * own_frequency;
      if (!own && z.imag() > eigenvalue_zero * size_ && std::abs(z.real()) < on_axis * z.imag()) add(EventType::hopf, k, z.imag());
    }
}

void Meeting::add_double_zero_hopf() {
  for (int k = 0; k < static_cast<int>(eigenvalues_.size()); ++k) {
    const auto& e = eigenvalues_[static_cast<std::size_t>(k)];
    // two small ones, products and sums: each may be the root of the error
    if ((e.cwiseAbs().array() < 1e-3 * size_).count() >= 2) add(EventType::hopf, k, 0.0);
  }
}

double frequency_at(const DefiningCurve& curve, const Vector& u) {
  if (curve.type != EventType::hopf || curve.u.cols() == 0) return std::nan("");
  Eigen::Index nearest = 0;
  (curve.u.colwise() - u).colwise().norm().minCoeff(&nearest);
  return curve.frequency[nearest];
}

}  // namespace

std::vector<CurveStart> curves_through(const Problem& f, const DefiningCurve& curve, const CodimensionTwo& point,
                                       const TwoParameterOptions& options) {
  const bool on_hopf = curve.type == EventType::hopf, of_branch_points = curve.type == EventType::branch_point;
  if (!f.is_flow() || !(on_hopf || of_branch_points || curve.type == EventType::fold)) return {};
  const ChartUnits units(f, point.u, 0.0, options);
  Meeting meeting(units.problem(), units.inwards(point), units.options());
  const std::string& type = point.type;
  if (type == "BT" && !on_hopf) meeting.add_double_zero_hopf();
  if (type == "ZH" && !on_hopf) meeting.add_hopf_pairs(-1, 0.0);
  if ((type == "BT" || type == "ZH") && on_hopf) meeting.add_singular(-1);
  if (type == "BT" && on_hopf) meeting.add_double_zero_hopf();  // of the branch that leaves the one where this curve has its points
  if (type == "HH") meeting.add_hopf_pairs(curve.block, units.inwards_frequency(frequency_at(curve, point.u)));
  if (type == "ZH" && on_hopf) meeting.add_hopf_pairs(-1, 0.0);
  if ((type == "FT" || type == "DP" || type == "FP") && of_branch_points) meeting.add_folds(curve.block);
  if ((type == "FT" || type == "DP") && curve.type == EventType::fold) meeting.add_singular(-1);
  if (type == "FP" || type == "PP") meeting.add_singular(of_branch_points ? curve.block : 0);
  for (CurveStart& start : meeting.starts) units.outwards(start);
  return meeting.starts;
}

}  // namespace whirl::continuation
