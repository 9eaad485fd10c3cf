#include "studies/extremes.hpp"

#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <optional>

namespace whirl::studies {
namespace {

using Complex = std::complex<double>;

struct Value {
  double q, slope, bend;  // q, q', q''
};

Value value_at(std::span<const Complex> z, double t) {
  Value v{0.0, 0.0, 0.0};
  const Complex turn = std::polar(1.0, t);
  Complex wave = 1.0;
  for (std::size_t k = 0; k < z.size(); ++k, wave *= turn) {
    const Complex w = z[k] * wave;
    const auto n = static_cast<double>(k);
    v.q += w.real();
    v.slope -= n * w.imag();
    v.bend -= n * n * w.real();
  }
  return v;
}

// From the sample nearest to it; never beyond its neighbours.
double polished(std::span<const Complex> z, double t, double spacing) {
  constexpr int most = 8;
  const double from = t;
  for (int i = 0; i < most; ++i) {
    const Value v = value_at(z, t);
    if (v.bend == 0.0) break;
    t = std::clamp(t - v.slope / v.bend, from - spacing, from + spacing);
  }
  return value_at(z, t).q;
}

// Extremes of the point last asked about: three columns want those of each coordinate.
class ExtremesOfPoint {
 public:
  ExtremesOfPoint(std::size_t coordinates, std::function<std::vector<Complex>(In, int)> harmonics)
      : harmonics_(std::move(harmonics)), known_(coordinates) {}
  const Extremes& at(In u, int coordinate) {
    if (point_.size() != u.size() || point_ != u) {
      point_ = u;
      known_.assign(known_.size(), std::nullopt);
    }
    auto& known = known_[static_cast<std::size_t>(coordinate)];
    if (!known) known = extremes_of(harmonics_(u, coordinate));
    return *known;
  }

 private:
  std::function<std::vector<Complex>(In, int)> harmonics_;
  std::vector<std::optional<Extremes>> known_;
  Vector point_;
};

}  // namespace

Extremes extremes_of(std::span<const Complex> z) {
  constexpr std::size_t samples_a_wave = 16;  // of the fastest: each extreme has a sample within 1/32 of it
  const std::size_t count = samples_a_wave * std::max<std::size_t>(z.size(), 2);
  const double spacing = 2.0 * std::numbers::pi / static_cast<double>(count);
  std::size_t top = 0, bottom = 0;
  double highest = -HUGE_VAL, lowest = HUGE_VAL;
  for (std::size_t m = 0; m < count; ++m) {
    const double q = value_at(z, static_cast<double>(m) * spacing).q;
    if (q > highest) highest = q, top = m;
    if (q < lowest) lowest = q, bottom = m;
  }
  const double polished_top = polished(z, static_cast<double>(top) * spacing, spacing),
               polished_bottom = polished(z, static_cast<double>(bottom) * spacing, spacing);
  return {std::max(highest, polished_top), std::min(lowest, polished_bottom)};
}

std::vector<PointColumn> extreme_columns(const std::vector<std::string>& coordinates, const std::string& unit, const std::string& what,
                                         std::function<std::vector<Complex>(In, int)> harmonics) {
  const auto at = std::make_shared<ExtremesOfPoint>(coordinates.size(), std::move(harmonics));
  std::vector<PointColumn> columns;
  for (std::size_t c = 0; c < coordinates.size(); ++c) {
    const std::string& q = coordinates[c];
    const auto add = [&](const char* name, const std::string& description, auto value) {
      columns.push_back({q + name, unit, description + what, [at, c, value](In u) { return value(at->at(u, static_cast<int>(c))); }});
    };
    add("_max", fmt::format("largest |{}| over the period", q), [](const Extremes& e) { return e.largest(); });
    add("_crest", fmt::format("largest {} over the period, with its sign", q), [](const Extremes& e) { return e.highest; });
    add("_trough", fmt::format("least {} over the period, with its sign", q), [](const Extremes& e) { return e.lowest; });
  }
  return columns;
}

std::vector<PointColumn> extreme_columns(const models::SuperharmonicFlow& flow, int order) {
  return extreme_columns({"q1", "q2"}, "m", " (averaged)", [&flow, order](In u, int coordinate) {
    const models::Superharmonic o = flow.observe(u);
    std::vector<Complex> z(static_cast<std::size_t>(order) + 1);
    z.back() = coordinate == 0 ? std::polar(o.A, o.Psi1) : std::polar(o.B, o.Psi2);
    if (coordinate == 1) z[1] += std::polar(o.B0, o.Psi0);
    return z;
  });
}

}  // namespace whirl::studies
