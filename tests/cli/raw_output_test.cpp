// --format raw: read back by our own reader and by ngspice.

#include <catch2/catch.hpp>
#include <csignal>
#include <cstdlib>

#include "cli/many_rows.hpp"
#include "cli/run_in.hpp"
#include "spice/ngspice.hpp"
#include "waveform/raw_file.hpp"

using namespace pwlsim;
using namespace pwlsim::test;
using Catch::Matchers::Contains;
using Names = std::vector<std::string>;

namespace {

/// Half of a 2 V step: every expected value is the divider's.
const std::string raw_divider =
    "divider\n"
    "V1 a 0 PULSE(0 2 0 0 0 1 2)\n"
    "R1 a b 1k\n"
    "R2 b 0 1k\n"
    ".tran 0.1 0.3 uic\n"
    ".save v(b) v(a,b) i(R1)\n"
    ".end\n";

waveform::RawFile read(const std::string& bytes) {
  const auto raw = waveform::read_raw(bytes);
  REQUIRE(raw);
  return *raw;
}

std::string points_line(const std::string& bytes) {
  const std::size_t at = bytes.find("No. Points: ");
  return bytes.substr(at, bytes.find_first_of(" \n", at + 12) - at);
}

}  // namespace

TEST_CASE("--format raw gives circuit.raw with the rows of the CSV", "[unit]") {
  const Scratch scratch;
  scratch.write("divider.net", raw_divider);
  REQUIRE(run_in(scratch, {"divider.net", "--format", "raw"}).status == 0);
  CHECK(scratch.names() == Names{"divider.net", "divider.raw"});
  const std::string bytes = read_file(scratch / "divider.raw");
  CHECK_THAT(bytes, Catch::Matchers::StartsWith("Title: divider\n") &&
                        Contains("\t1\tv(b)\tvoltage\n\t2\tv(a,b)\tvoltage\n\t3\ti(R1)\tcurrent\n"));
  CHECK(points_line(bytes) == "No. Points: 4");
  const waveform::RawFile raw = read(bytes);
  CHECK(raw.names == Names{"time", "v(b)", "v(a,b)", "i(r1)"});
  CHECK(raw.values == std::vector<double>{0, 1, 1, 0.001, 0.1, 1, 1, 0.001, 0.2, 1, 1, 0.001, 0.3, 1, 1, 0.001});
}

TEST_CASE("quantities of a raw system have no type in a raw file", "[unit]") {
  const Scratch scratch;
  scratch.write("s.txt", "A\n-1\nB\n1\nC\n1\nx0\n1\n");
  scratch.write("s.net", "system\n.lcs s \"s.txt\"\n.tran 0.5 1\n.save x(s,1)\n");
  REQUIRE(run_in(scratch, {"s.net", "--format", "raw"}).status == 0);
  CHECK_THAT(read_file(scratch / "s.raw"), Contains("\t1\tx(s,1)\tnotype\n"));
}

TEST_CASE("a raw file on standard output has the same bytes, with the number of points", "[unit]") {
  const Scratch scratch;
  scratch.write("divider.net", raw_divider);
  REQUIRE(run_in(scratch, {"divider.net", "--format", "raw", "--events"}).status == 0);
  const Finished finished = run_in(scratch, {"divider.net", "--format", "raw", "--events", "-o", "-"});
  REQUIRE(finished.status == 0);
  CHECK(finished.out == read_file(scratch / "divider.raw"));
}

TEST_CASE("ngspice loads a raw file with its names, its points and its values", "[unit]") {
  const auto program = spice::find_ngspice();
  if (!program) {
    WARN("ngspice is not installed: this test is skipped");
    return;
  }
  const Scratch scratch;
  scratch.write("divider.net", raw_divider);
  REQUIRE(run_in(scratch, {"divider.net", "--format", "raw"}).status == 0);
  scratch.write(
      "load.cir",
      "load\n.control\nload divider.raw\nlet last = length(time) - 1\nprint length(time) time[last] v(b)[last] i(r1)[last]\ndisplay\n"
      "quit\n.endc\n.end\n");
  REQUIRE(std::system(("cd '" + scratch.path().string() + "' && '" + *program + "' -n -b load.cir > log 2>&1").c_str()) == 0);
  const std::string log = read_file(scratch / "log");
  INFO(log);
  CHECK_THAT(log, Contains("Title:  divider") && Contains("tran1 (Transient Analysis)") && Contains("length(time) = 4.000000e+00") &&
                      Contains("time[last] = 3.000000e-01") && Contains("v(b)[last] = 1.000000e+00") &&
                      Contains("i(r1)[last] = 1.000000e-03"));
  CHECK_THAT(log, Contains("v(a,b)              : voltage, real, 4 long") && Contains("i(R1)               : current, real, 4 long"));
  CHECK_THAT(log, !Contains("Error") && !Contains("Warning"));
}

TEST_CASE("a raw file of a run that is interrupted is complete up to then", "[unit]") {
  const Scratch scratch;
  scratch.write("many.net", many_rows);
  Spawned program({"many.net", "--format", "raw"}, {.folder = scratch.path().string()});
  REQUIRE(wait_until(30, [&] { return scratch.holds("many.raw.partial"); }));
  pause(200);
  program.send(SIGTERM);
  CHECK(program.finish().status == 128 + SIGTERM);
  CHECK(scratch.names() == Names{"many.net", "many.raw"});
  const std::string bytes = read_file(scratch / "many.raw");
  const waveform::RawFile raw = read(bytes);
  CHECK(raw.rows() > 0);
  CHECK(points_line(bytes) == "No. Points: " + std::to_string(raw.rows()));
}

TEST_CASE("a raw file that finds no room has status 3; the partial file can be read", "[unit]") {
  const Scratch scratch;
  scratch.write("many.net", many_rows);
  scratch.write("many.raw", "old\n");
  const Finished finished = run_in(scratch, {"many.net", "--format", "raw"}, {.file_size = 300001});
  CHECK(finished.status == 3);
  CHECK_THAT(finished.err, Contains("error[E-cannot-write]") && Contains("many.raw.partial"));
  CHECK(read_file(scratch / "many.raw") == "old\n");
  const std::string bytes = read_file(scratch / "many.raw.partial");
  const waveform::RawFile raw = read(bytes);
  // A row is 24 bytes: time, v(a), i(V1).
  CHECK(bytes.size() > 300000 - 24);
  CHECK(points_line(bytes) == "No. Points: " + std::to_string(raw.rows()));
  CHECK((bytes.size() - bytes.find("Binary:\n") - 8) == raw.rows() * 24);
}

TEST_CASE("a full device has status 3 for a raw file too", "[unit]") {
  const Scratch scratch;
  scratch.write("divider.net", raw_divider);
  CHECK(run_in(scratch, {"divider.net", "--format", "raw", "-o", "/dev/full"}).status == 3);
  CHECK(scratch.names() == Names{"divider.net"});
}
