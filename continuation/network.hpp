#pragma once
/// All branches that can be reached: from seeds, and from every branch point up to a depth. Each branch once, mirror images told, not recomputed.
///
///     Network net(problem, {.walk = {.lower = 1.2, .upper = 2.4}, .depth = 2});
///     net.add_seed(u0, "start");       // walked unless it lies on a known branch
///     net.switch_branches();
///     for (const Branch& b : net.branches()) ...

#include <memory>

#include "continuation/walker.hpp"

namespace whirl::continuation {

struct NetworkOptions {
  WalkOptions walk;
  int depth = 2;  ///< branch points of branches of this generation and older are switched at; seeds are generation 0
  int max_branches = 64;
  double same = 1e-6;  ///< two solutions are one if they differ by less, relative to 1 + |x|
};

class Network {
 public:
  using Namer = std::function<std::string(const Branch&)>;  ///< a prefix; the running number is added

  Network(const Problem& problem, NetworkOptions options);

  void set_namer(Namer namer) { namer_ = std::move(namer); }
  void set_observer(Observer observer) { observer_ = std::move(observer); }
  /// Called with each branch when it is complete.
  void on_branch(std::function<void(const Branch&)> f) { on_branch_ = std::move(f); }

  /// Walks both ways from u0 unless it or a mirror image lies on a known branch; false if nothing new came of it. Tells isolas: a seed whose
  /// branch is closed and was reached from nowhere.
  bool add_seed(const Vector& u0, const std::string& origin);
  /// A branch point known from elsewhere (a period doubling of the undoubled problem) to switch at.
  void add_branch_point(const SpecialPoint& point, const std::string& origin);
  /// Follows what leaves the branch points met so far, and theirs, up to the depth.
  void switch_branches();

  const std::vector<Branch>& branches() const { return branches_; }
  /// Branch points, "B3:BP1", that lie too deep or beyond max_branches and that no branch found leaves.
  std::vector<std::string> not_followed() const;
  bool stopped() const { return stopped_; }
  /// Branch and solution at parameter value p nearest to u, if u (or a mirror image) is a solution known there.
  bool contains(In u) const;
  /// All solutions of known branches at parameter value p: (branch, u).
  std::vector<std::pair<int, Vector>> solutions_at(double p) const;
  /// Unstable directions on `branch` at its solution u, interpolated from the points around it.
  int unstable_at(int branch, In u) const;

 private:
  struct Junction {
    SpecialPoint point;
    int branch;          // on which it was found, -1: on none of this network
    std::string origin;  // "IP1:BP2"
    int generation;
    bool done = false;  // some branch already leaves or arrives here
  };
  void adopt(Branch branch, int generation);
  Vector regular_start(const Vector& u0) const;
  bool repeats(const Branch& branch) const;
  bool same_up_to_mirror(In a, In b) const;

  const Problem& problem_;
  NetworkOptions options_;
  Namer namer_;
  Observer observer_;
  std::function<void(const Branch&)> on_branch_;
  std::vector<Branch> branches_;
  std::vector<Junction> junctions_;
  bool stopped_ = false;
};

}  // namespace whirl::continuation
