// The program as a user meets it: exit status, what is written, what is left alone.

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <csignal>
#include <numbers>
#include <regex>
#include <sstream>

#include "cli/many_rows.hpp"
#include "cli/run_in.hpp"
#include "support/json.hpp"

using namespace pwlsim::test;
using Catch::Matchers::Contains;
using Catch::Matchers::Equals;
using Names = std::vector<std::string>;

namespace {

/// v(a) steps to 2 V at t = 0 and v(b) follows exactly: no state, so every expected value is the divider's 2 V / 2.
const std::string divider =
    "divider\n"
    "V1 a 0 PULSE(0 2 0 0 0 1 2)\n"
    "R1 a b 1k\n"
    "R2 b 0 1k\n"
    ".tran 0.1 0.3 uic\n"
    ".save v(a) v(b) v(a,b) i(R1)\n"
    ".end\n";
const std::string divider_rows =
    "time,v(a),v(b),\"v(a,b)\",i(R1)\n"
    "0,2,1,1,0.001\n"
    "0.1,2,1,1,0.001\n"
    "0.2,2,1,1,0.001\n"
    "0.3,2,1,1,0.001\n";

/// 1e12 periods: no machine ends it before the tests are over.
const std::string endless =
    "endless\n"
    "V1 a 0 PULSE(0 1 0 0 0 0.5n 1n)\n"
    "R1 a b 1k\n"
    "C1 b 0 1n\n"
    ".tran 1n 0.9 0 uic\n"
    ".save v(b)\n"
    ".end\n";

std::string lines_of(const std::string& text, std::size_t count) {
  std::size_t end = 0;
  while (count-- != 0 && end != std::string::npos) end = text.find('\n', end) + 1;
  return text.substr(0, end);
}

}  // namespace

TEST_CASE("a deck gives its CSV in the current directory and status 0", "[unit]") {
  const Scratch scratch;
  scratch.write("divider.net", divider);
  const Finished finished = run_in(scratch, {"divider.net"});
  REQUIRE(finished.status == 0);
  CHECK(read_file(scratch / "divider.csv") == divider_rows);
  CHECK(finished.out.empty());
  CHECK_THAT(finished.err, Contains("wrote divider.csv: 4 rows"));
  CHECK_THAT(finished.err, Contains("worst residuals: complementarity"));
  CHECK(scratch.names() == Names{"divider.csv", "divider.net"});
}

TEST_CASE("-o names the file, and an older one is replaced", "[unit]") {
  const Scratch scratch;
  scratch.write("divider.net", divider);
  scratch.write("out.csv", "old\n");
  REQUIRE(run_in(scratch, {"-o", "out.csv", "divider.net"}).status == 0);
  CHECK(read_file(scratch / "out.csv") == divider_rows);
  CHECK(scratch.names() == Names{"divider.net", "out.csv"});
}

TEST_CASE("-o - writes the rows and nothing else to standard output", "[unit]") {
  const Scratch scratch;
  scratch.write("divider.net", divider);
  const Finished finished = run_in(scratch, {"divider.net", "-o", "-"});
  REQUIRE(finished.status == 0);
  CHECK(finished.out == divider_rows);
  CHECK(scratch.names() == Names{"divider.net"});
}

TEST_CASE(".op prints name = value; with -o - on standard error", "[unit]") {
  const Scratch scratch;
  // The divider's operating point has the source at its value before t = 0, as language.md says of a PULSE.
  std::string deck = divider;
  deck.replace(deck.find("PULSE(0 2"), 9, "PULSE(4 2");
  deck.replace(deck.find(".tran 0.1 0.3 uic"), 17, ".op");
  scratch.write("op.net", deck);
  const std::string expected = "v(a) = 4\nv(b) = 2\nv(a,b) = 2\ni(R1) = 0.002\n";
  const Finished to_output = run_in(scratch, {"op.net"});
  REQUIRE(to_output.status == 0);
  CHECK(to_output.out == expected);
  CHECK(scratch.names() == Names{"op.net"});
  const Finished to_error = run_in(scratch, {"op.net", "-o", "-", "--quiet"});
  REQUIRE(to_error.status == 0);
  CHECK(to_error.out.empty());
  CHECK(to_error.err == expected);
}

TEST_CASE("a deck with .op and .tran gives both", "[unit]") {
  const Scratch scratch;
  scratch.write("both.net", std::string(divider).replace(divider.find(".end"), 4, ".op"));
  const Finished finished = run_in(scratch, {"both.net"});
  REQUIRE(finished.status == 0);
  CHECK(finished.out == "v(a) = 0\nv(b) = 0\nv(a,b) = 0\ni(R1) = 0\n");
  CHECK(read_file(scratch / "both.csv") == divider_rows);
}

TEST_CASE("--quiet keeps everything but results and errors", "[unit]") {
  const Scratch scratch;
  scratch.write("divider.net", divider);
  const Finished finished = run_in(scratch, {"--quiet", "divider.net"});
  CHECK(finished.status == 0);
  CHECK(finished.out.empty());
  CHECK(finished.err.empty());
  CHECK_THAT(run_in(scratch, {"--quiet", "missing.net"}).err, Contains("error["));
}

TEST_CASE("standard error that is no terminal gets no progress bar", "[unit]") {
  const Scratch scratch;
  scratch.write("divider.net", divider);
  CHECK(run_in(scratch, {"divider.net"}).err.find('\r') == std::string::npos);
}

TEST_CASE("on a terminal a progress bar is drawn now and then, and wiped", "[unit]") {
  const Scratch scratch;
  scratch.write("endless.net", endless);
  const auto err_of = [&](const std::string& flag) {
    Spawned program({"endless.net", flag}, {.folder = scratch.path().string(), .terminal = true});
    pause(1000);
    program.send(SIGTERM);
    return program.finish().err;
  };
  const std::string drawn = err_of("--events");
  const auto bars = std::count(drawn.begin(), drawn.end(), '%');
  CHECK(bars >= 1);
  CHECK(bars <= 30);  // ten a second, and the machine may be slow to stop it
  CHECK_THAT(drawn, Contains("\r[") && Contains("s to go") && Contains("\r\x1b[Kerror[E-interrupted]"));
  CHECK(err_of("--no-progress").find('%') == std::string::npos);
  CHECK(err_of("--quiet").find('%') == std::string::npos);
}

TEST_CASE("--verbose adds phases and counts", "[unit]") {
  const Scratch scratch;
  scratch.write("divider.net", divider);
  CHECK_THAT(run_in(scratch, {"divider.net", "--verbose"}).err, Contains("engine exact: ") && Contains("time: parse "));
}

TEST_CASE("--stats writes one JSON object with the keys of the contract", "[unit]") {
  const Scratch scratch;
  scratch.write("divider.net", divider);
  REQUIRE(run_in(scratch, {"divider.net", "--stats", "stats.json"}).status == 0);
  const std::string json = read_file(scratch / "stats.json");
  for (const char* key : {"engine",          "islands",  "states", "ports",      "switches",
                          "modes_visited",   "events",   "jumps",  "lcp_pivots", "klu_factorizations",
                          "klu_solves",      "steps",    "rows",   "seconds",    "parse",
                          "model",           "simulate", "write",  "total",      "certificate",
                          "complementarity", "kcl_kvl",  "energy", "passive",    "notes"}) {
    CHECK_THAT(json, Contains('"' + std::string(key) + "\": "));
  }
  CHECK_THAT(json, Contains("\"engine\": \"exact\"") && Contains("\"rows\": 4,"));
  CHECK(scratch.names() == Names{"divider.csv", "divider.net", "stats.json"});
}

TEST_CASE("help and version go to standard output with status 0", "[unit]") {
  const Scratch scratch;
  const Finished version = run_in(scratch, {"--version"});
  CHECK(version.status == 0);
  CHECK(std::regex_match(version.out, std::regex("pwlsim [0-9]+\\.[0-9]+\\.[0-9]+\n")));
  for (const std::vector<std::string>& words :
       {Names{"--help"}, Names{"inspect", "--help"}, Names{"export", "--help"}, Names{"compare", "--help"}}) {
    const Finished help = run_in(scratch, words);
    CHECK(help.status == 0);
    CHECK_THAT(help.out, Contains("Usage: pwlsim"));
    CHECK(help.err.empty());
  }
}

TEST_CASE("a wrong command line has status 2 and creates nothing", "[unit]") {
  const Scratch scratch;
  scratch.write("divider.net", divider);
  const Names words = GENERATE(
      Names{}, Names{"divider.net", "divider.net"}, Names{"divider.net", "--evnts"}, Names{"divider.net", "--engine", "dense"},
      Names{"divider.net", "-o"}, Names{"divider.net", "--plot", "p.gif"}, Names{"divider.net", "--reltol", "0"},
      Names{"inspect", "divider.net", "--mode", "R1"}, Names{"export", "divider.net"}, Names{"compare", "divider.net", "--events"});
  const Finished finished = run_in(scratch, words);
  CHECK(finished.status == 2);
  CHECK(finished.out.empty());
  CHECK_THAT(finished.err, Contains("error[E-") && Contains("; try "));
  CHECK(scratch.names() == Names{"divider.net"});
}

TEST_CASE("a large circuit with an amplifier is exact, and the sparse engine warns", "[unit]") {
  const Scratch scratch;
  std::ostringstream deck;
  deck << "ladder of an amplifier\nE1 n0 0 n450 a -1\nV1 a 0 1\n";
  for (int i = 0; i < 450; ++i) deck << "R" << i << " n" << i << " n" << i + 1 << " 1\nC" << i << " n" << i + 1 << " 0 1n\n";
  deck << ".save v(n450)\n.tran 1u 2u\n.end\n";
  scratch.write("ladder.net", deck.str());
  const Finished exact = run_in(scratch, {"ladder.net", "--stats", "-", "-o", "ladder.csv"});
  CHECK_THAT(exact.out, Contains("\"engine\": \"exact\"") && Contains("error_bound"));
  CHECK_THAT(exact.err, Contains("note[N-not-examined]") && !Contains("warning"));
  CHECK_THAT(run_in(scratch, {"ladder.net", "--engine", "sparse"}).err,
             Contains("warning[W-sparse-engine]: the sparse engine takes implicit steps"));
}

// N equal sections r, c behind a step of 1 V: v_k(t) = 1 − Σ_j 2/(2N+1) cot(θ_j/2) sin(kθ_j) e^{−4 sin²(θ_j/2) t/(rc)}, θ_j = (2j−1)π/(2N+1) (eigenvectors of the
// second difference with one end held and one free).
TEST_CASE("a passive circuit of any size is exact, whether modes or segments are taken", "[unit]") {
  const int sections = GENERATE(90, 150, 1200);
  const std::string engine = GENERATE(std::string("exact"), std::string("auto"), std::string("modes"));
  if (engine == "modes" && sections > 200) return;  // minutes
  const Scratch scratch;
  std::ostringstream deck;
  deck << "ladder\nV1 n0 0 1\n";
  for (int i = 0; i < sections; ++i) deck << "R" << i << " n" << i << " n" << i + 1 << " 1\nC" << i << " n" << i + 1 << " 0 1n ic=0\n";
  deck << ".save v(n9)\n.tran 10n 40n uic\n.end\n";
  scratch.write("ladder.net", deck.str());
  const Finished run = run_in(scratch, {"ladder.net", "--engine", engine, "-o", "ladder.csv", "--stats", "-"});
  REQUIRE(run.status == 0);
  CHECK_THAT(run.out, Contains("\"engine\": \"exact\""));
  CHECK_THAT(run.err, !Contains("warning"));
  std::istringstream rows(read_file(scratch / "ladder.csv"));
  std::string line;
  std::getline(rows, line);
  int compared = 0;
  while (std::getline(rows, line)) {
    const double t = std::stod(line), v = std::stod(line.substr(line.find(',') + 1));
    long double expected = 1.0L;
    for (int j = 1; j <= sections; ++j) {
      const long double theta = (2 * j - 1) * std::numbers::pi_v<long double> / (2 * sections + 1), half = std::sin(theta / 2);
      expected -= 2.0L / (2 * sections + 1) / std::tan(theta / 2) * std::sin(9 * theta) *
                  std::exp(-4 * half * half * static_cast<long double>(t) / 1e-9L);
    }
    CHECK(v == Approx(static_cast<double>(expected)).margin(1e-10));
    ++compared;
  }
  CHECK(compared == 5);
}

TEST_CASE("the sparse engine runs a deck, and refuses a tolerance below rounding", "[unit]") {
  const Scratch scratch;
  scratch.write("divider.net", divider);
  const Finished done = run_in(scratch, {"divider.net", "--engine", "sparse", "--stats", "-"});
  CHECK(done.status == 0);
  CHECK_THAT(done.out, Contains("\"engine\": \"sparse\""));
  const Finished refused = run_in(scratch, {"divider.net", "--engine", "sparse", "--reltol", "1e-14"});
  CHECK(refused.status == 2);
  CHECK_THAT(refused.err, Contains("error[E-tolerance]: a relative tolerance of 1e-14 is below rounding"));
}

TEST_CASE("a deck that cannot be read has status 3", "[unit]") {
  const Scratch scratch;
  scratch.write("x.csv", "old\n");
  const std::string deck = GENERATE(std::string("missing.net"), std::string("."), std::string("missing/x.net"), std::string(""));
  const Finished finished = run_in(scratch, {deck, "-o", "x.csv"});
  CHECK(finished.status == 3);
  CHECK_THAT(finished.err, Contains("error[E-"));
  CHECK(scratch.names() == Names{"x.csv"});
  CHECK(read_file(scratch / "x.csv") == "old\n");
}

TEST_CASE("a place that cannot be written has status 3 before the run", "[unit]") {
  const Scratch scratch;
  scratch.write("divider.net", divider);
  const Names words = GENERATE(Names{"-o", "missing/x.csv"}, Names{"-o", "."}, Names{"--stats", "missing/s.json"});
  const Finished finished = run_in(scratch, {"divider.net", words[0], words[1]});
  CHECK(finished.status == 3);
  CHECK_THAT(finished.err, Contains("error[E-cannot-write]"));
  CHECK(scratch.names() == Names{"divider.net"});
}

TEST_CASE("the deck is not overwritten by its own results", "[unit]") {
  const Scratch scratch;
  scratch.write("deck.csv", divider);
  const Names words =
      GENERATE(Names{"deck.csv"}, Names{"deck.csv", "-o", "./deck.csv"}, Names{"deck.csv", "-o", "x", "--stats", "deck.csv"});
  CHECK(run_in(scratch, words).status == 2);
  CHECK(read_file(scratch / "deck.csv") == divider);
  CHECK(scratch.names() == Names{"deck.csv"});
}

TEST_CASE("errors in the deck have status 2 and leave an older file as it was", "[unit]") {
  const Scratch scratch;
  scratch.write("bad.net", "bad\nR1 a 0\nR2 b 0 nonsense\n.tran 1 2\n");
  scratch.write("bad.csv", "old\n");
  const Finished finished = run_in(scratch, {"bad.net", "--stats", "s.json"});
  CHECK(finished.status == 2);
  CHECK_THAT(finished.err, Contains("bad.net:2:") && Contains("bad.net:3:"));
  CHECK(read_file(scratch / "bad.csv") == "old\n");
  CHECK(scratch.names() == Names{"bad.csv", "bad.net"});
}

TEST_CASE("a run that ends early says the mode it was in", "[unit]") {
  const Scratch scratch;
  // D1 conducts and D2 blocks when S1, closed at 0.7 s, shorts the source. The exact engine tells the mode before, the sparse one that it tried.
  const std::string cards =
      "t\nV1 a 0 1\nD1 a b DI\nR1 b 0 1\nR2 a d 1\nD2 0 d DI\nS1 a 0 c 0 SX\nVc c 0 PULSE(0 1 0.7)\n.model DI D\n.model SX SW(Vt=0.5)\n"
      ".save v(b) v(d) i(S1)\n.tran 0.25 1\n";
  scratch.write("short.net", cards);
  const Finished exact = run_in(scratch, {"short.net", "--engine", "exact", "-o", "-"});
  CHECK(exact.status == 1);
  CHECK_THAT(exact.err, Contains("; mode: D1 on, D2, S1 off; the rows up to then"));
  const Finished sparse = run_in(scratch, {"short.net", "--engine", "sparse", "-o", "-"});
  CHECK(sparse.status == 1);
  CHECK_THAT(sparse.err, Contains("; mode: D1, S1 on, D2 off; the rows up to then"));
}

TEST_CASE("a run that fails has status 1, says the time and the elements, and keeps the rows", "[unit]") {
  const Scratch scratch;
  // The source's current falls from 1 A to -1 A between 1 ms and 2 ms: at 1.5 ms it turns against the diode and has no other way.
  scratch.write("forced.net", "forced\nI1 0 a PULSE(1 -1 1m 1m)\nD1 a 0 DI\n.model DI D\n.save i(D1)\n.tran 0.25m 5m uic\n");
  scratch.write("forced.csv", "old\n");
  const Finished finished = run_in(scratch, {"forced.net", "--stats", "s.json"});
  CHECK(finished.status == 1);
  CHECK_THAT(finished.err, Contains("error[E-no-solution]") && Contains("0.0015") && Contains("D1") && Contains("forced.csv"));
  CHECK_THAT(lines_of(read_file(scratch / "forced.csv"), 6), Equals("time,i(D1)\n0,1\n0.00025,1\n5e-04,1\n0.00075,1\n0.001,1\n"));
  CHECK_THAT(read_file(scratch / "s.json"), Contains("error[E-no-solution]"));
  CHECK(scratch.names() == Names{"forced.csv", "forced.net", "s.json"});
}

TEST_CASE("a solution that leaves the range of numbers has status 1 and keeps the rows before", "[unit]") {
  const Scratch scratch;
  // v = exp(t / 1 us): the greatest double is exp(709.78), so 0.7 ms is the last time of the grid with a value. Energies are squares,
  // whose range ends at 0.355 ms, so a run may stop from there on.
  scratch.write("grow.net", "grow\nC1 a 0 1u ic=1\nR1 a 0 -1\n.save v(a)\n.tran 0.1m 5m uic\n");
  const Finished finished = run_in(scratch, {"grow.net"});
  CHECK(finished.status == 1);
  CHECK_THAT(finished.err, Contains("error[E-overflow]") && Contains("v(a)") && Contains("µs"));
  const std::string rows = read_file(scratch / "grow.csv");
  const auto lines = std::count(rows.begin(), rows.end(), '\n');
  CHECK(lines >= 1 + 4);
  CHECK(lines <= 1 + 8);
  CHECK(rows.find("inf") == std::string::npos);
  CHECK(scratch.names() == Names{"grow.csv", "grow.net"});
}

TEST_CASE("a signal ends the run, keeps the rows and says the time", "[unit]") {
  const int signal_number = GENERATE(SIGINT, SIGTERM);
  const Scratch scratch;
  scratch.write("endless.net", endless);
  scratch.write("endless.csv", "old\n");
  Spawned program({"endless.net", "--stats", "s.json"}, {.folder = scratch.path().string()});
  REQUIRE(wait_until(30, [&] { return scratch.holds("endless.csv.partial"); }));
  CHECK(read_file(scratch / "endless.csv") == "old\n");
  pause(300);
  program.send(signal_number);
  const Finished finished = program.finish();
  INFO(finished.err);
  CHECK(finished.status == 128 + signal_number);
  CHECK_THAT(finished.err, Contains("E-interrupted") && Contains("at t = ") && Contains("endless.csv"));
  const std::string rows = read_file(scratch / "endless.csv");
  CHECK(lines_of(rows, 2) == "time,v(b)\n0,0\n");
  CHECK(rows.back() == '\n');
  CHECK_THAT(read_file(scratch / "s.json"), Contains("error[E-interrupted]"));
  CHECK(scratch.names() == Names{"endless.csv", "endless.net", "s.json"});
}

TEST_CASE("a closed pipe has status 141", "[unit]") {
  const Scratch scratch;
  scratch.write("many.net", many_rows);
  Spawned program({"many.net", "-o", "-"}, {.folder = scratch.path().string()});
  pause(200);
  program.close_output();
  const Finished finished = program.finish();
  CHECK(finished.status == 141);
  CHECK(finished.err.find("error") == std::string::npos);
}

TEST_CASE("a disk that fills up has status 3, and the rows stay in the partial file", "[unit]") {
  const Scratch scratch;
  scratch.write("many.net", many_rows);
  scratch.write("many.csv", "old\n");
  SpawnOptions options;
  options.file_size = 3000000;
  const Finished finished = run_in(scratch, {"many.net"}, options);
  CHECK(finished.status == 3);
  CHECK_THAT(finished.err, Contains("error[E-cannot-write]") && Contains("many.csv.partial"));
  CHECK(read_file(scratch / "many.csv") == "old\n");
  const std::string rows = read_file(scratch / "many.csv.partial");
  CHECK(rows.size() > 2900000);
  CHECK(rows.back() == '\n');
}

TEST_CASE("a full device has status 3", "[unit]") {
  const Scratch scratch;
  scratch.write("divider.net", divider);
  SECTION("named by -o") {
    const Finished finished = run_in(scratch, {"divider.net", "-o", "/dev/full"});
    CHECK(finished.status == 3);
    CHECK_THAT(finished.err, Contains("No space left on device"));
  }
  SECTION("as standard output") {
    SpawnOptions options;
    options.standard_output = "/dev/full";
    CHECK(run_in(scratch, {"divider.net", "-o", "-"}, options).status == 3);
    CHECK(run_in(scratch, {"--help"}, options).status == 3);
  }
  SECTION("for the statistics") { CHECK(run_in(scratch, {"divider.net", "--stats", "/dev/full"}).status == 3); }
  CHECK(scratch.holds("divider.net"));
}

TEST_CASE("closed standard streams are not mistaken for the output file", "[unit]") {
  const Scratch scratch;
  scratch.write("divider.net", divider);
  SpawnOptions options;
  options.no_streams = true;
  CHECK(run_in(scratch, {"divider.net", "--stats", "s.json"}, options).status == 0);
  CHECK(read_file(scratch / "divider.csv") == divider_rows);
  CHECK(scratch.names() == Names{"divider.csv", "divider.net", "s.json"});
  CHECK(run_in(scratch, {"divider.net", "-o", "-"}, options).status == 3);
}

TEST_CASE("--events adds rows before and after each source edge", "[unit]") {
  const Scratch scratch;
  // A single edge at 0.15 s, off the grid, between 0 V and 2 V.
  scratch.write("edge.net", "edge\nV1 a 0 PULSE(0 2 0.15)\nR1 a 0 1k\n.tran 0.1 0.3\n.save v(a)\n");
  REQUIRE(run_in(scratch, {"edge.net", "--events"}).status == 0);
  CHECK(read_file(scratch / "edge.csv") == "time,v(a)\n0,0\n0.1,0\n0.15,0\n0.15,2\n0.2,2\n0.3,2\n");
  REQUIRE(run_in(scratch, {"edge.net"}).status == 0);
  CHECK(read_file(scratch / "edge.csv") == "time,v(a)\n0,0\n0.1,0\n0.2,2\n0.3,2\n");
}

TEST_CASE("inspect prints the model of a deck that runs nothing", "[unit]") {
  const Scratch scratch;
  // Hard case 19: V and T of one dimension each, CB = 1/C1 + 1/C2 = 1.5.
  scratch.write("share.net", "share\nC1 a 0 1\nD1 a b DI\nC2 b 0 2\n.model DI D\n");
  const Finished finished = run_in(scratch, {"inspect", "share.net", "--mode", "D1=on"});
  REQUIRE(finished.status == 0);
  CHECK(finished.err.empty());
  CHECK_THAT(finished.out, Contains("Island 1 (node a): C1, D1, C2\n") && Contains("x2 = 1.41421 v(C2)\n") && Contains("M1 = 1.5\n") &&
                               Contains("certificate: passive") && Contains("Nothing is left out.\n") &&
                               Contains("subspace V: dimension 1 of 2; jump subspace T: dimension 1\n"));
  const Finished as_json = run_in(scratch, {"--quiet", "inspect", "--json", "share.net"});
  REQUIRE(as_json.status == 0);
  const Json json = read_json(as_json.out);
  CHECK(json["islands"][0]["positions"][0]["markov_parameters"][1][0][0].number == Approx(1.5).epsilon(1e-13));
  CHECK(json["islands"][0].object.count("mode") == 0);
  CHECK(scratch.names() == Names{"share.net"});
}

TEST_CASE("inspect has the exit status of any run", "[unit]") {
  const Scratch scratch;
  scratch.write("divider.net", divider);
  scratch.write("bad.net", "bad\nR1 a 0\n");
  scratch.write("loop.net", "loop\nV1 a 0 1\nV2 a 0 2\n");
  const Finished unknown = run_in(scratch, {"inspect", "divider.net", "--mode", "D1=on"});
  CHECK(unknown.status == 2);
  CHECK(unknown.out.empty());
  CHECK_THAT(unknown.err, Contains("error[E-mode]: `--mode`: unknown element 'D1'"));
  const Finished bad = run_in(scratch, {"inspect", "bad.net"});
  CHECK(bad.status == 2);
  CHECK_THAT(bad.err, Contains("bad.net:2:"));
  CHECK_THAT(run_in(scratch, {"inspect", "loop.net"}).err, Contains("error[E-source-loop]"));
  CHECK(run_in(scratch, {"inspect", "loop.net"}).status == 2);
  CHECK(run_in(scratch, {"inspect", "missing.net"}).status == 3);
  SpawnOptions options;
  options.standard_output = "/dev/full";
  CHECK(run_in(scratch, {"inspect", "divider.net"}, options).status == 3);
}

TEST_CASE("the example of the reference is what inspect prints", "[golden]") {
  const std::string page = read_file(PWLSIM_SOURCE_DIR "/docs/reference/inspect.md");
  const std::string command = "    pwlsim inspect netlists/two_capacitors.net --mode D1=on\n\n";
  std::istringstream block(page.substr(page.find(command) + command.size()));
  const Finished finished = run_program({"inspect", "netlists/two_capacitors.net", "--mode", "D1=on"}, {.folder = PWLSIM_SOURCE_DIR});
  std::istringstream printed(finished.out);
  std::string line, shown;
  while (std::getline(printed, line)) {
    REQUIRE(std::getline(block, shown));
    if (line.find("KYP residual") == std::string::npos) CHECK(shown == (line.empty() ? "" : "    " + line));
  }
}

TEST_CASE("a current switch with a band closes at It+Ih and opens at It-Ih", "[unit]") {
  const Scratch scratch;
  // The control rises to 1 A within 1 s and falls back: 0.75 A at 0.75 s, 0.25 A at 1.75 s.
  scratch.write(
      "w.net",
      "w\nI1 0 c PWL(0 0 1 1 2 0)\nV0 c 0 0\nV1 a 0 1\nW1 a b V0 M\nR1 b 0 1\n.model M CSW(It=0.5 Ih=0.25)\n.tran 1 2\n.save v(b)\n");
  REQUIRE(run_in(scratch, {"w.net", "--events"}).status == 0);
  CHECK(read_file(scratch / "w.csv") == "time,v(b)\n0,0\n0.75,0\n0.75,1\n1,1\n1.75,1\n1.75,0\n2,0\n");
}
