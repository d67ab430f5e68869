/// Products in which one factor is a voltage of two levels: of a pulse, a comparison, a gate, or what adds up from them.

#include <catch2/catch.hpp>

#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include "regression/deck_run.hpp"

namespace {

using pwlsim::test::DeckRun;
using pwlsim::test::run_text;

bool high(double t, double delay) { return t >= delay && std::fmod(t - delay, 10e-6) < 5e-6; }
double sine(double t) { return 3.0 * std::sin(2.0 * std::numbers::pi * 20e3 * t); }

struct LevelCase {
  const char* expression;
  std::function<double(double)> value;  ///< none: refused
};

const LevelCase level_cases[] = {
    {"V(p)*V(q)", [](double t) { return high(t, 0.0) && high(t, 2e-6) ? 10.0 : 0.0; }},
    {"V(s)*V(p)", [](double t) { return high(t, 0.0) ? 5.0 * sine(t) : 0.0; }},
    {"V(r)*V(s)", [](double t) { return high(t, 2e-6) ? 4.0 * sine(t) : -sine(t); }},  // levels -1 and 4, edges of 1 ns
    {"V(p)^2", [](double t) { return high(t, 0.0) ? 25.0 : 0.0; }},
    {"V(p)*V(q)*V(s)", [](double t) { return high(t, 0.0) && high(t, 2e-6) ? 10.0 * sine(t) : 0.0; }},
    {"V(vcc)*V(s)", [](double t) { return 12.0 * sine(t); }},
    {"V(c)*V(s)", [](double t) { return sine(t) > 1.0 ? 5.0 * sine(t) : 0.0; }},                     // a comparison
    {"V(both)*V(s)", [](double t) { return high(t, 0.0) || high(t, 2e-6) ? 2.0 * sine(t) : 0.0; }},  // logic of comparisons
    {"V(g)*V(s)", [](double t) { return high(t, 0.0) && high(t, 2e-6) ? 3.0 * sine(t) : 0.0; }},     // an AND device
    {"V(n)*V(s)", [](double t) { return high(t, 0.0) ? 0.0 : sine(t); }},                            // a complement
    {"V(e)*V(s)", [](double t) { return high(t, 0.0) ? -9.0 * sine(t) : sine(t); }},                 // 1 - 2·v(p), by E
    {"V(t)*V(s)", [](double t) { return high(t, 0.0) ? 17.0 * sine(t) : 12.0 * sine(t); }},          // on top of 12 V
    {"V(p,q)*V(s)", [](double t) { return ((high(t, 0.0) ? 5.0 : 0.0) - (high(t, 2e-6) ? 2.0 : 0.0)) * sine(t); }},
    {"(V(p)+V(s))*V(q)", [](double t) { return high(t, 2e-6) ? 2.0 * ((high(t, 0.0) ? 5.0 : 0.0) + sine(t)) : 0.0; }},
    {"max(V(p)*V(s),1)", [](double t) { return std::max(high(t, 0.0) ? 5.0 * sine(t) : 0.0, 1.0); }},
    {"sdt(V(p)*V(vcc))*1e6", [](double t) { return 60.0 * (5.0 * std::floor(t / 10e-6) + std::min(std::fmod(t, 10e-6) * 1e6, 5.0)); }},
    {"V(s)*V(s)", nullptr},
    {"V(filtered)*V(s)", nullptr},
    {"V(three)*V(s)", nullptr},
    {"I(V1)*V(s)", nullptr},
    {"V(held)*V(s)", nullptr},
    {"V(ramp)*V(s)", nullptr},      // a slow start
    {"V(triangle)*V(s)", nullptr},  // no level between its edges
    {"V(saw)*V(p)", [](double t) { return high(t, 0.0) ? 5.0 * std::fmod(t, 10e-6) / 10e-6 : 0.0; }},
    {"V(saw)*V(s)", nullptr},
    {"V(slow)*V(s)", nullptr},  // edges of a fifth of the period
    {"V(ramp)^2", nullptr},
    {"V(p)/V(lifted)", nullptr},
    {"V(wide)*V(vcc)", [](double t) { return 12.0 * std::min(t / 20e-6, 1.0); }},
    {"V(step)*V(s)", [](double t) { return t > 20.05e-6 ? sine(t) : 0.0; }},  // an edge of 100 ns
};

constexpr const char* level_frame =
    "two levels\nV1 p 0 PULSE(0 5 0 0 0 5u 10u)\nV2 q 0 PULSE(0 2 2u 0 0 5u 10u)\nV3 r 0 PULSE(-1 4 2u 1n 1n 5u 10u)\n"
    "V4 s 0 SIN(0 3 20k)\nV5 vcc 0 12\nV6 t vcc PULSE(0 5 0 0 0 5u 10u)\nV7 three 0 PWL(0 0 1u 0 1u 1 2u 1 2u 2)\n"
    "V8 ramp 0 PWL(0 0 20u 1)\nV9 triangle 0 PULSE(0 1 0 5u 5u 0 10u)\nV10 saw 0 PULSE(0 1 0 10u 0 0 10u)\nV11 slow 0 PULSE(0 1 0 1u 1u 4u "
    "10u)\n"
    "V12 lifted 0 PWL(0 1 20u 3)\nV13 wide 0 PWL(0 0 20u 1)\nV14 step 0 PWL(20u 0 20.1u 1)\n"
    "Bc c 0 V=if(V(s)>1,5,0)\nBb both 0 V=2*((V(p)>1)|(V(q)>1))\nE1 e 0 value={1-2*V(p)}\n"
    "R1 p filtered 1k\nC1 filtered 0 1n\nA1 p q 0 0 0 0 g 0 AND Vhigh=3\nA2 p 0 0 0 0 n 0 0 BUF\nA3 s 0 p 0 0 0 held 0 SAMPLEHOLD\nB1 o 0 "
    "V=";

}  // namespace

TEST_CASE("a product with a voltage of two levels has its value", "[regression]") {
  const LevelCase& one = GENERATE_REF(from_range(std::begin(level_cases), std::end(level_cases)));
  INFO(one.expression);
  const DeckRun run = run_text(std::string(level_frame) + one.expression + "\nRo o 0 1k\n.save v(o)\n.tran 0.2u 59.9u 0.1u\n.end\n");
  if (!one.value) {
    CHECK(run.messages.find("E-not-piecewise-linear") != std::string::npos);
    return;
  }
  REQUIRE(run.messages.empty());
  REQUIRE(run.rows.size() == 300);
  for (const auto& row : run.rows) {
    INFO(row[0]);
    CHECK(row[1] == Approx(one.value(row[0])).margin(1e-9));
  }
}
