#include "continuation/orbit_network.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "continuation/period_doubling.hpp"
#include "core/newton.hpp"

namespace whirl::continuation {

namespace {

// A branch of doubled period ends at `point` on one of f: a seed there, unless known, beside the doubling itself.
void follow_undoubled(const OrbitProblem& f, Network& net, const WalkOptions& range, const SpecialPoint& point, const std::string& origin) {
  const Vector at = f.from_doubled(point.u);
  for (const double part : {1e-3, -1e-3, 0.0}) {
    Vector beside = at;
    double& p = beside[f.size()];
    p += part * (range.upper - range.lower);
    if (p < range.lower || p > range.upper) continue;
    const NewtonResult start = newton(f, beside, {.tolerance = 1e-12, .max_iterations = 30});
    if (!start.ok()) continue;
    (void)net.add_seed(start.x, origin);
    return;
  }
}

}  // namespace

OrbitNetwork::OrbitNetwork(const OrbitProblem& orbit, const NetworkOptions& options, int period_doublings) {
  if (period_doublings < 0 || period_doublings > 6)
    throw std::invalid_argument(fmt::format("period_doublings must be in 0..6, got {}", period_doublings));
  problems_.push_back(&orbit);
  for (int i = 0; i < period_doublings; ++i) problems_.push_back(&problems_.back()->doubled());
  for (const auto* problem : problems_) networks_.push_back(std::make_unique<Network>(*problem, options));
  passed_.assign(networks_.size(), 0);
  for (std::size_t level = 1; level < networks_.size(); ++level)
    networks_[level]->on_landing(
        [&f = *problems_[level - 1], &below = *networks_[level - 1], range = options.walk](const SpecialPoint& point, const std::string& origin) {
          if (point.subtype != period_doubling_subtype) return false;
          follow_undoubled(f, below, range, point, origin);
          return true;
        });
}

void OrbitNetwork::set_namer(const Namer& namer) {
  for (int i = 0; i < levels(); ++i) networks_[static_cast<std::size_t>(i)]->set_namer([namer, i](const Branch& b) { return namer(b, i); });
}

void OrbitNetwork::set_observer(const Observer& observer) {
  for (auto& net : networks_) net->set_observer(observer);
}

void OrbitNetwork::on_branch(const std::function<void(const Branch&, int)>& f) {
  for (int i = 0; i < levels(); ++i) networks_[static_cast<std::size_t>(i)]->on_branch([f, i](const Branch& b) { f(b, i); });
}

bool OrbitNetwork::stopped() const {
  return std::any_of(networks_.begin(), networks_.end(), [](const auto& net) { return net->stopped(); });
}

std::vector<std::string> OrbitNetwork::notes() const {
  std::vector<std::string> all;
  for (const auto& net : networks_) all.insert(all.end(), net->notes().begin(), net->notes().end());
  return all;
}

bool OrbitNetwork::add_seed(const Vector& u0, const std::string& origin, int level) {
  return networks_.at(static_cast<std::size_t>(level))->add_seed(u0, origin);
}

void OrbitNetwork::switch_branches() {
  for (std::size_t known = branches() + 1; known != branches() && !stopped();) {  // a level may find what starts branches of the one below
    known = branches();
    for (int level = 0; level < levels() && !stopped(); ++level) {
      networks_[static_cast<std::size_t>(level)]->switch_branches();
      if (level + 1 < levels()) pass_on(level);
    }
  }
}

std::size_t OrbitNetwork::branches() const {
  std::size_t count = 0;
  for (const auto& net : networks_) count += net->branches().size();
  return count;
}

void OrbitNetwork::pass_on(int level) {
  const auto at = static_cast<std::size_t>(level);
  const auto& branches = networks_[at]->branches();
  for (; passed_[at] < branches.size(); ++passed_[at]) {
    const Branch& b = branches[passed_[at]];
    int number = 0;
    for (const auto& s : b.special) {
      if (s.type != EventType::period_doubling) continue;
      ++number;
      if (const auto bp = period_doubling_near(problem(level), s.u, s.block))
        networks_[at + 1]->add_branch_point(*bp, fmt::format("{}:PD{}", b.name, number));
    }
  }
}

}  // namespace whirl::continuation
