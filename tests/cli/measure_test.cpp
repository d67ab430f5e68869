// What .meas and .four print, and where.

#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numbers>
#include <sstream>
#include <string>

#include "cli/run_in.hpp"
#include "support/json.hpp"

using namespace pwlsim::test;
using Catch::Matchers::Contains;

namespace {

/// 2 V over two equal resistors from 1 ms to 3 ms of 4 ms.
const std::string measured_divider =
    "divider\n"
    "V1 a 0 PULSE(0 2 1m 0 0 2m 10m)\n"
    "R1 a b 1k\n"
    "R2 b 0 1k\n"
    ".tran 1m 4m\n"
    ".save v(b)\n"
    ".meas tran mean AVG v(b) FROM=0 TO=4m\n"
    ".meas tran power AVG v(a,b)*i(R1) FROM 1m TO 3m\n"
    ".meas tran eta PARAM 2*power/1m\n"
    ".meas tran top FIND v(a) WHEN v(b)=0.5 RISE=1\n"
    ".meas tran never WHEN v(b)=5\n"
    ".end\n";
const std::string measured_lines = "mean = 0.5\npower = 0.001\neta = 2\ntop = 2\nnever = failed\n";

}  // namespace

TEST_CASE("measurements are lines name = value on standard output", "[unit]") {
  const Scratch scratch;
  scratch.write("divider.net", measured_divider);
  const Finished finished = run_in(scratch, {"divider.net"});
  CHECK(finished.status == 0);
  CHECK(finished.out == measured_lines);
  CHECK_THAT(
      finished.err,
      Contains(
          "divider.net:11:12: warning[W-measurement-failed]: measurement never failed: v(b) crosses 5 at no time from 0 s to 0.004 s"));
  // Measured signals that are not saved are no columns.
  CHECK(read_file(scratch / "divider.csv") == "time,v(b)\n0,0\n0.001,1\n0.002,1\n0.003,0\n0.004,0\n");
}

TEST_CASE("measurements do not depend on the output step, nor on --events", "[unit]") {
  const Scratch scratch;
  std::string coarse = measured_divider;
  coarse.replace(coarse.find(".tran 1m"), 8, ".tran 3m");
  scratch.write("coarse.net", coarse);
  CHECK(run_in(scratch, {"coarse.net", "--quiet"}).out == measured_lines);
  CHECK(run_in(scratch, {"coarse.net", "--quiet", "--events"}).out == measured_lines);
}

TEST_CASE("with -o - measurements go to standard error, --quiet or not", "[unit]") {
  const Scratch scratch;
  scratch.write("divider.net", measured_divider);
  const Finished finished = run_in(scratch, {"divider.net", "-o", "-", "--quiet"});
  CHECK(finished.status == 0);
  CHECK(finished.err == measured_lines);
  CHECK(finished.out == "time,v(b)\n0,0\n0.001,1\n0.002,1\n0.003,0\n0.004,0\n");
}

TEST_CASE("a run that fails still gives the measurements whose windows it reached the end of", "[unit]") {
  const Scratch scratch;
  // From 2 ms on the current source has no way to go: the diode blocks.
  scratch.write("stuck.net",
                "stuck\n"
                "I1 0 a PULSE(1 -1 2m 0 0 1 2)\n"
                "D1 a b DI\n"
                "R1 b 0 1\n"
                ".model DI D\n"
                ".tran 1m 4m\n"
                ".meas early AVG v(b) TO=1m\n"
                ".meas late AVG v(b)\n");
  const Finished finished = run_in(scratch, {"stuck.net"});
  CHECK(finished.status == 1);
  CHECK(finished.out == "early = 1\nlate = failed\n");
  CHECK_THAT(finished.err, Contains("measurement late failed: the run ended at t = 0.002 s, before the end of its window at 0.004 s"));
}

TEST_CASE(".four prints a table as ngspice does", "[unit]") {
  const Scratch scratch;
  scratch.write("sine.net",
                "sine\n"
                "V1 a 0 SIN(1 2 50)\n"
                "R1 a 0 1k\n"
                ".tran 1m 40m\n"
                ".four 50 3 v(a)\n");
  const Finished finished = run_in(scratch, {"sine.net"});
  CHECK(finished.status == 0);
  CHECK_THAT(finished.out, Contains("Fourier analysis for v(a):\n  No. Harmonics: 4, THD: "));
  CHECK_THAT(finished.out, Contains("\n1        50            2               "));
}

TEST_CASE("a mistake in a .meas card is an error before anything runs", "[unit]") {
  const Scratch scratch;
  scratch.write("wrong.net", "wrong\nV1 a 0 1\nR1 a 0 1\n.tran 1m 1m\n.meas x AVG v(b)\n");
  const Finished finished = run_in(scratch, {"wrong.net"});
  CHECK(finished.status == 2);
  CHECK(finished.out.empty());
  CHECK(!std::filesystem::exists(scratch / "wrong.csv"));
}

// A diode with Ron = 10 mOhm and 0.7 V feeds 1 kOhm from 10 sin ωt: it conducts while 10 sin ωt > 0.7, and carries nothing before that.
TEST_CASE("the current of a blocking diode passes zero when it starts and ends to flow, not before", "[unit]") {
  constexpr double pi = std::numbers::pi, rounding = 1e-12;
  const Scratch scratch;
  scratch.write("d.net",
                "blocking diode\nV1 a 0 SIN(0 10 50)\nD1 a b DD\nR1 b 0 1k\n.model DD D(Ron=10m Vfwd=0.7)\n.tran 1m 40m\n"
                ".meas first WHEN i(D1)=0 FALL=1\n.meas second WHEN i(D1)=0 RISE=LAST\n.meas off FIND i(D1) AT=0.1m\n");
  const Finished finished = run_in(scratch, {"d.net", "--quiet"});
  const auto value = [&](const std::string& name) {
    const auto at = finished.out.find(name + " = ");
    REQUIRE(at != std::string::npos);
    return std::strtod(finished.out.c_str() + at + name.size() + 3, nullptr);
  };
  const double delay = std::asin(0.07) / (100.0 * pi);
  CHECK(value("first") == Approx(0.01 - delay).epsilon(rounding));
  CHECK(value("second") == Approx(0.02 + delay).epsilon(rounding));
  CHECK(value("off") == 0.0);
}

TEST_CASE("an extremum of what has no value for part of the window fails", "[unit]") {
  const Scratch scratch;
  scratch.write("n.net",
                "part of it\nV1 a 0 SIN(0 2 50)\nR1 a 0 1\n.tran 1m 20m\n.meas m MAX sqrt(v(a)-1)\n.meas w WHEN sqrt(v(a)-1)=0.5\n");
  const Finished finished = run_in(scratch, {"n.net"});
  CHECK(finished.out == "m = failed\nw = failed\n");
  CHECK_THAT(finished.err, Contains("not finite"));
}

// The end of the ladder begins with t⁵: a small difference of large terms, of which pieces a millionth of a millionth long were made without end. The average is that of e^{At} of
// the ladder and its source in 30 digits (mpmath).
TEST_CASE("Krylov segments are measured where a signal begins far below what drives it", "[unit]") {
  const Scratch scratch;
  std::string deck = "ladder\nVs g0 0 SIN(0 10 10k)\n";
  for (int k = 1; k <= 5; ++k) deck += fmt::format("R{0} g{1} g{0} 10\nC{0} g{0} 0 100n\n", k, k - 1);
  scratch.write("ladder.net", deck + ".tran 10u 1m\n.save v(g5)\n.meas tran a AVG v(g5)\n.end\n");
  const Finished finished = run_in(scratch, {"ladder.net", "--engine", "krylov", "--quiet"});
  REQUIRE(finished.status == 0);
  REQUIRE(finished.out.substr(0, 4) == "a = ");
  CHECK(std::strtod(finished.out.c_str() + 4, nullptr) == Approx(0.0743783623252223).epsilon(1e-9));
}

namespace {

/// The measurements of a run, name by name.
std::map<std::string, double> values_of(const Finished& finished) {
  REQUIRE(finished.status == 0);
  std::map<std::string, double> values;
  std::istringstream text(finished.out);
  for (std::string name, equals, value; text >> name >> equals >> value;) {
    char* end = nullptr;
    values[name] = std::strtod(value.c_str(), &end);
    REQUIRE(*end == 0);  // "failed" is no number
  }
  return values;
}

/// A line of 1 µH and 400 pF a section.
std::string line_of(int sections) {
  std::string deck;
  for (int k = 0; k < sections; ++k) deck += fmt::format("L{0} n{0} n{1} 1u\nC{0} n{1} 0 400p\n", k, k + 1);
  return deck;
}

}  // namespace

// A wire across two inductors of a line and a diode that charges 1 nF: the current of the wire is decided by a constraint of voltages, and each vector of a Krylov space has its rounding 1/h times.
// Segments in which that has eaten the diode's current missed its end (i(D1) ran backwards from 2.6 µs on). Dense modes, which have no such vectors, are the reference.
TEST_CASE("Krylov segments end where rounding would hide the end of a current", "[unit]") {
  const Scratch scratch;
  scratch.write("wire.net", "wire\nV1 in 0 PULSE(0 1 0.1u 0 0 0.5u 2u)\nR0 in n0 50\n" + line_of(50) +
                                "Rl n50 0 50\nRw n7 n9 0\nD1 n20 q DI\nCq q 0 1n\nRq q 0 1k\n.model DI D\n.tran 10n 4u uic\n.save v(q)\n"
                                ".meas tran least MIN i(D1)\n.meas tran loop MAX i(Rw)\n.meas tran last FIND v(q) AT=3.9u\n.end\n");
  const auto values = values_of(run_in(scratch, {"wire.net", "--engine", "krylov", "--quiet"}));
  const auto dense = values_of(run_in(scratch, {"wire.net", "--engine", "modes", "--quiet"}));
  CHECK(std::abs(values.at("least")) < 1e-12);
  CHECK(values.at("loop") == Approx(dense.at("loop")).epsilon(1e-9));
  CHECK(values.at("last") == Approx(dense.at("last")).epsilon(1e-9));
}

// The far end of the line is reached after 51·20 ns; before that its voltage is a power of time, nothing but rounding, and was split into 3,340 pieces down to 10⁻²⁰ s.
TEST_CASE("what is far below the rounding of a Krylov segment is one piece", "[unit]") {
  const Scratch scratch;
  scratch.write("far.net",
                "far end\nV1 s 0 SIN(0 1 1meg)\nR0 s n0 50\n" + line_of(51) +
                    "Rl n51 0 1meg\n.tran 10n 0.6u\n.save v(n1)\n.meas tran most MAX v(n51)\n.meas tran near INTEG v(n1)\n.end\n");
  const auto values = values_of(run_in(scratch, {"far.net", "--engine", "krylov", "--quiet"}));
  const auto dense = values_of(run_in(scratch, {"far.net", "--engine", "modes", "--quiet"}));
  CHECK(std::abs(values.at("most")) < 1e-11);  // what a segment of many vectors may be off by, of its largest voltage
  CHECK(values.at("near") == Approx(dense.at("near")).epsilon(1e-9));
  CHECK(read_json(run_in(scratch, {"far.net", "--engine", "krylov", "--json", "--quiet"}).out)["stats"]["steps"].number < 100);
}
