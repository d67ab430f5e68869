/// What inspect says of circuits whose model is known in closed form.
#include "analysis/inspection.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "analysis/json.hpp"
#include "engine/exact/exact.hpp"
#include "netlist/load.hpp"
#include "support/json.hpp"

using namespace pwlsim;
using analysis::CertificateKind;
using analysis::Inspection;
using analysis::IslandView;
using analysis::ModeRequest;

namespace {

constexpr double tight = 1e-13;

struct Inspected {
  std::optional<Inspection> inspection;
  std::string errors;
};

Inspected inspect(const std::string& cards, const std::optional<ModeRequest>& mode = {}) {
  SourceStore sources;
  Diagnostics diagnostics;
  const netlist::Deck deck = netlist::parse("deck", "title\n" + cards, sources, diagnostics);
  const auto compiled = circuit::compile(deck, sources, diagnostics, {.analysis_required = false});
  REQUIRE(compiled);
  const auto model = engine::prepare(compiled->network, diagnostics);
  REQUIRE(model);
  Inspected result{analysis::inspect(*compiled, *model, mode, diagnostics), {}};
  for (const Diagnostic& diagnostic : diagnostics.all()) result.errors += diagnostic.id + ": " + diagnostic.text + "\n";
  return result;
}

/// The island with the most states.
IslandView main_island(const Inspected& inspected) {
  REQUIRE(inspected.inspection);
  const auto& islands = inspected.inspection->islands;
  return *std::max_element(islands.begin(), islands.end(), [](const auto& a, const auto& b) { return a.states < b.states; });
}

const std::string carts =
    "C1 x1 0 1\nC2 x2 0 1\nC3 x3 0 1\nC4 x4 0 1\n"
    "B1 0 x1 I={V(x3)}\nB2 0 x2 I={V(x4)}\nB3 0 x3 I={-2*V(x1) + V(x2) + I(VF)}\nB4 0 x4 I={V(x1) - V(x2)}\n"
    "E1 stop 0 x1 0 1\nVF force stop 0\nD1 0 force DI\n.model DI D\n";

/// `count` switches in a row, each over a capacitor of its own.
std::string switches(int count) {
  std::string cards = "V1 g 0 1\n.model SWI SW(Ron=1 Vt=0.5)\n";
  for (int i = 1; i <= count; ++i) {
    const std::string n = std::to_string(i);
    cards += "C" + n + " n" + n + " 0 1\nS" + n + " n" + n + " n" + std::to_string(i - 1) + " g 0 SWI" + (i == 2 ? " on\n" : "\n");
  }
  return cards + "R1 n0 0 1\n";
}

}  // namespace

// Paper, section 1 and eq. (4.20): y = x1, y'' = … + u. In the constrained mode x1 = x3 = 0: V = {x1 = x3 = 0}, T = span of x1 and x3.
TEST_CASE("two carts: degree two, principal minors, V and T of two dimensions", "[unit]") {
  const IslandView island = main_island(inspect(carts, ModeRequest{{"d1", true}}));
  REQUIRE(island.positions.size() == 1);
  const auto& position = island.positions[0];
  CHECK(position.ports[0].name == "D1");
  CHECK(position.ports[0].input_is_current);
  model::Matrix a(4, 4);
  a << 0, 0, 1, 0, 0, 0, 0, 1, -2, 1, 0, 0, 1, -1, 0, 0;
  CHECK((position.space.a - a).norm() <= tight);
  CHECK(position.markov.uniform_degree == 2);
  CHECK(position.markov.parameters[2](0, 0) == Approx(1.0).epsilon(tight));
  CHECK(position.certificate.kind == CertificateKind::principal_minors);
  REQUIRE(island.mode);
  CHECK(island.mode->on == std::vector<std::string>{"D1"});
  CHECK(island.mode->states == 4);
  CHECK(island.mode->consistent == 2);
  CHECK(island.mode->jump == 2);
  CHECK(island.mode->well_posed);
}

TEST_CASE("two carts off the stop: the whole space is consistent", "[unit]") {
  const IslandView island = main_island(inspect(carts, ModeRequest{}));
  REQUIRE(island.mode);
  CHECK(island.mode->on.empty());
  CHECK(island.mode->consistent == 4);
  CHECK(island.mode->jump == 0);
}

// Hard case 6: y = x1 of x1''' = u. Nothing but 0 is consistent.
TEST_CASE("triple integrator: V is nothing, T everything", "[hard]") {
  const IslandView island =
      main_island(inspect("C1 x1 0 1\nC2 x2 0 1\nC3 x3 0 1\nB1 0 x1 I={V(x2)}\nB2 0 x2 I={V(x3)}\nB3 0 x3 I={I(VF)}\n"
                          "E1 stop 0 x1 0 1\nVF force stop 0\nD1 0 force DI\n.model DI D\n",
                          ModeRequest{{"D1", true}}));
  CHECK(island.positions[0].markov.uniform_degree == 3);
  CHECK(island.mode->consistent == 0);
  CHECK(island.mode->jump == 3);
  CHECK(island.mode->well_posed);
}

// Hard case 19: joined, both have one voltage; the charge is what a jump keeps. CB = 1/C1 + 1/C2.
TEST_CASE("two capacitors joined by a diode", "[hard]") {
  const IslandView island = main_island(inspect("C1 a 0 1\nD1 a b DI\nC2 b 0 2\n.model DI D\n", ModeRequest{{"D1", true}}));
  CHECK(island.mode->consistent == 1);
  CHECK(island.mode->jump == 1);
  CHECK(island.positions[0].markov.uniform_degree == 1);
  CHECK(island.positions[0].markov.parameters[1](0, 0) == Approx(1.5).epsilon(tight));
  CHECK(island.positions[0].certificate.kind == CertificateKind::passive);
  CHECK(island.positions[0].certificate.always_solvable);
}

// v − 2 i_S = v(a), i_S + i_D = i, 3 i' = v(a) − 4 i, with x = √3 i and D1's blocking voltage v(a).
TEST_CASE("a chopper has one (A, B, C, D) for each position of its switch", "[unit]") {
  const IslandView island = main_island(
      inspect("V1 s 0 10\nVG g 0 0\nS1 s a g 0 SWI\nD1 0 a DI\nL1 a b 3\nR1 b 0 4\n.model SWI SW(Ron=2 Vt=0.5)\n.model DI D\n"));
  const double root3 = std::sqrt(3.0);
  CHECK(island.switches == std::vector<std::string>{"S1"});
  REQUIRE(island.positions.size() == 2);
  const auto& off = island.positions[0];
  CHECK(off.of_start);
  CHECK_FALSE(off.ports[0].input_is_current);
  CHECK(off.space.a(0, 0) == Approx(-4.0 / 3.0).epsilon(tight));
  CHECK(off.space.b(0, 0) == Approx(1.0 / root3).epsilon(tight));
  CHECK(off.space.c(0, 0) == Approx(1.0 / root3).epsilon(tight));
  CHECK(off.space.d(0, 0) == 0.0);
  const auto& on = island.positions[1];
  CHECK_FALSE(on.of_start);
  const bool current = on.ports[0].input_is_current;
  CHECK(on.space.a(0, 0) == Approx(current ? -2.0 : -4.0 / 3.0).epsilon(tight));
  CHECK(on.space.b(0, 0) == Approx(current ? 2.0 / root3 : 1.0 / root3).epsilon(tight));
  CHECK(on.space.c(0, 0) == Approx(current ? -2.0 / root3 : 1.0 / root3).epsilon(tight));
  CHECK(on.space.d(0, 0) == Approx(current ? 2.0 : 0.5).epsilon(tight));
  CHECK(on.certificate.kind == CertificateKind::passive);
}

TEST_CASE("a switch that shorts a source has no model closed, and says why", "[unit]") {
  const IslandView island =
      main_island(inspect("V1 s 0 10\nVG g 0 0\nS1 s 0 g 0 SWI\nR1 s a 1\nC1 a 0 1\n.model SWI SW(Vt=0.5)\n.save v(a) i(S1)\n"));
  const Inspected all = inspect("V1 s 0 10\nVG g 0 0\nS1 s 0 g 0 SWI\n.model SWI SW(Vt=0.5)\n.save i(S1)\n", ModeRequest{{"S1", true}});
  CHECK(island.states == 1);
  bool seen = false;
  for (const auto& part : all.inspection->islands) {
    if (part.switches.empty()) continue;
    seen = true;
    CHECK(part.positions[0].problem.empty());
    CHECK(part.positions[1].problem.find("S1") != std::string::npos);
    CHECK_FALSE(part.mode->well_posed);
  }
  CHECK(seen);
}

TEST_CASE("beyond four switches only the position of the start and that of the mode are shown", "[unit]") {
  CHECK(main_island(inspect(switches(4))).positions.size() == 16);
  const IslandView start = main_island(inspect(switches(5)));
  CHECK(start.positions_in_all == 32.0);
  REQUIRE(start.positions.size() == 1);
  CHECK(start.positions[0].of_start);
  CHECK(start.positions[0].on == std::vector<char>{0, 1, 0, 0, 0});
  const IslandView asked = main_island(inspect(switches(5), ModeRequest{{"S5", true}, {"S1", true}}));
  REQUIRE(asked.positions.size() == 2);
  CHECK(asked.positions[1].on == std::vector<char>{1, 0, 0, 0, 1});
  CHECK(asked.mode->on == std::vector<std::string>{"S1", "S5"});
}

// A relay is two ports; the sum of both identically zero currents through parallel diodes is determined, their shares are not.
TEST_CASE("ports of one element have numbers, and indeterminate ones are named", "[unit]") {
  const IslandView relay = main_island(inspect("C1 x 0 1\nA1 x %i x r\n.model r relay\n", ModeRequest{{"A1#2", true}}));
  CHECK(relay.positions[0].ports[0].name == "A1#1");
  CHECK(relay.positions[0].ports[1].name == "A1#2");
  CHECK_FALSE(relay.positions[0].ports[0].is_diode);
  CHECK(relay.mode->on == std::vector<std::string>{"A1#2"});
  CHECK(main_island(inspect("C1 x 0 1\nA1 x %i x r\n.model r relay\n", ModeRequest{{"a1", true}})).mode->on.size() == 2);
  const IslandView parallel =
      main_island(inspect("C1 a 0 1\nD1 a b DI\nD2 a b DI\nR1 b 0 1\n.model DI D\n", ModeRequest{{"D1", true}, {"D2", true}}));
  CHECK(parallel.mode->well_posed);
  CHECK(parallel.mode->indeterminate == std::vector<std::string>{"D1", "D2"});
}

TEST_CASE("breakdown of a diode is a port of its own, contacts of one control are one switch", "[unit]") {
  const IslandView diode = main_island(inspect("C1 a 0 1\nD1 a 0 DZ\n.model DZ D(Vrev=5)\n", ModeRequest{{"D1#reverse", true}}));
  CHECK(diode.positions[0].ports.size() == 2);
  CHECK(diode.mode->on == std::vector<std::string>{"D1#reverse"});
  const IslandView block = main_island(
      inspect("C1 x 0 1\nA1 x y h\nR1 y x 1\n.model h hyst(in_low=0 in_high=0 hyst=0.1 out_lower_limit=-1 out_upper_limit=1)\n"));
  CHECK(block.switches == std::vector<std::string>{"A1"});
  CHECK(block.positions.size() == 2);
  CHECK(block.positions[0].problem.empty());
  CHECK(block.positions[1].problem.empty());
}

TEST_CASE("stores of one element have numbers", "[unit]") {
  const IslandView island = main_island(inspect("V1 u 0 1\nA1 u y f\nR1 y 0 1\n.model f s_xfer(num_coeff=[1] den_coeff=[1 3 2])\n"));
  std::vector<std::string> names;
  for (const auto& state : island.positions.at(0).space.states) names.push_back(state.terms.at(0).element);
  CHECK(names == std::vector<std::string>{"A1#1", "A1#2"});
}

TEST_CASE("what nothing needs is left out and named", "[unit]") {
  const Inspected inspected = inspect("C1 a 0 1\nR1 a 0 1\nC2 b 0 1\nR2 b 0 1\n.save v(a)\n");
  CHECK(inspected.inspection->islands.size() == 1);
  CHECK(inspected.inspection->left_out == std::vector<std::vector<std::string>>{{"C2", "R2"}});
}

TEST_CASE("names that mean nothing in a mode are errors with a cure", "[golden]") {
  const std::string cards = "C1 a 0 1\nDin a b DI\nDout b 0 DI\nR1 b 0 1\nC2 e 0 1\nD3 e 0 DI\n.model DI D\n.save v(a)\n";
  const auto errors = [&](const ModeRequest& mode) {
    const Inspected inspected = inspect(cards, mode);
    CHECK_FALSE(inspected.inspection);
    return inspected.errors;
  };
  CHECK(errors({{"Dot", true}}) == "E-mode: `--mode`: unknown element 'Dot'; try 'Dout'\n");
  CHECK(errors({{"X", true}}) == "E-mode: `--mode`: unknown element 'X'; try one of Din, Dout\n");
  CHECK(errors({{"R1", true}}) == "E-mode: `--mode`: R1 has no modes; try a diode or a switch\n");
  CHECK(errors({{"Din", true}, {"din", false}}) == "E-mode: `--mode` sets Din twice; try it once\n");
  CHECK(errors({{"D3", true}}).find("E-mode: `--mode`: D3 is left out") == 0);
  CHECK(errors({{"X", true}, {"Y", false}}).find("'Y'") != std::string::npos);
}

TEST_CASE("the JSON is valid and holds every digit", "[unit]") {
  const Inspected inspected = inspect(carts + "C9 z 0 0.3\nR9 z 0 0.7\n.save v(x1) v(z)\n", ModeRequest{{"D1", true}});
  const test::Json json = test::read_json(analysis::inspection_json(*inspected.inspection));
  CHECK(json["title"].string == "title");
  REQUIRE(json["islands"].array.size() == 2);
  const test::Json& first = json["islands"][0];
  CHECK(first["mode"]["consistent_dimension"].number == 2.0);
  CHECK(first["mode"]["jump_dimension"].number == 2.0);
  CHECK(first["positions"][0]["A"][2][0].number == -2.0);
  CHECK(first["positions"][0]["relative_degree"]["uniform"].number == 2.0);
  CHECK(first["positions"][0]["certificate"]["kind"].string == "principal minors");
  const test::Json& second = json["islands"][1];
  CHECK(second["positions"][0]["states"][0][0]["element"].string == "C9");
  CHECK(second["positions"][0]["states"][0][0]["coefficient"].number ==
        inspected.inspection->islands[1].positions[0].space.states[0].terms[0].coefficient);
  CHECK(second["positions"][0]["B"].array.size() == 1);
  CHECK(json["left_out"].array.empty());
}

TEST_CASE("the JSON writer escapes, nests and ends its lines", "[golden]") {
  analysis::JsonWriter json;
  json.begin_object();
  json.member("a\"b\t", analysis::json_string("\\"));
  json.key("empty");
  json.begin_array();
  json.end_array();
  json.key("list");
  json.begin_array();
  json.value(analysis::json_line({"1", "2"}));
  json.value(analysis::json_number(INFINITY));
  json.end_array();
  json.end_object();
  const std::string text = json.take();
  CHECK(text == "{\n  \"a\\\"b\\u0009\": \"\\\\\",\n  \"empty\": [],\n  \"list\": [\n    [1, 2],\n    null\n  ]\n}\n");
  CHECK(test::read_json(text)["list"][0][1].number == 2.0);
}
