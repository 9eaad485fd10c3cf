#include "continuation/special_curve.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "continuation/normal_form.hpp"
#include "continuation/period_doubling.hpp"
#include "continuation/torus.hpp"

namespace whirl::continuation {
namespace {

Indices all_states(const Problem& f) {
  Indices all(static_cast<std::size_t>(f.size()));
  for (int i = 0; i < f.size(); ++i) all[static_cast<std::size_t>(i)] = i;
  return all;
}

std::unique_ptr<AugmentedSystem> make_system(const Problem& f, const SpecialPoint& point, const Blocks& blocks, const std::vector<Observable>& peaks,
                                             In u) {
  const Indices& state = blocks.indices[0];
  const auto of_block = [&]() -> const Indices& { return blocks.indices[static_cast<std::size_t>(point.block)]; };
  switch (point.type) {
    case EventType::fold:
      return std::make_unique<SingularSystem>(f, state, state, u);
    case EventType::branch_point:
      if (point.block > 0) return std::make_unique<SingularSystem>(f, state, of_block(), u);
      return std::make_unique<BranchPointSystem>(f, u);
    case EventType::hopf:
      return std::make_unique<HopfSystem>(f, state, of_block(), u);
    case EventType::peak:
      for (const auto& peak : peaks)
        if (peak.name == point.subtype && peak.form) return std::make_unique<PeakSystem>(f, state, *peak.form, u);
      throw std::invalid_argument(fmt::format("no form is known of the quantity '{}' that has its peak here", point.subtype));
    case EventType::torus:
      if (const auto* orbit = dynamic_cast<const OrbitProblem*>(&f))
        return std::make_unique<TorusSystem>(*orbit, state, unknowns_of_group(*orbit, u, point.block), u, point.frequency);
      break;
    case EventType::period_doubling:  // `follow` hands it on as a branch point of the doubled problem
    case EventType::end:
    case EventType::gave_up:
    case EventType::user_value:
    case EventType::unresolved:
      break;
  }
  throw std::invalid_argument(fmt::format("no two-parameter curve of {} points", to_string(point.type)));
}

}  // namespace

SpecialCurve::SpecialCurve(const Problem& f, const SpecialPoint& point, double p2, const TwoParameterOptions& options)
    : f_(f),
      point_(point),
      range_{options.range1[1] - options.range1[0], options.range2[1] - options.range2[0]},
      held_(f, p2),
      blocks_(make_blocks(f, active_reflections(f, point.u.head(f.size())))),
      start_(f.size() + 2) {
  start_ << point.u, p2;
  if (point.type == EventType::hopf) point_.subtype.clear();  // what one point of a Hopf curve is called says nothing of the curve
  system_ = make_system(f, point, blocks_, options.walk.peaks, start_);
  if (dynamic_cast<const BranchPointSystem*>(system_.get())) singular_ = std::make_unique<SingularSystem>(f, all_states(f), all_states(f), start_);
  if (!singular_ && !dynamic_cast<const SingularSystem*>(system_.get())) return;
  for (int k = 0; k < static_cast<int>(blocks_.indices.size()); ++k) {
    const Indices& block = blocks_.indices[static_cast<std::size_t>(k)];
    const bool own = k == point.block || block.empty() || singular_;
    others_.push_back(own ? nullptr : std::make_unique<SingularSystem>(f, blocks_.indices[0], block, start_));
  }
}

Vector SpecialCurve::start() const {
  Vector y = system_->unknowns(start_);
  if (point_.type == EventType::hopf && point_.frequency > 0.0) {
    y[static_cast<int>(blocks_.indices[0].size()) + 1] = point_.frequency * point_.frequency;
    system_->update_borders(y);
  }
  return y;
}

void SpecialCurve::update_borders(In y) {
  system_->update_borders(y);
  if (singular_) singular_->update_borders(singular_->unknowns(base(y)));
  for (auto& other : others_)
    if (other) other->update_borders(y);
}

double SpecialCurve::kappa(In y) const {
  const auto* hopf = dynamic_cast<const HopfSystem*>(system_.get());
  return hopf ? hopf->kappa(y) : std::nan("");
}

SpecialPoint SpecialCurve::at(In y) const {
  const Vector u = base(y);
  const int n = f_.size();
  SpecialPoint s = point_;
  s.u = u.head(n + 1);
  s.has_coefficient = false;
  s.coefficient = std::nan("");
  held_.hold(u[n + 1]);
  if (point_.type == EventType::hopf) {
    s.frequency = kappa(y) > 0.0 ? std::sqrt(kappa(y)) : 0.0;
    if (!(kappa(y) > 0.0)) return s;
  }
  if (const auto* torus = dynamic_cast<const TorusSystem*>(system_.get())) {
    s.frequency = torus->kappa(y);
    return s;
  }
  set_normal_form(held_, s, orientation_, [&](const Vector& v, const Vector& w) { return mass(f_, u, v, w); });
  if (!s.has_coefficient) s.coefficient = std::nan("");
  if (point_.type == EventType::fold && s.has_coefficient) orientation_ = s.null_vector;
  return s;
}

SpecialCurve::NullPair SpecialCurve::null_pair(In y) const {
  const auto& system = singular_ ? *singular_ : dynamic_cast<const SingularSystem&>(*system_);
  const Vector z = singular_ ? singular_->unknowns(base(y)) : Vector(y);
  return {system.null_vector(z), system.left_null_vector(z)};
}

// w'B(v, v) over the size of B(v, .): finite where w'v = 0.
double SpecialCurve::quadratic(In y) const {
  const auto [v, w] = null_pair(y);
  const Vector u = base(y);
  Vector full = Vector::Zero(u.size());
  full.head(f_.size()) = v;
  Matrix h(f_.size(), u.size());
  f_.second(u, full, h);
  const double size = h.norm();
  return size > 0.0 ? w.dot(h.leftCols(f_.size()) * v) / size : 0.0;
}

// A second eigenvalue joins the first at zero; of a periodic motion a second multiplier at 1, or at -1 of a doubling.
double SpecialCurve::double_root(In y) const {
  const auto [v, w] = null_pair(y);
  return mass(f_, base(y), v, w);
}

double SpecialCurve::apart_from_branch_points(In y) const {
  const auto [v, w] = null_pair(y);
  const int n = f_.size();
  Matrix j(n, n + 2);
  f_.jacobian(base(y), j);
  return std::hypot(w.dot(j.col(n)) * range_[0], w.dot(j.col(n + 1)) * range_[1]);
}

double SpecialCurve::branch_point_slope(In y) const {
  const auto [v, w] = null_pair(y);
  const int n = f_.size();
  Vector full = Vector::Zero(n + 2);
  full.head(n) = v;
  Matrix h(n, n + 2);
  f_.second(base(y), full, h);
  return std::hypot(w.dot(h.col(n)) * range_[0], w.dot(h.col(n + 1)) * range_[1]);
}

// Eigenvalues but for the critical one, or the critical pair.
Eigen::VectorXcd SpecialCurve::others(In y) const {
  Matrix j(f_.size(), f_.size() + 2);
  f_.jacobian(base(y), j);
  const Eigen::VectorXcd e = Eigen::EigenSolver<Matrix>(j.leftCols(f_.size()), false).eigenvalues();
  const bool hopf = point_.type == EventType::hopf;
  const std::complex<double> critical(0.0, hopf ? std::sqrt(std::max(0.0, kappa(y))) : 0.0);
  std::vector<std::complex<double>> rest(e.begin(), e.end());
  for (const auto& z : {critical, std::conj(critical)}) {
    if (rest.empty() || (!hopf && rest.size() < static_cast<std::size_t>(e.size()))) break;
    rest.erase(std::min_element(rest.begin(), rest.end(), [&](const auto& p, const auto& q) { return std::abs(p - z) < std::abs(q - z); }));
  }
  return Eigen::Map<const Eigen::VectorXcd>(rest.data(), static_cast<Eigen::Index>(rest.size()));
}

// Zero where a pair of the others is on the axis. Products, not the eigenvalue nearest to zero: that may be born from a complex pair on the way. Each
// factor over its size, so that many of them stay in range.
double SpecialCurve::crossing_pair(In y) const {
  const Eigen::VectorXcd e = others(y);
  if (e.size() < 2) return std::nan("");
  std::complex<double> product = 1.0;
  for (Eigen::Index k = 0; k < e.size(); ++k)
    for (Eigen::Index l = 0; l < k; ++l) product *= (e[k] + e[l]) / (std::abs(e[k]) + std::abs(e[l]));
  return product.real();
}

// Zero where one of the others is zero: each against itself and the frequency of the Hopf point, for it may be the only one.
double SpecialCurve::crossing_real(In y) const {
  const Eigen::VectorXcd e = others(y);
  const double frequency = std::sqrt(std::max(0.0, kappa(y)));
  std::complex<double> product = 1.0;
  for (const auto& z : e) product *= z / (std::abs(z) + frequency);
  return product.real();
}

// At a Bogdanov-Takens point the curve's own pair is a double zero.
bool SpecialCurve::is_crossing(In y, const std::string& type) const {
  const Eigen::VectorXcd e = others(y);
  constexpr double near = 1e-4;
  const bool hopf = point_.type == EventType::hopf;
  const double size = std::max(e.size() > 0 ? e.cwiseAbs().maxCoeff() : 0.0, hopf ? std::sqrt(std::abs(kappa(y))) : 0.0);
  if (hopf && !(kappa(y) > near * near * size * size)) return false;
  if (hopf && type == "ZH") return e.size() > 0 && e.cwiseAbs().minCoeff() < near * size;
  return std::any_of(e.begin(), e.end(), [&](const auto& z) { return z.imag() > near * size && std::abs(z.real()) < near * z.imag(); });
}

// Beyond its end the same curve runs back with the frequency mirrored.
bool SpecialCurve::past_strong_resonance(In y) const {
  const auto* torus = dynamic_cast<const TorusSystem*>(system_.get());
  return torus && (torus->kappa(y) < 0.0 || torus->kappa(y) > 0.5 * dynamic_cast<const OrbitProblem&>(f_).base_frequency(base(y)));
}

bool SpecialCurve::dissolved(In y) const {
  const auto* point = dynamic_cast<const BranchPointSystem*>(system_.get());
  return point && !point->persists(y);
}

bool SpecialCurve::unmoved_by_first(In y) const {
  constexpr double open = 1e-7;  // of the largest singular value
  if (!dynamic_cast<const BranchPointSystem*>(system_.get())) return false;
  Matrix j(system_->size(), system_->size() + 1);
  system_->jacobian(y, j);
  if (!j.allFinite()) return false;
  const Vector values = Eigen::JacobiSVD<Matrix>(j).singularValues();
  return values[values.size() - 1] < open * values[0];
}

std::vector<CurveTest> SpecialCurve::tests() const {
  std::vector<CurveTest> all;
  const bool orbit = dynamic_cast<const OrbitProblem*>(&f_) != nullptr;
  if (point_.type == EventType::fold || point_.type == EventType::branch_point) {
    if (point_.type == EventType::fold) all.push_back({"CP", [this](In y) { return quadratic(y); }});
    else add_branch_point_tests(all);
    const char* name = !orbit ? "BT" : point_.subtype == period_doubling_subtype ? "R2" : "R1";
    all.push_back({name, [this](In y) { return double_root(y); }});
    if (f_.is_flow()) all.push_back({"ZH", [this](In y) { return crossing_pair(y); }});
    add_other_blocks(all);
  }
  if (const auto* torus = dynamic_cast<const TorusSystem*>(system_.get())) {
    const auto& orbit_problem = dynamic_cast<const OrbitProblem&>(f_);
    for (const int q : {3, 4})
      all.push_back({fmt::format("R{}", q),
                     [this, torus, &orbit_problem, q](In y) { return torus->kappa(y) / orbit_problem.base_frequency(base(y)) - 1.0 / q; }});
  }
  if (point_.type == EventType::hopf) {
    all.push_back({"BT", [this](In y) { return kappa(y); }});
    // l1 has a pole at a zero-Hopf point, where A is singular: times the determinant it goes through.
    all.push_back({"GH", [this](In y) { return at(y).coefficient * crossing_real(y); }});
    if (f_.size() >= 3) all.push_back({"ZH", [this](In y) { return crossing_real(y); }});
    if (f_.size() >= 4) all.push_back({"HH", [this](In y) { return crossing_pair(y); }});
  }
  return all;
}

// DP: the cubic coefficient of a pitchfork, times w'v, which is zero where it has its pole. FT: the quadratic one of a transcritical point.
void SpecialCurve::add_branch_point_tests(std::vector<CurveTest>& all) const {
  if (point_.block > 0 || point_.subtype == "PF") all.push_back({"DP", [this](In y) { return at(y).coefficient * double_root(y); }});
  else if (point_.subtype == "TC") all.push_back({"FT", [this](In y) { return quadratic(y); }});
}

// Where r_x is singular in a second symmetry block as well, a curve of folds and one of pitchforks cross, or two of pitchforks.
void SpecialCurve::add_other_blocks(std::vector<CurveTest>& all) const {
  for (std::size_t k = 0; k < others_.size(); ++k) {
    if (!others_[k]) continue;
    all.push_back({k == 0 || point_.block == 0 ? "FP" : "PP", [other = others_[k].get(), r = Vector(system_->size())](In y) mutable {
                     other->residual(y, r);
                     return r[r.size() - 1];
                   }});
  }
}

}  // namespace whirl::continuation
