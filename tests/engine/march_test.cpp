/// Runs that start from any state at any time.
#include "engine/exact/march.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <memory>

#include "engine/exact/exact.hpp"
#include "engine/exact/exact_model.hpp"
#include "engine/exact/start.hpp"
#include "support/circuit.hpp"

using namespace pwlsim;
using namespace pwlsim::test;

namespace {

constexpr double switching_period = 10e-6;
constexpr double merge = 1e-18;             ///< s
constexpr double segment_rounding = 1e-12;  ///< of some hundred segments, relative to the largest state

/// A buck in discontinuous conduction: its diode turns off at an event, its switch is a clock.
TestCircuit buck() {
  model::Pulse gate;
  gate.pulsed = 1.0;
  gate.width = 0.3 * switching_period;
  gate.period = switching_period;
  TestCircuit c;
  c.v("in", "0", model::Dc{12.0});
  c.v("g", "0", gate);
  c.s("in", "sw", "g", "0", 0.5);
  c.d("0", "sw");
  c.l("sw", "out", 10e-6);
  c.c("out", "0", 10e-6);
  c.r("out", "0", 20.0);
  c.save_v("out");
  return c;
}

/// A rectifier whose source does not repeat within the run, and begins late.
TestCircuit rectifier() {
  model::Sin late = sine(1.0, 7e3);
  late.delay = 15e-6;
  TestCircuit c;
  c.v("a", "0", late);
  c.r("a", "b", 1.0);
  c.d("b", "out");
  c.c("out", "0", 10e-6);
  c.r("out", "0", 20.0);
  c.save_v("out");
  return c;
}

class CountsEvents : public engine::Observer {
 public:
  bool instant(const engine::InstantView& view) override {
    times.push_back(view.time);
    return true;
  }
  std::vector<double> times;
};

std::shared_ptr<const engine::ExactModel> prepared(TestCircuit circuit) {
  Diagnostics diagnostics;
  auto model = engine::prepare(circuit.network(), diagnostics);
  REQUIRE(model != nullptr);
  return model;
}

engine::March march_on(const engine::ExactModel& model) {
  engine::March::Options options;
  options.merge = merge;
  engine::March march(model, options);
  march.restart(engine::start_from_initial_values(model));
  return march;
}

void run(engine::March& march, double until) { REQUIRE(march.advance(until, nullptr).outcome == engine::Outcome::completed); }

double distance(const engine::RunState& a, const engine::RunState& b) {
  double worst = 0.0, size = 0.0;
  for (std::size_t i = 0; i < a.xi.size(); ++i) {
    if (a.xi[i].size() == 0) continue;  // sources alone
    worst = std::max(worst, (a.xi[i] - b.xi[i]).cwiseAbs().maxCoeff());
    size = std::max(size, a.xi[i].cwiseAbs().maxCoeff());
  }
  return worst / size;
}

}  // namespace

// The second half begins left of an edge of the gate, which is an instant of the whole run as well.
TEST_CASE("two half runs that meet at an instant equal one to the last bit", "[unit]") {
  const auto model = prepared(buck());
  for (const int periods : {1, 7, 20}) {
    engine::March whole = march_on(*model), halves = march_on(*model);
    run(whole, 40 * switching_period);
    run(halves, periods * switching_period);
    CHECK(halves.state().time == periods * switching_period);
    run(halves, 40 * switching_period);
    for (std::size_t i = 0; i < whole.state().xi.size(); ++i) CHECK(whole.state().xi[i] == halves.state().xi[i]);
    CHECK(whole.state().on == halves.state().on);
  }
}

TEST_CASE("a run may be left and entered anywhere", "[unit]") {
  const auto model = GENERATE(prepared(buck()), prepared(rectifier()));
  engine::March whole = march_on(*model);
  run(whole, 20 * switching_period);
  for (const double share : {0.037, 0.31, 0.5, 0.871}) {
    engine::March halves = march_on(*model);
    run(halves, share * 20 * switching_period);
    run(halves, 20 * switching_period);
    CHECK(distance(halves.state(), whole.state()) <= segment_rounding);
  }
}

TEST_CASE("instants have the time of the run, and those of the second half are not those of the first", "[unit]") {
  const auto model = prepared(buck());
  engine::March march = march_on(*model);
  run(march, 10.5 * switching_period);
  CountsEvents seen;
  REQUIRE(march.advance(12.0 * switching_period, &seen).outcome == engine::Outcome::completed);
  REQUIRE(seen.times.size() >= 3);
  CHECK(seen.times.front() == 10.5 * switching_period);  // where it was entered
  const auto at = [&](double time) {
    return std::any_of(seen.times.begin(), seen.times.end(), [&](double t) { return std::abs(t - time) <= segment_rounding * time; });
  };
  CHECK(at(11.0 * switching_period));
  CHECK(at(11.3 * switching_period));
  CHECK(seen.times.back() < 12.0 * switching_period);  // left to the next run
}

// What an instant is does not depend on how long the run is: an edge 1e-16 s behind another is one with it at merge = 1e-15 s, and of its own at 1e-18 s.
TEST_CASE("how close instants are one is given in seconds", "[unit]") {
  model::Pulse first, second;
  first.pulsed = second.pulsed = 1.0;
  first.delay = 1e-6;
  second.delay = 1e-6 + 1e-16;
  first.width = second.width = 2.0;
  TestCircuit c;
  c.v("a", "0", first);
  c.v("b", "0", second);
  c.r("a", "c", 1.0);
  c.r("b", "c", 1.0);
  c.c("c", "0", 1e-6);
  c.save_v("c");
  const auto model = prepared(c);
  for (const auto& [closest, instants] : {std::pair{1e-15, 2}, std::pair{1e-18, 3}}) {
    engine::March::Options options;
    options.merge = closest;
    engine::March march(*model, options);
    march.restart(engine::start_from_initial_values(*model));
    CountsEvents seen;
    REQUIRE(march.advance(1.0, &seen).outcome == engine::Outcome::completed);
    CHECK(seen.times.size() == static_cast<std::size_t>(instants));
  }
}
