#include "models/multimode/cable_model.hpp"

#include <fmt/format.h>

#include <boost/math/quadrature/gauss.hpp>
#include <set>

#include "models/multimode/potential.hpp"
#include "models/multimode/support.hpp"

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
CableTension::CableTension(const CableModel& model) : pull_(Vector::Zero(model.size())), stretch_(Matrix::Zero(model.size(), model.size())) {
  const auto& c = model.stay.cable;
  const auto shape = parabola(c);
  const auto modes = basis_modes(model, shape.irvine_lambda2);
  const SlopeIntegrals<double> I(modes);
  const auto direction = direction_of(model.direction, c.inclination_deg);
  const double e = model.stay.support_amplitude / c.chord_length * (model.end == End::upper ? 1.0 : -1.0), L = c.chord_length;
  at_rest_ = c.chord_tension;
  stiffness_ = c.axial_stiffness * stretching_rate(model, c, shape) / stiffness_rate(c);
  along_ = e * direction[0];
  across_ = 0.5 * e * e * (direction[1] * direction[1] + direction[2] * direction[2]);
  if (model.longitudinal == Longitudinal::galerkin) across_ += 0.5 * e * e * direction[0] * direction[0];
  for (int b = 0; b < model.size(); ++b) {
    const auto& m = modes[static_cast<std::size_t>(b)];
    if (m.in_plane) pull_[b] = shape.sag_ratio * 8.0 * m.mean / L;
    for (int a = 0; a <= b; ++a) {
      const auto& other = modes[static_cast<std::size_t>(a)];
      if (m.in_plane == other.in_plane && (m.half_waves + other.half_waves) % 2 == 0) stretch_(a, b) = stretch_(b, a) = 0.5 * I.two(a, b) / (L * L);
    }
  }
}

double CableTension::operator()(In q, double phase) const {
  const double c = std::cos(phase);
  return at_rest_ + stiffness_ * (along_ * c + across_ * c * c + pull_.dot(q) + q.dot(stretch_ * q));
}

double mean_tension(const CableModel& model, In q, double phase) { return CableTension(model)(q, phase); }

}  // namespace whirl::models
