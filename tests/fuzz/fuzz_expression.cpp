/// Expressions, one a line, in the inputs x, y, p: read, evaluated in numbers and duals, with numbers put in, held to what the last one conserves.

#include <array>
#include <cstdint>
#include <sstream>
#include <string>
#include <vector>

#include "core/dual.hpp"
#include "models/expression.hpp"

using namespace whirl;
using models::VectorField;

namespace {

template <class S>
void evaluate(const VectorField& f, const std::array<S, 3>& at) {
  std::vector<S> out(static_cast<std::size_t>(f.equations()));
  f.evaluate<S>(std::span<const S>(at.data(), static_cast<std::size_t>(f.inputs())), out);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using D = Dual<Dual<double, 1>, 2>;
  std::istringstream lines(std::string(reinterpret_cast<const char*>(data), size));
  std::vector<std::string> equations;
  for (std::string line; std::getline(lines, line);) equations.push_back(line);
  try {
    const VectorField f(equations, {"x", "y", "p"});
    for (const auto& [x, y, p] : {std::array{0.3, -0.7, 2.0}, std::array{0.0, 0.0, -1.0}}) {
      const std::array<double, 3> at{x, y, p};
      evaluate<double>(f, at);
      evaluate<D>(f, {seed<D>(x, 0), seed<D>(y, 1), D(p)});
      (void)f.not_finite(at);
      (void)f.corners(at);
    }
    if (!equations.empty()) evaluate<double>(f.held(2, {0.5}, {1.0}), {0.3, -0.7, 2.0});
    evaluate<double>(f.rebound({1, 0, 0.5}, 2), {0.3, -0.7, 0.0});
  } catch (const std::invalid_argument&) {  // ExpressionError among them; rebound and held say so of numbers that are not finite
  }
  return 0;
}
