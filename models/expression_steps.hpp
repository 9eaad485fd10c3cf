#pragma once
/// Inside of VectorField: steps written so that what is known is computed at once and nothing twice, and the slopes of steps.

#include <map>
#include <tuple>

#include "models/expression.hpp"

namespace whirl::models {

/// A value while steps are written: a number known already, or a register.
struct Operand {
  bool known = true;
  double number = 0.0;
  int index = 0;
  bool is(double x) const { return known && number == x; }
};
inline Operand fixed(double x) { return {true, x, 0}; }

class Writer {
 public:
  explicit Writer(int inputs) : inputs_(inputs) {}

  /// Numbers that are not finite are refused with std::domain_error, one line; zero times anything is zero.
  Operand input(int i) const { return {false, 0.0, i}; }
  Operand add(const Operand& a, const Operand& b);
  Operand subtract(const Operand& a, const Operand& b);
  Operand multiply(const Operand& a, const Operand& b);
  Operand divide(const Operand& a, const Operand& b);
  Operand raise(const Operand& base, const Operand& exponent);
  Operand call(Step::Op op, const Operand& a);
  Operand choose(Step::Op op, const Operand& a, const Operand& b);  ///< max, min

  /// The same operation on other operands.
  Operand again(const Step& step, const Operand& a, const Operand& b);
  /// Slope of y = step(a, b) along a direction in which a and b have the slopes da and db.
  Operand slope(const Step& step, const Operand& a, const Operand& b, const Operand& y, const Operand& da, const Operand& db);

  /// The register of a result.
  int result(const Operand& a) { return a.known ? write({Step::Op::constant, 0, 0, a.number}).index : a.index; }
  std::vector<Step> steps;

 private:
  Operand raise(const Operand& base, double y);
  Operand write(Step s);

  int inputs_;
  std::map<std::tuple<Step::Op, int, int, double>, int> known_;
};

}  // namespace whirl::models
