// Common periods and sources that have always been on.

#include <catch2/catch.hpp>

#include "steady/period.hpp"

using namespace pwlsim;
using namespace pwlsim::steady;

namespace {

model::Source source(const char* name, model::SourceFunction function) {
  model::Source s;
  s.label.name = name;
  s.function = std::move(function);
  return s;
}
model::Pulse pulse(double period, double delay = 0.0) { return {0.0, 1.0, delay, 0.0, 0.0, 0.25 * period, period}; }
model::Sin sine(double frequency) {
  model::Sin s;
  s.amplitude = 1.0;
  s.frequency = frequency;
  return s;
}

}  // namespace

TEST_CASE("the common period is the least common multiple of the periods as written", "[unit]") {
  CHECK(common_period({source("V1", pulse(1e-5))}).seconds == 1e-5);
  CHECK(common_period({source("V1", pulse(10e-6)), source("V2", pulse(15e-6))}).seconds == Approx(30e-6).epsilon(1e-15));
  const CommonPeriod mains = common_period({source("Vac", sine(50.0)), source("Vg", pulse(1e-4)), source("Vdc", model::Dc{5.0})});
  CHECK(mains.seconds == 0.02);
  REQUIRE(mains.sources.size() == 2);
  CHECK(mains.sources[0].cycles == 1);
  CHECK(mains.sources[1].cycles == 200);
  // 65 kHz beside 50 Hz: 1300 cycles; 1/65000 s is no short decimal.
  CHECK(common_period({source("Vac", sine(50.0)), source("Vt", sine(65e3))}).sources[1].cycles == 1300);
}

TEST_CASE("periods whose ratio is no fraction have no common one", "[unit]") {
  const CommonPeriod none = common_period({source("V1", sine(50.0)), source("V2", sine(70.710678118654755))});
  CHECK(none.seconds == 0.0);
  CHECK(none.failure.find("V1 (50 Hz)") != std::string::npos);
  CHECK(none.failure.find("V2 (70.7107 Hz)") != std::string::npos);
  // 70.71/50 = 7071/5000: a common period of 100 s would hold 5000 cycles of the slower source.
  CHECK_FALSE(common_period({source("V1", sine(50.0)), source("V2", sine(70.71))}).failure.empty());
}

TEST_CASE("a source that does not repeat is taken at its last value, one that does as if it had always been on", "[unit]") {
  model::Network network;
  network.sources = {source("Vstart", model::Pwl{{{0.0, 0.0}, {1e-3, 5.0}}}), source("Vg", pulse(1e-5, 3.2e-5))};
  CHECK(common_period(network.sources).settled == std::vector<std::string>{"Vstart"});
  const model::Network settled = with_settled_sources(network);
  CHECK(std::get<model::Dc>(settled.sources[0].function).value == 5.0);
  const auto& gate = std::get<model::Pulse>(settled.sources[1].function);
  CHECK(gate.delay < 0.0);
  CHECK(gate.delay == Approx(-8e-6).epsilon(1e-9));  // 32 us less four periods
}

TEST_CASE("whole multiples are told from others", "[unit]") {
  CHECK(whole_multiple(30e-3, 10e-3) == 3);
  CHECK(whole_multiple(15e-3, 10e-3) == 0);
  CHECK(whole_multiple(1e-3, 10e-3) == 0);
}
