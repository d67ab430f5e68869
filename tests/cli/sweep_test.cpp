// Decks with .step: rows, tables, failures, signals.

#include <algorithm>
#include <catch2/catch.hpp>
#include <csignal>

#include "cli/run_in.hpp"
#include "support/json.hpp"

using namespace pwlsim::test;
using Catch::Matchers::Contains;

namespace {

/// Dividers of 1 V: v(b) = R/(R + 1k) at once.
std::string divider(const std::string& steps) {
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
  scratch.write("d.net", divider(".step param R list 1k 3k\n"));
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
    scratch.write("d.net", divider(steps));
    return run_in(scratch, {"d.net", "--quiet"}).out;
  };
  CHECK(table(".step param R 1k 3k 1k\n.param R=5\n") == "R,mean\n1000,0.5\n2000,0.6666666666666666\n3000,0.75\n");
  CHECK(table(".step param R 3k 1k 2k\n") == "R,mean\n3000,0.75\n1000,0.5\n");
  CHECK(table(".step dec param R 1k 1Meg 1\n").rfind("R,mean\n1000,0.5\n10000,0.9090909", 0) == 0);
  CHECK(table(".step param R oct 1k 4k 1\n").find("\n2000,0.6666666666666666\n4000,0.8\n") != std::string::npos);
  CHECK(table(".param R=1k\n.step V1 list 2 4\n") == "V1,mean\n2,1\n4,2\n");
  CHECK(table(".param R={unif(1k,0)+aunif(0,0)}\n.step V1 list 2 4\n") == "V1,mean\n2,1\n4,2\n");
  CHECK(table(".step param R list 1k 3k\n.step V1 list 1 2\n") == "R,V1,mean\n1000,1,0.5\n3000,1,0.75\n1000,2,1\n3000,2,1.5\n");
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
    scratch.write("m.net", divider(".param R=mc(1k,0.1)\n.step param run 1 200 1\n" + seed));
    return run_in(scratch, {"m.net", "--quiet"}).out;
  };
  const std::string first = table("");
  CHECK(std::count(first.begin(), first.end(), '\n') == 201);
  CHECK(table("") == first);
  CHECK(table(".options seed=0\n") == first);
  CHECK(table(".options seed=2\n") != first);
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

TEST_CASE("what a deck with .step cannot do is refused by name", "[unit]") {
  const Scratch scratch;
  scratch.write("d.net", divider(".step param R list 1k 3k\n"));
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"--plot", "p.svg"}, {"--report", "r.html"}, {"--json"}, {"--format", "raw"}}) {
    std::vector<std::string> arguments{"d.net"};
    arguments.insert(arguments.end(), words.begin(), words.end());
    const Finished finished = run_in(scratch, arguments);
    CHECK(finished.status == 2);
    CHECK_THAT(finished.err, Contains("of a deck with .step is not supported"));
  }
  CHECK(scratch.names() == std::vector<std::string>{"d.net"});
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
