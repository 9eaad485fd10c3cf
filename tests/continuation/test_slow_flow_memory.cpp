// Residual and Jacobian of averaged equations do not allocate.
#include <catch2/catch.hpp>

#include "models/slow_flow/combinatorial_printed.hpp"
#include "tests/models/oresund.hpp"

using namespace whirl;
using namespace whirl::models;

#ifndef __SANITIZE_ADDRESS__
std::size_t allocations_so_far();  // test_oresund.cpp counts for the whole program

TEST_CASE("slow flow: residual and Jacobian do not allocate") {
  const auto system = stay_system(oresund(), {Lens("omega"), Lens("support_amplitude")}, Terms::full, Coefficients::exact);
  const auto reduced = stay_system(oresund(), {Lens("omega"), Lens("support_amplitude")}, Terms::reduced, Coefficients::exact);
  const SlowFlow rich(system, Ansatz::complete(2, 8, 2)), frozen(reduced, Ansatz::superharmonic(2, 2)),
      combinatorial(reduced, Ansatz::combinatorial_coupled());
  const PrintedCombinatorialFlow printed(reduced, CombinatorialMotion::coupled);
  for (const Problem* f : {static_cast<const Problem*>(&rich), static_cast<const Problem*>(&frozen), static_cast<const Problem*>(&combinatorial),
                           static_cast<const Problem*>(&printed)}) {
    Vector u = Vector::Constant(f->size() + 2, 0.1), r(f->size());
    u.tail(2) << 2.1, 0.5;
    Matrix j(f->size(), f->size() + 2);
    f->residual(u, r);
    f->linearise(u, r, j);
    f->jacobian(u, j);  // first calls fill the scratch
    const std::size_t before = allocations_so_far();
    f->residual(u, r);
    f->linearise(u, r, j);
    f->jacobian(u, j);
    const std::size_t after = allocations_so_far();
    CHECK(after == before);
  }
}
#endif
