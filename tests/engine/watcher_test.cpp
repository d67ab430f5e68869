// What both engines tell of events while they run.

#include <catch2/catch.hpp>
#include <numbers>

#include "engine/sparse/sparse.hpp"
#include "support/circuit.hpp"

using namespace pwlsim;
using Flags = std::vector<char>;

namespace {

struct Told : engine::EventWatcher {
  void begin(std::span<const std::string> names, std::span<const char> on) override {
    elements.assign(names.begin(), names.end());
    start.assign(on.begin(), on.end());
  }
  void happened(const engine::Event& event, std::span<const char> on) override {
    events.push_back(event);
    positions.emplace_back(on.begin(), on.end());
  }
  std::vector<std::string> elements;
  Flags start;
  std::vector<engine::Event> events;
  std::vector<Flags> positions;
};

Told watched(const model::Network& network, double stop, bool sparse) {
  Told told;
  test::Run rows;
  Diagnostics diagnostics;
  engine::Request request;
  request.stop = stop;
  request.grid = {[stop](std::uint64_t k) { return k == 0 ? 0.0 : stop; }, 2};
  request.use_initial_conditions = true;
  request.watcher = &told;
  const engine::Answer answer = sparse ? engine::sparse::run(*engine::sparse::prepare(network, diagnostics), request, 1e-6, rows)
                                       : engine::run(*engine::prepare(network, diagnostics), request, rows);
  CHECK(answer.outcome == engine::Outcome::completed);
  CHECK(answer.statistics.events == told.events.size());
  return told;
}

}  // namespace

TEST_CASE("a diode is told to turn off and on where the sine behind it changes sign", "[unit]") {
  const bool sparse = GENERATE(false, true);
  CAPTURE(sparse);
  test::TestCircuit circuit;
  circuit.v("a", "0", test::sine());
  circuit.d("a", "b");
  circuit.r("b", "0", 1.0);
  circuit.save_v("b");
  const Told told = watched(circuit.network(), 7.0, sparse);
  CHECK(told.elements == std::vector<std::string>{"D1"});
  CHECK(told.start == Flags{1});
  // sin t is negative from π to 2π.
  REQUIRE(told.events.size() == 2);
  const double tolerance = sparse ? 1e-3 : 1e-12;
  CHECK(told.events[0].time == Approx(std::numbers::pi).epsilon(tolerance));
  CHECK(told.events[1].time == Approx(2.0 * std::numbers::pi).epsilon(tolerance));
  CHECK(told.positions == std::vector<Flags>{{0}, {1}});
  CHECK((told.events[0].mode_change && !told.events[0].source_edge && !told.events[0].jump));
}

TEST_CASE("a switch in a part of its own is told to close by the edge of a source, which charges a capacitor at once", "[unit]") {
  const bool sparse = GENERATE(false, true);
  CAPTURE(sparse);
  test::TestCircuit circuit;
  model::Pulse pulse;
  pulse.pulsed = 1.0;
  pulse.delay = 0.25;
  circuit.v("g", "0", pulse);
  circuit.v("a", "0", model::Dc{2.0});
  circuit.s("a", "b", "g", "0", 0.5);
  circuit.c("b", "0", 1.0);
  circuit.d("b", "c");
  circuit.r("c", "0", 1.0);
  circuit.save_v("b");
  const Told told = watched(circuit.network(), 1.0, sparse);
  CHECK(told.elements == std::vector<std::string>{"D1", "SW1"});
  REQUIRE(told.events.size() == 1);
  CHECK(told.events[0].time == Approx(0.25).epsilon(1e-12));
  CHECK(told.events[0].jump);
  CHECK(told.events[0].mode_change);
  CHECK(told.start[1] == 0);
  CHECK(told.positions[0] == Flags{1, 1});
}

TEST_CASE("a diode across a closed switch is told to conduct, though no signal reads its share", "[unit]") {
  test::TestCircuit circuit;
  circuit.v("dc", "0", model::Dc{1.0});
  circuit.v("g", "0", model::Pulse{.initial = 1.0, .delay = 1.0});
  circuit.v("h", "0", model::Pulse{.pulsed = 1.0, .delay = 1.0});
  circuit.d("a", "dc");
  circuit.d("0", "a");
  circuit.s("dc", "a", "g", "0", 0.5);
  circuit.s("a", "0", "h", "0", 0.5);
  circuit.l("a", "m", 1.0);
  circuit.r("m", "0", 1.0);
  circuit.save_i_l(0);
  const Told told = watched(circuit.network(), 2.0, false);
  CHECK(told.elements == std::vector<std::string>{"D1", "D2", "SW1", "SW2"});
  // From 1 on the inductor's current comes out of ground, through the switch and the diode across it.
  CHECK(told.positions == std::vector<Flags>{{0, 1, 0, 1}});
}
