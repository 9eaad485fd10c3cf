#pragma once
/// Vector fields given as text: one expression for each equation, in named inputs.
///
///     VectorField f({"mu*x - x^3"}, {"x", "mu"});
///     f.evaluate<double>(inputs, out);                 // and in Dual or nested Dual: derivatives are exact
///
/// The tree of the text is turned once into a flat list of steps that runs in any scalar, common parts once.
/// Accepted: names, decimal numbers, pi, + - * / ^ ( ), exp log sin cos tan sinh cosh tanh atan sqrt abs sign max min. `^` is power
/// (expression_power.hpp): by its value also where the exponent is a parameter that happens to be whole, one-sided at 0, NaN for other powers of
/// negative numbers. A number in the text is the nearest double; numbers are combined in double. A sign behind an operator, and x^y^z, need
/// parentheses: readers disagree about them.
///
/// Throws ExpressionError with the equation and one line of reason.

#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "models/expression_corner.hpp"
#include "models/expression_power.hpp"

namespace whirl::models {

struct ExpressionError : std::invalid_argument {
  ExpressionError(int equation_number, const std::string& why);
  int equation;        ///< from 1; 0 if the names of the inputs are at fault
  std::string reason;  ///< "unknown symbol 'q9', did you mean q2?"
};

/// One operation on registers: inputs come first, then the result of each step.
struct Step {
  enum class Op : std::uint8_t {
    constant,     ///< number
    add,          ///< a + b
    subtract,     ///< a - b
    multiply,     ///< a * b
    divide,       ///< a / b
    offset,       ///< a + number
    scale,        ///< a * number
    over,         ///< number / a
    whole_power,  ///< a^b, b the exponent itself
    real_power,   ///< a^number
    power,        ///< a^b, both registers
    exp,
    log,
    sin,
    cos,
    tan,
    sinh,
    cosh,
    tanh,
    atan,
    sqrt,
    abs,
    sign,  ///< -1, 0, 1
    max,   ///< the larger of a and b
    min
  };
  Op op;
  int a = 0, b = 0;
  double number = 0.0;
};

class VectorField {
 public:
  VectorField(const std::vector<std::string>& equations, const std::vector<std::string>& inputs);

  int inputs() const { return inputs_; }
  int equations() const { return static_cast<int>(results_.size()); }
  const std::vector<Step>& steps() const { return steps_; }

  /// Where an old input comes from: a new input, or a fixed number.
  using Source = std::variant<int, double>;
  /// The same equations in other inputs: fixed numbers are computed into the steps. `sources` has one entry for each old input.
  VectorField rebound(const std::vector<Source>& sources, int new_inputs) const;

  /// The last values.size() equations c_k are conserved by the others, f: f - sum_k rate_k grad c_k (c_k - value_k), grad over the first `variables`
  /// inputs. It has the solutions of f = 0 on which c = value, and on c = value it is f.
  VectorField held(int variables, const std::vector<double>& values, const std::vector<double>& rates) const;

  /// Where the first value that is not finite comes from: "log(-0.3) is not a real number"; "" if all are finite.
  std::string not_finite(std::span<const double> x) const;
  /// A place where the field has no derivative: there `distance` is zero.
  struct Corner {
    Step::Op op;      ///< abs, sign, max, min
    double distance;  ///< what stands in abs or sign, the difference of what stands in max or min
  };
  std::vector<Corner> corners(std::span<const double> x) const;

  /// Sizes: x inputs(), r equations().
  template <class S>
  void evaluate(std::span<const S> x, std::span<S> r) const {
    static thread_local std::vector<S> registers;
    if (registers.size() < static_cast<std::size_t>(inputs_) + steps_.size()) registers.resize(static_cast<std::size_t>(inputs_) + steps_.size());
    S* next = std::copy(x.begin(), x.begin() + inputs_, registers.data());
    for (const Step& step : steps_) *next++ = run(step, registers.data());
    for (std::size_t i = 0; i < results_.size(); ++i) r[i] = registers[static_cast<std::size_t>(results_[i])];
  }

  /// One step on the registers x.
  template <class S>
  static S run(const Step& step, const S* x);

 private:
  VectorField() = default;
  std::vector<bool> used_by(std::size_t first) const;

  int inputs_ = 0;
  std::vector<Step> steps_;
  std::vector<int> results_;  // register of each equation
};

// ---------------------------------------------------------------------------------------------------------------------------

template <class S>
S VectorField::run(const Step& step, const S* x) {
  using std::abs, std::atan, std::cos, std::cosh, std::exp, std::log, std::sin, std::sinh, std::tan, std::tanh;
  const S& a = x[step.a];
  switch (step.op) {
    case Step::Op::constant:
      return S(step.number);
    case Step::Op::add:
      return a + x[step.b];
    case Step::Op::subtract:
      return a - x[step.b];
    case Step::Op::multiply:
      return a * x[step.b];
    case Step::Op::divide:
      return a / x[step.b];
    case Step::Op::offset:
      return a + step.number;
    case Step::Op::scale:
      return a * step.number;
    case Step::Op::over:
      return step.number / a;
    case Step::Op::whole_power:
      return power(a, step.b);
    case Step::Op::real_power:
      return detail::real_power(a, step.number);
    case Step::Op::power:
      return detail::log_power(a, x[step.b], 0);
    case Step::Op::exp:
      return exp(a);
    case Step::Op::log:
      return log(a);
    case Step::Op::sin:
      return sin(a);
    case Step::Op::cos:
      return cos(a);
    case Step::Op::tan:
      return tan(a);
    case Step::Op::sinh:
      return sinh(a);
    case Step::Op::cosh:
      return cosh(a);
    case Step::Op::tanh:
      return tanh(a);
    case Step::Op::atan:
      return atan(a);
    case Step::Op::sqrt:
      return detail::root(a);
    case Step::Op::abs:
      return abs(a);
    case Step::Op::sign:
      return detail::sign(a);
    case Step::Op::max:
      return detail::larger(a, x[step.b]);
    case Step::Op::min:
      return detail::larger(a, x[step.b], -1.0);
  }
  return S(0.0);
}

}  // namespace whirl::models
