#include "models/guy/longitudinal.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace whirl::models::guy {
namespace {

using std::numbers::pi;

void require_positive(const char* name, double v) {
  if (!(v > 0.0) || !std::isfinite(v)) throw std::invalid_argument(fmt::format("longitudinal motion: {} must be > 0, got {:g}", name, v));
}

}  // namespace

LongitudinalGuy::LongitudinalGuy(double length, double axial_stiffness, double mass, double alpha)
    : length_(length), stiffness_(alpha * axial_stiffness), mass_(mass), a_(std::sqrt(stiffness_ / mass)) {
  require_positive("length", length);
  require_positive("axial stiffness", axial_stiffness);
  require_positive("mass per length", mass);
  require_positive("alpha", alpha);
}

LongitudinalGuy::C LongitudinalGuy::wave_number(double p, double damping_rate) const {
  require_positive("frequency", p);
  if (!(damping_rate >= 0.0)) throw std::invalid_argument(fmt::format("longitudinal motion: damping rate must be >= 0, got {:g}", damping_rate));
  return std::sqrt(C(p * p, -p * damping_rate)) / a_;
}

LongitudinalGuy::C LongitudinalGuy::force_driven(double force, double s, double p, double damping_rate) const {
  const C k = wave_number(p, damping_rate);
  return force / stiffness_ * std::sin(k * s) / (k * std::cos(k * length_));
}

LongitudinalGuy::C LongitudinalGuy::displacement_driven(double motion, double s, double p, double damping_rate) const {
  const C k = wave_number(p, damping_rate);
  return motion * std::sin(k * s) / std::sin(k * length_);
}

// Modes sin((2i - 1) pi s / 2L), modal mass m L/2, force F sin((2i - 1) pi/2).
LongitudinalGuy::C LongitudinalGuy::force_driven_series(double force, double s, double p, double damping_rate, int terms) const {
  const C pe = wave_number(p, damping_rate) * a_;
  C sum = 0.0;
  for (int i = 1; i <= terms; ++i) {
    const double w = free_frequency(i), sign = i % 2 == 1 ? 1.0 : -1.0;
    sum += sign * std::sin(w / a_ * s) / (w * w - pe * pe);
  }
  return 2.0 * force / (mass_ * length_) * sum;
}

LongitudinalGuy::C LongitudinalGuy::displacement_driven_series(double motion, double s, double p, double damping_rate, int terms) const {
  const C pe = wave_number(p, damping_rate) * a_;
  C sum = 0.0;
  for (int i = 1; i <= terms; ++i) {
    const double w = held_frequency(i), sign = i % 2 == 1 ? -1.0 : 1.0;
    sum += sign * std::sin(w / a_ * s) / (static_cast<double>(i) * (w * w - pe * pe));
  }
  return motion * (s / length_ - 2.0 * pe * pe / pi * sum);
}

LongitudinalGuy::C LongitudinalGuy::magnification_of_displacement(double p, double damping_rate) const {
  const C X = wave_number(p, damping_rate) * length_;
  return std::tan(X) / X;
}

LongitudinalGuy::C LongitudinalGuy::magnification_of_force(double p, double damping_rate) const {
  const C X = wave_number(p, damping_rate) * length_;
  return X / std::tan(X);
}

LongitudinalGuy::C LongitudinalGuy::stiffness(double p, double damping_rate) const {
  return stiffness_ / length_ * magnification_of_force(p, damping_rate);
}

double LongitudinalGuy::free_frequency(int i) const { return (i - 0.5) * pi * a_ / length_; }
double LongitudinalGuy::held_frequency(int i) const { return i * pi * a_ / length_; }

}  // namespace whirl::models::guy
