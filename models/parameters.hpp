#pragma once
/// The parameter record of a stay under support motion, and the lens that picks entries of it as continuation parameters.
///
/// One list of fields (`fields`) feeds the TOML reader, `whirl init`, the HDF5 writer and the lens names.
/// SI units; angles in degrees where the name says `_deg`.
///
///     StayParameters<double> stay = ...;
///     Lens lens("support_motion.amplitude");              // or the short names omega, support_amplitude, damping, chord_tension, ...
///     auto d = lens.place<D>(stay, seed<D>(0.5, 0));      // the record in duals, one slope in the lens' direction

#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace whirl::models {

/// A cable between two supports. Static tension is given along the chord.
template <class S>
struct Cable {
  S chord_length;     ///< L [m]
  S axial_stiffness;  ///< AE [N]
  S chord_tension;    ///< T [N]
  S mass_per_length;  ///< mu [kg/m]
  S inclination_deg;  ///< theta, chord against the horizontal [deg]
  S gravity;          ///< g [m/s^2]
};

template <class S>
struct StayParameters {
  Cable<S> cable;
  S damping_out_of_plane;  ///< zeta1, ratio to critical
  S damping_in_plane;      ///< zeta2
  S support_amplitude;     ///< U [m], horizontal motion U cos(omega t) of the upper end
  S omega;                 ///< excitation frequency [rad/s]
};

/// What is known of one numeric entry besides its value. The accepted range is lower < value < upper, ends included where `closed_lower`.
struct Field {
  std::string_view name;  ///< dotted key of the study file
  std::string_view unit;
  std::string_view description;
  double default_value;  ///< NaN: the key is required
  double lower, upper;
  bool closed_lower;
  bool affects_cable;  ///< statics, modes and coefficients must be computed anew
  double example;      ///< what `whirl init` shows where there is no default: the Oresund stay
};

namespace detail {
inline constexpr double required = std::numeric_limits<double>::quiet_NaN();
inline constexpr double infinity = std::numeric_limits<double>::infinity();
}  // namespace detail

/// Visits (Field, reference) in a fixed order.
template <class Self, class Visit>
void fields(Self& s, Visit&& v) {
  using detail::infinity, detail::required;
  v(Field{"cable.chord_length", "m", "distance between the supports", required, 0.0, infinity, false, true, 260.0}, s.cable.chord_length);
  v(Field{"cable.axial_stiffness", "N", "axial stiffness AE", required, 0.0, infinity, false, true, 2.17e9}, s.cable.axial_stiffness);
  v(Field{"cable.chord_tension", "N", "static tension along the chord", required, 0.0, infinity, false, true, 5.5e6}, s.cable.chord_tension);
  v(Field{"cable.mass_per_length", "kg/m", "mass per unit length", required, 0.0, infinity, false, true, 81.05}, s.cable.mass_per_length);
  v(Field{"cable.inclination_deg", "deg", "inclination of the chord against the horizontal", 0.0, -90.0, 90.0, true, true, 30.4},
    s.cable.inclination_deg);
  v(Field{"cable.gravity", "m/s^2", "acceleration of gravity", 9.81, 0.0, infinity, true, true, 9.81}, s.cable.gravity);
  v(Field{"damping.out_of_plane", "-", "damping ratio of the out-of-plane mode", 0.01, 0.0, 1.0, true, false, 0.01}, s.damping_out_of_plane);
  v(Field{"damping.in_plane", "-", "damping ratio of the in-plane mode", 0.01, 0.0, 1.0, true, false, 0.01}, s.damping_in_plane);
  v(Field{"support_motion.amplitude", "m", "amplitude U of the support motion", required, 0.0, infinity, true, false, 0.5}, s.support_amplitude);
  v(Field{"omega", "rad/s", "excitation frequency", 1.0, 0.0, infinity, false, false, 1.65}, s.omega);
}

/// Picks one physical number (or, for `damping`, both ratios at once) of a StayParameters record as a continuation parameter.
class Lens {
 public:
  /// Throws std::invalid_argument naming the accepted names.
  explicit Lens(std::string_view name);

  const std::string& name() const { return name_; }  ///< as given
  std::string_view unit() const { return unit_; }
  bool affects_cable() const { return affects_cable_; }
  double get(const StayParameters<double>& record) const;
  /// The open or half-open range a field accepts.
  double lower() const { return lower_; }
  double upper() const { return upper_; }

  template <class S>
  void set(StayParameters<S>& record, const S& value) const {
    int i = 0;
    fields(record, [&](const Field&, S& entry) {
      for (int k : indices_)
        if (k == i) entry = value;
      ++i;
    });
  }

  static std::vector<std::string> names();

 private:
  std::string name_;
  std::string_view unit_;
  std::vector<int> indices_;
  bool affects_cable_ = false;
  double lower_ = 0.0, upper_ = 0.0;
};

/// The record in another scalar.
template <class S>
StayParameters<S> promote(const StayParameters<double>& r) {
  return {{S(r.cable.chord_length), S(r.cable.axial_stiffness), S(r.cable.chord_tension), S(r.cable.mass_per_length), S(r.cable.inclination_deg),
           S(r.cable.gravity)},
          S(r.damping_out_of_plane),
          S(r.damping_in_plane),
          S(r.support_amplitude),
          S(r.omega)};
}

}  // namespace whirl::models
