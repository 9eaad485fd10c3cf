#include "core/kinsol.hpp"

#include <kinsol/kinsol.h>
#include <sundials/sundials_version.h>

#include <exception>

#include "core/sundials_handles.hpp"

namespace whirl {
namespace {

struct Call {
  const Problem& f;
  Vector u;  // unknowns and held parameters
  Vector r;
  Matrix j;
  std::exception_ptr thrown;

  void take(N_Vector x) { u.head(f.size()) = Eigen::Map<const Vector>(N_VGetArrayPointer(x), f.size()); }
};

int residual(N_Vector x, N_Vector out, void* data) {
  auto& call = *static_cast<Call*>(data);
  try {
    call.take(x);
    call.f.residual(call.u, call.r);
    Eigen::Map<Vector>(N_VGetArrayPointer(out), call.f.size()) = call.r;
    return call.r.allFinite() ? 0 : 1;
  } catch (...) {
    call.thrown = std::current_exception();
    return -1;
  }
}

int jacobian(N_Vector x, N_Vector, SUNMatrix out, void* data, N_Vector, N_Vector) {
  auto& call = *static_cast<Call*>(data);
  try {
    call.take(x);
    call.f.jacobian(call.u, call.j);
    const int n = call.f.size();
    Eigen::Map<Matrix>(SUNDenseMatrix_Data(out), n, n) = call.j.leftCols(n);
    return 0;
  } catch (...) {
    call.thrown = std::current_exception();
    return -1;
  }
}

void silent(int, const char*, const char*, char*, void*) {}  // the return code says it all

struct KinsolDeleter {
  void operator()(void* k) const { KINFree(&k); }
};

}  // namespace

NewtonResult line_search_solve(const Problem& f, const Vector& start, const NewtonOptions& options) {
  const int n = f.size();
  Call call{f, start, Vector(n), Matrix(n, n + f.parameters()), nullptr};
  const auto context = sundials::make_context();
  const sundials::NVector x(N_VNew_Serial(n, context.get())), scale(N_VNew_Serial(n, context.get()));
  Eigen::Map<Vector>(N_VGetArrayPointer(x.get()), n) = start.head(n);
  N_VConst(1.0, scale.get());
  const sundials::DenseMatrix matrix(SUNDenseMatrix(n, n, context.get()));
  const sundials::LinearSolver solver(SUNLinSol_Dense(x.get(), matrix.get(), context.get()));
  const std::unique_ptr<void, KinsolDeleter> kinsol(KINCreate(context.get()));
  KINSetErrHandlerFn(kinsol.get(), silent, nullptr);
  KINInit(kinsol.get(), residual, x.get());
  KINSetUserData(kinsol.get(), &call);
  KINSetLinearSolver(kinsol.get(), solver.get(), matrix.get());
  KINSetJacFn(kinsol.get(), jacobian);
  KINSetMaxSetupCalls(kinsol.get(), 1);  // the exact Jacobian at every iteration
  KINSetFuncNormTol(kinsol.get(), 1e-10);
  KINSetNumMaxIters(kinsol.get(), 200);
  const int flag = KINSol(kinsol.get(), x.get(), KIN_LINESEARCH, scale.get(), scale.get());
  if (call.thrown) std::rethrow_exception(call.thrown);
  Vector found = start;
  found.head(n) = Eigen::Map<const Vector>(N_VGetArrayPointer(x.get()), n);
  NewtonResult polished = newton(f, found, options);
  if (flag < 0 && !polished.ok()) polished.outcome = Outcome::stalled;
  return polished;
}

std::string sundials_version() {
  char text[32] = "";
  SUNDIALSGetVersion(text, sizeof text);
  return text;
}

}  // namespace whirl
