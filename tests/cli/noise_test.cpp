// What a run says and what it leaves out: notes that concern nobody, digits on a terminal, the error last, whole periods.

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "cli/run_in.hpp"
#include "support/json.hpp"

using namespace pwlsim::test;
using Catch::Matchers::Contains;

namespace {

/// Diodes in parallel: how the current divides is open.
const std::string parallel_diodes = "parallel\nV1 a 0 SIN(0 1 50)\nR1 a b 1k\nD1 b 0 DI\nD2 b 0 DI\n.model DI D\n.tran 1m 20m\n";

}  // namespace

TEST_CASE("a note on signals that nobody named, measured or draws is kept for --verbose", "[unit]") {
  const Scratch scratch;
  scratch.write("d.net", parallel_diodes);
  scratch.write("saved.net", parallel_diodes + ".save i(D1)\n");
  scratch.write("measured.net", parallel_diodes + ".meas m MAX i(D2)\n");
  scratch.write("other.net", parallel_diodes + ".meas m MAX i(R1)\n");
  const auto says = [&](const std::vector<std::string>& arguments) {
    return run_in(scratch, arguments).err.find("N-indeterminate") != std::string::npos;
  };
  CHECK_FALSE(says({"d.net"}));
  CHECK_FALSE(says({"other.net"}));
  CHECK(says({"d.net", "--verbose"}));
  CHECK(says({"d.net", "--plot", "p.svg"}));
  CHECK(says({"saved.net"}));
  CHECK(says({"measured.net"}));
  CHECK_THAT(run_in(scratch, {"d.net", "--json"}).out, Contains("N-indeterminate"));  // not lost
}

TEST_CASE("an error comes last, behind one line for all measurements that it prevents", "[unit]") {
  const Scratch scratch;
  // v = -1 + 2 i, less 0.5 i in R1: without current -1 V across the diode, with it i = 2/3 A: both hold.
  scratch.write(
      "h.net",
      "wrong sign\nV1 e 0 -1\nH1 b e V2 2\nR1 b c 0.5\nD1 c d DI\nV2 d 0 0\n.model DI D\n.tran 1m 1\n.meas m1 AVG v(b)\n.meas m2 MAX "
      "v(b)\n.meas m3 MIN v(b)\n");
  const Finished finished = run_in(scratch, {"h.net"});
  CHECK(finished.status == 1);
  const std::size_t warning = finished.err.find("warning[W-measurement-failed]"), error = finished.err.find("error[E-not-unique]");
  REQUIRE(warning != std::string::npos);
  REQUIRE(error != std::string::npos);
  CHECK(warning < error);
  CHECK(finished.err.find("warning[W-measurement-failed]", warning + 1) == std::string::npos);
  CHECK_THAT(finished.err, Contains("(and so did 2 other measurements)"));
  CHECK_THAT(finished.err,
             Contains("the linear part is not passive with H1; try the other sign or a smaller gain there, or .options nonunique=stay"));
}

TEST_CASE("measurements have six digits on a terminal, and all elsewhere", "[unit]") {
  const Scratch scratch;
  scratch.write("d.net", "divider\nV1 a 0 1\nR1 a b 1\nR2 b 0 2\n.tran 1m 10m\n.meas m AVG v(b)\n");
  // With `-o -` results go to standard error.
  Spawned program({"d.net", "-o", "-", "--no-progress"}, {.folder = scratch.path().string(), .terminal = true});
  CHECK_THAT(program.finish().err, Contains("m = 0.666667\r\n"));
  CHECK(value_of(run_in(scratch, {"d.net"}).out, "m") == Approx(2.0 / 3.0).epsilon(1e-14));
}

TEST_CASE("LAST=n PERIODS OF a source is a window of whole periods", "[unit]") {
  const Scratch scratch;
  // sin² over whole periods: the half; over 2.3 periods it is not.
  const std::string deck =
      "sine\nV1 a 0 SIN(0 2 50)\nR1 a 0 1\nX1 a half\n.subckt half a\nV2 b 0 PULSE(0 1 0 0 0 1m 4m)\nR2 a b 1\n.ends\n"
      ".tran 1m 46m\n.meas whole AVG v(a)*v(a) LAST=2 PERIODS OF v1\n.meas rest AVG v(a)*v(a)\n"
      ".meas one RMS v(a) LAST PERIOD OF V1\n.meas pulse AVG v(x1.b) LAST=3 PERIODS OF X1.V2\n";
  scratch.write("d.net", deck);
  const std::string out = run_in(scratch, {"d.net"}).out;
  CHECK(value_of(out, "whole") == Approx(2.0).epsilon(1e-12));
  CHECK(value_of(out, "one") == Approx(std::numbers::sqrt2).epsilon(1e-12));
  CHECK(value_of(out, "pulse") == Approx(0.25).epsilon(1e-12));
  CHECK(std::abs(value_of(out, "rest") - 2.0) > 1e-3);
}

TEST_CASE("LAST=n PERIODS OF something that does not repeat, or of more periods than there are, is refused", "[unit]") {
  const Scratch scratch;
  const auto said = [&](const std::string& window) {
    scratch.write("d.net", "sine\nV1 a 0 SIN(0 2 50)\nR1 a 0 1\nV2 b 0 3\nR2 b 0 1\n.tran 1m 46m\n.meas m AVG v(a) " + window + "\n");
    const Finished finished = run_in(scratch, {"d.net"});
    CHECK(finished.status == 2);
    return finished.err;
  };
  CHECK_THAT(said("LAST=2 PERIODS OF V2"), Contains("error[E-measurement]: measurement m: V2 is not a periodic source"));
  CHECK_THAT(said("LAST=2 PERIODS OF V9"), Contains("V9 is not a periodic source"));
  CHECK_THAT(said("LAST=3 PERIODS OF V1"), Contains("the run contains 2.3 periods of V1 (0.02 s), not 3"));
  CHECK_THAT(said("LAST=1.5 PERIODS OF V1"), Contains("error[E-range]"));
  CHECK_THAT(said("LAST=2 OF V1"), Contains("error[E-missing-value]"));
  CHECK_THAT(said("LAST=2 PERIODS OF"), Contains("error[E-missing-value]"));
}

TEST_CASE("an efficiency above one is warned about where its window holds no whole periods, and else for the energy that is stored",
          "[unit]") {
  const Scratch scratch;
  const std::string choke =
      "choke\nV1 in 0 10\nVg g 0 PULSE(0 1 0 0 0 4u 10u)\nS1 in a g 0 SX\nD1 0 a DI\nL1 a out 100u ic=1\nR1 out 0 4\n.model SX SW(Vt=0.5)\n"
      ".model DI D\n.tran 1u 100u uic\n";
  const auto said = [&](const std::string& window, const std::string& name) {
    scratch.write("d.net", choke + ".meas pin AVG -v(in)*i(V1) " + window + "\n.meas pout AVG v(out)*i(R1) " + window + "\n.meas " + name +
                               " PARAM pout/pin\n");
    return run_in(scratch, {"d.net"}).err;
  };
  CHECK_THAT(said("FROM=84u", "eta"),
             Contains("warning[W-efficiency]: eta = 1.60") && Contains("contains 1.6 periods of Vg; try LAST=1 PERIODS OF Vg"));
  CHECK_THAT(said("FROM=84u TO=94u", "eff"), !Contains("periods of"));
  CHECK_THAT(said("FROM=84u", "ratio"), !Contains("W-efficiency"));
  CHECK_THAT(said("LAST=1 PERIODS OF Vg", "eta"), !Contains("periods of"));
}
