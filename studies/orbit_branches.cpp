#include "studies/orbit_branches.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "continuation/period_doubling.hpp"
#include "core/kinsol.hpp"
#include "core/parallel.hpp"

namespace whirl::studies {

using namespace continuation;
using namespace models;

namespace {

constexpr int first_harmonics = 10;     // per excitation period of the motion
constexpr int truncation_samples = 16;  // points of a branch at which the truncation is measured, beside the special points

bool has(const HarmonicBalance& hb, const std::vector<int>& active, const std::string& subtype) {
  return std::any_of(active.begin(), active.end(), [&](int r) { return hb.reflections()[static_cast<std::size_t>(r)].subtype == subtype; });
}

bool keeps(const HarmonicBalance& hb, In u, const std::string& subtype) { return has(hb, active_reflections(hb, u.head(hb.size()), 1e-9), subtype); }

}  // namespace

OrbitBranches::OrbitBranches(ForcedSystem source, OrbitBranchOptions options, RunContext& context)
    : source_(std::move(source)),
      options_(std::move(options)),
      context_(context),
      harmonics_(options_.harmonics > 0 ? options_.harmonics : first_harmonics * options_.nu),
      check_(source_, options_.check) {}

const HarmonicBalance& OrbitBranches::balance(int level) const { return dynamic_cast<const HarmonicBalance&>(net_->problem(level)); }

const HarmonicBalance& OrbitBranches::balance_of(In u) const {
  for (int level = 0; level < levels(); ++level)
    if (balance(level).size() + balance(level).parameters() == u.size()) return balance(level);
  throw std::invalid_argument("no balance has unknowns of this size");
}

std::vector<Branch> OrbitBranches::all() const {
  std::vector<Branch> branches;
  for (int level = 0; level < levels(); ++level) branches.insert(branches.end(), network(level).branches().begin(), network(level).branches().end());
  return branches;
}

// Measures the truncation of a finished branch; too large: this pass ends, the next has the harmonics that the worst motion needs.
void OrbitBranches::judge(const Branch& b, int level) {
  if (needed_ > 0 || b.points() == 0) return;
  const HarmonicBalance& hb = balance(level);
  double worst = 0.0;
  Vector at;
  const auto look = [&](In u, const Vector& tangent) {
    const double error = hb.truncation(u, tangent).error;
    if (error <= worst) return;
    worst = error;
    at = u;
  };
  const int every = std::max(1, b.points() / truncation_samples);
  for (int i = 0; i < b.points(); i += every) look(b.u(i), b.tangent(i));
  for (const auto& s : b.special) look(s.u, s.tangent);
  if (worst <= options_.truncation_tolerance || options_.harmonics > 0 || harmonics_ >= options_.max_harmonics) {
    if (on_branch_) on_branch_(b, level, worst);
    return;
  }
  const int enough = hb.harmonics_for(at, 0.1 * options_.truncation_tolerance / worst) >> level;
  needed_ = std::clamp(enough, harmonics_ + options_.nu, std::min(2 * harmonics_, options_.max_harmonics));
}

void OrbitBranches::seed_linear() {
  const auto& walk = options_.network.walk;
  for (int i = 0; i < options_.seed_grid && !net_->stopped(); ++i) {
    const double p = walk.lower + (walk.upper - walk.lower) * (options_.seed_grid == 1 ? 0.5 : static_cast<double>(i) / (options_.seed_grid - 1));
    const Vector guess = balance_->linear_response(Vector::Constant(1, p));
    NewtonResult at = newton(*balance_, guess);
    if (!at.ok()) at = line_search_solve(*balance_, guess);
    if (at.ok()) net_->add_seed(at.x, fmt::format("linear response at {:.6g}", p));
    if (i == 0) net_->switch_branches();
  }
}

// Settled motions are integrated once, in all passes the same.
void OrbitBranches::seed_integrated() {
  if (!has_settled_) {
    std::vector<Settled> runs(options_.seeds.size() * options_.seed_values.size());
    parallel_for(runs.size(), [&](std::size_t i) {
      if (interrupted) return;
      runs[i].p = options_.seed_values[i / options_.seeds.size()];
      const ModalSystem<double> system = source_.at(Vector::Constant(1, runs[i].p));
      Vector y = Vector::Zero(2 * system.size());
      y.head(system.size()) = options_.seeds[i % options_.seeds.size()];
      auto settle_options = options_.settle;
      settle_options.interrupted = &interrupted;
      runs[i].motion = settle(system, y, settle_options);
      context_.progress.show(fmt::format("integrating for starts, {} of {}", i + 1, runs.size()));
    });
    settled_ = std::move(runs);
    has_settled_ = true;
  }
  for (const auto& s : settled_) {
    if (s.motion.kind != MotionKind::periodic) continue;
    int level = 0;
    while (level < levels() && period(level) % s.motion.multiple != 0) ++level;
    if (level == levels()) {
      const std::string text =
          fmt::format("a motion over {} excitation periods was met at {:.6g}: periodic.nu = {} or more period_doublings follow it", s.motion.multiple,
                      s.p, s.motion.multiple);
      if (std::find(context_.warnings.begin(), context_.warnings.end(), text) == context_.warnings.end()) context_.warn(text);
      continue;
    }
    const HarmonicBalance& hb = balance(level);
    const NewtonResult at = newton(hb, hb.from_motion(s.motion, Vector::Constant(1, s.p)));
    // Newton may fall back on a motion of half the period: that one belongs to the level below.
    if (at.ok() && (level == 0 || !keeps(hb, at.x, period_doubling_subtype)))
      net_->add_seed(at.x, fmt::format("integrated motion at {:.6g}", s.p), level);
  }
}

// All averaged motions about the resonances, at each level those of its period; fewer values where polishing one costs much.
void OrbitBranches::seed_averaged() {
  constexpr int few_coordinates = 3, sparser = 3;
  const auto& walk = options_.network.walk;
  const bool few = static_cast<int>(source_.coordinates.size()) <= few_coordinates;
  if (!averaged_) {
    const int count = few ? options_.seed_grid : (options_.seed_grid + sparser - 1) / sparser;
    std::vector<double> values;
    for (int i = 0; i < count; ++i) values.push_back(walk.lower + (walk.upper - walk.lower) * (i + 0.5) / count);
    averaged_ = std::make_unique<OrbitSeeds>(source_, values, OrbitSeeds::Options{.nu = options_.nu, .doubled = levels() > 1});
  }
  for (int level = 0; level < std::min(levels(), 2); ++level)
    for (int i = 0; i < averaged_->size(); ++i) {
      if (net_->stopped() || interrupted) return;
      for (const Vector& u : averaged_->motions(balance(level), i))
        if (!net_->stopped()) net_->add_seed(u, fmt::format("averaged motion at {:.6g}", averaged_->value(i)), level);
    }
}

// The branch that holds a motion met by integration; "" and its unknowns where none does, level -1 where no level has its period.
std::string OrbitBranches::branch_of(const SteadyMotion& motion, double p, int& level, Vector& u) const {
  level = -1;
  if (motion.kind != MotionKind::periodic) return "";
  for (int i = 0; i < levels() && level < 0; ++i)
    if (period(i) % motion.multiple == 0) level = i;
  if (level < 0) return "";
  const HarmonicBalance& hb = balance(level);
  const NewtonResult at = newton(hb, hb.from_motion(motion, Vector::Constant(1, p)));
  if (!at.ok()) {
    level = -1;
    return "";
  }
  u = at.x;
  const double size = largest_motion().norm();
  for (const auto& [branch, known] : network(level).solutions_at(p))
    if (OrbitSeeds::alike(hb, known, u, size)) return network(level).branches()[static_cast<std::size_t>(branch)].name;
  return "";
}

// Largest amplitude of each coordinate on all branches: the sum of its harmonics' at sampled points.
Vector OrbitBranches::largest_motion() const {
  Vector size = Vector::Zero(static_cast<Eigen::Index>(source_.coordinates.size()));
  for (int level = 0; level < levels(); ++level) {
    const HarmonicBalance& hb = balance(level);
    for (const auto& b : network(level).branches())
      for (int k = 0; k < b.points(); k += std::max(1, b.points() / truncation_samples))
        size = size.cwiseMax(hb.observe(b.u(k)).cwiseAbs().rowwise().sum());
  }
  return size;
}

// What the walk has cost, as a number of excitation periods integrated. Microseconds of a point of n unknowns (assembly in blocks, elimination,
// multipliers, its share of the special points) and of a period (steps of thirteen stages, the polish of attractors), both as measured on one core.
double OrbitBranches::walked_periods() const {
  constexpr double point_linear = 2.0, point_cubic = 1e-4, period_constant = 4.0, period_per_operation = 0.35;
  double walk = 0.0;
  for (int level = 0; level < levels(); ++level) {
    const double n = balance(level).size();
    for (const auto& b : network(level).branches()) walk += b.points() * (point_linear * n + point_cubic * n * n * n);
  }
  const FlatFlow field(source_.at(Vector::Constant(1, options_.network.walk.lower)));
  return walk / (period_constant + period_per_operation * (field.products() + 8.0 * field.coordinates()));
}

// Starts are integrated once, where everything else has been found; motions met that no branch holds start branches in every pass.
void OrbitBranches::seed_attractors() {
  const auto& walk = options_.network.walk;
  if (!check_.done()) check_.integrate(walk.lower, walk.upper, largest_motion(), walked_periods(), context_);
  for (const bool last : {false, true}) {
    for (auto& m : check_.met()) {
      if (net_->stopped() || interrupted) return;
      int level = -1;
      Vector u;
      m.branch = branch_of(m.motion.motion, m.p, level, u);
      if (!last && m.branch.empty() && level >= 0) net_->add_seed(u, fmt::format("integrated motion at {:.6g}", m.p), level);
    }
    net_->switch_branches();
  }
}

bool OrbitBranches::pass() {
  needed_ = 0;
  net_.reset();
  HarmonicBalanceOptions o{.harmonics = harmonics_, .nu = options_.nu, .reflections = source_.reflections, .floquet = {}};
  balance_ = std::make_unique<HarmonicBalance>(source_.system, o);
  net_ = std::make_unique<OrbitNetwork>(*balance_, options_.network, options_.period_doublings);
  const bool whirls = std::any_of(source_.reflections.begin(), source_.reflections.end(), [](const auto& r) { return r.subtype == "WH"; });
  net_->set_namer([this, whirls](const Branch& b, int level) {
    const std::string doubled = level == 0 ? "" : level == 1 ? "D" : fmt::format("P{}", period(level));
    return doubled + (!whirls ? "B" : has(balance(level), b.active_reflections, "WH") ? "IP" : "W");
  });
  net_->set_observer([this](const Branch& b, int i) {
    if (i % 20 == 0)
      context_.progress.show(fmt::format("{} harmonics, branch at {:.6g}, {} points", harmonics_, i < b.points() ? b.parameter(i) : 0.0, i));
    return !interrupted && needed_ == 0;
  });
  net_->on_branch([this](const Branch& b, int level) { judge(b, level); });
  seed_linear();
  net_->switch_branches();
  if (options_.averaged_seeds) seed_averaged();
  if (!options_.seeds.empty() && !net_->stopped()) seed_integrated();
  net_->switch_branches();
  if (!net_->stopped()) seed_attractors();
  return needed_ == 0 || interrupted;
}

void OrbitBranches::find() {
  while (!pass()) harmonics_ = needed_;
  context_.progress.clear();
}

std::vector<OrbitBranches::Motion> OrbitBranches::motions_at(double p) const {
  std::vector<Motion> found;
  for (int level = 0; level < levels(); ++level) {
    const HarmonicBalance& hb = balance(level);
    for (const auto& [branch, u] : network(level).solutions_at(p)) {
      Eigen::VectorXcd mu(hb.multiplier_count());
      Eigen::VectorXi group(hb.multiplier_count());
      const bool known = static_cast<const OrbitProblem&>(hb).multipliers(u, mu, group);
      found.push_back({network(level).branches()[static_cast<std::size_t>(branch)].name, level, u, known && mu.cwiseAbs().maxCoeff() <= 1.0});
    }
  }
  return found;
}

}  // namespace whirl::studies
