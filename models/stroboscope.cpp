#include "models/stroboscope.hpp"

#include <fmt/format.h>

#include <numbers>

#include "core/explicit_integrator.hpp"

namespace whirl::models {

struct Stroboscope::Base {
  virtual ~Base() = default;
  // `y` is the state with its tangents, in place.
  virtual bool advance(double* y, double t0, double t1) = 0;
  virtual IntegrationStop stop() const = 0;
  virtual std::string why() const = 0;
  virtual long steps() const = 0;
};

template <class State>
struct Stroboscope::Run : Base {
  struct System {
    FlatFlow flow;
    int tangents;
    void operator()(const State& y, State& d, double t) const {
      if (tangents == 0) flow(t, y.data(), d.data());
      else flow.with_tangents(t, y.data(), d.data(), tangents);
    }
  };
  ExplicitIntegrator<State, System> run;
  State buffer;

  Run(const ModalSystem<double>& system, int tangents, State zero, const StroboscopeOptions& o)
      : run({FlatFlow(system), tangents}, options_of(2 * system.size(), zero.size(), o)), buffer(zero) {}

  // Tangents of length about one are known as well as the state relatively.
  static ExplicitOptions options_of(int state, std::size_t all, const StroboscopeOptions& o) {
    ExplicitOptions e;
    e.relative_tolerance = o.relative_tolerance;
    e.absolute.assign(all, std::max(o.absolute_tolerance, o.relative_tolerance));
    std::fill_n(e.absolute.begin(), state, o.absolute_tolerance);
    e.largest_norm = std::numeric_limits<double>::max();
    if (all == static_cast<std::size_t>(state)) e.largest_norm = o.largest_norm;
    return e;
  }
  bool advance(double* y, double t0, double t1) override {
    std::copy_n(y, buffer.size(), buffer.begin());
    run.restart(t0, buffer);
    const bool ok = run.advance(t1);
    std::copy_n(run.state().begin(), buffer.size(), y);
    return ok;
  }
  IntegrationStop stop() const override { return run.stop(); }
  std::string why() const override { return run.why(); }
  long steps() const override { return run.steps(); }
};

std::unique_ptr<Stroboscope::Base> Stroboscope::make(const ModalSystem<double>& system, int tangents, const StroboscopeOptions& o) {
  switch (const int size = 2 * system.size() * (1 + tangents)) {  // of one and two coordinates: sizes known to the compiler
    case 2:
      return std::make_unique<Run<std::array<double, 2>>>(system, tangents, std::array<double, 2>{}, o);
    case 4:
      return std::make_unique<Run<std::array<double, 4>>>(system, tangents, std::array<double, 4>{}, o);
    case 6:
      return std::make_unique<Run<std::array<double, 6>>>(system, tangents, std::array<double, 6>{}, o);
    case 8:
      return std::make_unique<Run<std::array<double, 8>>>(system, tangents, std::array<double, 8>{}, o);
    case 20:
      return std::make_unique<Run<std::array<double, 20>>>(system, tangents, std::array<double, 20>{}, o);
    default:
      return std::make_unique<Run<std::vector<double>>>(system, tangents, std::vector<double>(static_cast<std::size_t>(size), 0.0), o);
  }
}

Stroboscope::Stroboscope(const ModalSystem<double>& system, const StroboscopeOptions& options) : system_(system), options_(options) {
  if (system.size() < 1) throw std::invalid_argument("a modal system without coordinates cannot be integrated");
  if (!(system.omega > 0.0)) throw std::invalid_argument(fmt::format("omega must be > 0, got {}", system.omega));
  plain_ = make(system, 0, options);
}
Stroboscope::~Stroboscope() = default;
Stroboscope::Stroboscope(Stroboscope&&) noexcept = default;
Stroboscope& Stroboscope::operator=(Stroboscope&&) noexcept = default;

int Stroboscope::size() const { return 2 * system_.size(); }
double Stroboscope::omega() const { return system_.omega; }
double Stroboscope::period() const { return 2.0 * std::numbers::pi / system_.omega; }
bool Stroboscope::diverged() const { return diverged_; }
std::string Stroboscope::why() const { return why_; }
long Stroboscope::steps() const { return plain_->steps() + (tangent_ ? tangent_->steps() : 0) + (monodromy_ ? monodromy_->steps() : 0); }

void Stroboscope::remember(const Base& run) {
  diverged_ = run.stop() == IntegrationStop::diverged;
  why_ = run.why();
}

bool Stroboscope::advance(Vector& y, double t0, double t1) {
  if (y.size() != size()) throw std::invalid_argument(fmt::format("a state needs {} values (q, q'), got {}", size(), y.size()));
  if (plain_->advance(y.data(), t0, t1)) return true;
  remember(*plain_);
  return false;
}

bool Stroboscope::map(Vector& y, int periods) {
  for (int k = 0; k < periods; ++k)
    if (!advance(y, 0.0, period())) return false;
  return true;
}

bool Stroboscope::map(Vector& y, Matrix& derivative, int periods) {
  const int n = size();
  if (y.size() != n) throw std::invalid_argument(fmt::format("a state needs {} values (q, q'), got {}", n, y.size()));
  if (!monodromy_) monodromy_ = make(system_, n, options_);
  Matrix all(n, n + 1);
  derivative = Matrix::Identity(n, n);
  for (int k = 0; k < periods; ++k) {
    all.col(0) = y;
    all.rightCols(n).setIdentity();
    if (!monodromy_->advance(all.data(), 0.0, period())) {
      remember(*monodromy_);
      return false;
    }
    y = all.col(0);
    derivative = (all.rightCols(n) * derivative).eval();
  }
  return true;
}

bool Stroboscope::map_tangent(Vector& y, Vector& tangent) {
  const int n = size();
  if (y.size() != n || tangent.size() != n) throw std::invalid_argument(fmt::format("state and tangent need {} values", n));
  if (!tangent_) tangent_ = make(system_, 1, options_);
  Matrix all(n, 2);
  all << y, tangent;
  if (!tangent_->advance(all.data(), 0.0, period())) {
    remember(*tangent_);
    return false;
  }
  y = all.col(0);
  tangent = all.col(1);
  return true;
}

}  // namespace whirl::models
