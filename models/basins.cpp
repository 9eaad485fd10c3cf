#include "models/basins.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numeric>

#include "core/parallel.hpp"

namespace whirl::models {
namespace {

constexpr long group_size = 1024, block_size = 8;

class Plane {
 public:
  Plane(const std::vector<Reflection>& reflections, const BasinOptions& o) : reflections_(reflections), o_(o) {
    for (std::size_t r = 0; o.use_symmetry && r < reflections.size() && mirror_ < 0; ++r) {
      const Vector& s = reflections[r].signs;
      bool maps = s[o.x.state] < 0.0 || s[o.y.state] < 0.0;
      for (Eigen::Index i = 0; i < s.size(); ++i) {
        if (i == o.x.state || i == o.y.state) continue;
        maps = maps && (s[i] > 0.0 || o.base[i] == 0.0);
      }
      for (const BasinAxis* axis : {&o.x, &o.y}) maps = maps && (s[axis->state] > 0.0 || axis->lower == -axis->upper);
      if (maps) mirror_ = static_cast<int>(r);
    }
  }
  long cells() const { return static_cast<long>(o_.x.points) * o_.y.points; }
  int mirror() const { return mirror_; }
  long image(long cell) const {
    const Vector& s = reflections_[static_cast<std::size_t>(mirror_)].signs;
    long i = cell % o_.x.points, j = cell / o_.x.points;
    if (s[o_.x.state] < 0.0) i = o_.x.points - 1 - i;
    if (s[o_.y.state] < 0.0) j = o_.y.points - 1 - j;
    return j * o_.x.points + i;
  }
  Vector start(long cell) const {
    Vector y = o_.base;
    y[o_.x.state] = o_.x.at(static_cast<int>(cell % o_.x.points));
    y[o_.y.state] = o_.y.at(static_cast<int>(cell / o_.x.points));
    for (const auto& r : reflections_) {
      if ((y - r.signs.cwiseProduct(y)).norm() > 1e-12 * (1.0 + y.norm())) continue;
      for (Eigen::Index i = 0; i < y.size() / 2; ++i)
        if (r.signs[i] < 0.0) y[i] += o_.perturbation;
    }
    return y;
  }
  // A coarse lattice first, so that most attractors are known early, then the rest in order; of two mirror images the later one is left out.
  std::vector<std::vector<long>> groups() const {
    std::vector<long> first, rest;
    const int sx = std::max(1, o_.x.points / 12), sy = std::max(1, o_.y.points / 12);
    for (long c = 0; c < cells(); ++c) {
      if (mirror_ >= 0 && image(c) < c) continue;
      const bool lattice = (c % o_.x.points) % sx == sx / 2 && (c / o_.x.points) % sy == sy / 2;
      (lattice ? first : rest).push_back(c);
    }
    std::vector<std::vector<long>> all;
    const auto cut = [&](const std::vector<long>& list, long size) {
      for (std::size_t i = 0; i < list.size(); i += static_cast<std::size_t>(size))
        all.emplace_back(list.begin() + static_cast<std::ptrdiff_t>(i),
                         list.begin() + static_cast<std::ptrdiff_t>(std::min(list.size(), i + static_cast<std::size_t>(size))));
    };
    cut(first, 32);
    cut(rest, group_size);
    return all;
  }

 private:
  const std::vector<Reflection>& reflections_;
  const BasinOptions& o_;
  int mirror_ = -1;
};

// Attractors by what they are, not by when they were found: their order by index, mirror images side by side.
std::vector<int> numbering(const AttractorSet& set) {
  std::vector<int> order(static_cast<std::size_t>(set.size()));
  std::iota(order.begin(), order.end(), 0);
  const auto extent = [&](int i) { return set[i].points.colwise().norm().mean(); };
  const auto landmark = [&](int i) { return set[i].points(0, 0) + 0.618 * set[i].points(1, 0); };
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    const Attractor &p = set[a], &q = set[b];
    if (p.kind != q.kind) return p.kind < q.kind;
    if (p.multiple != q.multiple) return p.multiple < q.multiple;
    if (std::abs(extent(a) - extent(b)) > 1e-6 * (extent(a) + extent(b))) return extent(a) < extent(b);
    return landmark(a) > landmark(b);
  });
  return order;
}

class BasinRun {
 public:
  BasinRun(const ModalSystem<double>& system, const std::vector<Reflection>& reflections, const BasinOptions& o)
      : system_(system), o_(o), plane_(reflections, o), set_(reflections) {
    map_.cell = Eigen::MatrixXi::Constant(o.y.points, o.x.points, BasinMap::not_computed);
    map_.periods = Eigen::MatrixXi::Zero(o.y.points, o.x.points);
    if (plane_.mirror() >= 0) map_.symmetry = reflections[static_cast<std::size_t>(plane_.mirror())].subtype;
  }

  BasinMap run() {
    const auto groups = plane_.groups();
    for (const auto& g : groups) total_ += static_cast<long>(g.size());
    for (const auto& g : groups) work(g);
    map_.complete = !interrupted();
    check();
    number();
    return std::move(map_);
  }

 private:
  bool interrupted() const { return o_.settle.interrupted && *o_.settle.interrupted; }
  template <class Each>
  void in_blocks(std::size_t count, const AttractorOptions& options, Each&& each) {
    parallel_for((count + block_size - 1) / block_size,
                 [&](std::size_t block) {
                   AttractorFinder finder(system_, options);
                   for (std::size_t i = block * block_size; i < std::min(count, (block + 1) * block_size) && !interrupted(); ++i) each(finder, i);
                 },
                 o_.threads > 0 ? o_.threads : std::thread::hardware_concurrency());
  }

  void work(const std::vector<long>& group) {
    if (interrupted()) return;
    std::vector<Settled> settled(group.size());
    std::vector<char> done(group.size(), 0);
    in_blocks(group.size(), o_.settle, [&](AttractorFinder& finder, std::size_t i) {
      settled[i] = finder.settle(plane_.start(group[i]), set_, o_.phase);
      done[i] = settled[i].why != "interrupted";
      if (o_.progress) o_.progress(++done_, total_, set_.size());
    });
    std::map<std::pair<int, int>, int> images;  // looked up once a group
    for (std::size_t i = 0; i < group.size(); ++i) {
      if (!done[i]) continue;
      Settled& s = settled[i];
      int value = s.kind == MotionKind::diverging ? BasinMap::diverging : BasinMap::unsettled;
      if (s.known >= 0) value = s.known;
      else if (s.fresh) value = set_.add(std::move(*s.fresh), s.capture);
      put(group[i], value, s.periods);
      ++map_.integrated;
      if (plane_.mirror() < 0) continue;
      if (value >= 0) {
        const auto [at, fresh] = images.try_emplace({value, 0}, 0);
        if (fresh) at->second = set_.image(value, static_cast<std::size_t>(plane_.mirror()));
        value = at->second;
      }
      if (const long other = plane_.image(group[i]); other != group[i]) put(other, value, s.periods);
    }
  }
  void put(long cell, int value, int periods) {
    map_.cell(cell / o_.x.points, cell % o_.x.points) = value;
    map_.periods(cell / o_.x.points, cell % o_.x.points) = periods;
  }

  // Every so many cells again, with care: the fine tolerance, followed until within 1e-6 of an attractor's points.
  void check() {
    if (o_.check_share <= 0.0) return;
    std::vector<long> cells;
    long count = 0;
    for (const auto& g : plane_.groups())
      for (const long c : g) {
        if (map_.cell(c / o_.x.points, c % o_.x.points) == BasinMap::not_computed) continue;
        const double due = static_cast<double>(++count) * o_.check_share;
        if (std::floor(due) > std::floor(due - o_.check_share)) cells.push_back(c);
      }
    AttractorOptions careful = o_.settle;
    careful.transient = careful.fine;
    std::vector<int> verdict(cells.size(), -1);
    in_blocks(cells.size(), careful, [&](AttractorFinder& finder, std::size_t i) {
      const int here = map_.cell(cells[i] / o_.x.points, cells[i] % o_.x.points);
      const int there = destination(finder, plane_.start(cells[i]));
      if (!interrupted()) verdict[i] = here == there ? 1 : 0;
    });
    map_.checked = std::count_if(verdict.begin(), verdict.end(), [](int v) { return v >= 0; });
    map_.disagreed = std::count(verdict.begin(), verdict.end(), 0);
  }

  int destination(AttractorFinder& finder, const Vector& start) const {
    const Settled s = finder.settle(start, set_, o_.phase);
    if (s.kind == MotionKind::diverging) return BasinMap::diverging;
    if (s.known < 0) return s.fresh ? -9 : BasinMap::unsettled;  // one that the map does not have
    if (set_[s.known].kind != MotionKind::periodic) return s.known;
    Vector y = s.state;
    for (int k = 0; k < o_.settle.max_periods; ++k) {
      if (!finder.fine().map(y)) return -9;
      for (int i = 0; i < set_.size(); ++i)
        if (set_[i].kind == MotionKind::periodic && (set_[i].points.colwise() - y).colwise().norm().minCoeff() < 1e-6 * (1.0 + y.norm())) return i;
    }
    return -9;
  }

  void number() {
    const auto order = numbering(set_);
    std::vector<int> number(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) number[static_cast<std::size_t>(order[i])] = static_cast<int>(i);
    for (const int i : order) {
      Attractor a = set_[i];
      if (a.mirror_of >= 0) a.mirror_of = number[static_cast<std::size_t>(a.mirror_of)];
      map_.attractors.push_back(std::move(a));
    }
    map_.cells.assign(order.size(), 0);
    for (Eigen::Index k = 0; k < map_.cell.size(); ++k) {
      int& value = map_.cell.data()[k];
      if (value < 0) continue;
      value = number[static_cast<std::size_t>(value)];
      ++map_.cells[static_cast<std::size_t>(value)];
    }
  }

  const ModalSystem<double>& system_;
  const BasinOptions& o_;
  Plane plane_;
  AttractorSet set_;
  BasinMap map_;
  long total_ = 0;
  std::atomic<long> done_{0};
};

}  // namespace

void BasinOptions::validate(int states) const {
  settle.validate();
  for (const BasinAxis& a : {x, y}) {
    if (a.state < 0 || a.state >= states)
      throw std::invalid_argument(fmt::format("an axis must be one of the {} states, got index {}", states, a.state));
    if (a.points < 1 || !(a.lower < a.upper)) throw std::invalid_argument("an axis needs points >= 1 and lower < upper");
  }
  if (x.state == y.state) throw std::invalid_argument("the two axes must differ");
  if (base.size() != states) throw std::invalid_argument(fmt::format("base needs {} values (q, q'), got {}", states, base.size()));
  if (!(check_share >= 0.0 && check_share <= 1.0)) throw std::invalid_argument(fmt::format("check_share must be in [0, 1], got {}", check_share));
}

double BasinMap::share(int attractor) const {
  const auto computed = (cell.array() != not_computed).count();
  return computed > 0 ? static_cast<double>(cells[static_cast<std::size_t>(attractor)]) / static_cast<double>(computed) : 0.0;
}

BasinMap basins(const ModalSystem<double>& system, const std::vector<Reflection>& reflections, const BasinOptions& options) {
  options.validate(2 * system.size());
  for (const auto& r : reflections)
    if (r.signs.size() != 2 * system.size()) throw std::invalid_argument(fmt::format("a reflection needs {} signs (q, q')", 2 * system.size()));
  return BasinRun(system, reflections, options).run();
}

}  // namespace whirl::models
