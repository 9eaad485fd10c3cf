#include "models/slow_flow/ansatz.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

namespace whirl::models {
namespace {

constexpr int largest_denominator = 64;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

int denominator_of(double multiple) {
  for (int d = 1; d <= largest_denominator; ++d)
    if (std::abs(multiple * d - std::round(multiple * d)) < 1e-9 * d) return d;
  throw std::invalid_argument(fmt::format("harmonic {:g} is no fraction of omega with a denominator up to {}", multiple, largest_denominator));
}

using Flips = std::vector<bool>;

Flips flips_of(const CoordinateReflection& r, int n) {
  if (static_cast<int>(r.signs.size()) != n) throw std::invalid_argument(fmt::format("a reflection needs {} signs, got {}", n, r.signs.size()));
  Flips flips;
  for (const int s : r.signs) {
    if (std::abs(s) != 1) throw std::invalid_argument("the signs of a reflection are +1 or -1");
    flips.push_back(s < 0);
  }
  return flips;
}

// Do signs, and a shift by half the base period where asked for, leave every equation as it is?
// `as_it_is`: terms and forces that vanish in this system do not count; a model may list what no free parameter wakes.
bool symmetric(const ModalSystem<double>& system, int nu, const Flips& flips, bool shifted, bool as_it_is = false) {
  const auto odd = [&](int h) { return shifted && (h * nu) % 2 != 0; };
  for (const auto& t : system.terms) {
    bool sign = odd(t.cos_harmonic);
    for (int a = 0; a < t.degree; ++a) sign ^= flips[at(t.factor[at(a)])];
    if (sign != flips[at(t.equation)] && !(as_it_is && t.coefficient == 0.0)) return false;
  }
  return std::all_of(system.forces.begin(), system.forces.end(),
                     [&](const auto& f) { return odd(f.harmonic) == flips[at(f.equation)] || (as_it_is && f.amplitude == 0.0); });
}

Vector signs_of(const Ansatz& ansatz, const Flips& flips, bool shifted) {
  Vector signs(ansatz.size());
  int row = 0;
  for (int i = 0; i < ansatz.coordinates(); ++i)
    for (const int k : ansatz.harmonics[at(i)])
      for (int part = 0; part < (k > 0 ? 2 : 1); ++part) signs[row++] = flips[at(i)] != (shifted && k % 2 != 0) ? -1.0 : 1.0;
  return signs;
}

}  // namespace

// ---- lists -----------------------------------------------------------------------------------------------------------------

Ansatz Ansatz::list(const std::vector<std::vector<double>>& multiples, bool frozen) {
  Ansatz a;
  a.frozen = frozen;
  for (const auto& coordinate : multiples)
    for (const double k : coordinate) a.nu = std::lcm(a.nu, denominator_of(k));
  for (const auto& coordinate : multiples) {
    a.harmonics.emplace_back();
    for (const double k : coordinate) a.harmonics.back().push_back(static_cast<int>(std::lround(k * a.nu)));
    std::sort(a.harmonics.back().begin(), a.harmonics.back().end());
  }
  a.validate();
  return a;
}

Ansatz Ansatz::complete(int coordinates, int harmonics, int nu) {
  if (harmonics < 1) throw std::invalid_argument(fmt::format("a complete ansatz needs at least one harmonic, got {}", harmonics));
  Ansatz a;
  a.nu = nu;
  std::vector<int> all(at(harmonics + 1));
  std::iota(all.begin(), all.end(), 0);
  a.harmonics.assign(at(coordinates), all);
  a.validate();
  return a;
}

Ansatz Ansatz::superharmonic(int coordinates, int order) {
  return list(std::vector<std::vector<double>>(at(coordinates), {static_cast<double>(order)}), true);
}

Ansatz Ansatz::combinatorial_coupled() { return list({{0.5, 1.5}, {0.0, 1.0, 2.0}}); }

Ansatz Ansatz::combinatorial_in_plane() { return list({{}, {0.5, 1.0, 1.5}}); }

void Ansatz::validate() const {
  if (nu < 1 || nu > largest_denominator) throw std::invalid_argument(fmt::format("nu must be in 1..{}, got {}", largest_denominator, nu));
  for (const auto& list : harmonics) {
    if (!list.empty() && list.front() < 0) throw std::invalid_argument("a harmonic must not be negative");
    if (std::adjacent_find(list.begin(), list.end(), std::greater_equal<>()) != list.end())
      throw std::invalid_argument("a list of harmonics must hold each of them once, ascending");
  }
  if (size() == 0) throw std::invalid_argument("an ansatz needs at least one harmonic");
  if (highest() > 2000) throw std::invalid_argument(fmt::format("the highest harmonic must not exceed 2000 omega/nu, got {}", highest()));
}

int Ansatz::width(int i) const {
  int n = 0;
  for (const int k : harmonics[at(i)]) n += k > 0 ? 2 : 1;
  return n;
}

int Ansatz::offset(int i) const {
  int n = 0;
  for (int j = 0; j < i; ++j) n += width(j);
  return n;
}

int Ansatz::size() const { return offset(coordinates()); }

int Ansatz::index(int i, int k) const {
  int row = offset(i);
  for (const int kept : harmonics[at(i)]) {
    if (kept == k) return row;
    row += kept > 0 ? 2 : 1;
  }
  return -1;
}

int Ansatz::highest() const {
  int k = 0;
  for (const auto& list : harmonics)
    if (!list.empty()) k = std::max(k, list.back());
  return k;
}

// ---- states ----------------------------------------------------------------------------------------------------------------

std::complex<double> amplitude(const Ansatz& ansatz, In x, int i, int k) {
  const int row = ansatz.index(i, k);
  if (row < 0) return 0.0;
  return {x[row], k > 0 ? x[row + 1] : 0.0};
}

Vector motion_at(const Ansatz& ansatz, In x, double omega, double t) {
  const int n = ansatz.coordinates();
  Vector y = Vector::Zero(2 * n);
  for (int i = 0; i < n; ++i)
    for (const int k : ansatz.harmonics[at(i)]) {
      const double speed = k * omega / ansatz.nu;
      const std::complex<double> z = amplitude(ansatz, x, i, k) * std::polar(1.0, speed * t);
      y[i] += z.real();
      y[n + i] -= speed * z.imag();
    }
  return y;
}

Vector linear_state(const Ansatz& ansatz, const ModalSystem<double>& system) {
  Vector x = Vector::Zero(ansatz.size());
  for (const auto& f : system.forces) {
    const int row = ansatz.index(f.equation, f.harmonic * ansatz.nu);
    if (row < 0) continue;
    const double speed = f.harmonic * system.omega;
    const std::complex<double> z =
        f.amplitude / std::complex<double>(system.stiffness[at(f.equation)] - speed * speed, system.damping[at(f.equation)] * speed);
    x[row] += z.real();
    if (f.harmonic > 0) x[row + 1] += z.imag();
  }
  return x;
}

Vector state_of(const Ansatz& ansatz, const SteadyMotion& motion) {
  if (motion.kind != MotionKind::periodic || ansatz.nu % motion.multiple != 0)
    throw std::invalid_argument(fmt::format("a motion over {} excitation periods is none over {}", motion.multiple, ansatz.nu));
  Vector x = Vector::Zero(ansatz.size());
  for (int i = 0; i < ansatz.coordinates(); ++i)
    for (const int k : ansatz.harmonics[at(i)]) {
      const std::complex<double> z = motion.harmonic(i, static_cast<double>(k) / ansatz.nu);
      const int row = ansatz.index(i, k);
      x[row] = z.real();
      if (k > 0) x[row + 1] = z.imag();
    }
  return x;
}

Vector balance_state(const Ansatz& ansatz, In x, int H) {
  const int width = 2 * H + 1;
  Vector out = Vector::Zero(ansatz.coordinates() * width);
  for (int i = 0; i < ansatz.coordinates(); ++i)
    for (const int k : ansatz.harmonics[at(i)]) {
      const std::complex<double> z = amplitude(ansatz, x, i, k);
      out[i * width + (k > 0 ? 2 * k - 1 : 0)] = z.real();
      if (k > 0) out[i * width + 2 * k] = -z.imag();
    }
  return out;
}

// ---- symmetries ------------------------------------------------------------------------------------------------------------

std::vector<Reflection> reflections_of(const Ansatz& ansatz, const ModalSystem<double>& system, const std::vector<CoordinateReflection>& given) {
  const int n = system.size();
  std::vector<Reflection> found;
  const auto add = [&](const Flips& flips, bool shifted, const std::string& subtype) {
    const Vector signs = signs_of(ansatz, flips, shifted);
    const bool known = std::any_of(found.begin(), found.end(), [&](const Reflection& r) { return r.signs == signs; });
    if (!known && signs.minCoeff() < 0.0) found.push_back({signs, subtype});
  };
  std::vector<Flips> group = {Flips(at(n), false)};  // of the coordinate reflections
  for (const auto& r : given) {
    const Flips flips = flips_of(r, n);
    if (!symmetric(system, ansatz.nu, flips, false, true))
      throw std::invalid_argument(fmt::format("the equations lack the reflection \"{}\"", r.subtype));
    add(flips, false, r.subtype);
    const std::size_t known = group.size();
    for (std::size_t i = 0; i < known && known < 8; ++i) {
      Flips product = group[i];
      for (int c = 0; c < n; ++c) product[at(c)] = product[at(c)] != flips[at(c)];
      group.push_back(product);
    }
  }
  // The shift by half a base period with some signs; all sign patterns are tried up to 12 coordinates.
  for (unsigned pattern = 0; pattern < (n <= 12 ? 1u << n : 1u); ++pattern) {
    Flips flips(at(n));
    for (int i = 0; i < n; ++i) flips[at(i)] = ((pattern >> i) & 1u) != 0;
    if (!symmetric(system, ansatz.nu, flips, true)) continue;
    for (const Flips& g : group) {
      Flips product = flips;
      for (int c = 0; c < n; ++c) product[at(c)] = product[at(c)] != g[at(c)];
      const bool alone = std::none_of(product.begin(), product.end(), [](bool f) { return f; });
      add(product, true, alone ? "PD" : "SB");
    }
    break;
  }
  return found;
}

}  // namespace whirl::models
