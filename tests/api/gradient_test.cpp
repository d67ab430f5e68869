// Derivatives of measurements through the public headers alone, against those of closed forms.

#include <pwlsim/pwlsim.hpp>

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <string>

#include "support/errors.hpp"

using namespace pwlsim;
using pwlsim::test::id_of_error;

namespace {

constexpr double wanted = 1e-9;  ///< relative

/// i rises towards V/R for DT, then falls towards 0: its mean is D V/R.
Circuit chopper() {
  Circuit circuit("chopper");
  circuit.parameter("fs", "10k").parameter("D", 0.4);
  circuit.cards(
      "V1 in 0 20\nS1 in a g 0 SX\nD1 0 a DX\nL1 a b 1m\nR1 b 0 5\nVg g 0 PULSE(0 1 0 0 0 {D/fs} {1/fs})\n"
      ".model SX SW(Ron=0 Vt=0.5 Vh=0)\n.model DX D\n");
  return circuit;
}

}  // namespace

TEST_CASE("api: the gradient of a run is that of its exponential", "[unit]") {
  Circuit circuit("rc");
  circuit.voltage_source("V1", "in", "0", 10).resistor("R1", "in", "out", "1k").capacitor("C1", "out", "0", 1e-6, {{"ic", 2}});
  circuit.measure("end", "FIND v(out) AT=1m");
  const Gradient gradient = circuit.gradient("end", {"R1", "V1", "ic(C1)"}, {.stop = 2e-3, .use_initial_conditions = true});
  // v = V + (v0 − V) e^{−x}, x = t/RC = 1
  const double fall = std::exp(-1.0);
  CHECK(gradient.measurement == "end");
  CHECK(gradient.measured == Approx(10.0 - 8.0 * fall).epsilon(wanted));
  REQUIRE(gradient.derivatives.size() == 3);
  CHECK(gradient.derivatives[0].parameter == "R1");
  CHECK(gradient.derivatives[0].value == Approx(-8.0 * fall / 1e3).epsilon(wanted));
  CHECK(gradient.derivatives[1].value == Approx(1.0 - fall).epsilon(wanted));
  CHECK(gradient.derivatives[2].value == Approx(fall).epsilon(wanted));
  CHECK(gradient.derivatives[2].normalised == Approx(2.0 * fall / gradient.measured).epsilon(wanted));
}

TEST_CASE("api: gradients of a steady state, of one measurement and of all", "[unit]") {
  Circuit circuit = chopper();
  circuit.cards(".pss\n.meas pss mean AVG i(L1)\n.meas pss t PERIOD\n.tran 1u 100u\n.meas tran start AVG v(in)\n");
  const Gradient mean = circuit.gradient("mean", {"D", "V1"});
  CHECK(mean.measured == Approx(0.4 * 20 / 5).epsilon(wanted));
  CHECK(mean.derivatives[0].value == Approx(20.0 / 5).epsilon(wanted));
  CHECK(mean.derivatives[1].value == Approx(0.4 / 5).epsilon(wanted));
  const std::vector<Gradient> all = circuit.gradients({}, {"fs", "D"});
  REQUIRE(all.size() == 3);
  CHECK(all[1].measurement == "t");
  CHECK(all[1].derivatives[0].value == Approx(-1e-8).epsilon(wanted));  // −1/fs²
  CHECK(all[2].measurement == "start");
}

TEST_CASE("api: gradients that cannot be are refused by id", "[unit]") {
  Circuit circuit = chopper();
  circuit.measure("top", "MAX i(L1)");
  const Options options{.stop = 1e-3};
  CHECK(id_of_error([&] { (void)circuit.gradient("bottom", {"V1"}, options); }) == "E-sens-no-measurement");
  CHECK(id_of_error([&] { (void)circuit.gradient("top", {"V7"}, options); }) == "E-sens-unknown-parameter");
  CHECK(id_of_error([&] { (void)circuit.gradient("top", {}, options); }) == "E-missing-value");
}
