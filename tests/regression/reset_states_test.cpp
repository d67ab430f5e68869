/// Switches that answer to states which they make jump, and flip-flops that see logic settle.

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "regression/deck_run.hpp"

namespace {

using namespace pwlsim;

constexpr double by_exact_engine = 1e-9, by_steps = 1e-4;  ///< V, of values near 1 V

struct Engine {
  std::string name;
  test::DeckRun run;
  double tolerance;
};

std::vector<Engine> by_exact_engines(const std::string& deck) {
  return {{"modes", test::run_text(deck), by_exact_engine}, {"segments", test::run_text_segments(deck), by_exact_engine}};
}

std::vector<Engine> by_all_engines(const std::string& deck) {
  return {{"modes", test::run_text(deck), by_exact_engine},
          {"segments", test::run_text_segments(deck), by_exact_engine},
          {"steps", test::run_text_sparse(deck, 1e-7), by_steps}};
}

}  // namespace

// It empties the capacitor that closed it at once, and opens only then.
TEST_CASE("a switch without resistance makes a sawtooth of the voltage that closes it", "[regression]") {
  const std::string deck =
      "sawtooth\nI1 0 a 1m\nC1 a 0 1u\nS1 a 0 a 0 SX\n.model SX SW(Ron=0 Vt=0.5 Vh=0.4)\n.tran 17u 4m uic\n.save v(a)\n.end\n";
  for (const Engine& engine : by_exact_engines(deck)) {
    INFO(engine.name << ": " << engine.run.answer.message);
    REQUIRE(engine.run.answer.outcome == engine::Outcome::completed);
    for (const auto& row : engine.run.rows) CHECK(row[1] == Approx(std::fmod(1e3 * row[0], 0.9)).epsilon(0.0).margin(engine.tolerance));
  }
}

TEST_CASE("idtmod of a signal wraps at both ends", "[regression]") {
  const double amplitude = 2.71, frequency = 665.24, unit = 1.1241e-3, modulus = 0.87, offset = -0.35;
  const std::string deck =
      "wrapped integral\nV1 s 0 SIN(0 2.71 665.24)\nB1 o 0 V=idtmod(V(s)/1.1241m,0,0.87,-0.35)\nR1 o 0 1k\n.tran 74.9u 11.2m\n.save "
      "v(o)\n.end\n";
  const double omega = 2.0 * std::numbers::pi * frequency;
  for (const Engine& engine : by_exact_engines(deck)) {
    INFO(engine.name << ": " << engine.run.answer.message);
    REQUIRE(engine.run.answer.outcome == engine::Outcome::completed);
    for (const auto& row : engine.run.rows) {
      const double turns = (amplitude / (unit * omega) * (1.0 - std::cos(omega * row[0])) - offset) / modulus;
      const double place = turns - std::floor(turns);
      if (std::min(place, 1.0 - place) < 1e-3) continue;  // on either side of a jump
      CHECK(row[1] == Approx(offset + modulus * place).epsilon(0.0).margin(10.0 * engine.tolerance));
    }
  }
}

// The clock is the output of a gate behind a gate, and loaded by a capacitor. It is high from the start and rises at 2 ms alone.
TEST_CASE("a flip-flop takes no edge of a clock that is high from the start", "[regression]") {
  const std::string deck =
      "flip-flop\nV1 s 0 PWL(0 1 1m 1 1m 0 2m 0 2m 1)\nV2 in 0 1\nA1 s 0 0 0 0 0 y 0 BUF Ref=.5\nA2 y 0 0 0 0 0 z 0 BUF Ref=.5\n"
      "R1 z zf 1k\nC1 zf 0 1u\nA4 in 0 z 0 0 db d 0 DFLOP Ref=.5\n.save v(d)\n.tran 0.3m 3m uic\n.end\n";
  for (const Engine& engine : by_all_engines(deck)) {
    INFO(engine.name << ": " << engine.run.answer.message);
    REQUIRE(engine.run.answer.outcome == engine::Outcome::completed);
    for (const auto& row : engine.run.rows) CHECK(row[1] == Approx(row[0] < 2e-3 ? 0.0 : 1.0).epsilon(0.0).margin(engine.tolerance));
  }
}

// The control is at its threshold to rounding where it has passed: the position that it has left is none that follows.
TEST_CASE("idtmod wraps once where its control has passed by rounding alone", "[regression]") {
  const std::string deck =
      "wraps beside a grid\n"
      "Vasa asa 0 SIN(-0.95364 2.2139 1.1124e+05 0 0 280)\n"
      "Ba1 ao1 0 V=idtmod(abs(V(asa))/5.9417e-06,0,1.4701,-0.78507)\n"
      "RaQ1 ao1 ao1f 5898.2\n"
      ".model DbM0 D(Ron=0.0011315 Roff=8.8507e+05)\n"
      "RbV10 bn10 bn20 2.7645\n"
      "Cb10 bn10 0 1.0164e-06 ic=5.6463\n"
      "RbV11 bn11 bn21 2.7645\n"
      "Cb11 bn11 0 1.0164e-06 ic=4.2377\n"
      "RbV12 bn12 bn22 2.7645\n"
      "Cb12 bn12 0 1.0164e-06 ic=0\n"
      "RbH20 bn20 bn21 2.7645\n"
      "Cb20 bn20 0 1.0164e-06 ic=0\n"
      "RbH21 bn21 bn22 2.7645\n"
      "Cb21 bn21 0 1.0164e-06 ic=6.0609\n"
      "Cb22 bn22 0 1.0164e-06 ic=0\n"
      "Vb1 bv1 0 SIN(0 10 92567 0 0 140)\n"
      "RbS1 bv1 bw1 1.3823\n"
      "Db1 bw1 bn20 DbM0\n"
      "RX0 ao1f bn22 1.08829e+06\n"
      ".tran 4.75332e-07 7.12998e-05 1.7825e-05 uic\n"
      ".save v(ao1) v(bn22) v(bn20) i(Db1)\n"
      ".end\n";
  const test::DeckRun modes = test::run_text(deck), segments = test::run_text_segments(deck);
  INFO(segments.answer.message);
  REQUIRE(segments.answer.outcome == engine::Outcome::completed);
  REQUIRE(segments.rows.size() == modes.rows.size());
  for (std::size_t i = 0; i < modes.rows.size(); ++i)
    for (std::size_t k = 1; k < modes.rows[i].size(); ++k)
      CHECK(segments.rows[i][k] == Approx(modes.rows[i][k]).epsilon(0.0).margin(by_exact_engine));
}
