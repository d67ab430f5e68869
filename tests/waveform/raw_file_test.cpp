#include "waveform/raw_file.hpp"

#include <catch2/catch.hpp>
#include <cstring>
#include <string>

#include "support/scratch.hpp"
#include "waveform/output_file.hpp"

using namespace pwlsim::waveform;

namespace {

const std::string head =
    "Title: t\nDate: today\nPlotname: Transient Analysis\nFlags: real\nNo. Variables: 2\nNo. Points: 2     \nVariables:\n"
    "\t0\ttime\ttime\n\t1\tV(Out)\tvoltage\nBinary:\n";

std::string bytes_of(std::initializer_list<double> values) {
  std::string bytes;
  for (double value : values) bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  return bytes;
}

}  // namespace

TEST_CASE("a binary raw file is read by its names, which have no case", "[unit]") {
  const auto file = read_raw(head + bytes_of({0.0, 1.0, 0.5, 2.0}));
  REQUIRE(file);
  REQUIRE(file->rows() == 2);
  REQUIRE(file->find("v(OUT)") == 1);
  CHECK_FALSE(file->find("v(in)"));
  CHECK(file->at(1, 0) == 0.5);
  CHECK(file->at(1, 1) == 2.0);
}

TEST_CASE("a raw file that was cut short holds its whole rows", "[unit]") {
  const auto file = read_raw(head + bytes_of({0.0, 1.0, 0.5}));
  REQUIRE(file);
  CHECK(file->rows() == 1);
  CHECK(read_raw(head)->rows() == 0);
}

TEST_CASE("what is no binary raw file is not read", "[unit]") {
  CHECK_FALSE(read_raw(""));
  CHECK_FALSE(read_raw("time,v(a)\n0,1\n"));
  CHECK_FALSE(read_raw("Binary:\n"));
}

TEST_CASE("rows are written as ngspice writes them, with their number in the head", "[unit]") {
  const pwlsim::test::Scratch scratch;
  std::string problem;
  auto file = OutputFile::open(scratch / "a.raw", problem);
  REQUIRE(file);
  RawWriter writer(*file, "a\ntitle", std::vector<RawVector>{{"time", "time"}, {"v(Out)", "voltage"}});
  REQUIRE(writer.write(std::vector<double>{0.0, 1.0}));
  REQUIRE(writer.write(std::vector<double>{0.5, 2.0, 1.0, -3.0}));
  REQUIRE(writer.flush());
  REQUIRE(file->commit());
  // The head is that of a file that ngspice 39 wrote, but for the title, the date, the padding of the number of points and the command.
  CHECK(pwlsim::test::read_file(scratch / "a.raw") ==
        "Title: a title\nDate: Thu Jan  1 00:00:00  1970\nPlotname: Transient Analysis\nFlags: real\nNo. Variables: 2\n"
        "No. Points: 3                   \nCommand: version pwlsim, read as ngspice\nVariables:\n\t0\ttime\ttime\n\t1\tv(Out)\tvoltage\nBinary:\n" +
            bytes_of({0.0, 1.0, 0.5, 2.0, 1.0, -3.0}));
}

TEST_CASE("a title that looks like a line of the head does no harm", "[unit]") {
  const pwlsim::test::Scratch scratch;
  std::string problem;
  auto file = OutputFile::open(scratch / "a.raw", problem);
  REQUIRE(file);
  RawWriter writer(*file, "Binary:\nNo. Points: 7", std::vector<RawVector>{{"time", "time"}});
  REQUIRE(writer.write(std::vector<double>{0.5}));
  REQUIRE(writer.flush());
  REQUIRE(file->commit());
  const auto raw = read_raw(pwlsim::test::read_file(scratch / "a.raw"));
  REQUIRE(raw);
  REQUIRE(raw->rows() == 1);
  CHECK(raw->at(0, 0) == 0.5);
}
