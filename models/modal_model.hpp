#pragma once
/// A forced modal system given as numbers, the plain record behind `[modal_model]` of a study file:
///
///     q_i'' + c_i q_i' + sum_j K_ij q_j + sum of terms  =  sum of forces
///     term:  coefficient q_1^powers[0] q_2^powers[1] ... cos(cos_harmonic omega t)          force:  amplitude cos(harmonic omega t)
///
/// K from `frequency` (K_ii = frequency_i^2) or `stiffness`; damping c_i directly or c_i = 2 damping_ratio_i frequency_i. Units of a mass-normalised
/// model: frequencies rad/s, c in 1/s, K in 1/s^2. Any number is a lens by name: "omega", "frequency[1]", "force[1].amplitude",
/// "term[2].coefficient", with or without "modal_model." in front; counts start at 1. A list's own name ("damping") or the `name` of terms and
/// forces moves several numbers at once, if they are equal in the model.
///
///     ModalModel duffing{.frequency = {1.0}, .damping = {0.05}, .terms = {{0, 0.1, {3}}}, .forces = {{0, 0.18}}};
///     ParametricSystem system = modal_system(duffing, {"omega"});
///     HarmonicBalance hb(system, {.harmonics = 15, .reflections = mirrors(duffing, {"omega"})});
///
/// Throws std::invalid_argument, one line.

#include "models/harmonic_balance.hpp"

namespace whirl::models {

struct ModalModel {
  struct Term {
    int equation;             ///< from 0
    double coefficient;       ///< on the left-hand side
    std::vector<int> powers;  ///< one for each coordinate
    int cos_harmonic = 0;     ///< h of cos(h omega t), 0: no time dependence
    std::string name = {};    ///< a lens that moves all terms of this name
  };
  struct Force {
    int equation;
    double amplitude;  ///< on the right-hand side
    int harmonic = 1;  ///< 0: a constant load
    std::string name = {};
  };

  double omega = 1.0;                               ///< excitation frequency [rad/s]
  std::vector<double> frequency;                    ///< [rad/s], one for each coordinate; or
  std::vector<std::vector<double>> stiffness = {};  ///< rows of K [1/s^2]
  std::vector<double> damping = {};                 ///< c [1/s]; or
  std::vector<double> damping_ratio = {};           ///< of `frequency`; neither: no damping
  std::vector<Term> terms = {};
  std::vector<Force> forces = {};
  std::string mirror_subtype = "PF";  ///< of a branch point that breaks a sign symmetry

  int size() const { return static_cast<int>(frequency.empty() ? stiffness.size() : frequency.size()); }
  void validate() const;

  /// Every name `lens` accepts, without "modal_model.".
  std::vector<std::string> lens_names() const;
  double lens_value(const std::string& name) const;
  std::string lens_unit(const std::string& name) const;
};

/// The model as a system with up to two free parameters.
ParametricSystem modal_system(const ModalModel& model, const std::vector<std::string>& lenses);

/// The system as plain numbers.
ModalSystem<double> modal_system(const ModalModel& model);

/// Sign changes of coordinates that leave the equations as they are, whatever the free parameters: generators of all of them. Found from the
/// powers alone, over GF(2): a term of equation e keeps the symmetry if sign_e = product of sign_i^powers_i, a force if sign_e = +1.
std::vector<CoordinateReflection> mirrors(const ModalModel& model, const std::vector<std::string>& lenses = {});

}  // namespace whirl::models
