#include "models/steady_motion.hpp"

#include <fmt/format.h>

#include <deque>
#include <numbers>

#include "models/slow_decay.hpp"

namespace whirl::models {
namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;

// Largest Lyapunov exponent: one tangent vector carried along by duals, renormalised every period.
double largest_exponent(const ModalSystem<double>& system, const Vector& start, const SettleOptions& o) {
  using D = Dual<double, 1>;
  const auto n = static_cast<std::size_t>(2 * system.size());
  const double period = two_pi / system.omega;
  std::vector<D> y(n), d(n);
  const auto flow = [&](double t, std::span<const double> z, std::span<double> out) {
    for (std::size_t i = 0; i < n; ++i) {
      y[i] = D(z[i]);
      y[i].d[0] = z[n + i];
    }
    system.flow<D>(system.omega * t, y, d);
    for (std::size_t i = 0; i < n; ++i) {
      out[i] = d[i].v;
      out[n + i] = d[i].d[0];
    }
  };
  Vector z(2 * n);
  z << start, Vector::Ones(static_cast<Eigen::Index>(n)).normalized();
  IntegratorOptions integrator = o.integrator;
  integrator.relative_tolerance = std::max(integrator.relative_tolerance, 1e-8);
  integrator.absolute_tolerance = std::max(integrator.absolute_tolerance, 1e-10);
  Integrator run(flow, 0.0, z, integrator);
  double sum = 0.0;
  const int skip = o.lyapunov_periods / 4;
  for (int k = 0; k < o.lyapunov_periods; ++k) {
    if (!run.advance(period)) return 0.0;
    z = run.state();
    const double growth = z.tail(static_cast<Eigen::Index>(n)).norm();
    if (k >= skip) sum += std::log(growth);
    z.tail(static_cast<Eigen::Index>(n)) /= growth;
    run.restart(0.0, z);
  }
  return sum / ((o.lyapunov_periods - skip) * period);
}

// Columns of a ring of the last so many of `count`, oldest first.
Matrix in_order(const Matrix& ring, int count) {
  Matrix out(ring.rows(), ring.cols());
  for (Eigen::Index j = 0; j < ring.cols(); ++j) out.col(j) = ring.col((count + j) % ring.cols());
  return out;
}

// Largest distances of m periods in the middle and at the end of a run: does the motion last?
class Lasting {
 public:
  Lasting(int periods, int multiples)
      : middle_(periods / 2),
        window_(std::max(1, periods / 8)),
        last_(periods - window_),
        early_(static_cast<std::size_t>(multiples) + 1, 0.0),
        late_(early_) {}
  void see(int k, int m, double distance) {
    const auto slot = static_cast<std::size_t>(m);
    if (k > middle_ && k <= middle_ + window_) early_[slot] = std::max(early_[slot], distance);
    if (k > last_) late_[slot] = std::max(late_[slot], distance);
  }
  /// m that comes nearest to itself in the end; 0 if the run was too short to tell.
  int nearest() const {
    if (window_ < 8) return 0;
    return static_cast<int>(std::min_element(late_.begin() + 1, late_.end()) - late_.begin());
  }
  int window() const { return window_; }
  double ratio(int m) const { return late_[static_cast<std::size_t>(m)] / early_[static_cast<std::size_t>(m)]; }
  int apart() const { return last_ - middle_; }  ///< periods between the two

 private:
  int middle_, window_, last_;
  std::vector<double> early_, late_;
};

constexpr double lasts_within = 0.03;

// A motion that seems to last: does it decay too slowly to be seen? `points`: the last stroboscopic ones.
bool decays_unseen(const ModalSystem<double>& system, const Matrix& points, const Lasting& lasting, SteadyMotion& motion) {
  AttractorFinder finder(system);
  const auto decay = slow_decay(finder, points, lasting.nearest(), {.periods = double(lasting.apart()), .visible = lasts_within});
  if (!decay) return false;
  motion.decay_rate = decay->rate;
  motion.why = fmt::format("after {} periods it {}", motion.periods_integrated, decay->words(two_pi / system.omega));
  return true;
}

// True if distances changed between middle and end of the run: then that is what is known, not what the motion will be.
bool still_changing(const Lasting& lasting, double period, SteadyMotion& motion) {
  const int m = lasting.nearest();
  if (m == 0 || !std::isfinite(lasting.ratio(m)) || std::abs(lasting.ratio(m) - 1.0) <= lasts_within) return false;
  motion.decay_rate = -std::log(lasting.ratio(m)) / (lasting.apart() * period);
  const double half_life = std::log(2.0) / (std::abs(motion.decay_rate) * period);
  motion.why = fmt::format("still {} after {} periods: the change over {} period{} {} in some {:.0f} periods",
                           motion.decay_rate > 0.0 ? "decaying" : "growing", motion.periods_integrated, m, m == 1 ? "" : "s",
                           motion.decay_rate > 0.0 ? "halves" : "doubles", half_life);
  return true;
}

}  // namespace

const char* to_string(MotionKind kind) {
  switch (kind) {
    case MotionKind::periodic:
      return "periodic";
    case MotionKind::quasi_periodic:
      return "quasi-periodic";
    case MotionKind::chaotic:
      return "chaotic";
    case MotionKind::unsettled:
      return "unsettled";
    case MotionKind::failed:
      return "failed";
    case MotionKind::diverging:
      return "diverging";
  }
  return "?";
}

void SettleOptions::validate() const {
  integrator.validate();
  if (!(tolerance > 0.0)) throw std::invalid_argument(fmt::format("settle tolerance must be > 0, got {}", tolerance));
  if (max_periods < 1 || max_multiple < 1 || samples < 8 || record_periods < 1 || lyapunov_periods < 0)
    throw std::invalid_argument("settle needs max_periods, max_multiple, record_periods >= 1, samples >= 8, lyapunov_periods >= 0");
}

std::complex<double> SteadyMotion::harmonic(int i, double k) const {
  const Eigen::Index total = record.cols();
  const double cycles = k * record_periods;
  if (kind == MotionKind::periodic && std::abs(cycles - std::round(cycles)) > 1e-9) return 0.0;  // no such harmonic in this motion
  const bool window = kind != MotionKind::periodic;                                              // Hann where the record is not one period
  std::complex<double> sum = 0.0;
  double weight = 0.0;
  for (Eigen::Index j = 0; j < total; ++j) {
    const double w = window ? 0.5 * (1.0 - std::cos(two_pi * static_cast<double>(j) / static_cast<double>(total))) : 1.0;
    sum += w * record(i, j) * std::polar(1.0, -cycles * two_pi * static_cast<double>(j) / static_cast<double>(total));
    weight += w;
  }
  return sum * ((k == 0.0 ? 1.0 : 2.0) / weight);
}

SteadyMotion settle(const ModalSystem<double>& system, const Vector& y0, const SettleOptions& o) {
  o.validate();
  const int n = system.size();
  if (y0.size() != 2 * n) throw std::invalid_argument(fmt::format("a start needs {} values (q, q'), got {}", 2 * n, y0.size()));
  const double period = two_pi / system.omega;
  SteadyMotion motion;
  motion.omega = system.omega;
  const auto flow = [&system](double t, std::span<const double> y, std::span<double> d) { system.flow<double>(system.omega * t, y, d); };
  Integrator run(flow, 0.0, y0, o.integrator);
  std::deque<Vector> past{y0};  // stroboscopic points, newest first
  std::vector<double> last(static_cast<std::size_t>(o.max_multiple) + 1, 0.0);
  std::vector<int> calm(last.size(), 0);
  Lasting lasting(o.max_periods, o.max_multiple);
  Matrix late(2 * n, std::min(o.max_periods, lasting.window()));  // the last stroboscopic points, in a ring
  for (int k = 1; k <= o.max_periods && motion.multiple == 0; ++k) {
    if (o.interrupted && *o.interrupted) break;
    if (!run.advance(k * period)) {
      motion.why = run.why();
      motion.periods_integrated = k;
      motion.state = run.state();
      return motion;
    }
    const Vector x = run.state();
    late.col((k - 1) % late.cols()) = x;
    motion.periods_integrated = k;
    const double limit = o.tolerance * (1.0 + x.norm());
    for (int m = 1; m <= std::min(o.max_multiple, static_cast<int>(past.size())); ++m) {
      const auto slot = static_cast<std::size_t>(m);
      const double e = (x - past[slot - 1]).norm();
      // Distances shrink by `rate` a period: what is left to go is about e rate^m / (1 - rate^m).
      const double rate = last[slot] > 0.0 ? std::min(e / last[slot], 0.9999) : 0.9999;
      const double left = e / (1.0 - std::pow(rate, m));
      last[slot] = e;
      lasting.see(k, m, e);
      calm[slot] = left < limit || e < 1e-3 * limit ? calm[slot] + 1 : 0;
      // Of an m that is calm, a divisor nearly so may be the true period that only settles more slowly: wait for it.
      bool shorter = false;
      for (int d = 1; d < m; ++d) shorter = shorter || (m % d == 0 && last[static_cast<std::size_t>(d)] < 1e3 * limit);
      if (calm[slot] >= 2 * m + 1 && !shorter) {
        motion.multiple = m;
        motion.distance = e;
        break;
      }
    }
    past.push_front(x);
    if (static_cast<int>(past.size()) > o.max_multiple) past.pop_back();
  }
  motion.state = past.front();
  if (motion.multiple > 0) {
    motion.kind = MotionKind::periodic;
  } else {
    motion.distance = last[1];
    motion.kind = MotionKind::unsettled;
    const bool interrupted = o.interrupted && *o.interrupted;
    if (interrupted) motion.why = "interrupted";
    else if (still_changing(lasting, period, motion)) {
      // A beat slower than the windows looks like growth or decay, too: the multipliers know.
      (void)decays_unseen(system, in_order(late, motion.periods_integrated), lasting, motion);
    } else if (o.lyapunov_periods > 0) {
      motion.lyapunov = largest_exponent(system, motion.state, o);
      // A tangent vector along a torus neither grows nor shrinks; over N periods the estimate is good to about ln(N)/N.
      const double resolution = std::log(static_cast<double>(o.lyapunov_periods)) / (o.lyapunov_periods * period);
      if (motion.lyapunov > resolution) motion.kind = MotionKind::chaotic;
      else if (motion.lyapunov > -resolution) {
        if (!decays_unseen(system, in_order(late, motion.periods_integrated), lasting, motion)) motion.kind = MotionKind::quasi_periodic;
      } else
        motion.why = fmt::format("not settled after {} periods, largest Lyapunov exponent {:.2g} 1/s", motion.periods_integrated, motion.lyapunov);
    }
  }
  motion.record_periods = motion.multiple > 0 ? motion.multiple : o.record_periods;
  const int total = o.samples * motion.record_periods;
  motion.record.resize(2 * n, total);
  run.restart(0.0, motion.state);
  for (int j = 0; j < total; ++j) {
    if (!run.advance(j * period * motion.record_periods / total)) {
      motion.why = run.why();
      motion.kind = MotionKind::failed;
      motion.record.conservativeResize(2 * n, j);
      return motion;
    }
    motion.record.col(j) = run.state();
  }
  return motion;
}

}  // namespace whirl::models
