#include "models/slow_flow/combinatorial_printed.hpp"

namespace whirl::models {
namespace {

// The terms of the reduced coupling (35) in the order of nielsen_kirkegaard: equation, factors, harmonic.
struct Expected {
  int equation, degree;
  std::array<short, 3> factor;
  int harmonic;
};
constexpr Expected reduced[] = {{0, 1, {0, 0, 0}, 1}, {1, 1, {1, 0, 0}, 1}, {0, 3, {0, 0, 0}, 0},
                                {0, 3, {0, 1, 1}, 0}, {1, 3, {0, 0, 1}, 0}, {1, 3, {1, 1, 1}, 0}};

bool is_reduced(const ModalSystem<double>& system) {
  if (system.size() != 2 || system.terms.size() != std::size(reduced) || system.forces.size() != 1) return false;
  if (system.forces[0].equation != 1 || system.forces[0].harmonic != 1) return false;
  for (std::size_t i = 0; i < std::size(reduced); ++i) {
    const auto& t = system.terms[i];
    const Expected& e = reduced[i];
    if (t.equation != e.equation || t.degree != e.degree || t.cos_harmonic != e.harmonic) return false;
    if (!std::equal(t.factor.begin(), t.factor.begin() + t.degree, e.factor.begin())) return false;
  }
  return true;
}

ModalSystem<double> reference_of(const ParametricSystem& system) {
  ModalSystem<double> shape;
  system.at(std::span<const double>(system.reference().data(), static_cast<std::size_t>(system.parameters())), shape);
  return shape;
}

Ansatz ansatz_of(CombinatorialMotion motion) {
  return motion == CombinatorialMotion::coupled ? Ansatz::combinatorial_coupled() : Ansatz::combinatorial_in_plane();
}

}  // namespace

PrintedCombinatorialModel::PrintedCombinatorialModel(const ParametricSystem& system, CombinatorialMotion motion)
    : system_(system), motion_(motion), ansatz_(ansatz_of(motion)) {
  if (!is_reduced(reference_of(system_)))
    throw std::invalid_argument("the printed combinatorial equations are those of the reduced coupling of a stay in two coordinates");
}

PrintedCombinatorialFlow::PrintedCombinatorialFlow(const ParametricSystem& system, CombinatorialMotion motion)
    : DualProblem(PrintedCombinatorialModel(system, motion), ansatz_of(motion).size(), system.parameters(), true) {
  name_parameters(system.names());
  for (auto& r : reflections_of(ansatz(), reference_of(system), {{{-1, 1}, "WH"}})) add_reflection(std::move(r));
}

}  // namespace whirl::models
