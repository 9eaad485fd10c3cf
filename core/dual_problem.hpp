#pragma once
/// A Problem from a residual that is written once, templated on its scalar:
///
///     struct Cusp {                                                   // r = mu + x - x^3, p = mu
///       template <class S> void residual(std::span<const S> u, std::span<S> r) const { r[0] = u[1] + u[0] - u[0] * u[0] * u[0]; }
///     };
///     DualProblem<Cusp> cusp({}, 1, 1, true);
///
/// Jacobian and higher derivatives are exact: forward duals in sweeps of 8 columns, nested for `second` and `third`.

#include <span>
#include <utility>

#include "core/dual.hpp"
#include "core/problem.hpp"

namespace whirl {

template <class Model>
class DualProblem : public Problem {
 public:
  DualProblem(Model model, int n, int k, bool flow)
      : Problem(n, k, flow), model_(std::move(model)), u8_(width()), r8_(height()), u8h_(width()), r8h_(height()), u3_(width()), r3_(height()) {
    offer_derivatives(3);
  }

  const Model& model() const { return model_; }
  Model& model() { return model_; }

 protected:
  static constexpr int sweep = 8;
  using Slopes = Dual<double, sweep>;
  using Along = Dual<double, 1>;
  using SlopesAlong = Dual<Along, sweep>;
  using Triple = Dual<Dual<Along, 1>, 1>;

 private:
  std::size_t width() const { return static_cast<std::size_t>(size() + parameters()); }
  std::size_t height() const { return static_cast<std::size_t>(size()); }

  void do_residual(In u, Out r) const override {
    model_.template residual<double>(std::span<const double>(u.data(), width()), std::span<double>(r.data(), height()));
  }

  void do_jacobian(In u, MatrixOut j) const override { sweep_columns(u, nullptr, j); }

  void do_linearise(In u, Out r, MatrixOut j) const override { sweep_columns(u, &r, j); }

  void sweep_columns(In u, Out* r, MatrixOut j) const {
    const int columns = size() + parameters();
    for (int first = 0; first < columns; first += sweep) {
      for (int i = 0; i < columns; ++i) u8_[std::size_t(i)] = Slopes(u[i]);
      for (int i = first; i < std::min(first + sweep, columns); ++i) u8_[std::size_t(i)].d[std::size_t(i - first)] = 1.0;
      model_.template residual<Slopes>(u8_, r8_);
      for (int i = first; i < std::min(first + sweep, columns); ++i)
        for (int row = 0; row < size(); ++row) j(row, i) = r8_[std::size_t(row)].d[std::size_t(i - first)];
      if (first == 0 && r)
        for (int row = 0; row < size(); ++row) (*r)[row] = r8_[std::size_t(row)].v;
    }
  }

  void do_second(In u, In v, MatrixOut h) const override {
    const int columns = size() + parameters();
    for (int first = 0; first < columns; first += sweep) {
      for (int i = 0; i < columns; ++i) {
        Along a(u[i]);
        a.d[0] = v[i];
        u8h_[std::size_t(i)] = SlopesAlong(a);
      }
      for (int i = first; i < std::min(first + sweep, columns); ++i) u8h_[std::size_t(i)].d[std::size_t(i - first)].v = 1.0;
      model_.template residual<SlopesAlong>(u8h_, r8h_);
      for (int i = first; i < std::min(first + sweep, columns); ++i)
        for (int row = 0; row < size(); ++row) h(row, i) = r8h_[std::size_t(row)].d[std::size_t(i - first)].d[0];
    }
  }

  void do_third(In u, In a, In b, In c, Out t) const override {
    for (int i = 0; i < size() + parameters(); ++i) {
      Triple& x = u3_[std::size_t(i)];
      x = Triple(u[i]);
      x.v.v.d[0] = a[i];
      x.v.d[0].v = b[i];
      x.d[0].v.v = c[i];
    }
    model_.template residual<Triple>(u3_, r3_);
    for (int row = 0; row < size(); ++row) t[row] = r3_[std::size_t(row)].d[0].d[0].d[0];
  }

  Model model_;
  mutable std::vector<Slopes> u8_, r8_;
  mutable std::vector<SlopesAlong> u8h_, r8h_;
  mutable std::vector<Triple> u3_, r3_;
};

}  // namespace whirl
