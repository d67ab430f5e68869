// Schematics of LTspice from the command line.

#include <catch2/catch.hpp>

#include "cli/run_in.hpp"

using namespace pwlsim::test;

namespace {

/// 1 V behind 1 kohm charges 1 uF, through a T junction.
const std::string low_pass = R"(Version 4
SHEET 1 880 680
WIRE 48 96 0 96
WIRE 192 96 128 96
WIRE 192 112 192 96
FLAG 0 176 0
FLAG 192 176 0
FLAG 192 96 out
SYMBOL voltage 0 80 R0
SYMATTR InstName V1
SYMATTR Value PULSE(0 1 0)
SYMBOL res 32 112 R270
SYMATTR InstName R1
SYMATTR Value 1k
SYMBOL cap 176 112 R0
SYMATTR InstName C1
SYMATTR Value 1µ
TEXT 0 240 Left 2 !.tran 1m\n.meas end FIND V(out) AT 1m
)";

}  // namespace

TEST_CASE("a schematic runs", "[unit]") {
  const Scratch scratch;
  scratch.write("low.asc", low_pass);
  const Finished finished = run_in(scratch, {"low.asc"});
  CHECK(finished.status == 0);
  CHECK(finished.out.starts_with("end = 0.63212055"));  // 1 - exp(-1)
  CHECK(read_file(scratch / "low.csv").starts_with("time,v(N001),v(out),i(V1)\n"));
}

TEST_CASE("the example of netlists/ runs with models at hand", "[unit]") {
  const Scratch scratch;
  const Finished finished = run_in(scratch, {PWLSIM_SOURCE_DIR "/netlists/boost_schematic.asc"});
  CHECK(finished.status == 0);
  CHECK(finished.err.find("IRF540N") != std::string::npos);
  // 12 V/(1 - D) at a duty cycle of a half, less 0.3 V + 0.1 V of the diode and the drops of 2 A in 20 mohm of the inductor and in half of the time 44 mohm.
  const double mean = std::stod(finished.out.substr(finished.out.find('=') + 1));
  CHECK(mean == Approx(24.0 - 0.37 - 2.0 * (0.04 + 0.044)).margin(0.1));
}

TEST_CASE("export of a schematic under a name .net writes its netlist", "[unit]") {
  const Scratch scratch;
  scratch.write("low.asc", low_pass);
  REQUIRE(run_in(scratch, {"export", "low.asc", "-o", "written.net"}).status == 0);
  CHECK(read_file(scratch / "written.net") ==
        "* low.asc\nV1 N001 0 PULSE(0 1 0)\nR1 N001 out 1k\nC1 out 0 1µ\n.tran 1m\n.meas end FIND V(out) AT 1m\n.backanno\n.end\n");
  REQUIRE(run_in(scratch, {"low.asc"}).status == 0);
  REQUIRE(run_in(scratch, {"written.net"}).status == 0);
  CHECK(read_file(scratch / "low.csv") == read_file(scratch / "written.csv"));

  SECTION("else its smoothed equivalent") {
    CHECK(run_in(scratch, {"export", "low.asc", "-o", "smooth.cir"}).status == 0);
    CHECK(read_file(scratch / "smooth.cir") != read_file(scratch / "written.net"));
  }
  SECTION("not over a file that is read") {
    scratch.write("block.net", "x");
    CHECK(run_in(scratch, {"export", "gone.asc", "-o", "block.net"}).status == 3);
    scratch.write("broken.asc", "Version 4\nWIRE 0 0\n");
    CHECK(run_in(scratch, {"export", "broken.asc", "-o", "block.net"}).status == 2);
    CHECK(read_file(scratch / "block.net") == "x");
  }
}
