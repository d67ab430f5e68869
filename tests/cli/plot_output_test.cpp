// --plot: the waveforms of a run as a picture.

#include <algorithm>
#include <catch2/catch.hpp>
#include <csignal>
#include <cstdlib>
#include <sstream>

#include "cli/many_rows.hpp"
#include "cli/run_in.hpp"
#include "waveform/png.hpp"

using namespace pwlsim;
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
  CHECK_THAT(picture, Contains("rectifier") && Contains(">v(b)<") && Contains(">i(D1)<") && Contains(">switching<") && Contains(">D1<") &&
                          Contains("time (ms)"));
  CHECK(count(picture, "<polyline") == 2);
  // The diode conducts in the two positive half periods of 10 ms, 200 of 800 units each.
  CHECK_THAT(picture, Contains("<rect x=\"110\"") && Contains("<rect x=\"510\""));
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

TEST_CASE("a picture draws the solution between the rows", "[unit]") {
  const Scratch scratch;
  // A row each whole period: all of them are zero.
  scratch.write("s.net", "sine\nV1 a 0 SIN(0 1 1k)\nR1 a 0 1\n.tran 1m 10m\n.save v(a)\n");
  REQUIRE(run_in(scratch, {"s.net", "--plot", "s.svg"}).status == 0);
  const std::string picture = read_file(scratch / "s.svg");
  const std::size_t begin = picture.find("points=\"", picture.find("<polyline")) + 8;
  std::istringstream points(picture.substr(begin, picture.find('"', begin) - begin));
  std::vector<double> heights;
  for (std::string point; points >> point;) heights.push_back(std::stod(point.substr(point.find(',') + 1)));
  const auto [top, bottom] = std::minmax_element(heights.begin(), heights.end());
  int turns = 0;  // through the middle
  for (std::size_t k = 1; k < heights.size(); ++k)
    turns += (heights[k] > 0.5 * (*top + *bottom)) != (heights[k - 1] > 0.5 * (*top + *bottom));
  constexpr double most_of_a_panel = 80.0;
  CHECK(*bottom - *top > most_of_a_panel);
  CHECK(turns >= 19);  // ten periods
  CHECK(turns <= 21);
}

TEST_CASE("the sparse engine's runs are drawn too", "[unit]") {
  const Scratch scratch;
  scratch.write("r.net", rectifier);
  REQUIRE(run_in(scratch, {"r.net", "--plot", "r.svg", "--engine", "sparse"}).status == 0);
  CHECK_THAT(read_file(scratch / "r.svg"), Contains(">D1<") && Contains(">switching<"));
}

TEST_CASE("a run that is interrupted draws what it has", "[unit]") {
  const Scratch scratch;
  scratch.write("many.net", many_rectified_rows);
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

TEST_CASE("where .op fails before the run there is nothing to draw", "[unit]") {
  const Scratch scratch;
  scratch.write("r.net", "t\nV1 a 0 1\nR1 a b 1k\nC1 b 0 1u\nV2 b 0 2\n.ic v(b)=3\n.op\n.tran 1u 10u uic\n.end\n");
  const Finished finished = run_in(scratch, {"r.net", "--plot", "p.svg"});
  CHECK(finished.status == 1);
  CHECK_THAT(finished.err, Contains("error[E-ic-contradiction]"));
  CHECK(scratch.names() == Names{"r.net"});
}

TEST_CASE("a name that ends in .png gives a PNG picture", "[unit]") {
  if (!waveform::find_png_converter()) {
    WARN("rsvg-convert is not installed: this test is skipped");
    return;
  }
  const Scratch scratch;
  scratch.write("r.net", rectifier);
  REQUIRE(run_in(scratch, {"r.net", "--plot", "p.PNG"}).status == 0);
  CHECK(scratch.names() == Names{"p.PNG", "r.csv", "r.net"});
  const std::string bytes = read_file(scratch / "p.PNG");
  REQUIRE(bytes.size() > 10'000);
  // PNG (ISO/IEC 15948) 5.2 and 11.2.2: the signature, then IHDR with width and height. The picture is 930 units wide, 1860 dots.
  CHECK(bytes.substr(0, 8) == "\x89PNG\r\n\x1a\n");
  CHECK(bytes.substr(12, 8) == std::string("IHDR\0\0\x07\x44", 8));
}

TEST_CASE("without a converter a PNG picture is refused before the run", "[golden]") {
  const Scratch scratch;
  scratch.write("r.net", rectifier);
  const char* path = std::getenv("PATH");
  const std::string before = path != nullptr ? path : "";
  ::setenv("PATH", scratch.path().c_str(), 1);
  const Finished finished = run_in(scratch, {"r.net", "--plot", "p.png"});
  ::setenv("PATH", before.c_str(), 1);
  CHECK(finished.status == 3);
  CHECK(finished.err ==
        "error[E-no-png]: p.png: a PNG picture needs rsvg-convert, and no program of that name is in PATH; try apt install librsvg2-bin, "
        "or a name that ends in .svg\n");
  CHECK(scratch.names() == Names{"r.net"});
}

TEST_CASE("a converter that fails has status 3 and its words", "[unit]") {
  const Scratch scratch;
  scratch.write("r.net", rectifier);
  REQUIRE(std::system(("printf '#!/bin/sh\\necho no colours left\\nexit 1\\n' > '" + (scratch / "rsvg-convert") + "' && chmod +x '" +
                       (scratch / "rsvg-convert") + "'")
                          .c_str()) == 0);
  const char* path = std::getenv("PATH");
  const std::string before = path != nullptr ? path : "";
  ::setenv("PATH", scratch.path().c_str(), 1);
  const Finished finished = run_in(scratch, {"r.net", "--plot", "p.png"});
  ::setenv("PATH", before.c_str(), 1);
  CHECK(finished.status == 3);
  CHECK_THAT(finished.err, Contains("error[E-cannot-write]: p.png: rsvg-convert fails: no colours left; try a name that ends in .svg"));
  CHECK_FALSE(scratch.holds("p.png"));
  CHECK(scratch.holds("r.csv"));
}
