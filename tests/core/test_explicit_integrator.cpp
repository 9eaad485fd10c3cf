// The fast explicit integrator and the Fourier tools, against closed forms.
#include <atomic>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <new>
#include <numbers>

#include "core/explicit_integrator.hpp"
#include "core/fourier.hpp"

using namespace whirl;

// Counts what the integrator allocates; the address sanitizer brings operators of its own, which must not be mixed with these.
static std::atomic<long> allocations{0};
#ifndef __SANITIZE_ADDRESS__
void* operator new(std::size_t size) {
  ++allocations;
  if (void* p = std::malloc(size)) return p;
  throw std::bad_alloc();
}
void operator delete(void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }
#endif

namespace {
using Pair = std::array<double, 2>;
struct Oscillator {
  void operator()(const Pair& y, Pair& d, double) const {
    d[0] = y[1];
    d[1] = -y[0];
  }
};
struct Chain {  // of any length
  void operator()(const std::vector<double>& y, std::vector<double>& d, double t) const {
    for (std::size_t i = 0; i < y.size(); ++i) d[i] = std::cos(t) - y[i] + (i > 0 ? y[i - 1] : 0.0);
  }
};
struct Blowup {
  void operator()(const std::vector<double>& y, std::vector<double>& d, double) const { d[0] = y[0] * y[0]; }
};
constexpr double two_pi = 2.0 * std::numbers::pi;
}  // namespace

TEST_CASE("the error of the explicit integrator follows its tolerance") {
  for (const double tolerance : {1e-5, 1e-7, 1e-9, 1e-11}) {
    ExplicitIntegrator<Pair, Oscillator> run(Oscillator{}, {.relative_tolerance = tolerance, .absolute_tolerance = tolerance});
    run.restart(0.0, {1.0, 0.0});
    REQUIRE(run.advance(10.0 * two_pi));
    CHECK(run.time() == 10.0 * two_pi);
    const double error = std::hypot(run.state()[0] - 1.0, run.state()[1]);
    CHECK(error < 300.0 * tolerance);  // some 10^2 steps, each within the tolerance
    REQUIRE(run.advance(0.0));         // and back
    CHECK(std::hypot(run.state()[0] - 1.0, run.state()[1]) < 600.0 * tolerance);
  }
}

TEST_CASE("output times do not change the solution: a last step that is rejected has not arrived") {
  // Many short intervals of every length against one long one; a step taken for arrived would lose time.
  for (int pieces : {1, 2, 3, 7, 19, 50, 1000}) {
    ExplicitIntegrator<Pair, Oscillator> run(Oscillator{}, {.relative_tolerance = 1e-9, .absolute_tolerance = 1e-9, .first_step = 3.0});
    run.restart(0.0, {1.0, 0.0});
    for (int i = 1; i <= pieces; ++i) REQUIRE(run.advance(40.0 * i / pieces));
    CHECK(run.state()[0] == Approx(std::cos(40.0)).epsilon(0).margin(1e-6));
    CHECK(run.state()[1] == Approx(-std::sin(40.0)).epsilon(0).margin(1e-6));
  }
}

TEST_CASE("tolerances per component, divergence and misuse are told") {
  ExplicitIntegrator<Pair, Oscillator> fine(Oscillator{}, {.relative_tolerance = 1e-3, .absolute = {1e-12, 1e-3}});
  ExplicitIntegrator<Pair, Oscillator> coarse(Oscillator{}, {.relative_tolerance = 1e-3, .absolute = {1e-3, 1e-3}});
  for (auto* run : {&fine, &coarse}) {
    run->restart(0.0, {0.0, 1.0});
    REQUIRE(run->advance(1.0));
  }
  CHECK(fine.steps() >= coarse.steps());
  ExplicitIntegrator<std::vector<double>, Blowup> blow(Blowup{}, {.largest_norm = 1e6});
  blow.restart(0.0, {1.0});  // y = 1/(1 - t)
  REQUIRE(blow.advance(0.9));
  CHECK(blow.state()[0] == Approx(10.0).epsilon(1e-6));
  CHECK_FALSE(blow.advance(2.0));
  CHECK(blow.stop() == IntegrationStop::diverged);
  CHECK(blow.time() == Approx(1.0).epsilon(0).margin(1e-5));
  CHECK_FALSE(blow.why().empty());
  using Run = ExplicitIntegrator<Pair, Oscillator>;
  CHECK_THROWS_AS(Run(Oscillator{}, {.relative_tolerance = 0.0}), std::invalid_argument);
  CHECK_THROWS_AS(Run(Oscillator{}, {.absolute = {1e-3}}).restart(0.0, Pair{}), std::invalid_argument);
}

TEST_CASE("steps allocate nothing") {
  ExplicitIntegrator<Pair, Oscillator> fixed(Oscillator{});
  ExplicitIntegrator<std::vector<double>, Chain> dynamic(Chain{});
  const std::vector<double> start(7, 0.5);
  fixed.restart(0.0, {1.0, 0.0});
  dynamic.restart(0.0, start);
  REQUIRE((fixed.advance(1.0) && dynamic.advance(1.0)));  // the stepper sizes its stages at its first step
  const long before = allocations, steps = dynamic.steps();
  for (int k = 2; k < 20; ++k) {
    if (!fixed.advance(k) || !dynamic.advance(k)) FAIL("stopped");
    dynamic.restart(k, start);
  }
  const long after = allocations;
  CHECK(after == before);
  CHECK(dynamic.steps() > steps + 18);
}

TEST_CASE("Fourier transform against the definition, lines between the bins") {
  std::vector<std::complex<double>> x(16), y;
  for (std::size_t j = 0; j < 16; ++j) x[j] = {std::sin(0.7 * double(j * j)), std::cos(1.3 * double(j))};
  for (std::size_t k = 0; k < 16; ++k) {
    std::complex<double> sum = 0.0;
    for (std::size_t j = 0; j < 16; ++j) sum += x[j] * std::polar(1.0, -two_pi * double(j * k) / 16.0);
    y.push_back(sum);
  }
  fourier_transform(x);
  for (std::size_t k = 0; k < 16; ++k) CHECK(std::abs(x[k] - y[k]) < 1e-12);
  std::vector<double> record;
  for (int j = 0; j < 4096; ++j) record.push_back(0.3 + 2.0 * std::cos(two_pi * 0.0617 * j + 0.4) + 0.01 * std::cos(two_pi * 0.2023456 * j - 1.1));
  const auto lines = spectral_lines(record);
  REQUIRE(lines.size() == 2);
  CHECK(lines[0].frequency == Approx(0.0617).epsilon(0).margin(1e-8));  // side lobes of the other lines, 250 bins and more away, fall as 1/bins^3
  CHECK(std::abs(lines[0].amplitude) == Approx(2.0).epsilon(1e-6));
  CHECK(std::arg(lines[0].amplitude) == Approx(0.4).epsilon(0).margin(1e-4));
  CHECK(lines[1].frequency == Approx(0.2023456).epsilon(0).margin(1e-6));
  CHECK(std::abs(lines[1].amplitude) == Approx(0.01).epsilon(1e-3));
  CHECK(windowed_line(record, 0.0).real() == Approx(0.3).epsilon(1e-5));
  std::vector<std::complex<double>> odd(12);
  CHECK_THROWS_AS(fourier_transform(odd), std::invalid_argument);
}
