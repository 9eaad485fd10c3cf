#pragma once
/// All branches of periodic motions that can be reached, those of doubled period included: at every period doubling the walk goes on in the doubled
/// problem, as often as asked.
///
///     OrbitNetwork net(orbit, {.walk = {.lower = 1.2, .upper = 2.4}}, 1);
///     net.add_seed(u0, "start");
///     net.switch_branches();
///     for (int level = 0; level < net.levels(); ++level)           // motions over 2^level times the period of `orbit`
///       for (const Branch& b : net.network(level).branches()) ...
///
/// Keeps a reference to the problem.

#include "continuation/network.hpp"
#include "core/orbit_problem.hpp"

namespace whirl::continuation {

class OrbitNetwork {
 public:
  using Namer = std::function<std::string(const Branch&, int level)>;

  OrbitNetwork(const OrbitProblem& orbit, const NetworkOptions& options, int period_doublings);

  void set_namer(const Namer& namer);
  void set_observer(const Observer& observer);
  void on_branch(const std::function<void(const Branch&, int level)>& f);

  /// u0: an unknown of `problem(level)`.
  bool add_seed(const Vector& u0, const std::string& origin, int level = 0);
  /// At every branch point up to the network's depth, at every period doubling up to the number asked for. Where a branch of doubled period ends on
  /// one of the undoubled that is not known yet, that one is followed too.
  void switch_branches();

  int levels() const { return static_cast<int>(networks_.size()); }
  const OrbitProblem& problem(int level) const { return *problems_[static_cast<std::size_t>(level)]; }
  const Network& network(int level) const { return *networks_[static_cast<std::size_t>(level)]; }
  std::vector<std::string> notes() const;  ///< of all levels, see Network::notes
  bool stopped() const;

 private:
  void pass_on(int level);  // period doublings of a level to the next
  std::size_t branches() const;
  std::vector<const OrbitProblem*> problems_;
  std::vector<std::unique_ptr<Network>> networks_;
  std::vector<std::size_t> passed_;  // branches of each level whose period doublings were passed on
};

}  // namespace whirl::continuation
