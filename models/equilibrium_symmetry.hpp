#pragma once
/// Why equilibria of x' = f(x, p) may never be isolated, found from the field alone, and what makes them so.
///
/// Conserved totals: weights w with w . f(x, p) = 0 for all x and all free p. Held at their value (EquilibriumModel::conserved) they leave isolated
/// equilibria.
///
/// Continuous symmetries g(x) = A x + b, translations and rotations say, with Df g = A f for all x: where g(x) is not zero an equilibrium lies on a
/// curve of them. The flow is reduced by holding one coordinate x_k ("the phase") and moving along g so that it stays,
///
///     x_j' = f_j - (f_k / g_k) g_j,  j != k,
///
/// whose equilibria are those of f and the motions that only drift along g, with the speed f_k / g_k; their growth rates are all but the neutral one.
///
///     for (const auto& c : linear_invariants(model, {"b"})) model.conserved.push_back(c);     // "S + I + R"
///     const EquilibriumModel reduced = pinned(model, "theta1", {"K"});

#include "models/equilibrium_model.hpp"

namespace whirl::models {

/// Sums with constant weights that the equations conserve beside those of model.conserved, each as an expression.
std::vector<std::string> linear_invariants(const EquilibriumModel& model, const std::vector<std::string>& lenses);

struct Symmetry {
  Matrix a;  ///< n x n
  Vector b;  ///< n
  Vector field(In x) const { return a * x + b; }
};
/// Generators of all that have this form; none is looked for among more than `largest` variables: their number is its square.
std::vector<Symmetry> continuous_symmetries(const EquilibriumModel& model, const std::vector<std::string>& lenses, int largest = 12);

/// Whole numbers k with f(x + 2 pi k) = f(x): one variable that is an angle, or several that turn together, as pendula tied by a spring.
struct Turn {
  Vector k;  ///< n, whole
};
/// A basis of all of them, each with as few entries as possible, but for those along which f does not change at all.
std::vector<Turn> turns(const EquilibriumModel& model, const std::vector<std::string>& lenses);
/// The turn that takes the variable round once, with what it takes along; that variable alone if none of them does.
Turn turn_of(const EquilibriumModel& model, const std::vector<Turn>& turns, const std::string& variable);
/// "theta", or "a + b" of variables that turn together.
std::string describe(const Turn& turn, const std::vector<std::string>& variables);

/// "translation along theta1 + theta2" or "rotation of (x, y)", with what else it moves.
std::string describe(const Symmetry& symmetry, const std::vector<std::string>& variables);

/// The model with `variable` a parameter, held at its initial value. Throws std::invalid_argument if no symmetry moves it, and if there is only one
/// variable.
EquilibriumModel pinned(const EquilibriumModel& model, const std::string& variable, const std::vector<std::string>& lenses);

}  // namespace whirl::models
