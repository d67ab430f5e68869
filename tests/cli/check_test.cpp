// --check: verdicts, exit status, JSON, and what it refuses.

#include <catch2/catch.hpp>

#include "cli/run_in.hpp"
#include "support/json.hpp"

using namespace pwlsim::test;
using Catch::Matchers::Contains;

namespace {

const std::string pulsed_filter = "f\nV1 a 0 PULSE(0 1 0 0 0 0.5m 1m)\nR1 a b 1k\nC1 b 0 1u\n.save v(b) i(R1)\n.tran 20u 3m uic\n";
// A lossless tank over 1,000 periods: at such a tolerance the sparse engine's phase is off by a radian.
const std::string tank = "t\nC1 a 0 1u ic=1\nL1 a 0 1u ic=0\n.save v(a)\n.tran 50u 6.28m uic\n";

}  // namespace

TEST_CASE("--check: the rows agree with the other engine, signal by signal", "[unit]") {
  const Scratch scratch;
  scratch.write("f.net", pulsed_filter);
  const Finished finished = run_in(scratch, {"f.net", "--check", "--quiet"});
  CHECK(finished.status == 0);
  CHECK(finished.err.empty());
  CHECK_THAT(finished.out, Catch::StartsWith("agrees: ") && Contains("from the sparse engine at reltol 1e-0") && Contains("\nv(b) ") &&
                               Contains("\ni(R1) "));
  CHECK(scratch.holds("f.csv"));
  // With the rows on standard output the report goes to standard error.
  const Finished piped = run_in(scratch, {"f.net", "--check", "--quiet", "-o", "-"});
  CHECK(piped.out == read_file(scratch / "f.csv"));
  CHECK_THAT(piped.err, Catch::StartsWith("agrees: "));
}

// The secondary's current is zero at t = 0, and v(s) with it; a picosecond later the blocked diode's Roff has ended the decay, v(s) = −0.98·√(L2/L1)·100 V, and the
// drain begins to rise.
TEST_CASE("--check: a decay at the start, which one engine follows and the other takes for a jump, is no difference", "[unit]") {
  const Scratch scratch;
  scratch.write("f.net",
                "flyback\nVin in 0 100\nL1 in d 500u ic=0\nL2 0 s 20u ic=0\nK1 L1 L2 0.98\nS1 d 0 g 0 SX\nCoss d 0 200p ic=0\nD1 s out DB\n"
                "C1 out 0 220u ic=0\nR1 out 0 20\nVg g 0 PULSE(0 10 0 30n 30n 3u 12u)\n.model SX SW(Ron=0.2 Roff=1e8 Vt=5)\n"
                ".model DB D(Ron=30m Roff=1e8 Vfwd=0.6)\n.save v(s) v(out)\n.tran 10u 1m uic\n");
  const Finished finished = run_in(scratch, {"f.net", "--check", "--json", "--quiet"});
  CHECK(finished.status == 0);
  const Json check = read_json(finished.out)["check"];
  INFO(check["reason"].string);
  CHECK(check["verdict"].string == "agrees");
}

TEST_CASE("--check --json: verdict, levels and signals", "[unit]") {
  const Scratch scratch;
  scratch.write("f.net", pulsed_filter);
  const Finished finished = run_in(scratch, {"f.net", "--check", "--json", "--quiet"});
  const Json check = read_json(finished.out)["check"];
  CHECK(check["verdict"].string == "agrees");
  CHECK(check["rows"].number == 151);
  REQUIRE(check["levels"].array.size() >= 2);
  CHECK(check["levels"].array[0]["engine"].string == "sparse");
  CHECK(check["levels"].array[0]["reltol"].number == 1e-4);
  REQUIRE(check["signals"].array.size() == 2);
  const Json& voltage = check["signals"].array[0];
  CHECK(voltage["name"].string == "v(b)");
  // The largest is at the end of the third pulse, with q = e^-1/2 a half period: (1 − q)(1 + q² + q⁴).
  const double q = std::exp(-0.5);
  CHECK(voltage["maximum"].number == Approx((1 - q) * (1 + q * q + q * q * q * q)).epsilon(1e-9));
  CHECK(voltage["difference"].number <= 2.0 * voltage["error"].number + 1e-9);
  CHECK(read_json(run_in(scratch, {"f.net", "--json", "--quiet"}).out)["check"].kind == Json::Kind::null);
}

TEST_CASE("--check: a wrong run is noticed, with status 1 and all of its rows", "[unit]") {
  const Scratch scratch;
  scratch.write("t.net", tank);
  const Finished finished = run_in(scratch, {"t.net", "--engine", "sparse", "--reltol", "1e-3", "--check"});
  CHECK(finished.status == 1);
  CHECK_THAT(finished.out, Catch::StartsWith("differs: v(a) differs by ") && Contains("from the exact engine"));
  CHECK_THAT(finished.err, Contains("error[E-check-differs]: v(a) differs by "));
  const std::string rows = read_file(scratch / "t.csv");
  CHECK(std::count(rows.begin(), rows.end(), '\n') == 1 + 127);
  CHECK(run_in(scratch, {"t.net", "--check", "--quiet"}).status == 0);  // the exact engine's are right: no phase is lost
}

// When the gates of a thyristor bridge open the current of its inductor behind Roff of 10 MΩ, its voltage is 10⁸ V for nanoseconds. Leaks of 10⁻⁵ A have signs after that: the sparse engine judged
// them by that voltage, and kept a diode on that conducts backwards.
TEST_CASE("--check: the sparse engine judges signs after a surge of voltage by what is there then", "[unit]") {
  const Scratch scratch;
  scratch.write(
      "b.net",
      "phase-controlled bridge\nV1 ac1 ac2 SIN(0 325 50)\nRs ac1 a 0.05\nX1 a dc g1 scr\nX2 ac2 dc g2 scr\nX3 0 a g2 scr\nX4 0 ac2 g1 scr\n"
      "L1 dc x 20m ic=0\nR1 x y 2\nVe y 0 100\nVg1 g1 0 PULSE(0 1 3.5m 10u 10u 1m 20m)\nVg2 g2 0 PULSE(0 1 13.5m 10u 10u 1m 20m)\n"
      ".subckt scr a k g\nS1 a m g 0 SG\nD1 m k DX\n.model SG SW(Ron=1m Roff=1e7 Vt=0.5)\n.model DX D(Ron=5m Roff=1e7 Vfwd=1)\n.ends\n"
      ".save v(x1.m) v(x2.m) v(x3.m) v(x4.m) i(l1)\n.tran 0.1m 60m uic\n");
  const Finished finished = run_in(scratch, {"b.net", "--check", "--quiet"});
  INFO(finished.out << finished.err);
  CHECK(finished.status == 0);
  CHECK_THAT(finished.out, Catch::StartsWith("agrees"));
}

TEST_CASE("--check: what the other engine refuses has no verdict", "[unit]") {
  const Scratch scratch;
  scratch.write("c.net", read_file(std::string(PWLSIM_SOURCE_DIR) + "/tests/messages/E-jump-order.net"));
  const Finished finished = run_in(scratch, {"c.net", "--check"});
  CHECK(finished.status == 0);
  CHECK_THAT(finished.out, Catch::StartsWith("no verdict: the sparse engine did not reach the end: E-jump-order"));
  CHECK_THAT(finished.err, Contains("warning[W-check-undecided]"));
}

TEST_CASE("--check refuses sweeps and decks without .tran, before anything is written", "[unit]") {
  const Scratch scratch;
  scratch.write("s.net", "s\nV1 a 0 1\nR1 a 0 {R}\n.step param R list 1 2\n.tran 1 2\n");
  scratch.write("o.net", "o\nV1 a 0 1\nR1 a 0 1\n.op\n");
  const auto before = scratch.names();
  const Finished sweep = run_in(scratch, {"s.net", "--check"});
  CHECK(sweep.status == 2);
  CHECK_THAT(sweep.err, Contains("error[E-check-sweep]"));
  const Finished point = run_in(scratch, {"o.net", "--check"});
  CHECK(point.status == 2);
  CHECK_THAT(point.err, Contains("error[E-no-transient]"));
  CHECK(scratch.names() == before);
}
