// --json: a run as one JSON object on standard output.

#include <catch2/catch.hpp>

#include "cli/run_in.hpp"
#include "support/json.hpp"

using namespace pwlsim::test;
using Catch::Matchers::Contains;

namespace {

/// Half of 4 V at the operating point, of 2 V from t = 0 on.
const std::string dropping_divider =
    "divider\n"
    "V1 a 0 PULSE(4 2 0 0 0 1 2)\n"
    "R1 a b 1k\n"
    "R2 b 0 1k\n"
    ".tran 0.1 0.3\n"
    ".op\n"
    ".save v(b) i(R1)\n";

}  // namespace

TEST_CASE("--json tells the file, the signals, the operating point and the statistics", "[unit]") {
  const Scratch scratch;
  scratch.write("d.net", dropping_divider);
  const Finished finished = run_in(scratch, {"d.net", "--json", "--stats", "s.json", "--plot", "p.svg"});
  REQUIRE(finished.status == 0);
  const Json json = read_json(finished.out);
  CHECK(json["deck"].string == "d.net");
  CHECK(json["title"].string == "divider");
  CHECK(json["status"].number == 0.0);
  CHECK(json["output"]["file"].string == "d.csv");
  CHECK(json["output"]["format"].string == "csv");
  CHECK(json["output"]["rows"].number == 4.0);
  CHECK(json["output"]["end"].number == 0.3);
  CHECK(json["output"]["complete"].truth);
  CHECK(json["plot"].string == "p.svg");
  REQUIRE(json["signals"].array.size() == 2);
  CHECK(json["signals"][0]["name"].string == "v(b)");
  CHECK(json["signals"][1]["unit"].string == "A");
  CHECK(json["operating_point"]["v(b)"].number == 2.0);
  CHECK(json["operating_point"]["i(R1)"].number == 0.002);
  // The same keys as --stats.
  const Json statistics = read_json(read_file(scratch / "s.json"));
  for (const auto& [key, value] : statistics.object) CHECK(json["stats"].object.count(key) == 1);
  CHECK(json["stats"]["rows"].number == 4.0);
}

TEST_CASE("--json with an operating point alone has no rows", "[unit]") {
  const Scratch scratch;
  scratch.write("op.net", "op\nV1 a 0 3\nR1 a 0 1k\n.op\n.save v(a)\n");
  const Json json = read_json(run_in(scratch, {"op.net", "--json"}).out);
  CHECK(json["output"].kind == Json::Kind::null);
  CHECK(json["operating_point"]["v(a)"].number == 3.0);
}

TEST_CASE("--json of a deck that is wrong holds its messages", "[unit]") {
  const Scratch scratch;
  scratch.write("bad.net", "bad\nR1 a 0 {nix}\n.tran 1 2\n");
  const Finished finished = run_in(scratch, {"bad.net", "--json"});
  CHECK(finished.status == 2);
  const Json json = read_json(finished.out);
  CHECK(json["status"].number == 2.0);
  CHECK(json["stats"].kind == Json::Kind::null);
  REQUIRE(json["notes"].array.size() == 1);
  CHECK_THAT(json["notes"][0].string, Contains("bad.net:2:") && Contains("error[E-"));
}

TEST_CASE("--json of a run that fails says how far it came", "[unit]") {
  const Scratch scratch;
  scratch.write("d.net", dropping_divider);
  SECTION("for want of room") {
    const Finished finished = run_in(scratch, {"d.net", "--json"}, {.file_size = 30});
    CHECK(finished.status == 3);
    const Json json = read_json(finished.out);
    CHECK(json["status"].number == 3.0);
    CHECK_FALSE(json["output"]["complete"].truth);
    CHECK_THAT(json["output"]["file"].string, Contains("d.csv.partial"));
  }
  SECTION("on a device") {
    const Json json = read_json(run_in(scratch, {"d.net", "--json", "-o", "/dev/full"}).out);
    CHECK(json["output"]["file"].string == "/dev/full");
    CHECK_FALSE(json["output"]["complete"].truth);
  }
}

TEST_CASE("standard output holds one thing", "[golden]") {
  const Scratch scratch;
  scratch.write("d.net", dropping_divider);
  const Finished rows = run_in(scratch, {"d.net", "--json", "-o", "-"});
  CHECK(rows.status == 2);
  CHECK(rows.err == "error[E-option-conflict]: the rows and `--json` would both go to standard output; try two files\n");
  CHECK(run_in(scratch, {"d.net", "--json", "--stats", "-"}).status == 2);
  CHECK(run_in(scratch, {"d.net", "--json"}, {.standard_output = "/dev/full"}).status == 3);
}
