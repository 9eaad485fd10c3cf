#include "core/cvode.hpp"

#include <cvodes/cvodes.h>
#include <fmt/format.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include <cstdlib>
#include <exception>
#include <utility>

#include "core/sundials_handles.hpp"

namespace whirl {

void IntegratorOptions::validate() const {
  if (!(relative_tolerance > 0.0 && relative_tolerance < 1.0))
    throw std::invalid_argument(fmt::format("relative_tolerance must be in (0, 1), got {}", relative_tolerance));
  if (!(absolute_tolerance > 0.0)) throw std::invalid_argument(fmt::format("absolute_tolerance must be > 0, got {}", absolute_tolerance));
  if (max_steps < 1) throw std::invalid_argument(fmt::format("max_steps must be >= 1, got {}", max_steps));
}

namespace {
struct CvodeDeleter {
  void operator()(void* c) const { CVodeFree(&c); }
};
using NonlinearSolver = std::unique_ptr<std::remove_pointer_t<SUNNonlinearSolver>, sundials::Deleter<SUNNonlinSolFree>>;
void silent(int, const char*, const char*, char*, void*) {}
}  // namespace

struct Integrator::Implementation {
  RightHandSide f;
  IntegratorOptions options;
  double t = 0.0;
  std::exception_ptr thrown;
  std::string reason;
  sundials::Context context;
  sundials::NVector y;
  sundials::DenseMatrix matrix;
  sundials::LinearSolver linear;
  NonlinearSolver fixed_point;
  std::unique_ptr<void, CvodeDeleter> cvode;

  static int call(double t, N_Vector y, N_Vector dydt, void* data) {
    auto& self = *static_cast<Implementation*>(data);
    const auto n = static_cast<std::size_t>(N_VGetLength(y));
    try {
      self.f(t, {N_VGetArrayPointer(y), n}, {N_VGetArrayPointer(dydt), n});
      return Eigen::Map<const Vector>(N_VGetArrayPointer(dydt), static_cast<Eigen::Index>(n)).allFinite() ? 0 : 1;
    } catch (...) {
      self.thrown = std::current_exception();
      return -1;
    }
  }
};

Integrator::Integrator(RightHandSide f, double t0, const Vector& y0, const IntegratorOptions& options) : self_(std::make_unique<Implementation>()) {
  options.validate();
  auto& s = *self_;
  s.f = std::move(f);
  s.options = options;
  s.t = t0;
  s.context = sundials::make_context();
  s.y.reset(N_VNew_Serial(y0.size(), s.context.get()));
  Eigen::Map<Vector>(N_VGetArrayPointer(s.y.get()), y0.size()) = y0;
  s.cvode.reset(CVodeCreate(options.stiff ? CV_BDF : CV_ADAMS, s.context.get()));
  CVodeSetErrHandlerFn(s.cvode.get(), silent, nullptr);
  CVodeInit(s.cvode.get(), Implementation::call, t0, s.y.get());
  CVodeSetUserData(s.cvode.get(), &s);
  CVodeSStolerances(s.cvode.get(), options.relative_tolerance, options.absolute_tolerance);
  CVodeSetMaxNumSteps(s.cvode.get(), options.max_steps);
  if (options.stiff) {
    s.matrix.reset(SUNDenseMatrix(y0.size(), y0.size(), s.context.get()));
    s.linear.reset(SUNLinSol_Dense(s.y.get(), s.matrix.get(), s.context.get()));
    CVodeSetLinearSolver(s.cvode.get(), s.linear.get(), s.matrix.get());
  } else {
    s.fixed_point.reset(SUNNonlinSol_FixedPoint(s.y.get(), 0, s.context.get()));
    CVodeSetNonlinearSolver(s.cvode.get(), s.fixed_point.get());
  }
}

Integrator::~Integrator() = default;
Integrator::Integrator(Integrator&&) noexcept = default;

bool Integrator::advance(double t) {
  auto& s = *self_;
  if (t == s.t) return true;
  CVodeSetStopTime(s.cvode.get(), t);
  double reached = s.t;
  const int flag = CVode(s.cvode.get(), t, s.y.get(), &reached, CV_NORMAL);
  if (s.thrown) std::rethrow_exception(std::exchange(s.thrown, nullptr));
  s.t = reached;
  if (flag >= 0) return true;
  char* name = CVodeGetReturnFlagName(flag);
  s.reason = fmt::format("CVODE stopped at t = {:.6g} s with {}", reached, name);
  std::free(name);
  return false;
}

void Integrator::restart(double t, const Vector& y) {
  auto& s = *self_;
  s.t = t;
  Eigen::Map<Vector>(N_VGetArrayPointer(s.y.get()), y.size()) = y;
  CVodeReInit(s.cvode.get(), t, s.y.get());
}

double Integrator::time() const { return self_->t; }
Eigen::Map<const Vector> Integrator::state() const { return {N_VGetArrayPointer(self_->y.get()), N_VGetLength(self_->y.get())}; }
const std::string& Integrator::why() const { return self_->reason; }

}  // namespace whirl
