#include "studies/orbit_seeds.hpp"

#include <random>

#include "continuation/deflation.hpp"
#include "core/parallel.hpp"
#include "studies/run_context.hpp"

namespace whirl::studies {

using namespace models;

namespace {

constexpr int coarse_harmonics = 4;  // per excitation period, of the balance in which deflation looks for further motions
constexpr int random_starts = 3;     // of deflation, beside the averaged states that lead nowhere
constexpr double same = 1e-6;        // of two motions, relative to the larger
constexpr double rest = 1e-8;        // of a motion that is none, relative to the largest known
constexpr NewtonOptions few{.tolerance = 1e-11, .max_iterations = 40};

// Harmonics of a motion in units of omega/nu as start values of a balance.
Vector in_balance(const HarmonicBalance& hb, const Eigen::MatrixXcd& z, int nu, double p) {
  Vector u = Vector::Zero(hb.size() + 1);
  u[hb.size()] = p;
  for (int i = 0; i < hb.coordinates(); ++i)
    for (int h = 0; h < z.cols(); ++h) {
      if (h * hb.nu() % nu != 0) continue;
      const int k = h * hb.nu() / nu;
      if (k > hb.harmonics()) break;
      u[hb.index(i, k)] = z(i, h).real();
      if (k > 0) u[hb.index(i, k) + 1] = -z(i, h).imag();
    }
  return u;
}

// Does a motion of a doubled balance hold odd harmonics, which its repetition after half the time forbids?
bool of_full_period(const HarmonicBalance& hb, In u, double size) {
  double odd = 0.0;
  for (int i = 0; i < hb.coordinates(); ++i)
    for (int k = 1; k <= hb.harmonics(); k += 2) odd = std::max({odd, std::abs(u[hb.index(i, k)]), std::abs(u[hb.index(i, k) + 1])});
  return odd > same * size;
}

// Those of likely_resonances, and all multiples of 1/nu between 0 and 2.
ResonanceOptions orders(int nu) {
  ResonanceOptions o;
  for (int k = 1; k < 2 * nu; ++k)
    if (k % nu != 0) o.orders.push_back(static_cast<double>(k) / nu);
  return o;
}

}  // namespace

OrbitSeeds::OrbitSeeds(const ForcedSystem& source, std::vector<double> values, const Options& options)
    : values_(std::move(values)), options_(options), nu_(options.doubled ? 2 * options.nu : options.nu), states_(values_.size()) {
  std::map<std::pair<std::vector<int>, bool>, AveragedStates> averaged;
  for (std::size_t v = 0; v < values_.size() && !interrupted; ++v) {
    const ModalSystem<double> system = source.at(Vector::Constant(1, values_[v]));
    for (const auto& harmonics : likely_resonances(system, nu_, orders(options_.nu)))
      for (const bool second_order : {false, true}) {
        const AveragedStateOptions o{.second_order = second_order};
        auto at = averaged.try_emplace({harmonics, second_order}, nu_, harmonics, o).first;
        for (auto& z : at->second.solve(system)) states_[v].push_back(std::move(z));
      }
  }
}

bool OrbitSeeds::alike(const Problem& f, In a, In b, double size) {
  const int n = f.size();
  const double limit = std::max(same * std::max(a.head(n).norm(), b.head(n).norm()), rest * size);
  const std::size_t subsets = std::size_t{1} << f.reflections().size();
  for (std::size_t subset = 0; subset < subsets; ++subset) {
    Vector image = b.head(n);
    for (std::size_t r = 0; r < f.reflections().size(); ++r)
      if (subset >> r & 1) image.array() *= f.reflections()[r].signs.array();
    if ((a.head(n) - image).norm() <= limit) return true;
  }
  return false;
}

std::vector<Vector> OrbitSeeds::motions(const HarmonicBalance& hb, int i) const {
  std::vector<Vector> found;
  if (hb.nu() != options_.nu && hb.nu() != 2 * options_.nu) return found;
  const auto& states = states_[static_cast<std::size_t>(i)];
  double size = hb.linear_response(Vector::Constant(1, value(i))).head(hb.size()).norm();
  for (const auto& z : states) size = std::max(size, z.norm());
  const auto add_to = [&](std::vector<Vector>& list, const Vector& u) {
    if (hb.nu() != options_.nu && !of_full_period(hb, u, size)) return;
    if (std::none_of(list.begin(), list.end(), [&](const Vector& other) { return alike(hb, other, u, size); })) list.push_back(u);
  };
  const auto add = [&](const Vector& u) { add_to(found, u); };
  std::vector<Vector> starts;
  for (const auto& z : states) add_to(starts, in_balance(hb, z, nu_, value(i)));
  std::vector<Vector> lost;  // starts that Newton's method leads nowhere
  for (const auto& start : starts) {
    const NewtonResult at = newton(hb, start);
    if (at.ok()) add(at.x);
    else lost.push_back(start);
  }
  if (hb.coordinates() > options_.deflated_up_to) return found;
  for (const Vector& u : deflated(hb, found, lost, value(i))) {
    const NewtonResult at = newton(hb, u);
    if (at.ok()) add(at.x);
  }
  return found;
}

// What a balance of few harmonics has beside the motions known, as start values of hb.
std::vector<Vector> OrbitSeeds::deflated(const HarmonicBalance& hb, const std::vector<Vector>& known, std::vector<Vector> starts, double p) const {
  const int harmonics = std::min(coarse_harmonics * hb.nu(), hb.harmonics());
  auto& coarse = coarse_[hb.nu()];
  if (!coarse || coarse->harmonics() != harmonics) coarse = std::make_unique<HarmonicBalance>(hb.with_harmonics(harmonics));
  const Vector linear = hb.linear_response(Vector::Constant(1, p));
  double size = linear.head(hb.size()).lpNorm<Eigen::Infinity>();
  for (const auto& u : known) size = std::max(size, u.head(hb.size()).lpNorm<Eigen::Infinity>());
  if (!(size > 0.0)) size = 1.0;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> entry(-size, size);
  for (int k = 0; k < random_starts; ++k) {
    Vector u = linear;
    for (int q = 0; q < hb.coordinates(); ++q)
      for (int h = 1; h <= 2 * hb.nu() && h <= hb.harmonics(); ++h)
        for (const int part : {0, 1}) u[hb.index(q, h) + part] += entry(random);
    starts.push_back(u);
  }
  std::vector<Vector> solved;
  for (const auto& u : known)
    if (const NewtonResult at = newton(*coarse, coarse->carry(hb, u)); at.ok()) solved.push_back(at.x);
  for (auto& u : starts) u = coarse->carry(hb, u);
  const std::size_t first = solved.size();
  std::vector<Vector> further;
  const auto all = continuation::deflated_solutions(*coarse, solved, starts, {.newton = few, .scale = size});
  for (std::size_t k = first; k < all.size(); ++k) further.push_back(hb.carry(*coarse, all[k]));
  return further;
}

}  // namespace whirl::studies
