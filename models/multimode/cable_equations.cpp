#include "models/multimode/potential_terms.hpp"
#include "models/multimode/support.hpp"

namespace whirl::models {
namespace {

template <class T>
Potential<T> potential_of(const CableModel& model, const std::vector<BasisMode<T>>& modes) {
  const Direction d = model.direction;
  const bool in_plane = d != Direction::out_of_plane;
  const Moving moving{in_plane && d != Direction::normal, in_plane && d != Direction::chord, !in_plane};
  if (model.longitudinal == Longitudinal::galerkin) return galerkin_potential(modes, model.terms, model.shapes == Shapes::sines, moving);
  return quasi_static_potential(modes, model.terms, model.shapes == Shapes::sines, moving);
}

/// Writes coefficients into a system, making the list of terms and forces the first time.
template <class S>
class Writer {
 public:
  explicit Writer(ModalSystem<S>& out) : out_(out) {}
  void force(int equation, const S& amplitude, int harmonic) {
    if (forces_ == out_.forces.size()) out_.add_force(equation, amplitude, harmonic);
    else out_.forces[forces_].amplitude = amplitude;
    ++forces_;
  }
  // All factors of the monomial but one of its coordinate `equation`.
  void term(int equation, const S& coefficient, const Monomial& m) {
    if (terms_ < out_.terms.size()) {
      out_.terms[terms_++].coefficient = coefficient;
      return;
    }
    Term<S> t{equation, coefficient, m.degree - 1, {}, m.harmonic};
    bool dropped = false;
    std::size_t next = 0;
    for (int i = 0; i < m.degree; ++i) {
      if (!dropped && m.index[static_cast<std::size_t>(i)] == equation) dropped = true;
      else t.factor[next++] = m.index[static_cast<std::size_t>(i)];
    }
    out_.terms.push_back(t);
    out_.max_harmonic = std::max(out_.max_harmonic, m.harmonic);
    ++terms_;
  }

 private:
  ModalSystem<S>& out_;
  std::size_t terms_ = 0, forces_ = 0;
};

// The equations at one record: S the record's scalar, T that of modes and energy (double where the cable does not move).
template <class S, class T>
void assemble(const CableModel& model, const StayParameters<S>& p, const std::vector<BasisMode<T>>& modes, const Potential<T>& energy,
              ModalSystem<S>& out) {
  using std::sqrt;
  const auto shape = parabola(p.cable);
  const S L = p.cable.chord_length, wave = sqrt(p.cable.chord_tension / p.cable.mass_per_length) / L;
  const auto direction = direction_of(model.direction, p.cable.inclination_deg);
  const double sign = model.end == End::upper ? 1.0 : -1.0;
  std::array<S, 3> E;
  for (std::size_t i = 0; i < 3; ++i) E[i] = p.support_amplitude / L * direction[i] * sign;
  const auto factors = factor_values(E, shape.sag_ratio);
  const S rate = stretching_rate(model, p.cable, shape) * L;
  std::array<S, 5> scale;  // of a term of an equation from a monomial of that degree
  scale[1] = rate;
  for (std::size_t d = 2; d < scale.size(); ++d) scale[d] = scale[d - 1] / L;

  const auto n = modes.size();
  Writer<S> write(out);
  out.omega = p.omega;
  out.damping.resize(n);
  out.stiffness.resize(n);
  std::vector<S> inverse_mass(n);
  for (std::size_t a = 0; a < n; ++a) {
    const S omega = wave * modes[a].b;
    out.stiffness[a] = omega * omega;
    out.damping[a] = omega * (modes[a].in_plane ? p.damping_in_plane : p.damping_out_of_plane) * 2.0;
    inverse_mass[a] = S(1.0) / S(modes[a].mass);
    const S inertia = p.omega * p.omega * p.support_amplitude * modes[a].first_moment(model.end) * inverse_mass[a];
    write.force(static_cast<int>(a), inertia * direction[modes[a].in_plane ? 1 : 2], 1);
  }
  for (const Monomial& m : energy.monomials) {
    S value(0.0);
    for (int c = m.first; c < m.first + m.count; ++c) {
      const auto& part = energy.contributions[static_cast<std::size_t>(c)];
      value += factors[static_cast<std::size_t>(part.factor)] * part.value;
    }
    value = value * scale[static_cast<std::size_t>(m.degree)];
    for (int i = 0; i < m.degree; ++i) {
      const int a = m.index[static_cast<std::size_t>(i)];
      if (i > 0 && m.index[static_cast<std::size_t>(i - 1)] == a) continue;
      int count = 0;
      for (int k = i; k < m.degree && m.index[static_cast<std::size_t>(k)] == a; ++k) ++count;
      const S coefficient = value * inverse_mass[static_cast<std::size_t>(a)] * static_cast<double>(count);
      if (m.degree == 1) write.force(a, -coefficient, m.harmonic);
      else write.term(a, coefficient, m);
    }
  }
}

class CableMaker {
 public:
  CableMaker(const CableModel& model, std::vector<Lens> lenses)
      : model_(model),
        lenses_(std::move(lenses)),
        modes_(basis_modes(model_, parabola(model_.stay.cable).irvine_lambda2)),
        energy_(potential_of(model_, modes_)) {
    for (const auto& lens : lenses_) cable_moves_ = cable_moves_ || lens.affects_cable();
  }

  template <class S>
  void operator()(std::span<const S> p, ModalSystem<S>& out) const {
    StayParameters<S> record = promote<S>(model_.stay);
    for (std::size_t i = 0; i < lenses_.size(); ++i) lenses_[i].set(record, p[i]);
    if (!cable_moves_) {
      assemble(model_, record, modes_, energy_, out);
      return;
    }
    const auto modes = basis_modes(model_, parabola(record.cable).irvine_lambda2);
    assemble(model_, record, modes, potential_of(model_, modes), out);
  }

 private:
  CableModel model_;
  std::vector<Lens> lenses_;
  std::vector<BasisMode<double>> modes_;
  Potential<double> energy_;
  bool cable_moves_ = false;
};

}  // namespace

ParametricSystem cable_system(const CableModel& model, const std::vector<Lens>& lenses) {
  model.validate();
  std::vector<std::string> names;
  Vector reference(static_cast<Eigen::Index>(lenses.size()));
  for (const auto& lens : lenses) {
    reference[static_cast<Eigen::Index>(names.size())] = lens.get(model.stay);
    names.push_back(lens.name());
  }
  return ParametricSystem(CableMaker(model, lenses), std::move(names), std::move(reference));
}

ModalSystem<double> cable_equations(const CableModel& model) {
  ModalSystem<double> system;
  cable_system(model, {}).at(std::span<const double>(), system);
  return system;
}

}  // namespace whirl::models
