#pragma once
/// All branches that can be reached: from seeds, and from every branch point up to a depth. Each branch once, mirror images told, not recomputed.
/// Images under other symmetries of a small flow (symmetries.hpp) are branches of their own, copied, not walked.
///
///     Network net(problem, {.walk = {.lower = 1.2, .upper = 2.4}, .depth = 2});
///     net.add_seed(u0, "start");       // walked unless it lies on a known branch
///     net.switch_branches();
///     for (const Branch& b : net.branches()) ...

#include <memory>
#include <optional>

#include "continuation/membership.hpp"
#include "continuation/symmetries.hpp"
#include "continuation/walker.hpp"
#include "core/newton.hpp"

namespace whirl::continuation {

struct NetworkOptions {
  WalkOptions walk;
  int depth = 2;          ///< branch points of branches of this generation and older are switched at; seeds are generation 0
  int max_branches = 64;  ///< walked
  int max_images = 512;   ///< copied beside them
  double same = 1e-6;     ///< two solutions are one if they differ by less, in units of the range and of the largest |x|; see membership.hpp
};

class Network {
 public:
  using Namer = std::function<std::string(const Branch&)>;  ///< a prefix; the running number is added

  Network(const Problem& problem, NetworkOptions options);

  void set_namer(Namer namer) { namer_ = std::move(namer); }
  void set_observer(Observer observer) { observer_ = std::move(observer); }
  /// Called with each branch when it is complete.
  void on_branch(std::function<void(const Branch&)> f) { on_branch_ = std::move(f); }

  /// Called where a branch ends on a more symmetric one; true: somebody else follows that one.
  void on_landing(std::function<bool(const SpecialPoint&, const std::string& origin)> f) { on_landing_ = std::move(f); }

  /// Walks both ways from u0 unless it or a mirror image lies on a known branch; false if nothing new came of it. Tells isolas: a seed whose
  /// branch is closed and was reached from nowhere. Where Newton finds no solution that is noted.
  bool add_seed(const Vector& u0, const std::string& origin);
  /// A branch point known from elsewhere (a period doubling of the undoubled problem) to switch at.
  void add_branch_point(const SpecialPoint& point, const std::string& origin);
  /// Follows what leaves the branch points met so far, and theirs, up to the depth; and, at any depth, the symmetric branches on which others end.
  void switch_branches();

  const std::vector<Branch>& branches() const { return branches_; }
  /// Branch points, "B3:BP1", that lie too deep or beyond max_branches and that no branch found leaves.
  std::vector<std::string> not_followed() const;
  /// What else the search leaves open, a sentence each.
  const std::vector<std::string>& notes() const { return notes_; }
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
    bool done = false;     // some branch already leaves here
    bool landing = false;  // the branch ends here on a more symmetric one
  };
  void adopt(Branch branch, int generation);
  void note(const std::string& text);
  MembershipOptions membership(double accuracy) const;
  void name(Branch& branch) const;
  void publish(Branch branch);
  void add_images(const Branch& original);
  bool is_solution(const Branch& branch) const;
  const std::vector<SignedPermutation>& group();
  bool full() const { return static_cast<int>(branches_.size()) - images_ >= options_.max_branches; }
  enum class Seed { walked, known, no_solution };
  Seed walk_seed(const Vector& u0, const std::string& origin, int generation);
  void follow_landing(const Junction& junction);
  void leave(const Junction& junction);
  NewtonResult solve(const Vector& start, const NewtonOptions& options) const;
  double unit_at(const Vector& u) const;
  Vector regular_start(const Vector& u0) const;
  Vector inside(Vector u) const;
  bool on_as_symmetric_branch(In u) const;
  bool repeats(const Branch& branch) const;
  bool same_up_to_mirror(In a, In b) const;

  const Problem& problem_;
  NetworkOptions options_;
  Namer namer_;
  Observer observer_;
  std::function<void(const Branch&)> on_branch_;
  std::function<bool(const SpecialPoint&, const std::string&)> on_landing_;
  std::vector<Vector> mirrors_;  // signs of all mirror images, the identity first
  std::vector<Branch> branches_;
  std::vector<BranchShape> shapes_;  // of branches_
  double size_ = 0.0;                // largest |x| on any branch
  std::vector<Junction> junctions_;
  std::vector<std::string> notes_;
  std::optional<std::vector<SignedPermutation>> group_;  // once asked for
  int images_ = 0;                                       // among the branches
  bool stopped_ = false;
};

}  // namespace whirl::continuation
