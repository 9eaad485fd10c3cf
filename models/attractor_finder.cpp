#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/fourier.hpp"
#include "models/attractors.hpp"
#include "models/lyapunov.hpp"
#include "models/slow_decay.hpp"

namespace whirl::models {
namespace {

// Points in order, beginning with one that does not depend on how they were reached.
void begin_at_landmark(Matrix& points) {
  Vector weight(points.rows());
  for (Eigen::Index i = 0; i < weight.size(); ++i) weight[i] = std::pow(0.6180339887498949, static_cast<double>(i));
  Eigen::Index first = 0;
  (weight.transpose() * points).maxCoeff(&first);
  Matrix turned(points.rows(), points.cols());
  for (Eigen::Index j = 0; j < points.cols(); ++j) turned.col(j) = points.col((first + j) % points.cols());
  points = turned;
}

double rms_spread(const Eigen::Ref<const Matrix>& points) {
  return std::sqrt((points.colwise() - points.rowwise().mean()).squaredNorm() / static_cast<double>(points.cols()));
}

// Largest distance between points that are neighbours in k f mod 1, over the largest extent: small if the points fill a closed curve turned by f.
double largest_gap(const Matrix& points, double f) {
  std::vector<std::pair<double, Eigen::Index>> order;
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    const double turns = f * static_cast<double>(k);
    order.emplace_back(turns - std::floor(turns), k);
  }
  std::sort(order.begin(), order.end());
  double gap = 0.0;
  for (std::size_t i = 0; i < order.size(); ++i)
    gap = std::max(gap, (points.col(order[i].second) - points.col(order[(i + 1) % order.size()].second)).norm());
  return gap / (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
}

// The frequency, in cycles per period, that unrolls the stroboscopic points into a closed curve; 0 if none of the strong lines does.
double torus_frequency(const Matrix& points) {
  Eigen::Index row = 0;
  (points.colwise() - points.rowwise().mean()).rowwise().squaredNorm().maxCoeff(&row);
  const Vector x = points.row(row).transpose();
  double best = 0.0, least = 0.25;
  for (const auto& line : spectral_lines({x.data(), static_cast<std::size_t>(x.size())}, {.floor = 0.02, .most = 6}))
    for (const double f : {line.frequency, 0.5 * line.frequency, 0.5 * (line.frequency + 1.0)}) {
      const double gap = largest_gap(points, f);
      if (gap < 0.5 * least || (best == 0.0 && gap < least)) {  // half of a frequency that unrolls does so too, with twice the gap
        least = gap;
        best = f;
      }
    }
  return best;
}

}  // namespace

void AttractorOptions::validate() const {
  if (max_periods < 1 || max_multiple < 1 || nonperiodic_after < 1 || lyapunov_periods < 0)
    throw std::invalid_argument("attractors need max_periods, max_multiple, nonperiodic_after >= 1, lyapunov_periods >= 0");
  if (lyapunov_periods > 0 && lyapunov_periods < 64)
    throw std::invalid_argument(fmt::format("lyapunov_periods must be 0 or >= 64, got {}", lyapunov_periods));
  if (!(newton_radius > 0.0)) throw std::invalid_argument(fmt::format("newton_radius must be > 0, got {}", newton_radius));
}

AttractorFinder::AttractorFinder(const ModalSystem<double>& system, const AttractorOptions& options)
    : options_(options), transient_(system, options.transient), fine_(system, options.fine) {
  options_.validate();
}

std::optional<Attractor> AttractorFinder::refine(const Vector& start, int multiple) {
  Saddle at;
  return refine(start, multiple, at);
}

std::optional<Attractor> AttractorFinder::refine(const Vector& start, int multiple, Saddle& at) {
  const Eigen::Index n = start.size();
  Vector x = start;
  Matrix derivative;
  Attractor a;
  double step = 1e300;
  for (int k = 0; k < 12 && step > 1e-9 * (1.0 + x.norm()); ++k) {
    Vector end = x;
    if (!fine_.map(end, derivative, multiple)) return std::nullopt;
    const Vector dx = (Matrix::Identity(n, n) - derivative).partialPivLu().solve(end - x);
    step = dx.norm();
    if (!std::isfinite(step)) return std::nullopt;
    x += dx;
    if ((x - start).norm() > 0.3 * (1.0 + start.norm())) return std::nullopt;
  }
  if (step > 1e-9 * (1.0 + x.norm())) return std::nullopt;
  a.multiple = multiple;
  a.points.resize(n, multiple);
  Vector y = x;
  for (int j = 0; j < multiple; ++j) {
    a.points.col(j) = y;
    if (!fine_.map(y)) return std::nullopt;
    if (j + 1 < multiple && multiple % (j + 1) == 0 && (y - x).norm() < 1e-6 * (1.0 + x.norm())) return refine(x, j + 1, at);
  }
  a.residual = (y - x).norm();
  if (a.residual > 1e-7 * (1.0 + x.norm())) return std::nullopt;
  a.kind = MotionKind::periodic;
  begin_at_landmark(a.points);
  a.multipliers = derivative.eigenvalues();
  std::sort(a.multipliers.begin(), a.multipliers.end(), [](auto p, auto q) { return std::abs(p) > std::abs(q); });
  a.lyapunov = std::log(std::abs(a.multipliers[0])) / (multiple * fine_.period());
  at = {multiple, x, derivative};
  return a;
}

// Near an unstable motion a state comes back to itself nearly, and Newton's method would find that motion again, at much cost for large multiples.
bool AttractorFinder::explains(const Saddle& s, const Vector& before, const Vector& after, int periods) {
  if (periods % s.multiple != 0) return false;
  Vector d = before - s.point;
  for (int k = 0; k < periods / s.multiple; ++k) d = s.derivative * d;
  return (after - s.point - d).norm() < 0.1 * (after - before).norm();
}

Settled AttractorFinder::settle(Vector y, const AttractorSet& known, double phase) {
  if (y.size() != fine_.size()) throw std::invalid_argument(fmt::format("a start needs {} values (q, q'), got {}", fine_.size(), y.size()));
  Settled s;
  const auto stopped = [&] {
    s.kind = transient_.diverged() ? MotionKind::diverging : MotionKind::failed;
    s.why = transient_.why();
    s.state = y;
    return s;
  };
  if (phase != 0.0 && !transient_.advance(y, phase / fine_.omega(), fine_.period())) return stopped();
  Matrix past(y.size(), options_.max_multiple);
  std::vector<int> hits(static_cast<std::size_t>(known.size()), 0);
  std::vector<std::pair<Attractor, Capture>> candidates;
  std::vector<Saddle> saddles;  // met on the way
  int next_try = 3, wait = 3, ask = options_.nonperiodic_after;
  bool postponed = false;
  for (int k = 1; k <= options_.max_periods; ++k) {
    if (options_.interrupted && *options_.interrupted) break;
    past.col((k - 1) % options_.max_multiple) = y;
    if (!transient_.map(y)) return stopped();
    ++s.periods;
    s.state = y;
    for (int i = 0; i < known.size(); ++i) {
      auto& count = hits[static_cast<std::size_t>(i)];
      count = known.capture(i).near(y) ? count + 1 : 0;
      if (count < (known.capture(i).at_once() ? 1 : Capture::hits)) continue;
      s.known = i;
      s.kind = known[i].kind;
      s.why.clear();
      return s;
    }
    for (auto& [attractor, capture] : candidates)
      if (capture.near(y)) {
        s.fresh = std::move(attractor);
        s.capture = std::move(capture);
        s.kind = s.fresh->kind;
        s.why.clear();
        return s;
      }
    if (k >= next_try) {
      std::vector<double> apart;  // from where it was m periods before
      for (int m = 1; m <= std::min(options_.max_multiple, k); ++m) {
        apart.push_back((y - past.col((k - m) % options_.max_multiple)).norm());
        if (m == 1) s.distance = apart[0];
        if (apart.back() > options_.newton_radius * (1.0 + y.norm())) continue;
        // A slow drift is no nearer to itself after m periods than after a part of them; a motion of multiple m is.
        bool drifts = false;
        for (int d = 1; d < m; ++d) drifts = drifts || (m % d == 0 && apart.back() > 0.5 * apart[static_cast<std::size_t>(d - 1)]);
        if (drifts) continue;
        const auto explained = [&](const Saddle& u) { return explains(u, past.col((k - m) % options_.max_multiple), y, m); };
        if (std::any_of(saddles.begin(), saddles.end(), explained)) continue;
        Saddle at;
        auto a = refine(y, m, at);
        if (a && std::abs(a->multipliers[0]) >= 1.0) saddles.push_back(std::move(at));
        if (!a || std::abs(a->multipliers[0]) >= 1.0) continue;
        const bool listed =
            known.find(*a) >= 0 || std::any_of(candidates.begin(), candidates.end(), [&](const auto& c) { return same_motion(c.first, *a); });
        if (!listed) {
          Capture capture(*a, transient_, fine_);
          candidates.emplace_back(std::move(*a), std::move(capture));
        }
        break;
      }
      next_try = k + wait;
      wait = std::min(2 * wait, 64);
    }
    if (k == ask && !candidates.empty() && !postponed) {  // a stable periodic motion is near: more time to come to it
      postponed = true;
      ask *= 2;
    }
    if (k == ask && options_.lyapunov_periods > 0) {
      if (not_periodic(s, y)) {
        s.known = known.find(*s.fresh);
        if (s.known >= 0) s.fresh.reset();
        return s;
      }
      if (s.kind == MotionKind::diverging) return s;
      if (s.ahead && known.find(*s.ahead) < 0 && candidates.empty()) candidates.emplace_back(*s.ahead, Capture(*s.ahead, transient_, fine_));
      ask *= 2;
      std::fill(hits.begin(), hits.end(), 0);
      for (Eigen::Index j = 0; j < past.cols(); ++j) past.col(j) = y.array() + 1e3;  // no distances across the gap
    }
  }
  s.kind = MotionKind::unsettled;
  const std::string slow = s.why.empty() ? "" : ": " + s.why;  // what the last question told
  s.why = options_.interrupted && *options_.interrupted ? "interrupted" : fmt::format("not settled after {} periods{}", s.periods, slow);
  return s;
}

// The largest Lyapunov exponent and the shape of the stroboscopic points decide; true if they do.
bool AttractorFinder::not_periodic(Settled& s, Vector& y) {
  const int n = options_.lyapunov_periods;
  const LyapunovResult r = largest_lyapunov(fine_, y, {.periods = n, .skip = n / 8});
  s.periods += n + n / 8;
  s.state = y;
  if (!r.ok) {
    if (fine_.diverged()) s.kind = MotionKind::diverging;
    s.why = fine_.why();
    return false;
  }
  // Over N periods a motion with exponent zero shows about ln(N)/(N T).
  const double resolution = std::log(static_cast<double>(n)) / (n * fine_.period());
  const int half = n / 2;
  const double spread = rms_spread(r.points.rightCols(half)), before = rms_spread(r.points.leftCols(half));
  constexpr double visible = 0.1;  // relative change between the halves
  const bool lasting = spread > (1.0 - visible) * before && spread > 1e-6 * (1.0 + y.norm());
  Attractor a;
  a.points = r.points;
  a.lyapunov = r.exponent;
  a.lyapunov_error = std::max(r.error, 1.0 / (n * fine_.period()));
  a.residual = (r.points.col(n - 1) - r.points.col(n - 2)).norm();
  if (lasting && r.exponent > r.error && r.exponent > 2.0 * resolution) {
    a.kind = MotionKind::chaotic;
  } else if (auto decay = slow_decay(*this, r.points.rightCols(half), 1, {.periods = double(half), .visible = visible})) {
    s.why = decay->words(fine_.period());
    s.ahead = std::move(decay->motion);
    return false;
  } else if (lasting && std::abs(r.exponent) < std::max(resolution, r.error)) {
    double f = torus_frequency(r.points);
    if (f == 0.0) return false;
    f -= std::floor(f);
    a.second_frequency = std::min(f, 1.0 - f);
    a.kind = MotionKind::quasi_periodic;
  } else {
    return false;
  }
  s.kind = a.kind;
  s.capture = Capture(a);
  s.fresh = std::move(a);
  return true;
}

SteadyMotion AttractorFinder::motion(const Attractor& a, int samples, int periods) {
  if (samples < 8 || periods < 1) throw std::invalid_argument("a recorded motion needs samples >= 8 and periods >= 1");
  SteadyMotion m;
  m.kind = a.kind;
  m.multiple = a.multiple;
  m.lyapunov = a.lyapunov;
  m.omega = fine_.omega();
  m.distance = a.residual;
  m.state = a.points.col(0);
  m.record_periods = a.multiple > 0 ? a.multiple : periods;
  m.record.resize(fine_.size(), samples * m.record_periods);
  Vector y = m.state;
  for (int j = 0; j < samples * m.record_periods; ++j) {
    m.record.col(j) = y;
    const int within = j % samples;
    if (!fine_.advance(y, fine_.period() * within / samples, fine_.period() * (within + 1) / samples)) {
      m.kind = MotionKind::failed;
      m.why = fine_.why();
      m.record.conservativeResize(fine_.size(), j + 1);
      break;
    }
  }
  return m;
}

}  // namespace whirl::models
