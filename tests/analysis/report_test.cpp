#include "analysis/report.hpp"

#include <catch2/catch.hpp>
#include <limits>

#include "analysis/quantity.hpp"

using namespace pwlsim;
using analysis::quantity;

namespace {

analysis::RunReport example() {
  analysis::RunReport report;
  report.engine = "exact";
  report.statistics = {.islands = 1,
                       .states = 2,
                       .ports = 1,
                       .switches = 1,
                       .modes_visited = 3,
                       .events = 1000,
                       .jumps = 4,
                       .lcp_pivots = 12,
                       .klu_factorizations = 0,
                       .klu_solves = 0,
                       .steps = 7,
                       .rows = 501};
  report.certificate = {.complementarity = 1e-16, .kcl_kvl = 2.5e-15, .energy = std::numeric_limits<double>::quiet_NaN()};
  report.seconds = {
      .parse = 0.001, .flatten = 0.002, .model = 0.003, .simulate = 0.00042, .write = 0.005, .certificate = 0.006, .total = 0.5};
  report.jumps = {{.time = 0.5,
                   .impulses = {{"D1", "C", 2.0}},
                   .higher_order = false,
                   .states = {{"v(C1)", 3.0, 1.0}, {"v(C2)", 0.0, 1.0}},
                   .energy_before = 4.5,
                   .energy_after = 1.5}};
  report.notes = {"warning[W-x]: a \"quoted\"\tword"};
  return report;
}

}  // namespace

TEST_CASE("the statistics file has the keys of the contract", "[golden]") {
  // Keys and nesting as language.md lists them; escapes as RFC 8259 section 7 has them; NaN has no JSON form, so null.
  CHECK(analysis::statistics_json(example()) == R"json({
  "engine": "exact",
  "islands": 1,
  "states": 2,
  "ports": 1,
  "switches": 1,
  "modes_visited": 3,
  "events": 1000,
  "jumps": 4,
  "accumulations": 0,
  "lcp_pivots": 12,
  "klu_factorizations": 0,
  "klu_solves": 0,
  "steps": 7,
  "rows": 501,
  "jump_details": [
    {"time": 0.5, "impulses": [{"element": "D1", "value": 2, "unit": "C"}], "higher_order": false, "states": [{"name": "v(C1)", "before": 3, "after": 1}, {"name": "v(C2)", "before": 0, "after": 1}], "energy_before": 4.5, "energy_after": 1.5, "energy_lost": 3}
  ],
  "seconds": {
    "parse": 0.001,
    "flatten": 0.002,
    "model": 0.003,
    "simulate": 0.00042,
    "write": 0.005,
    "certificate": 0.006,
    "total": 0.5
  },
  "certificate": {
    "complementarity": 1e-16,
    "kcl_kvl": 2.5e-15,
    "energy": null,
    "passive": null,
    "points_checked": 0
  },
  "notes": [
    "warning[W-x]: a \"quoted\"\u0009word"
  ]
}
)json");
}

TEST_CASE("passivity is true, false or null", "[unit]") {
  analysis::RunReport report = example();
  report.certificate.has_passivity = true;
  CHECK(analysis::statistics_json(report).find("\"passive\": false") != std::string::npos);
  report.certificate.passive = true;
  CHECK(analysis::statistics_json(report).find("\"passive\": true") != std::string::npos);
}

TEST_CASE("a jump in a sentence, and how many were not told", "[golden]") {
  const std::vector<engine::Jump> jumps = example().jumps;
  CHECK(analysis::jump_texts(jumps, 1) ==
        std::vector<std::string>{
            "jump at t = 500 ms: D1 passes 2 C; v(C1) from 3 V to 1 V, v(C2) from 0 V to 1 V; stored energy from 4.5 J to 1.5 J"});
  std::vector<engine::Jump> later(25, jumps[0]);
  for (std::size_t i = 0; i < later.size(); ++i) later[i].time = static_cast<double>(i);
  const auto many = analysis::jump_texts(later, 30);
  REQUIRE(many.size() == 21);
  CHECK(many.back() == "and jumps at 10 more instants; --stats lists the first thousand");

  // Within a gate that the deck wrote as one element, at instants of their own: none of them is told, nor counted.
  const circuit::HiddenParts hidden{{"x1.a2"}};
  later[3].states = later[4].states = {{"v(X1.A2.Criseend)", 1.0, 0.0}};
  const auto visible = analysis::jump_texts(later, 30, hidden);
  REQUIRE(visible.size() == 21);
  CHECK(visible.back() == "and jumps at 8 more instants; --stats lists the first thousand");
  CHECK(analysis::jump_texts({later[3]}, 1, hidden).empty());
}

TEST_CASE("the summary is one line with the certificate", "[golden]") {
  analysis::RunReport report = example();
  report.certificate.energy = 0.0;
  CHECK(analysis::summary(report, "buck.csv", 0.005) ==
        "wrote buck.csv: 501 rows, 1000 events to t = 5 ms in 420 µs; worst residuals: complementarity 1.0e-16, KCL/KVL 2.5e-15, energy "
        "0\n");
}

TEST_CASE("quantities carry a metric prefix", "[unit]") {
  CHECK(quantity(0.0, "s") == "0 s");
  CHECK(quantity(1.0, "s") == "1 s");
  CHECK(quantity(0.0012345678, "s") == "1.23457 ms");
  CHECK(quantity(-2.5e-6, "A", 3) == "-2.5 µA");
  CHECK(quantity(4700, "Ω") == "4.7 kΩ");
  CHECK(quantity(1e-20, "s") == "1e-20 s");
  CHECK(quantity(999.9999, "s", 3) == "1 ks");
}

TEST_CASE("an operating point prints name = value", "[unit]") {
  const std::string names[] = {"v(out)", "i(L1)"};
  const double values[] = {5.0, -0.125};
  CHECK(analysis::operating_point_text(names, values) == "v(out) = 5\ni(L1) = -0.125\n");
}
