#include "continuation/multiplier_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>

namespace whirl::continuation {

namespace {
constexpr double pi = std::numbers::pi, two_pi = 2.0 * pi;
}

double folded(double angle) {
  const double rest = std::abs(std::remainder(angle, two_pi));
  return std::min(rest, pi);
}

double unfolded(double image, double near, bool& turned) {
  const double turns = two_pi * std::round(near / two_pi), rest = near - turns;  // in [-pi, pi]
  const double candidates[] = {image, -image, two_pi - image, image - two_pi};
  double best = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 4; ++k) {
    if (!(std::abs(candidates[k] - rest) < std::abs(best - rest))) continue;
    best = candidates[k];
    turned = k == 1 || k == 2;
  }
  return turns + best;
}

void MultiplierPairs::list(const Eigen::VectorXcd& multipliers, const Eigen::VectorXi& group, std::vector<MultiplierPair>& pairs) {
  pairs.clear();
  real_.clear();
  for (Eigen::Index i = 0; i < multipliers.size(); ++i) {
    const std::complex<double> mu = multipliers[i];
    const double log = std::log(std::abs(mu));
    if (mu.imag() > 0.0 && log > least_growth) pairs.push_back({.group = group[i], .growth = log, .angle = std::arg(mu)});
    if (mu.imag() == 0.0 && log > 2.0 * least_growth) real_.push_back({group[i], mu.real() < 0.0, log});
  }
  const auto key = [](const Real& r) { return std::tuple(r.group, r.negative, r.log); };
  std::sort(real_.begin(), real_.end(), [&](const Real& a, const Real& b) { return key(a) < key(b); });
  // Real pairs that left the same circle stand one within the other: the largest belongs to the smallest.
  for (std::size_t first = 0, last = 0; first < real_.size(); first = last) {
    while (last < real_.size() && real_[last].group == real_[first].group && real_[last].negative == real_[first].negative) ++last;
    for (std::size_t i = first, j = last; i + 1 < j; ++i) {
      const Real &small = real_[i], &large = real_[--j];
      const double growth = 0.5 * (small.log + large.log);
      if (growth > least_growth)
        pairs.push_back({.group = small.group, .growth = growth, .angle = small.negative ? pi : 0.0, .split = 0.5 * (large.log - small.log)});
    }
  }
  std::sort(pairs.begin(), pairs.end(), [](const auto& a, const auto& b) { return std::tie(a.group, a.angle) < std::tie(b.group, b.angle); });
}

// In order of size, which is the assignment with the least sum of distances; one by one to the nearest where the numbers differ.
void MultiplierPairs::match(const std::vector<MultiplierPair>& pairs, int first, int last) {
  std::sort(expected_.begin(), expected_.end(), [](const Place& a, const Place& b) { return a.angle < b.angle; });
  matched_.assign(expected_.size(), -1);
  const auto count = static_cast<std::size_t>(last - first);
  if (expected_.size() == count) {
    for (std::size_t k = 0; k < count; ++k) matched_[k] = first + static_cast<int>(k);
    return;
  }
  taken_.assign(count, false);
  for (std::size_t round = 0; round < std::min(count, expected_.size()); ++round) {
    double least = std::numeric_limits<double>::infinity();
    std::size_t best = 0;
    int at = first;
    for (std::size_t k = 0; k < expected_.size(); ++k)
      for (int i = first; i < last && matched_[k] < 0; ++i) {
        const double distance = std::abs(pairs[static_cast<std::size_t>(i)].angle - expected_[k].angle);
        if (taken_[static_cast<std::size_t>(i - first)] || distance >= least) continue;
        least = distance;
        best = k;
        at = i;
      }
    matched_[best] = at;
    taken_[static_cast<std::size_t>(at - first)] = true;
  }
}

void MultiplierPairs::follow(const std::vector<MultiplierPair>& from, double stretch, std::vector<MultiplierPair>& to) {
  for (auto& pair : to) pair.from = -1;
  for (std::size_t a = 0, b = 0; a < from.size() && b < to.size();) {
    const int group = std::min(from[a].group, to[b].group);
    expected_.clear();
    for (; a < from.size() && from[a].group == group; ++a)
      expected_.push_back({folded(from[a].angle + stretch * from[a].last_turn), static_cast<int>(a)});
    const std::size_t first = b;
    while (b < to.size() && to[b].group == group) ++b;
    match(to, static_cast<int>(first), static_cast<int>(b));
    for (std::size_t k = 0; k < expected_.size(); ++k) {
      if (matched_[k] < 0) continue;
      const MultiplierPair& old = from[static_cast<std::size_t>(expected_[k].index)];
      MultiplierPair& now = to[static_cast<std::size_t>(matched_[k])];
      bool turned = false;
      now.from = expected_[k].index;
      now.reached = unfolded(now.angle, old.angle + stretch * old.last_turn, turned);
      now.last_turn = (turned ? -1.0 : 1.0) * (now.reached - old.angle);
    }
  }
}

int MultiplierPairs::find(std::span<const double> expected, std::size_t which, int group, const std::vector<MultiplierPair>& pairs) {
  expected_.clear();
  for (std::size_t k = 0; k < expected.size(); ++k) expected_.push_back({folded(expected[k]), static_cast<int>(k)});
  const auto in_group = [&](const MultiplierPair& p) { return p.group == group; };
  const auto first = std::find_if(pairs.begin(), pairs.end(), in_group), last = std::find_if_not(first, pairs.end(), in_group);
  match(pairs, static_cast<int>(first - pairs.begin()), static_cast<int>(last - pairs.begin()));
  for (std::size_t k = 0; k < expected_.size(); ++k)
    if (expected_[k].index == static_cast<int>(which)) return matched_[k];
  return -1;
}

}  // namespace whirl::continuation
