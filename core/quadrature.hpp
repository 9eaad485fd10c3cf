#pragma once
/// Gauss-Legendre quadrature on [a, b], any scalar: the nodes are Boost's, the sum is ours so that duals pass through.
///
///     S m = integrate<S>([](S xi) { return sin(pi * xi) * sin(pi * xi); });     // on [0, 1]

#include <boost/math/quadrature/gauss.hpp>

namespace whirl {

/// Points = 40 resolves the products of four mode slopes of the first modes to rounding.
template <class S, int Points = 40, class F>
S integrate(F&& f, double a = 0.0, double b = 1.0) {
  static_assert(Points % 2 == 0);
  using Rule = boost::math::quadrature::gauss<double, Points>;
  const double half = 0.5 * (b - a), mid = 0.5 * (a + b);
  S sum(0.0);
  for (std::size_t i = 0; i < Rule::abscissa().size(); ++i) {
    const double x = Rule::abscissa()[i], w = Rule::weights()[i] * half;
    sum += (f(mid + half * x) + f(mid - half * x)) * w;
  }
  return sum;
}

}  // namespace whirl
