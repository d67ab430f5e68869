// --plot: the waveforms of a run as a picture.

#include <catch2/catch.hpp>
#include <csignal>

#include "cli/run_in.hpp"

using namespace pwlsim::test;
using Catch::Matchers::Contains;
using Names = std::vector<std::string>;

namespace {

const std::string rectifier =
    "rectifier\n"
    "V1 a 0 SIN(0 1 50)\n"
    "D1 a b DI\n"
    "R1 b 0 1k\n"
    ".model DI D\n"
    ".tran 0.1m 40m\n"
    ".save v(b) i(D1)\n";
const std::string many_rows = "many rows\nV1 a 0 SIN(0 1 50)\nD1 a b DI\nR1 b 0 1k\n.model DI D\n.tran 1n 0.9\n.end\n";

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t number = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++number;
  return number;
}

}  // namespace

TEST_CASE("--plot draws the signals in panels by unit, events and modes below", "[unit]") {
  const Scratch scratch;
  scratch.write("r.net", rectifier);
  REQUIRE(run_in(scratch, {"r.net", "--plot", "r.svg"}).status == 0);
  CHECK(scratch.names() == Names{"r.csv", "r.net", "r.svg"});
  const std::string picture = read_file(scratch / "r.svg");
  CHECK_THAT(picture, Catch::Matchers::StartsWith("<svg ") && Catch::Matchers::EndsWith("</svg>\n"));
  CHECK_THAT(picture, Contains("rectifier") && Contains(">v(b)<") && Contains(">i(D1)<") && Contains(">mode changes<") &&
                          Contains(">D1<") && Contains("time (ms)"));
  CHECK(count(picture, "<polyline") == 2);
  // The diode conducts in the two positive half periods of 10 ms, 200 of 800 units each.
  CHECK_THAT(picture, Contains("<rect x=\"80\"") && Contains("<rect x=\"480\""));
  CHECK(count(picture, "width=\"200\" height=\"11\"") == 2);
}

TEST_CASE("rows, picture and statistics come from one run, and the rows are the same as without", "[unit]") {
  const Scratch scratch;
  scratch.write("r.net", rectifier);
  REQUIRE(run_in(scratch, {"r.net"}).status == 0);
  const std::string alone = read_file(scratch / "r.csv");
  const Finished finished = run_in(scratch, {"r.net", "--plot", "r.svg", "--stats", "s.json", "-o", "-", "--events"});
  REQUIRE(finished.status == 0);
  CHECK(run_in(scratch, {"r.net", "-o", "-", "--events"}).out == finished.out);
  REQUIRE(run_in(scratch, {"r.net", "--plot", "r.svg"}).status == 0);
  CHECK(read_file(scratch / "r.csv") == alone);
}

TEST_CASE("the sparse engine's runs are drawn too", "[unit]") {
  const Scratch scratch;
  scratch.write("r.net", rectifier);
  REQUIRE(run_in(scratch, {"r.net", "--plot", "r.svg", "--engine", "sparse"}).status == 0);
  CHECK_THAT(read_file(scratch / "r.svg"), Contains(">D1<") && Contains(">mode changes<"));
}

TEST_CASE("a run that is interrupted draws what it has", "[unit]") {
  const Scratch scratch;
  scratch.write("many.net", many_rows);
  Spawned program({"many.net", "--plot", "p.svg"}, {.folder = scratch.path().string()});
  REQUIRE(wait_until(30, [&] { return scratch.holds("many.csv.partial"); }));
  pause(300);
  program.send(SIGINT);
  CHECK(program.finish().status == 130);
  CHECK(scratch.names() == Names{"many.csv", "many.net", "p.svg"});
  CHECK(count(read_file(scratch / "p.svg"), "<polyline") > 0);
}

TEST_CASE("a picture that finds no room has status 3 and leaves an older one as it was", "[unit]") {
  const Scratch scratch;
  scratch.write("r.net", rectifier);
  SECTION("on a device") { CHECK(run_in(scratch, {"r.net", "--plot", "full.svg", "-o", "/dev/full"}).status == 3); }
  SECTION("on a disk") {
    scratch.write("p.svg", "old\n");
    const Finished finished = run_in(scratch, {"r.net", "--plot", "p.svg", "-o", "-"}, {.file_size = 1000});
    CHECK(finished.status == 3);
    CHECK(read_file(scratch / "p.svg") == "old\n");
  }
  CHECK_FALSE(scratch.holds("full.svg"));
}

TEST_CASE("a picture in a folder that is not there has status 3 before the run", "[unit]") {
  const Scratch scratch;
  scratch.write("r.net", rectifier);
  CHECK(run_in(scratch, {"r.net", "--plot", "no/p.svg"}).status == 3);
  CHECK(scratch.names() == Names{"r.net"});
}

TEST_CASE("a deck without .tran has nothing to draw", "[golden]") {
  const Scratch scratch;
  scratch.write("op.net", "op\nV1 a 0 1\nR1 a 0 1\n.op\n");
  const Finished finished = run_in(scratch, {"op.net", "--plot", "p.svg"});
  CHECK(finished.status == 2);
  CHECK(finished.err == "error[E-no-transient]: the deck has no .tran: there are no waveforms to draw; try without --plot\n");
  CHECK(scratch.names() == Names{"op.net"});
}
