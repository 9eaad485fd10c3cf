#include "models/attractor_survey.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace whirl::models {
namespace {

// The radical inverse of k in base b: the digits mirrored at the point; in (0, 1) for k > 0. One base for each coordinate: Halton's
// sequence.
double radical_inverse(int k, int base) {
  double value = 0.0, digit = 1.0 / base;
  for (; k > 0; k /= base, digit /= base) value += digit * (k % base);
  return value;
}

std::vector<int> first_primes(std::size_t count) {
  std::vector<int> primes;
  for (int p = 2; primes.size() < count; ++p)
    if (std::none_of(primes.begin(), primes.end(), [p](int q) { return p % q == 0; })) primes.push_back(p);
  return primes;
}

Vector start(int number, const Vector& half_width, const std::vector<int>& primes) {
  Vector y = Vector::Zero(half_width.size());
  if (number == 0) return y;
  for (Eigen::Index i = 0; i < y.size(); ++i) y[i] = (2.0 * radical_inverse(number, primes[static_cast<std::size_t>(i)]) - 1.0) * half_width[i];
  return y;
}

// A start in a symmetric subspace never leaves it.
void leave_symmetry(Vector& y, const std::vector<Reflection>& reflections, double amount) {
  for (const auto& r : reflections) {
    if ((r.signs.asDiagonal() * y - y).norm() > 0.0) continue;
    for (Eigen::Index i = 0; i < y.size() / 2; ++i)
      if (r.signs[i] < 0.0) {
        y[i] += amount;
        break;
      }
  }
}

// The attractor of the set that stands for all its mirror images.
int original(const AttractorSet& set, int i) { return set[i].mirror_of >= 0 ? std::min(i, set[i].mirror_of) : i; }

}  // namespace

void SurveyOptions::validate(int states) const {
  if (starts < 0 || first < 0 || patience < 1 || samples < 8 || record_periods < 1)
    throw std::invalid_argument("a survey needs starts, first >= 0, patience, record_periods >= 1, samples >= 8");
  if (half_width.size() != states || !(half_width.minCoeff() > 0.0))
    throw std::invalid_argument(fmt::format("a survey needs {} half widths > 0 (q, q'), got {}", states, half_width.size()));
}

double slowest_decay(const ModalSystem<double>& system) {
  const double least = *std::min_element(system.damping.begin(), system.damping.end());
  return least > 0.0 ? 2.0 / least * system.omega / (2.0 * std::numbers::pi) : std::numeric_limits<double>::infinity();
}

ModalSystem<double> in_units_of(const ModalSystem<double>& system, double size) {
  ModalSystem<double> s = system;
  const double w = system.omega, w2 = w * w;
  s.omega = 1.0;
  for (auto& c : s.damping) c /= w;
  for (auto& k : s.stiffness) k /= w2;
  for (auto& t : s.terms) t.coefficient *= std::pow(size, t.degree - 1) / w2;
  for (auto& f : s.forces) f.amplitude /= size * w2;
  return s;
}

SurveyResult survey_attractors(const ModalSystem<double>& system, const std::vector<Reflection>& reflections, const SurveyOptions& o) {
  constexpr double off_symmetry = 1e-3;  // in units of the box
  const int n = system.size();
  o.validate(2 * n);
  const double size = o.half_width.head(n).maxCoeff();
  Vector unit(2 * n);  // of (q, q')
  unit << Vector::Constant(n, size), Vector::Constant(n, size * system.omega);
  AttractorFinder finder(in_units_of(system, size), o.settle);
  AttractorSet set(reflections);
  const auto primes = first_primes(static_cast<std::size_t>(2 * n));
  const Vector box = o.half_width.cwiseQuotient(unit);
  std::vector<int> counts;
  SurveyResult result;
  for (int k = 0; k < o.starts; ++k) {
    if (o.settle.interrupted && *o.settle.interrupted) break;
    Vector y = start(o.first + k, box, primes);
    leave_symmetry(y, reflections, off_symmetry);
    ++result.starts;
    Settled s;
    for (int attempt = 0; attempt < o.patience && (attempt == 0 || s.kind == MotionKind::unsettled); ++attempt) {
      s = finder.settle(y, set);
      result.periods += s.periods;
      y = s.state;
    }
    if (s.fresh) s.known = set.add(std::move(*s.fresh), s.capture);
    counts.resize(static_cast<std::size_t>(set.size()), 0);
    if (s.known >= 0) ++counts[static_cast<std::size_t>(original(set, s.known))];
    else if (s.kind == MotionKind::diverging) ++result.diverged;
    else if (s.kind == MotionKind::unsettled) ++result.unsettled;
    else ++result.failed;
  }
  for (int i = 0; i < set.size(); ++i) {
    if (original(set, i) != i) continue;
    SteadyMotion motion = finder.motion(set[i], o.samples, o.record_periods);
    motion.omega = system.omega;
    motion.state = motion.state.cwiseProduct(unit);
    motion.record = unit.asDiagonal() * motion.record;
    motion.lyapunov *= system.omega;
    Attractor a = set[i];
    a.points = unit.asDiagonal() * a.points;
    a.lyapunov *= system.omega;
    a.lyapunov_error *= system.omega;
    result.attractors.push_back({std::move(a), std::move(motion), counts[static_cast<std::size_t>(i)]});
  }
  return result;
}

}  // namespace whirl::models
