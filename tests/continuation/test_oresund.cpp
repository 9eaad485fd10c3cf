#include <catch2/catch.hpp>
#include <cstdlib>
#include <new>

#include "continuation/network.hpp"
#include "core/kinsol.hpp"
#include "models/closed_forms.hpp"
#include "tests/models/oresund.hpp"

using namespace whirl;
using namespace whirl::models;
using namespace whirl::continuation;

namespace {

Network whole(const SuperharmonicFlow& flow, double lower, double upper) {
  NetworkOptions o;
  o.walk.lower = lower;
  o.walk.upper = upper;
  Network net(flow, o);
  net.set_namer([](const Branch& b) { return b.active_reflections.empty() ? "W" : "IP"; });
  for (int i = 0; i <= 60; ++i) {
    const double w = lower + (upper - lower) * i / 60;
    const auto c = flow.model().coefficients<double>(std::array<double, 1>{w});
    for (const auto& states : {in_plane_states(c), coupled_states(c)})
      for (const auto& x : states) {
        Vector u(5);
        u << x, w;
        net.add_seed(u, "seed");
      }
    if (i == 0) net.switch_branches();
  }
  net.switch_branches();
  return net;
}

const SpecialPoint* find(const Network& net, EventType type, double w) {
  for (const auto& b : net.branches())
    for (const auto& s : b.special)
      if (s.type == type && std::abs(s.u[4] - w) < 1e-6) return &s;
  return nullptr;
}

[[maybe_unused]] std::size_t allocations = 0;

}  // namespace

// Counts every allocation of this test program; the address sanitizer brings operators of its own, which must not be mixed with these.
#ifndef __SANITIZE_ADDRESS__
void* operator new(std::size_t n) {
  ++allocations;
  if (void* p = std::malloc(n)) return p;
  throw std::bad_alloc();
}
void* operator new(std::size_t n, const std::nothrow_t&) noexcept {
  ++allocations;
  return std::malloc(n);
}
void operator delete(void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }
void operator delete(void* p, const std::nothrow_t&) noexcept { std::free(p); }
std::size_t allocations_so_far();  // for the other tests of this program
std::size_t allocations_so_far() { return allocations; }
#endif

TEST_CASE("every special point of the Oresund stay, U = 0.5 m, n = 2") {
  const SuperharmonicFlow flow(oresund(0.5), {.order = 2}, {Lens("omega")});
  const Network net = whole(flow, 1.2, 2.4);
  REQUIRE(net.branches().size() == 3);  // two in-plane, one whirling
  struct Row {
    EventType type;
    double omega, A, B;
  };
  // AUTO-07p and an independent Newton, agreeing to 5e-11.
  const Row rows[] = {{EventType::branch_point, 1.61185715606, 0.0, 2.5150624945},    {EventType::branch_point, 1.90136878608, 0.0, 5.29180221377},
                      {EventType::fold, 1.77661519045, 0.0, 2.11972676939},           {EventType::fold, 2.20516162006, 6.72415137997, 6.31638643084},
                      {EventType::fold, 1.84643580247, 4.47880330373, 2.40295748433}, {EventType::fold, 2.03547274351, 4.9442648162, 4.08352260729}};
  for (const auto& row : rows) {
    const SpecialPoint* s = find(net, row.type, row.omega);
    INFO(to_string(row.type) << " at " << row.omega);
    REQUIRE(s);
    CHECK(s->u[4] == Approx(row.omega).epsilon(1e-10));  // located to 1e-10 relative
    const auto o = flow.observe(s->u);
    CHECK(o.A == Approx(row.A).epsilon(1e-8).margin(1e-9));  // a fold's state moves with the root of the parameter's error
    CHECK(o.B == Approx(row.B).epsilon(1e-8));
    CHECK(s->residual < 1e-12);
    CHECK(s->bracket[0] <= s->u[4]);
    CHECK(s->bracket[1] >= s->u[4]);
    if (row.type == EventType::branch_point) CHECK(s->subtype == "WH");
  }
  // Two Hopf points, one within 7e-4 rad/s of a fold: the eigenvalues on them are +-i frequency.
  int hopf = 0;
  for (const auto& b : net.branches())
    for (const auto& s : b.special) {
      CHECK(s.type != EventType::unresolved);
      if (s.type != EventType::hopf) continue;
      ++hopf;
      Matrix j(4, 5);
      flow.jacobian(s.u, j);
      const Eigen::VectorXcd e = Eigen::EigenSolver<Matrix>(j.leftCols(4), false).eigenvalues();
      double nearest = 1.0;
      for (const auto& z : e) nearest = std::min(nearest, std::abs(z - std::complex<double>(0.0, s.frequency)));
      CHECK(nearest < 1e-12);
    }
  CHECK(hopf == 2);
  CHECK(find(net, EventType::hopf, 1.84707663736));
  CHECK(find(net, EventType::hopf, 2.03317655052));
  for (const auto& b : net.branches())
    if (b.name[0] == 'W') CHECK(b.stop_reason == StopReason::symmetric_branch);  // ends where whirling dies out; the rest is its mirror image
}

TEST_CASE("stability changes along a branch are all explained by its special points") {
  const SuperharmonicFlow flow(oresund(0.5), {.order = 2}, {Lens("omega")});
  const Network net = whole(flow, 1.2, 2.4);
  for (const auto& b : net.branches()) {
    std::size_t next = 0;
    const int first = b.start_reason == StopReason::known_branch_point ? 1 : 0;
    const int last = b.points() - (b.stop_reason == StopReason::symmetric_branch ? 1 : 0);
    int unstable = b.n_unstable(first);
    for (int i = first + 1; i < last; ++i) {
      for (; next < b.special.size() && b.special[next].arclength <= b.arclength(i); ++next)
        unstable += b.special[next].unstable_after - b.special[next].unstable_before;
      INFO(b.name << " point " << i);
      CHECK(b.n_unstable(i) == unstable);
      CHECK(b.residual(i) < 1e-10);
    }
  }
}

TEST_CASE("U = 0.15 m: in-plane only, no special point") {
  const SuperharmonicFlow flow(oresund(0.15), {.order = 2}, {Lens("omega")});
  const Network net = whole(flow, 1.2, 2.4);
  REQUIRE(net.branches().size() == 1);
  CHECK(net.branches()[0].special.empty());
  CHECK(net.branches()[0].stop_reason == StopReason::parameter_bound);
}

TEST_CASE("whirling threshold in the support amplitude and in the tension, at fixed frequency") {
  // The same branch point approached in another parameter: at the U it was found for, continuing in U must find it again.
  for (const char* name : {"support_amplitude", "chord_tension", "damping"}) {
    const Lens lens(name);
    const auto stay = oresund(0.5, 1.6118571560642);
    const SuperharmonicFlow flow(stay, {.order = 2}, {lens});
    const double p0 = lens.get(stay);
    NetworkOptions o;
    o.walk.lower = 0.5 * p0;
    o.walk.upper = 1.5 * p0;
    Network net(flow, o);
    for (const auto& x : in_plane_states(flow.model().coefficients<double>(std::array<double, 1>{o.walk.lower}))) {
      Vector u(5);
      u << x, o.walk.lower;
      net.add_seed(u, "seed");
    }
    bool found = false;
    for (const auto& b : net.branches())
      for (const auto& s : b.special) found = found || (s.type == EventType::branch_point && std::abs(s.u[4] / p0 - 1.0) < 1e-8);
    INFO(name);
    CHECK(found);
  }
}

#ifndef __SANITIZE_ADDRESS__
TEST_CASE("the walker's loop allocates nothing") {
  const SuperharmonicFlow flow(oresund(0.15), {.order = 2}, {Lens("omega")});
  Vector start = Vector::Zero(5);
  start[4] = 1.2;
  const auto first = line_search_solve(flow, start);
  REQUIRE(first.ok());
  WalkOptions o;
  o.lower = 1.2;
  o.upper = 2.4;
  std::vector<std::size_t> count;
  count.reserve(10000);
  const Branch b = Walker(flow, o).walk_from(first.x, Vector::Unit(5, 4), false, [&](const Branch&, int) {
    count.push_back(allocations);
    return true;
  });
  REQUIRE(b.points() > 30);
  CHECK(count.back() == count.front());
}
#endif
