#include "models/shallow/resonances.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace whirl::models::shallow {
namespace {

bool in_plane(const ModeShape& m) { return m.family() != Family::out_of_plane; }

// int phi_a' phi_b' of one plane: zero for sines of different half waves and for different symmetry.
bool stretch_couples(const ModeShape& a, const ModeShape& b) {
  if (in_plane(a) != in_plane(b)) return false;
  if (a.half_waves() == b.half_waves()) return true;
  return a.family() == Family::symmetric && b.family() == Family::symmetric;
}

void add_external(const ModeShape& m, const ResonanceOptions& o, std::vector<Resonance>& list) {
  const auto add = [&](ResonanceKind kind, const std::string& condition, double at, bool driven) {
    list.push_back({kind, condition, m.name(), "", at, o.omega > 0.0 ? o.omega / at - 1.0 : std::numeric_limits<double>::quiet_NaN(), driven});
  };
  add(ResonanceKind::primary, fmt::format("omega = w({})", m.name()), m.omega(), in_plane(m));
  add(ResonanceKind::parametric, fmt::format("omega = 2 w({})", m.name()), 2.0 * m.omega(), true);
  for (int n = 2; n <= o.superharmonics; ++n)
    add(ResonanceKind::superharmonic, fmt::format("omega = w({})/{}", m.name(), n), m.omega() / n, in_plane(m));
}

void add_pair(const ModeShape& a, const ModeShape& b, const ResonanceOptions& o, std::vector<Resonance>& list) {
  if (stretch_couples(a, b)) {
    const double at = a.omega() + b.omega();
    list.push_back({ResonanceKind::combination, fmt::format("omega = w({}) + w({})", a.name(), b.name()), a.name(), b.name(), at,
                    o.omega > 0.0 ? o.omega / at - 1.0 : std::numeric_limits<double>::quiet_NaN(), true});
  }
  const auto internal = [&](const ModeShape& slow, const ModeShape& fast, int n, bool coupled) {
    const double detuning = n * slow.omega() / fast.omega() - 1.0;
    if (std::abs(detuning) <= o.tolerance)
      list.push_back({ResonanceKind::internal,
                      n == 1 ? fmt::format("w({}) = w({})", slow.name(), fast.name()) : fmt::format("2 w({}) = w({})", slow.name(), fast.name()),
                      slow.name(), fast.name(), slow.omega(), detuning, coupled});
  };
  internal(a, b, 1, true);
  internal(a, b, 2, b.family() == Family::symmetric);
  internal(b, a, 2, a.family() == Family::symmetric);
}

}  // namespace

const char* to_string(ResonanceKind kind) {
  switch (kind) {
    case ResonanceKind::primary:
      return "primary";
    case ResonanceKind::superharmonic:
      return "superharmonic";
    case ResonanceKind::parametric:
      return "parametric";
    case ResonanceKind::combination:
      return "combination";
    case ResonanceKind::internal:
      return "internal";
  }
  return "";
}

void ResonanceOptions::validate() const {
  if (!(tolerance > 0.0)) throw std::invalid_argument(fmt::format("the tolerance of resonances must be > 0, got {}", tolerance));
  if (!(omega >= 0.0)) throw std::invalid_argument(fmt::format("omega must be >= 0, got {}", omega));
}

std::vector<Resonance> resonances(const std::vector<ModeShape>& modes, const ResonanceOptions& options) {
  options.validate();
  std::vector<Resonance> list;
  for (std::size_t i = 0; i < modes.size(); ++i) {
    add_external(modes[i], options, list);
    for (std::size_t k = i + 1; k < modes.size(); ++k) add_pair(modes[i], modes[k], options, list);
  }
  const bool judged = options.omega > 0.0;
  if (judged) std::erase_if(list, [&](const Resonance& r) { return !(std::abs(r.detuning) <= options.tolerance); });
  std::stable_sort(list.begin(), list.end(), [judged](const Resonance& a, const Resonance& b) {
    const bool ia = a.kind == ResonanceKind::internal, ib = b.kind == ResonanceKind::internal;
    if (ia != ib) return ib;
    return judged || ia ? std::abs(a.detuning) < std::abs(b.detuning) : a.at < b.at;
  });
  return list;
}

}  // namespace whirl::models::shallow
