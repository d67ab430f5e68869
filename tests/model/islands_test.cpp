/// What hangs together, what needs what.
#include "model/islands.hpp"

#include <algorithm>
#include <catch2/catch.hpp>

#include "support/circuit.hpp"

using namespace pwlsim;
using namespace pwlsim::test;

namespace {

const model::Island& island_with(const std::vector<model::Island>& islands, const std::string& node) {
  for (const auto& island : islands)
    for (const auto& label : island.network.nodes)
      if (label.name == node && !(island.network.capacitors.empty() && island.network.resistors.empty() && island.network.diodes.empty()))
        return island;
  FAIL("no island holds " << node);
  return islands.front();
}

}  // namespace

TEST_CASE("parts that share only ground are islands, each with its own numbers", "[unit]") {
  TestCircuit c;
  c.r("a", "0", 1.0);
  c.c("b", "0", 2.0);
  c.c("a", "0", 3.0);
  c.r("b", "d", 4.0);
  c.save_v("d");
  c.save_v("a");
  const auto islands = model::split_islands(c.network());
  REQUIRE(islands.size() == 2);
  const auto& a = island_with(islands, "a");
  CHECK(a.network.nodes.size() == 1);
  REQUIRE(a.network.capacitors.size() == 1);
  CHECK(a.network.capacitors[0].capacitance == 3.0);
  CHECK(a.network.capacitors[0].p == 0);
  CHECK(a.signal_number == std::vector<int>{1});
  CHECK(island_with(islands, "d").signal_number == std::vector<int>{0});
  CHECK(std::all_of(islands.begin(), islands.end(), [](const auto& island) { return island.needed; }));
}

TEST_CASE("an island that nothing asks for is not needed, unless it drives a switch of one that is", "[unit]") {
  const bool drives = GENERATE(false, true);
  TestCircuit c;
  c.r("a", "b", 1.0);
  c.c("b", "0", 1.0);
  c.i("0", "a", model::Dc{1.0});
  c.r("x", "0", 1.0);
  c.i("0", "x", sine());
  c.r("y", "0", 1.0);
  c.i("0", "y", sine());
  c.s("a", "0", drives ? "x" : "b", "0", 0.5);
  c.save_v("b");
  const auto islands = model::split_islands(c.network());
  REQUIRE(islands.size() == 3);
  CHECK(island_with(islands, "b").needed);
  CHECK(island_with(islands, "x").needed == drives);
  CHECK_FALSE(island_with(islands, "y").needed);
  CHECK(island_with(islands, "x").controls.size() == (drives ? 1U : 0U));
}

TEST_CASE("a signal over two islands has a share in each", "[unit]") {
  TestCircuit c;
  c.r("a", "0", 1.0);
  c.c("a", "0", 1.0);
  c.r("b", "0", 1.0);
  c.c("b", "0", 1.0);
  c.save_v("a", "b");
  const auto islands = model::split_islands(c.network());
  REQUIRE(islands.size() == 2);
  for (const auto& island : islands) {
    REQUIRE(island.network.signals.size() == 1);
    CHECK(island.signal_number == std::vector<int>{0});
    CHECK(island.network.signals[0].form.size() == 1);
  }
}

TEST_CASE("couplings and controlled sources tie parts together", "[unit]") {
  TestCircuit coupled;
  const int l1 = coupled.l("a", "0", 1.0), l2 = coupled.l("b", "0", 1.0);
  coupled.k(l1, l2, 0.5);
  coupled.r("a", "0", 1.0);
  coupled.r("b", "0", 1.0);
  CHECK(model::split_islands(coupled.network()).size() == 1);

  TestCircuit controlled;
  controlled.r("a", "0", 1.0);
  controlled.c("a", "0", 1.0);
  controlled.g("b", "0", "a", "0", 2.0);
  controlled.r("b", "0", 1.0);
  CHECK(model::split_islands(controlled.network()).size() == 1);
}

TEST_CASE("what hangs on both sides of an ideal source to ground is not tied by it", "[unit]") {
  TestCircuit c;
  c.v("rail", "0", model::Dc{5.0});
  c.r("rail", "a", 1.0);
  c.c("a", "0", 1.0);
  c.r("rail", "b", 1.0);
  c.c("b", "0", 1.0);
  c.save_v("a");
  c.save_v("b");
  const auto islands = model::split_islands(c.network());
  const auto& a = island_with(islands, "a");
  CHECK(a.network.capacitors.size() == 1);
  const auto& b = island_with(islands, "b");
  CHECK(b.network.capacitors.size() == 1);
  CHECK(a.part == b.part);
}
