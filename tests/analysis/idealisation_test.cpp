#include <catch2/catch.hpp>

#include "analysis/idealisation.hpp"

using namespace pwlsim;
using namespace pwlsim::analysis;

namespace {

struct Told {
  SourceStore sources;
  Diagnostics diagnostics;
  FileIndex file = sources.add("a.net", "title\n.model DX D(IS=1p)\nC1 a 0 1u V=25\n.tran 1 2\n+ startup\n");
};

}  // namespace

TEST_CASE("what is not run as written is a list, in the order of its messages", "[unit]") {
  Told told;
  told.diagnostics.note("N-diode-tangent", {told.file, 13, 15}, "DX is replaced");
  told.diagnostics.warning("W-no-departure", {told.file, 13, 15}, "not this one");
  told.diagnostics.error("E-range", {told.file, 13, 15}, "nor this one");
  told.diagnostics.warning("W-ignored-parameter", {told.file, 35, 39}, "V= is ignored");
  told.diagnostics.warning("W-startup", {told.file, 40, 59}, "startup is read as uic");
  told.diagnostics.note("N-control-skipped", {}, "nowhere");
  const std::vector<Idealisation> list = departures(told.diagnostics, told.sources);
  REQUIRE(list.size() == 4);
  CHECK(list[0].kind == "replaced");
  CHECK(list[0].subject == "DX");
  CHECK(list[0].place == "a.net:2");
  CHECK(list[0].text == "DX is replaced");
  CHECK(list[1].kind == "ignored");
  CHECK(list[1].subject == "V=25");
  CHECK(list[1].place == "a.net:3");
  CHECK(list[2].kind == "read otherwise");
  CHECK(list[2].subject == ".tran 1 2");  // of a subject on two lines the first
  CHECK(list[3].place.empty());
  CHECK(departures_line(list) == "not as written: 1 replaced, 2 ignored, 1 read otherwise (--verbose lists them)\n");
  CHECK(departures_table(std::vector(list.begin(), list.begin() + 2)) ==
        "not as written:\n  replaced        a.net:2  DX    DX is replaced\n  ignored         a.net:3  V=25  V= is ignored\n");
  CHECK(departures_json(std::vector(list.begin(), list.begin() + 1)) ==
        R"([{"kind": "replaced", "subject": "DX", "place": "a.net:2", "text": "DX is replaced"}])");
}

TEST_CASE("a deck that runs as written says nothing of it", "[unit]") {
  CHECK(departures_line({}).empty());
  CHECK(departures_table({}).empty());
  CHECK(departures_json({}) == "[]");
}
