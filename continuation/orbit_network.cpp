#include "continuation/orbit_network.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "continuation/period_doubling.hpp"

namespace whirl::continuation {

OrbitNetwork::OrbitNetwork(const OrbitProblem& orbit, const NetworkOptions& options, int period_doublings) {
  if (period_doublings < 0 || period_doublings > 6)
    throw std::invalid_argument(fmt::format("period_doublings must be in 0..6, got {}", period_doublings));
  problems_.push_back(&orbit);
  for (int i = 0; i < period_doublings; ++i) problems_.push_back(&problems_.back()->doubled());
  for (const auto* problem : problems_) networks_.push_back(std::make_unique<Network>(*problem, options));
  passed_.assign(networks_.size(), 0);
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

bool OrbitNetwork::add_seed(const Vector& u0, const std::string& origin, int level) {
  return networks_.at(static_cast<std::size_t>(level))->add_seed(u0, origin);
}

void OrbitNetwork::switch_branches() {
  for (int level = 0; level < levels() && !stopped(); ++level) {
    networks_[static_cast<std::size_t>(level)]->switch_branches();
    if (level + 1 < levels()) pass_on(level);
  }
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
