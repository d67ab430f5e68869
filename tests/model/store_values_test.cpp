/// Stores in SI units from the state.
#include "model/store_values.hpp"

#include <catch2/catch.hpp>

#include "support/circuit.hpp"

using namespace pwlsim;
using namespace pwlsim::test;

// 1 H and 4 H perfectly coupled (M = 2 H) carry 3 A and 0: fluxes of 3 and 6 Vs, which leave both currents open; the 0.5 A of a third
// inductor beside them are known. ½·(2 H)·(0.5 A)² + ½·(3 A + 2·0 A)²·1 H = 4.75 J.
TEST_CASE("perfect coupling hides the currents of its own windings only", "[unit]") {
  constexpr double exact = 1e-13;
  TestCircuit c;
  const int first = c.l("a", "0", 1.0, 3.0);
  const int second = c.l("b", "0", 4.0, 0.0);
  c.k(first, second, 1.0);
  c.l("a", "d", 2.0, 0.5);
  c.r("a", "0", 1.0);
  c.r("b", "0", 1.0);
  c.r("d", "0", 1.0);
  std::vector<model::Island> islands = model::split_islands(c.network());
  REQUIRE(islands.size() == 1);
  Diagnostics diagnostics;
  const auto extraction = model::extract(islands[0], diagnostics);
  REQUIRE(extraction);
  const model::StoreValues stores(islands[0], *extraction);
  CHECK(stores.names() == std::vector<std::string>{"flux(L1)", "flux(L2)", "i(L3)"});
  const model::System& system = extraction->system;
  model::Vector x = model::Vector::Zero(system.size());
  x.head(system.n) = system.x0;
  const model::Vector values = stores.values(x);
  REQUIRE(values.size() == 3);
  CHECK(values[0] == Approx(3.0).epsilon(exact));
  CHECK(values[1] == Approx(6.0).epsilon(exact));
  CHECK(values[2] == Approx(0.5).epsilon(exact));
  CHECK(stores.energy(x) == Approx(4.75).epsilon(exact));
}
