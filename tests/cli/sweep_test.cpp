// Decks with .step: rows, tables, failures, signals.

#include <algorithm>
#include <catch2/catch.hpp>
#include <csignal>
#include <cstdlib>
#include <sstream>

#include "cli/run_in.hpp"
#include "spice/ngspice.hpp"
#include "support/json.hpp"
#include "waveform/raw_file.hpp"
#include "waveform/svg_plot.hpp"

using namespace pwlsim::test;
using Catch::Matchers::Contains;

namespace {

/// Dividers of 1 V: v(b) = R/(R + 1k) at once.
std::string swept_divider(const std::string& steps) {
  return "divider\n"
         "V1 a 0 1\n"
         "R1 a b 1k\n"
         "R2 b 0 {R}\n" +
         steps +
         ".tran 1m 1m\n"
         ".save v(b)\n"
         ".meas mean AVG v(b)\n";
}

}  // namespace

TEST_CASE("one CSV: the stepped values, then time, runs in order; measurements as a table", "[unit]") {
  const Scratch scratch;
  scratch.write("d.net", swept_divider(".step param R list 1k 3k\n"));
  const Finished finished = run_in(scratch, {"d.net"});
  CHECK(finished.status == 0);
  CHECK(read_file(scratch / "d.csv") == "R,time,v(b)\n1000,0,0.5\n1000,0.001,0.5\n3000,0,0.75\n3000,0.001,0.75\n");
  CHECK(finished.out == "R,mean\n1000,0.5\n3000,0.75\n");
  const Finished to_output = run_in(scratch, {"d.net", "-o", "-", "--quiet"});
  CHECK(to_output.out == read_file(scratch / "d.csv"));
  CHECK(to_output.err == finished.out);
}

TEST_CASE("sweeps: linear, by decades and octaves, lists, sources; the first of several changes fastest", "[unit]") {
  const Scratch scratch;
  const auto table = [&](const std::string& steps) {
    scratch.write("d.net", swept_divider(steps));
    return run_in(scratch, {"d.net", "--quiet"}).out;
  };
  CHECK(table(".step param R 1k 3k 1k\n.param R=5\n") == "R,mean\n1000,0.5\n2000,0.6666666666666666\n3000,0.75\n");
  CHECK(table(".step param R 3k 1k 2k\n") == "R,mean\n3000,0.75\n1000,0.5\n");
  CHECK(table(".step param R 0.1 0.5 0.1\n").find("\n0.3,") != std::string::npos);
  CHECK(table(".step param R 0.7 0.1 0.2\n").find("\n0.3,") != std::string::npos);
  CHECK(table(".step dec param R 1k 1Meg 1\n").rfind("R,mean\n1000,0.5\n10000,0.9090909", 0) == 0);
  CHECK(table(".step param R oct 1k 4k 1\n").find("\n2000,0.6666666666666666\n4000,0.8\n") != std::string::npos);
  CHECK(table(".param R=1k\n.step V1 list 2 4\n") == "V1,mean\n2,1\n4,2\n");
  CHECK(table(".param R=1k\n.step R2 1k 3k 2k\n") == "R2,mean\n1000,0.5\n3000,0.75\n");
  CHECK(table(".param R=1k\n.step r1 list 1k 3k\n.step V1 list 1 2\n") == "r1,V1,mean\n1000,1,0.5\n3000,1,0.25\n1000,2,1\n3000,2,0.5\n");
  CHECK(table(".param R={unif(1k,0)+aunif(0,0)}\n.step V1 list 2 4\n") == "V1,mean\n2,1\n4,2\n");
  CHECK(table(".step param R list 1k 3k\n.step V1 list 1 2\n") == "R,V1,mean\n1000,1,0.5\n3000,1,0.75\n1000,2,1\n3000,2,1.5\n");
}

TEST_CASE("sweeps of a capacitor and of an inductor: time constants RC and L/R", "[unit]") {
  const Scratch scratch;
  scratch.write("c.net",
                "time constants\n"
                "V1 a 0 1\n"
                "R1 a b 1k\n"
                "C1 b 0 {tau/1k} ic=0\n"
                "V2 c 0 1\n"
                "L1 c d 1m ic=0\n"
                "R2 d 0 1\n"
                ".param tau=1m\n"
                ".step C1 list 1u 2u\n"
                ".step L1 list 1m 3m\n"
                ".tran 1m 10m uic\n"
                ".save v(b)\n"
                ".meas rc WHEN v(b)={1-exp(-1)}\n"
                ".meas lr WHEN v(d)={1-exp(-1)}\n");
  const Finished finished = run_in(scratch, {"c.net", "--quiet"});
  CHECK(finished.status == 0);
  std::istringstream table(finished.out);
  std::string line;
  std::getline(table, line);
  CHECK(line == "C1,L1,rc,lr");
  for (const double l : {1e-3, 3e-3})
    for (const double c : {1e-6, 2e-6}) {
      double stepped_c = 0, stepped_l = 0, rc = 0, lr = 0;
      char comma = 0;
      table >> stepped_c >> comma >> stepped_l >> comma >> rc >> comma >> lr;
      CHECK(stepped_c == c);
      CHECK(stepped_l == l);
      CHECK(rc == Approx(1e3 * c).epsilon(1e-12));
      CHECK(lr == Approx(l).epsilon(1e-12));
    }
}

TEST_CASE("a run that fails is told with its values, recorded, and stops no other", "[unit]") {
  const Scratch scratch;
  scratch.write("f.net",
                "some fail\n"
                "I1 0 a PULSE(1 {x} 2m 0 0 1 2)\n"
                "D1 a b DI\n"
                "R1 b 0 {1/(x+1)}\n"
                ".step param x list 1 -2 -1 3\n"
                ".model DI D\n"
                ".tran 2m 4m\n"
                ".save v(b)\n"
                ".meas last FIND v(b) AT=4m\n");
  const Finished finished = run_in(scratch, {"f.net", "--stats", "stats.json"});
  CHECK(finished.status == 1);
  CHECK(finished.out == "x,last\n1,0.5\n-2,failed\n-1,failed\n3,0.75\n");
  CHECK(read_file(scratch / "f.csv") == "x,time,v(b)\n1,0,0.5\n1,0.002,0.5\n1,0.004,0.5\n-2,0,-1\n3,0,0.25\n3,0.002,0.75\n3,0.004,0.75\n");
  CHECK_THAT(finished.err, Contains("error[E-no-solution]: run with x=-2: no solution continues at t = 0.002 s") &&
                               Contains("error[E-not-finite]: run with x=-1: division by zero"));
  const std::string stats = read_file(scratch / "stats.json");
  CHECK_THAT(stats, Contains("\"runs\": 4") && Contains("\"failed_runs\": 2"));
}

TEST_CASE("random numbers depend on the seed and the run alone", "[unit]") {
  const Scratch scratch;
  const auto table = [&](const std::string& seed) {
    scratch.write("m.net", swept_divider(".param R=mc(1k,0.1)\n.step param run 1 200 1\n" + seed));
    return run_in(scratch, {"m.net", "--quiet"}).out;
  };
  const std::string first = table("");
  CHECK(std::count(first.begin(), first.end(), '\n') == 201);
  CHECK(table("") == first);
  CHECK(table(".options seed=0\n") == first);
  CHECK(table(".options seed=2\n") != first);
  CHECK(table(".options seed={1+1}\n") == table(".options seed=2\n"));

  const auto steps = [&](const std::string& seed) {
    scratch.write("m.net", swept_divider(".step param R list {mc(1k,0.1)} {mc(1k,0.1)}\n" + seed));
    return run_in(scratch, {"m.net", "--quiet"}).out;
  };
  CHECK(steps(".options seed=1\n") == steps(".options seed=1\n"));
  CHECK(steps(".options seed=1\n") != steps(".options seed=2\n"));
}

TEST_CASE("Monte Carlo: means and spreads of 20,000 numbers", "[unit]") {
  const Scratch scratch;
  scratch.write("m.net",
                "spreads\n"
                "V1 a 0 {gauss(2)}\nV2 b 0 {flat(3)}\nV3 c 0 {agauss(1,3,3)}\n"
                "R1 a 0 1\nR2 b 0 1\nR3 c 0 1\n"
                ".step param run 1 20000 1\n"
                ".tran 1 1\n.save v(a)\n"
                ".meas g FIND v(a) AT=1\n.meas f FIND v(b) AT=1\n.meas n FIND v(c) AT=1\n");
  std::istringstream lines(run_in(scratch, {"m.net", "--quiet"}).out);
  std::string line;
  std::getline(lines, line);
  double sums[3] = {}, squares[3] = {};
  int count = 0;
  for (; std::getline(lines, line); ++count) {
    const char* at = line.c_str() + line.find(',');
    for (int k = 0; k < 3; ++k) {
      char* end = nullptr;
      const double value = std::strtod(at + 1, &end);
      at = end;
      sums[k] += value;
      squares[k] += value * value;
    }
  }
  REQUIRE(count == 20000);
  // Four standard errors: σ/√n of a mean, about σ²·√(2/n) of a normal variance.
  const double root = std::sqrt(20000.0);
  CHECK(std::abs(sums[0] / count) < 4.0 * 2.0 / root);
  CHECK(std::abs(sums[1] / count) < 4.0 * std::sqrt(3.0) / root);
  CHECK(std::abs(sums[2] / count - 1.0) < 4.0 / root);
  CHECK(squares[0] / count == Approx(4.0).epsilon(4.0 * std::sqrt(2.0) / root));
  CHECK(squares[1] / count == Approx(3.0).epsilon(4.0 / root));  // a²/3
  CHECK(squares[2] / count == Approx(2.0).epsilon(4.0 * std::sqrt(3.0) / root));
}

TEST_CASE("a raw file of a sweep holds the runs one after the other, as LTspice writes them, with the stepped values", "[unit]") {
  const Scratch scratch;
  scratch.write("d.net", swept_divider(".step param R list 1k 3k\n"));
  REQUIRE(run_in(scratch, {"d.net", "--format", "raw"}).status == 0);
  CHECK(scratch.names() == std::vector<std::string>{"d.net", "d.raw"});
  const std::string bytes = read_file(scratch / "d.raw");
  CHECK_THAT(bytes, Contains("\nFlags: real stepped\nNo. Variables: 3\nNo. Points: 4 ") &&
                        Contains("\t1\tv(b)\tvoltage\n\t2\tR\tnotype\nBinary:\n"));
  const auto raw = pwlsim::waveform::read_raw(bytes);
  REQUIRE(raw);
  CHECK(raw->names == std::vector<std::string>{"time", "v(b)", "r"});
  CHECK(raw->values == std::vector<double>{0, 0.5, 1000, 0.001, 0.5, 1000, 0, 0.75, 3000, 0.001, 0.75, 3000});

  const auto program = pwlsim::spice::find_ngspice();
  if (!program) {
    WARN("ngspice is not installed: this test is skipped");
    return;
  }
  scratch.write("load.cir", "load\n.control\nload d.raw\nprint length(time) v(b)[3] r[3]\nquit\n.endc\n.end\n");
  REQUIRE(std::system(("cd '" + scratch.path().string() + "' && '" + *program + "' -n -b load.cir > log 2>&1").c_str()) == 0);
  CHECK_THAT(read_file(scratch / "log"),
             Contains("length(time) = 4.0") && Contains("v(b)[3] = 7.500000e-01") && Contains("r[3] = 3.000000e+03"));
}

TEST_CASE("--json of a sweep lists the runs; one that fails tells why", "[unit]") {
  const Scratch scratch;
  // 1 V across R2 of x - 1: at x = 1 its conductance has no value.
  scratch.write("d.net",
                "list\nV1 a 0 1\nR1 a b 1\nR2 b 0 {1/(1-x)}\n.step param x list 0 1 0.5\n.tran 1 2\n.save v(b)\n.meas m MAX v(b)\n.meas n "
                "FIND v(b) AT=9\n"
                ".four 1 v(b)\n");
  const Finished finished = run_in(scratch, {"d.net", "--json"});
  CHECK(finished.status == 1);
  const Json json = read_json(finished.out);
  CHECK(json["output"]["rows"].number == 6.0);
  CHECK_FALSE(json["output"]["complete"].truth);
  CHECK(json["stats"]["failed_runs"].number == 1.0);
  REQUIRE(json["runs"].array.size() == 3);
  CHECK(json["runs"][0]["parameters"]["x"].number == 0.0);
  CHECK(json["runs"][0]["failure"].kind == Json::Kind::null);
  CHECK(json["runs"][0]["end"].number == 2.0);
  CHECK(json["runs"][0]["rows"].number == 3.0);
  CHECK(json["runs"][0]["measurements"][0]["value"].number == 0.5);
  CHECK_THAT(json["runs"][0]["measurements"][1]["failure"].string, Contains("9"));
  CHECK(json["runs"][0]["fourier"][0]["harmonics"][0]["magnitude"].number == Approx(0.5));
  CHECK(json["runs"][0]["certificate"]["kcl_kvl"].number < 1e-15);
  CHECK_THAT(json["runs"][1]["failure"].string, Contains("E-not-finite: division by zero"));
  CHECK(json["runs"][2]["measurements"][0]["value"].number == Approx(2.0 / 3.0));
}

// An ideal switch puts C across 4 V: the source gives C·16 in no time, in the runs in which it closes before the end.
TEST_CASE("impulses that measurements of a sweep leave out are told once each, and in --json", "[unit]") {
  const Scratch scratch;
  scratch.write("c.net",
                "charge\nV1 in 0 4\nS1 in b g 0 SW\nC1 b 0 {C}\nV2 g 0 PULSE(0 1 {1/C} 0 0 9 0)\n.model SW SW(Vt=0.5)\n.tran 1 4 uic\n"
                ".step param C list 0.1 1 2\n.meas given INTEG -v(in)*i(V1)\n.meas lost INTEG v(in,b)*i(S1)\n.four 0.25 3 i(S1)\n");
  const Finished told = run_in(scratch, {"c.net"});
  CHECK(told.status == 0);
  CHECK_THAT(told.out, Contains("C,given,lost\n0.1,0,0\n1,16,0\n2,32,0\n"));
  CHECK_THAT(told.err,
             Contains("c.net:10:7: warning[W-impulse-left-out]: measurement lost leaves out in the run with C=1 the impulse at t = 1 s: "
                      "v(in,b)*i(S1) has no integral over it; try a small resistance") &&
                 Contains("(and in 1 other run)\n") && !Contains("measurement given"));
  const Json json = read_json(run_in(scratch, {"c.net", "--json"}).out);
  CHECK(json["runs"][0]["measurements"][1]["left_out"].kind == Json::Kind::null);
  CHECK(json["runs"][1]["measurements"][0]["left_out"].kind == Json::Kind::null);
  CHECK(json["runs"][1]["measurements"][1]["left_out"].string == "the impulse at t = 1 s: v(in,b)*i(S1) has no integral over it");
  CHECK(json["runs"][1]["fourier"][0]["thd"].kind == Json::Kind::null);
}

TEST_CASE("--plot of a sweep lays the runs over each other, a colour a run, and says how many are left out", "[unit]") {
  const Scratch scratch;
  const auto count = [](const std::string& text, const std::string& what) {
    std::size_t number = 0;
    for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++number;
    return number;
  };
  scratch.write("d.net", swept_divider(".step param R list 1k 3k\n.save i(R1)\n"));
  REQUIRE(run_in(scratch, {"d.net", "--plot", "p.svg"}).status == 0);
  const std::string picture = read_file(scratch / "p.svg");
  CHECK(count(picture, "<polyline") == 4);
  CHECK_THAT(picture, Contains(">R=1000<") && Contains(">R=3000<") && Contains(">v(b)<") && Contains(">i(R1)<") && Contains(">divider<"));
  for (const double share : {0.0, 1.0}) CHECK(count(picture, "stroke=\"" + pwlsim::waveform::ramp_colour(share) + "\"") == 3);

  scratch.write("m.net", swept_divider(".step param R 1 100 1\n"));
  REQUIRE(run_in(scratch, {"m.net", "--plot", "m.svg"}).status == 0);
  const std::string many = read_file(scratch / "m.svg");
  CHECK(count(many, "<polyline") == 12);
  CHECK_THAT(many, Contains(">divider (12 of 100 runs)<") && Contains(">R=1<") && Contains(">R=10<") && Contains(">R=100<"));
}

TEST_CASE("a sweep says where the deck does not run as written, and with --verbose where the time went", "[unit]") {
  const Scratch scratch;
  scratch.write("d.net", swept_divider(".step param R list 1k 3k\n.nodeset v(b)=1\n"));
  CHECK_THAT(run_in(scratch, {"d.net"}).err, Contains("not as written: 1 ignored (--verbose lists them)"));
  CHECK_THAT(run_in(scratch, {"d.net", "--verbose"}).err, Contains("engine exact:") && Contains("\n  ignored"));
}

TEST_CASE("operating points of a sweep are a table, with .tran and without; one that fails is told", "[unit]") {
  const Scratch scratch;
  // x V across 1 + 3 ohm; at x = 0 the resistance has no value. With a current source against a diode there is no state.
  const std::string deck = "o\nV1 a 0 {x}\nR1 a b {x/x}\nR2 b 0 3\n.step param x list 1 0 4\n.save v(b) i(R1)\n.op\n";
  scratch.write("o.net", deck);
  const Finished alone = run_in(scratch, {"o.net", "--stats", "s.json"});
  CHECK(alone.status == 1);
  CHECK(alone.out == "x,v(b),i(R1)\n1,0.75,0.25\n0,failed,failed\n4,3,1\n");
  CHECK_THAT(alone.err, Contains("error[E-not-finite]: run with x=0: division by zero"));
  CHECK(scratch.names() == std::vector<std::string>{"o.net", "s.json"});
  CHECK_THAT(read_file(scratch / "s.json"), Contains("\"runs\": 3") && Contains("\"failed_runs\": 1"));
  const Json json = read_json(run_in(scratch, {"o.net", "--json", "--report", "r.html"}).out);
  CHECK(json["output"].kind == Json::Kind::null);
  CHECK(json["runs"][2]["operating_point"]["i(R1)"].number == 1.0);
  CHECK(json["runs"][1]["operating_point"].kind == Json::Kind::null);

  scratch.write("t.net", deck + ".tran 1 2\n.meas m MAX v(b)\n");
  CHECK(run_in(scratch, {"t.net", "--quiet"}).out == "x,v(b),i(R1)\n1,0.75,0.25\n0,failed,failed\n4,3,1\n\nx,m\n1,0.75\n0,failed\n4,3\n");
  CHECK(read_file(scratch / "t.csv").rfind("x,time,v(b),i(R1)\n1,0,0.75,0.25\n", 0) == 0);

  scratch.write("n.net", "n\nI1 0 a {x}\nD1 a b DI\nR1 b 0 1\n.model DI D\n.step param x list 1 -1\n.save v(b)\n.op\n");
  const Finished none = run_in(scratch, {"n.net"});
  CHECK(none.status == 1);
  CHECK(none.out == "x,v(b)\n1,1\n-1,failed\n");
  CHECK_THAT(none.err, Contains("error[E-no-operating-point]: run with x=-1:"));

  // A capacitor takes the current of the run, which begins without an operating point.
  scratch.write("u.net", "u\nI1 0 a {x}\nC1 a 0 1\n.step param x list 0 2\n.tran 1 1 uic\n.op\n.save v(a)\n");
  const Finished without = run_in(scratch, {"u.net"});
  CHECK(without.status == 1);
  CHECK(without.out == "x,v(a)\n0,0\n2,failed\n");
  CHECK(read_file(scratch / "u.csv") == "x,time,v(a)\n0,0,0\n0,1,0\n2,0,0\n2,1,2\n");
}

TEST_CASE("a signal keeps the runs that are done, and a closed pipe ends them all", "[unit]") {
  const Scratch scratch;
  // The second run has 1e9 periods.
  const std::string deck =
      "long\nV1 a 0 PULSE(0 1 0 0 0 0.5n 1n)\nR1 a b 1k\nC1 b 0 1n\n.step param T list 2n 0.9\n.tran 1n {T} 0 uic\n.save v(a)\n.meas m MAX "
      "v(a)\n";
  scratch.write("long.net", deck);
  Spawned program({"long.net"}, {.folder = scratch.path().string()});
  REQUIRE(wait_until(30, [&] { return scratch.holds("long.csv.partial"); }));
  pause(300);
  program.send(SIGINT);
  const Finished finished = program.finish();
  INFO(finished.err);
  CHECK(finished.status == 130);
  CHECK_THAT(finished.err, Contains("error[E-interrupted]: stopped by a signal after 1 of 2 runs; their rows are in long.csv"));
  CHECK(finished.out == "T,m\n2e-09,1\n0.9,failed\n");
  CHECK(read_file(scratch / "long.csv").rfind("T,time,v(a)\n2e-09,0,1\n2e-09,1e-09,1\n2e-09,2e-09,1\n", 0) == 0);

  Spawned piped({"long.net", "-o", "-"}, {.folder = scratch.path().string()});
  pause(200);
  piped.close_output();
  CHECK(piped.finish().status == 141);
}
