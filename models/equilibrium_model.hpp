#pragma once
/// An autonomous system given as text, x' = f(x, p), as an equilibrium problem: any one or two of its parameters, by name, are free.
///
///     EquilibriumModel m{.variables = {"x"}, .parameters = {{"mu", 0.1}}, .rhs = {"mu*x - x^3"}, .initial = {0.1}, .mirrors = {{{"x"}, "PF"}}};
///     EquilibriumFlow flow(m, {"mu"});
///     flow.residual(u, r);          // u = (x, mu), r = x'
///
/// Throws ExpressionError for text that cannot be read and std::invalid_argument, one line, for everything else.

#include <string_view>

#include "core/dual_problem.hpp"
#include "models/expression.hpp"

namespace whirl::models {

/// Variables that change sign together without changing the equations.
struct Mirror {
  std::vector<std::string> variables;
  std::string subtype = "PF";  ///< of a branch point that breaks the symmetry
};

/// The root of the sum of squares of some variables, under a name of its own.
struct Amplitude {
  std::string name;
  std::vector<std::string> variables;
};

struct EquilibriumModel {
  struct Parameter {
    std::string name;
    double value;
  };
  /// A coordinate that a continuous symmetry leaves free, taken out of the variables: equilibrium_symmetry.hpp.
  struct Pinned {
    std::string name;   ///< among the parameters now
    std::string drift;  ///< expression: the speed at which solutions move along the symmetry
  };
  std::vector<std::string> variables;
  std::vector<Parameter> parameters;
  std::vector<std::string> rhs;  ///< one for each variable
  std::vector<double> initial;   ///< a guess, one for each variable
  std::vector<Mirror> mirrors;
  std::vector<Amplitude> amplitudes = {};
  /// Expressions that the equations conserve. Solutions keep the values they have at `initial`, and are isolated then: the field is
  /// f - sum_k rate_k grad c_k (c_k - c_k(initial)), which adds one negative growth rate for each and leaves all others as they are.
  std::vector<std::string> conserved = {};
  std::vector<std::string> angles = {};  ///< variables whose values 2 pi apart are one
  std::vector<Pinned> pinned = {};

  int size() const { return static_cast<int>(variables.size()); }
  std::vector<std::string> parameter_names() const;
  double parameter(std::string_view name) const;  ///< throws naming the accepted names
  void validate() const;                          ///< shapes and names; not the text of rhs
};

/// Expressions in the model's names as functions of u = (variables, free parameters).
VectorField bound(const EquilibriumModel& model, const std::vector<std::string>& expressions, const std::vector<std::string>& lenses);

/// The field in u = (variables, free parameters).
class EquilibriumField {
 public:
  EquilibriumField(const EquilibriumModel& model, const std::vector<std::string>& lenses);

  template <class S>
  void residual(std::span<const S> u, std::span<S> r) const {
    field_.evaluate<S>(u, r);
  }
  const EquilibriumModel& model() const { return model_; }
  const VectorField& field() const { return field_; }

 private:
  EquilibriumModel model_;
  VectorField field_;
};

class EquilibriumFlow : public DualProblem<EquilibriumField> {
 public:
  /// Refuses a mirror that the equations do not have, f(R x, p) = R f(x, p), and an expression that they do not conserve, grad c . f = 0: both are
  /// tested at random x and free p.
  EquilibriumFlow(const EquilibriumModel& model, const std::vector<std::string>& lenses);

 private:
  void check_mirror(const Mirror& mirror, const Vector& signs) const;
};

/// Random u = (x, free p) around `initial` and the parameters' values, the same in every run, half of them with positive x; those at which f is not
/// finite are left out.
std::vector<Vector> sample_points(const EquilibriumModel& model, const std::vector<std::string>& lenses, int count);

}  // namespace whirl::models
