/// Switches that answer to states which they make jump, on all engines.

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "regression/deck_run.hpp"

namespace {

using namespace pwlsim;

constexpr double exact = 1e-9, by_steps = 1e-4;  ///< V, of values near 1 V

struct Engine {
  std::string name;
  test::DeckRun run;
  double tolerance;
};

std::vector<Engine> by_all_engines(const std::string& deck) {
  return {{"modes", test::run_text(deck), exact},
          {"segments", test::run_text_segments(deck), exact},
          {"steps", test::run_text_sparse(deck, 1e-7), by_steps}};
}

}  // namespace

// It empties the capacitor that closed it at once, and opens only then.
TEST_CASE("a switch without resistance makes a sawtooth of the voltage that closes it", "[regression]") {
  const std::string deck =
      "sawtooth\nI1 0 a 1m\nC1 a 0 1u\nS1 a 0 a 0 SX\n.model SX SW(Ron=0 Vt=0.5 Vh=0.4)\n.tran 17u 4m uic\n.save v(a)\n.end\n";
  for (const Engine& engine : by_all_engines(deck)) {
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
  for (const Engine& engine : by_all_engines(deck)) {
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
