#include "models/multimode/cable_model.hpp"

#include <fmt/format.h>

#include <set>

#include "core/quadrature.hpp"
#include "models/multimode/potential_terms.hpp"

namespace whirl::models {
namespace {

constexpr int most_modes = 60, most_half_waves = 400;

void check_list(const char* name, const std::vector<int>& list) {
  std::set<int> seen;
  for (int k : list) {
    if (k < 1 || k > most_half_waves) throw std::invalid_argument(fmt::format("{}: half waves must be in 1..{}, got {}", name, most_half_waves, k));
    if (!seen.insert(k).second) throw std::invalid_argument(fmt::format("{}: mode {} stands there twice", name, k));
  }
}

// The moving end's displacement of unit amplitude: along the chord, across it (downwards), out of plane.
template <class S>
std::array<S, 3> direction_of(Direction direction, const S& inclination_deg) {
  using std::cos;
  using std::sin;
  const S theta = inclination_deg * (pi / 180.0), zero(0.0);
  switch (direction) {
    case Direction::horizontal:
      return {cos(theta), sin(theta), zero};
    case Direction::vertical:
      return {sin(theta), -cos(theta), zero};
    case Direction::chord:
      return {S(1.0), zero, zero};
    case Direction::normal:
      return {zero, S(1.0), zero};
    case Direction::out_of_plane:
      return {zero, zero, S(1.0)};
  }
  return {};
}

template <class T>
Potential<T> potential_of(const CableModel& model, const std::vector<BasisMode<T>>& modes) {
  const Direction d = model.direction;
  const bool in_plane = d != Direction::out_of_plane;
  const Moving moving{in_plane && d != Direction::normal, in_plane && d != Direction::chord, !in_plane};
  if (model.longitudinal == Longitudinal::galerkin) return galerkin_potential(modes, model.terms, model.shapes == Shapes::sines, moving);
  return quasi_static_potential(modes, model.terms, model.shapes == Shapes::sines, moving);
}

// AE, or AE/(1 + 8 r^2/3) where the tension is uniform: the stiffness in lambda2.
template <class S>
S stretching_rate(const CableModel& model, const Cable<S>& c, const Parabola<S>& shape) {
  const S K = stiffness_rate(c);
  return model.longitudinal == Longitudinal::galerkin ? K : K / (shape.sag_ratio * shape.sag_ratio * (8.0 / 3.0) + 1.0);
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

HalfChord::HalfChord(int highest_half_waves) {
  using Rule = boost::math::quadrature::gauss<double, 20>;
  const int panels = 1 + static_cast<int>(2.0 * pi * highest_half_waves / 20.0);
  for (int k = 0; k < panels; ++k) {
    const double width = 0.5 / panels, middle = (k + 0.5) * width;
    for (std::size_t i = 0; i < Rule::abscissa().size(); ++i)
      for (const double side : {-1.0, 1.0}) {
        xi.push_back(middle + 0.5 * width * side * Rule::abscissa()[i]);
        weight.push_back(width * Rule::weights()[i]);  // both halves
      }
  }
}

std::vector<int> lowest_half_waves(int count) {
  std::vector<int> list;
  for (int k = 1; k <= count; ++k) list.push_back(k);
  return list;
}

std::vector<std::string> CableModel::coordinates() const {
  std::vector<std::string> names;
  for (int k : out_of_plane) names.push_back(fmt::format("y{}", k));
  for (int k : in_plane) names.push_back(fmt::format("z{}", k));
  return names;
}

void CableModel::validate() const {
  check_list("out-of-plane modes", out_of_plane);
  check_list("in-plane modes", in_plane);
  if (size() < 1 || size() > most_modes) throw std::invalid_argument(fmt::format("a cable model has 1..{} modes, got {}", most_modes, size()));
  (void)check(stay.cable);
}

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

std::vector<CoordinateReflection> cable_reflections(const CableModel& model) {
  if (model.direction == Direction::out_of_plane || model.out_of_plane.empty()) return {};
  CoordinateReflection whirl{{}, "WH"};
  whirl.signs.assign(model.out_of_plane.size(), -1);
  whirl.signs.resize(static_cast<std::size_t>(model.size()), 1);
  return {whirl};
}

Vector shapes_at(const CableModel& model, double xi) {
  const auto modes = basis_modes(model, parabola(model.stay.cable).irvine_lambda2);
  Vector values(model.size());
  for (int a = 0; a < model.size(); ++a) values[a] = modes[static_cast<std::size_t>(a)].shape(xi);
  return values;
}

Displacement displacement(const CableModel& model, In q, double xi) {
  const Vector shapes = shapes_at(model, xi);
  const auto out = static_cast<Eigen::Index>(model.out_of_plane.size()), in = model.size() - out;
  return {shapes.tail(in).dot(q.segment(out, in)), shapes.head(out).dot(q.head(out))};
}

// AE times the strain averaged along the chord; the same in both treatments but for the square of the stretching itself.
double mean_tension(const CableModel& model, In q, double phase) {
  const auto& c = model.stay.cable;
  const auto shape = parabola(c);
  const auto modes = basis_modes(model, shape.irvine_lambda2);
  const SlopeIntegrals<double> I(modes);
  const auto direction = direction_of(model.direction, c.inclination_deg);
  const double e = model.stay.support_amplitude / c.chord_length * std::cos(phase) * (model.end == End::upper ? 1.0 : -1.0);
  double strain = e * direction[0] + 0.5 * e * e * (direction[1] * direction[1] + direction[2] * direction[2]);
  if (model.longitudinal == Longitudinal::galerkin) strain += 0.5 * e * e * direction[0] * direction[0];
  for (int a = 0; a < model.size(); ++a) {
    const auto& m = modes[static_cast<std::size_t>(a)];
    if (m.in_plane) strain += shape.sag_ratio * 8.0 * m.mean * q[a] / c.chord_length;
    for (int b = 0; b < model.size(); ++b)
      if (m.in_plane == modes[static_cast<std::size_t>(b)].in_plane && (m.half_waves + modes[static_cast<std::size_t>(b)].half_waves) % 2 == 0)
        strain += 0.5 * I.two(std::min(a, b), std::max(a, b)) * q[a] * q[b] / (c.chord_length * c.chord_length);
  }
  const double rate = stretching_rate(model, c, shape) / stiffness_rate(c);
  return c.chord_tension + c.axial_stiffness * rate * strain;
}

}  // namespace whirl::models
