// SIGINT and SIGTERM within work that does not look for signals (large dense extractions), and between frequencies and derivatives.

#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>

#include "cli/run_in.hpp"
#include "support/json.hpp"

using namespace pwlsim::test;
using Catch::Matchers::Contains;
using Names = std::vector<std::string>;

namespace {

constexpr double prompt = 5.0;  // seconds; 0.6 on an idle machine, where the extraction takes 50

/// A ladder of resistors: so many nodes, one capacitor.
std::string ladder(int nodes) {
  std::string text = "ladder\nV1 n0 0 SIN(0 1 1k)\n";
  for (int k = 0; k < nodes; ++k) {
    const std::string next = 'n' + std::to_string(k + 1), number = std::to_string(k);
    text += "Rs" + number + " n" + number + ' ' + next + " 1\nRp" + number + ' ' + next + " 0 1k\n";
  }
  return text + "C1 n" + std::to_string(nodes) + " 0 1u\n.save v(n1)\n";
}

}  // namespace

TEST_CASE("a signal during a large extraction ends the program at once", "[regression]") {
  const Scratch scratch;
  scratch.write("big.net", ladder(2000) + ".tran 10u 1m uic\n");
  scratch.write("op.net", ladder(2000) + ".op\n");
  const int signal_number = GENERATE(SIGINT, SIGTERM);
  const auto arguments =
      GENERATE(Names{"big.net", "--engine", "modes"}, Names{"op.net", "--engine", "modes", "--json"}, Names{"inspect", "big.net"});
  const Names before = scratch.names();
  Spawned program(arguments, {.folder = scratch.path().string()});
  pause(1000);
  program.send(signal_number);
  const auto sent = std::chrono::steady_clock::now();
  const Finished finished = program.finish();
  INFO(finished.err);
  CHECK(std::chrono::duration<double>(std::chrono::steady_clock::now() - sent).count() < prompt);
  CHECK(finished.status == 128 + signal_number);
  CHECK_THAT(finished.err, Contains("error[E-interrupted]: interrupted before"));
  CHECK(scratch.names() == before);
  if (arguments.back() == "--json") CHECK(read_json(finished.out)["status"].number == 128 + signal_number);
}

TEST_CASE("a network of thousands of resistors is exact without dense equations", "[regression]") {
  const Scratch scratch;
  scratch.write("big.net", ladder(2500) + ".tran 10u 1m uic\n");
  const Finished finished = run_in(scratch, {"big.net", "-o", "-"});
  CHECK(finished.status == 0);
  CHECK(finished.seconds < 20.0);  // 0.3 s; by dense modes 100
  CHECK_THAT(finished.err, !Contains("warning"));
  // r + (1k parallel r) = r of the endless ladder: r = (1 + sqrt(1 + 4000)) / 2; v(n1) = V1·(r − 1)/r. At 0.25 ms V1 = 1.
  const double r = 0.5 * (1.0 + std::sqrt(4001.0));
  const std::size_t row = finished.out.find("\n0.00025,");
  REQUIRE(row != std::string::npos);
  CHECK(std::stod(finished.out.substr(row + 9)) == Approx((r - 1.0) / r).epsilon(1e-9));
}

// Each frequency takes a third of a millisecond.
TEST_CASE("a signal ends small signals, and the frequencies up to then are kept", "[regression]") {
  const Scratch scratch;
  std::string line = "line\nV1 n0 0 AC 1\n";
  for (int k = 0; k < 400; ++k) line += fmt::format("L{0} n{0} n{1} 1u Rser=1m\nC{0} n{1} 0 1n\n", k, k + 1);
  scratch.write("line.net", line + "R1 n400 0 30\n.ac dec 100000 1 1e6\n.save v(n400)\n.end\n");
  const int signal_number = GENERATE(SIGINT, SIGTERM);
  Spawned program({"line.net", "--report", "page.html"}, {.folder = scratch.path().string()});
  pause(1000);
  program.send(signal_number);
  const Finished finished = program.finish();
  INFO(finished.err);
  CHECK(finished.status == 128 + signal_number);
  CHECK_THAT(finished.err, Contains("of 600001 frequencies; the rows up to then are in line.ac.csv"));
  const std::string rows = read_file(scratch / "line.ac.csv");
  CHECK(rows.starts_with("frequency,"));
  CHECK(rows.ends_with("\n"));
  CHECK_FALSE(std::filesystem::exists(scratch / "line.ac.csv.partial"));
}

// The rows stand before derivatives begin, which take seconds of 50,000 periods.
TEST_CASE("a signal between derivatives is no success", "[regression]") {
  const Scratch scratch;
  scratch.write("buck.net",
                "buck\nV1 in 0 24\nVG g 0 PULSE(0 1 0 0 0 4.5u 10u)\nS1 in sw g 0 SW\nD1 0 sw DX\nL1 sw out 22u\nC1 out 0 100u\nR1 out 0 "
                "3\n.model SW SW(Vt=0.5)\n.model DX D\n.save v(out)\n.tran 1m 0.5 uic\n.meas tran m AVG v(out)\n.meas tran w RMS "
                "v(out)*i(L1)\n.sens param=L1,C1,R1,V1\n.end\n");
  Spawned program({"buck.net", "--json"}, {.folder = scratch.path().string()});
  CHECK(wait_until(60.0, [&] { return std::filesystem::exists(scratch / "buck.csv"); }));
  program.send(SIGINT);
  const Finished finished = program.finish();
  INFO(finished.err);
  CHECK(finished.status == 130);
  CHECK_THAT(finished.err, Contains("error[E-interrupted]: stopped by a signal before all derivatives were known"));
  CHECK_THAT(read_file(scratch / "buck.sens.csv"), Contains("interrupted by a signal"));
  CHECK(read_json(finished.out)["status"].number == 130.0);
}
