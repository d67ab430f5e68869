/// Elements A and B, value= and TABLE, and raw systems, run from their cards, against closed forms.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <numbers>

#include <fmt/format.h>

#include "regression/deck_run.hpp"
#include "support/scratch.hpp"

using namespace pwlsim;
using namespace pwlsim::test;

namespace {

constexpr double block_bound = 1e-12;  ///< of values of order one
constexpr double two_pi = 2.0 * std::numbers::pi;

using Function = std::function<double(double)>;

/// Signals are the nodes, in order of appearance; the first is the input.
void check_nodes(const std::string& cards, const std::vector<Function>& nodes) {
  const DeckRun run = run_text("t\n" + cards + "\n.tran 0.0625 1\n");
  INFO(run.messages << run.answer.message);
  REQUIRE(run.messages.empty());
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  for (std::size_t k = 0; k < nodes.size(); ++k)
    for (const auto& row : run.rows) {
      INFO(run.signals[k] << " at t = " << row[0]);
      CHECK(row[k + 1] == Approx(nodes[k](row[0])).margin(block_bound).epsilon(block_bound));
    }
}

double wave(double t) { return 2.0 * std::sin(two_pi * t + 0.3); }

const std::string source = "V1 a 0 SIN(0 2 1 0 0 {0.3*180/pi})\n";

DeckRun run_raw(const std::string& file, const std::string& cards, bool events = false) {
  const Scratch scratch;
  return run_text("t\n.lcs s \"" + scratch.write("test.lcs", file) + "\"\n" + cards, events);
}

}  // namespace

TEST_CASE("blocks without memory", "[regression]") {
  check_nodes(source +
                  "A1 a g mg\nA2 [a a] s ms\nA3 a l ml\nA4 a p mp\n.model mg gain(gain=2 in_offset=0.5 out_offset=-1)\n"
                  ".model ms summer(in_gain=[1 2] in_offset=[0 1] out_gain=3 out_offset=1)\n.model ml limit(gain=2 out_lower_limit=-1 "
                  "out_upper_limit=0.5)\n"
                  ".model mp pwl(x_array=[-1 0 1] y_array=[0 1 0])",
              {wave, [](double t) { return 2.0 * (wave(t) + 0.5) - 1.0; }, [](double t) { return 3.0 * (3.0 * wave(t) + 2.0) + 1.0; },
               [](double t) { return std::clamp(2.0 * wave(t), -1.0, 0.5); }, [](double t) { return 1.0 - std::abs(wave(t)); }});
}

TEST_CASE("ports of currents and differences", "[regression]") {
  check_nodes(source +
                  "VM a m 0\nR1 m 0 2\nA1 %vnam VM b mg\nA2 %vd(a,b) %i c mg\nRC c 0 1\nA3 %i d %vd(0,e) mg\nRD a d 4\nRE e 0 1\n.model mg "
                  "gain(gain=3)",
              {wave, wave, [](double t) { return 1.5 * wave(t); }, [](double t) { return 1.5 * wave(t); }, [](double) { return 0.0; },
               [](double t) { return -0.75 * wave(t); }});
}

TEST_CASE("blocks with states", "[regression]") {
  const double w = two_pi;
  // Integral of 1 from 0.25, stopped at 0.75; 1/(p² + 2p + 1) and p/(p + 1) from rest, input 1 from t = 0 on; a derivative.
  check_nodes(
      "V1 a 0 SIN(0 2 1)\nV2 b 0 PULSE(0 1 0)\nA1 b i mi\nA2 b x mx\nA3 b y my\nA4 a d md\n.model mi int(out_ic=0.25 "
      "out_upper_limit=0.75)\n"
      ".model mx s_xfer(num_coeff=[1] den_coeff=[1 2 1])\n.model my s_xfer(num_coeff=[1 0] den_coeff=[1 1])\n.model md d_dt(gain=0.5)",
      {[&](double t) { return 2.0 * std::sin(w * t); }, [](double) { return 1.0; }, [](double t) { return std::min(0.25 + t, 0.75); },
       [](double t) { return 1.0 - (1.0 + t) * std::exp(-t); }, [](double t) { return std::exp(-t); },
       [&](double t) { return w * std::cos(w * t); }});
}

// A low pass by s_xfer and one by int, of time constant 1/rate, answer a step as 1 - exp(-rate t); an integral in no loop rises as rate t. The
// state is a volt across 2^-20 F, whose current is small against R times the rate times that.
TEST_CASE("blocks keep their states however fast they are beside large resistors", "[regression]") {
  const auto [rate, resistance] = GENERATE(table<double, double>({{1e3, 1e6}, {1e5, 1e4}, {1e6, 1e3}, {1e6, 1e6}, {10.0, 1e9}}));
  const std::string cards = fmt::format(
      "V1 a 0 PULSE(0 1)\nA1 a x mx\nA2 %vd(a,y) y mi\nA3 a z mi\nR1 x 0 {1}\nR2 y 0 {1}\nR3 z 0 {1}\n.model mx s_xfer(num_coeff=[1] "
      "den_coeff=[{{1/{0}}} 1])\n.model mi int(gain={0})\n.save v(x) v(y) v(z)\n.tran {{0.25/{0}}} {{2/{0}}}\n",
      rate, resistance);
  const DeckRun run = run_text("t\n" + cards);
  INFO(cards << run.messages << run.answer.message);
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  for (const auto& row : run.rows) {
    const double turns = rate * row[0];
    for (const int low_pass : {1, 2}) CHECK(row[low_pass] == Approx(-std::expm1(-turns)).margin(block_bound));
    CHECK(row[3] == Approx(turns).margin(block_bound));
  }
}

TEST_CASE("hysteresis changes sides once the input has passed the band", "[regression]") {
  // Up from -1 to 1 in half a second, then down: the step lies at 0.5 on the way up, at -0.5 on the way down.
  const auto input = [](double t) { return t < 0.5 ? -1.0 + 4.0 * t : 3.0 - 4.0 * t; };
  const auto step = [](double t) { return t >= 0.375 && t < 0.875 ? 5.0 : -5.0; };
  // A ramp from in = 0 to 0.25, shifted by 0.25 up or down; fully up at 0.5 on the way up.
  const auto ramp = [&](double t) {
    const double shift = t < 0.375 ? 0.25 : -0.25;
    return std::clamp((input(t) - shift) / 0.25, 0.0, 1.0);
  };
  check_nodes(
      "V1 a 0 PWL(0 -1 0.5 1 1 -1)\nA1 a s ms\nA2 a r mr\n.model ms hyst(in_low=0 in_high=0 hyst=0.5 out_lower_limit=-5 "
      "out_upper_limit=5)\n"
      ".model mr hyst(in_low=0 in_high=0.25 hyst=0.25)",
      {input, step, ramp});
}

TEST_CASE("expressions of signals", "[regression]") {
  const auto v = [](Function f) { return [f](double t) { return f(wave(t)); }; };
  check_nodes(
      source +
          ".func clip(x) {limit(x,-0.5,1.5)}\nB1 b 0 V={max(V(a),min(0.5,abs(V(a))-1))}\nB2 c 0 V={clip(V(a)) + uramp(-V(a))}\n"
          "B3 d 0 V={V(a) > 1 ? 2*V(a)-1 : V(a)}\nB4 e 0 V={V(a) > 1 && V(b) > 0 ? V(a) : -V(b)}\nB5 f 0 V={table(V(a),-1,0,0,1,1,0)}\n"
          "B6 g 0 V={exp(-time)*sin(2*pi*time)^2 + (time < 0.5 ? 1 : 3)}\nE1 h 0 TABLE {V(a)} = (-1,-5) (1,5)\nE2 i 0 a 0 table=(-1 -5, 1 "
          "5)\n"
          "G1 0 j value={2*abs(V(a))}\nR1 j 0 1\nB7 0 k I={I(G1) + I(E1)}\nR2 k 0 1",
      {wave, v([](double x) { return std::max(x, std::min(0.5, std::abs(x) - 1.0)); }),
       v([](double x) { return std::clamp(x, -0.5, 1.5) + std::max(-x, 0.0); }), v([](double x) { return x > 1.0 ? 2.0 * x - 1.0 : x; }),
       v([](double x) {
         const double b = std::max(x, std::min(0.5, std::abs(x) - 1.0));
         return x > 1.0 && b > 0.0 ? x : -b;
       }),
       v([](double x) { return std::max(0.0, 1.0 - std::abs(x)); }),
       [](double t) { return std::exp(-t) * std::pow(std::sin(two_pi * t), 2) + (t < 0.5 ? 1.0 : 3.0); },
       v([](double x) { return 5.0 * std::clamp(x, -1.0, 1.0); }), v([](double x) { return 5.0 * std::clamp(x, -1.0, 1.0); }),
       v([](double x) { return 2.0 * std::abs(x); }), v([](double x) { return 2.0 * std::abs(x); })});
}

TEST_CASE("1, raw: the carts need no circuit", "[hard]") {
  const DeckRun run =
      run_raw("# positions, velocities\nA\n0 0 1 0\n0 0 0 1\n-2 1 0 0 # springs\n1 -1 0 0\nB\n0\n0\n1\n0\nC\n1 0 0 0\nx0\n0 -1 -1 0\n",
              ".tran 0.125 1.5\n");
  REQUIRE(run.messages.empty());
  CHECK(run.signals == std::vector<std::string>{"x(s,1)", "x(s,2)", "x(s,3)", "x(s,4)", "u(s,1)", "y(s,1)"});
  for (const auto& row : run.rows) {
    CHECK(row[2] == Approx(-std::cos(row[0])).margin(block_bound));
    CHECK(row[3] == Approx(0.0).margin(block_bound));
    CHECK(row[5] == Approx(std::cos(row[0])).margin(block_bound));
  }
}

TEST_CASE("6, raw: an impulse of higher order", "[hard]") {
  const DeckRun run = run_raw("A\n0 1 0\n0 0 1\n0 0 0\nB\n0\n0\n1\nC\n1 0 0\nx0\n0 -1 0\n", ".tran 0.5 1\n");
  REQUIRE(run.messages.empty());
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  for (const auto& row : run.rows)
    for (std::size_t k = 1; k <= 3; ++k) CHECK(std::abs(row[k]) <= block_bound);
}

// A mass that reaches a stop at speed −1 stays there: the stop takes its momentum.
TEST_CASE("jumps of a raw system name its states", "[regression]") {
  const DeckRun run = run_raw("A\n0 1\n0 0\nB\n0\n1\nC\n1 0\nx0\n0 -1\n", ".tran 0.5 1\n", true);
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  REQUIRE(run.answer.jumps.size() == 1);
  REQUIRE(run.answer.jumps[0].states.size() == 1);
  CHECK(run.answer.jumps[0].states[0].name == "x(s,2)");
  CHECK(run.answer.jumps[0].states[0].before == -1.0);
  CHECK(run.answer.jumps[0].states[0].after == 0.0);
}

TEST_CASE("34, 35, raw: problems without states", "[hard]") {
  const DeckRun two = run_raw("D\n-1\nF\n1\nw\nDC 1\n", ".tran 0.5 1\n");
  REQUIRE(two.messages.empty());
  CHECK(two.answer.outcome == engine::Outcome::not_unique);
  const DeckRun none = run_raw("D\n-1\nF\n1\nw\nDC -1\n", ".tran 0.5 1\n");
  REQUIRE(none.messages.empty());
  CHECK(none.answer.outcome == engine::Outcome::no_solution);
  const DeckRun cycling = run_raw("D\n1 0 2\n2 1 0\n0 2 1\nF\n-1\n-1\n-1\nw\nDC 1\n", ".save u(s,1) u(s,2) u(s,3)\n.tran 0.5 1\n");
  REQUIRE(cycling.messages.empty());
  for (const auto& row : cycling.rows)
    for (std::size_t k = 1; k <= 3; ++k) CHECK(row[k] == Approx(1.0 / 3.0).margin(block_bound));
}

// x' = 2 + u with y = x1 - 1.5 t²: the support accelerates by 3 and carries the mass, u = 1.
TEST_CASE("15, raw: a support that accelerates", "[hard]") {
  const DeckRun run =
      run_raw("A\n0 1 0 0\n0 0 0 0\n0 0 0 1\n0 0 0 0\nB\n0\n1\n0\n0\nC\n1 0 -1 0\nE\n0\n2\n0\n3\nw\nDC 1\nF\n0\n", ".tran 0.25 1\n");
  REQUIRE(run.messages.empty());
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  for (const auto& row : run.rows) CHECK(row[1] == Approx(1.5 * row[0] * row[0]).margin(block_bound));
}

// x1 turns with x2 at 10^10 rad/s from (1, 0): x1 = cos, x2 = -sin; x3' = -10^12 x3 beside x4' = -x4.
TEST_CASE("a raw system keeps its fast states", "[regression]") {
  const DeckRun run = run_raw("A\n0 1e10 0 0\n-1e10 0 0 0\n0 0 -1e12 0\n0 0 0 -1\nx0\n1 0 1 1\n", ".tran 25p 1n\n");
  INFO(run.messages << run.answer.message);
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  for (const auto& row : run.rows) {
    const double t = row[0];
    CHECK(row[1] == Approx(std::cos(1e10 * t)).margin(block_bound));
    CHECK(row[2] == Approx(-std::sin(1e10 * t)).margin(block_bound));
    CHECK(row[3] == Approx(std::exp(-1e12 * t)).margin(block_bound));
    CHECK(row[4] == Approx(std::exp(-t)).margin(block_bound));
  }
}

TEST_CASE("sizes of a raw system that do not fit are named with their line", "[unit]") {
  const auto refused = [](const std::string& file) { return run_raw(file, ".tran 1 2\n").messages; };
  CHECK(refused("A\n0 1\n0 0\nB\n1\n").find("test.lcs:4:1: error[E-lcs]: B is 1 by 1, but must be 2 by 1") != std::string::npos);
  CHECK(refused("A\n0 1\n0\n").find(":3:1: error[E-lcs]: a row of 1 numbers in A, whose first row has 2") != std::string::npos);
  CHECK(refused("A\n0 x\n0 0\n").find(":2:3: error[E-lcs]: 'x' is not a number") != std::string::npos);
  CHECK(refused("1 2\n").find(":1:1: error[E-lcs]: rows must follow a keyword") != std::string::npos);
  CHECK(refused("A\n1\nA\n1\n").find(":3:1: error[E-lcs]: a second A") != std::string::npos);
  CHECK(refused("A\n0\nx0\n1e400\n").find(":4:1: error[E-lcs]: '1e400' is too large") != std::string::npos);
  CHECK(refused("A\n-1\nB\n1\nD\n1\nx0\n2\n").find("test.lcs:3:1: error[E-lcs]: C is missing, which B needs") != std::string::npos);
  CHECK(refused("A\n-1\nC\n1\nD\n1\n").find("test.lcs:3:1: error[E-lcs]: B is missing, which C needs") != std::string::npos);
  CHECK(refused("A\n-1\nD\n1\n").find("test.lcs:3:1: error[E-lcs]: B is missing, which D needs") != std::string::npos);
  CHECK(refused("B\n1\nC\n1\n").find("test.lcs:1:1: error[E-lcs]: A is missing, which B needs") != std::string::npos);
  CHECK(refused("x0\n").find("neither states nor ports") != std::string::npos);
}

TEST_CASE("the name of a raw system's file stands in either kind of quotes", "[unit]") {
  const Scratch scratch;
  const std::string file = scratch.write("a b.lcs", "A\n-1\nx0\n1\n");
  for (const char quote : {'"', '\''}) {
    const DeckRun run = run_text("t\n.lcs s " + (quote + file + quote) + "\n.tran 0.5 1\n");
    INFO(run.messages);
    REQUIRE(run.rows.size() == 3);
    CHECK(run.rows[2][1] == Approx(std::exp(-1.0)).margin(block_bound));
  }
  CHECK(run_text("t\n.lcs s '" + file + "\n.tran 0.5 1\n").messages.find("error[E-syntax-unclosed]") != std::string::npos);
}

// A source that rests on a threshold is in no loop: sgn(0) = 0, u(0) = 0, and a > b is false, a >= b true where they are equal.
TEST_CASE("a step of a source at rest on its threshold has one value", "[regression]") {
  const auto on = [](double t) { return t >= 0.25 && t < 0.5 ? 1.0 : 0.0; };
  check_nodes(
      "V1 a 0 PULSE(0 1 0.25 0 0 0.25)\nB1 b 0 V={sgn(V(a))}\nB2 c 0 V={u(V(a))}\nB3 d 0 V={V(a)>0 ? 5 : 3}\nB4 e 0 V={V(a)<=0 ? 5 : 3}\n"
      "B5 f 0 V={sgn(-V(a))}\nR1 b g 1\nC1 g 0 1",
      {on, on, on, [&](double t) { return on(t) > 0.0 ? 5.0 : 3.0; }, [&](double t) { return on(t) > 0.0 ? 3.0 : 5.0; },
       [&](double t) { return -on(t); },
       [](double t) {
         const double charged = 1.0 - std::exp(-0.25);
         return t < 0.25 ? 0.0 : (t < 0.5 ? 1.0 - std::exp(-(t - 0.25)) : charged * std::exp(-(t - 0.5)));
       }});
}

TEST_CASE("steps of ramps, pulses and straight lines", "[regression]") {
  // A ramp from -1 to 1 within half a second, then on top; a polygon that touches 0, rests there and falls.
  const auto above = [](double t) { return t >= 0.375 ? 1.0 : 0.0; };
  const auto polygon = [](double t) { return t < 0.25 ? 1.0 : (t < 0.5 ? 0.0 : -1.0); };
  check_nodes(
      "V1 a 0 PULSE(-1 1 0 0.5 0.5 10)\nV2 p 0 PWL(0 1 0.25 0 0.5 0 1 -1)\nB1 b 0 V={u(V(a) - 0.5)}\nB2 c 0 V={sgn(V(p))}\nB3 d 0 V={u(0.5 "
      "- V(a))}",
      {[](double t) { return std::min(-1.0 + 4.0 * t, 1.0); },
       [](double t) { return t < 0.25 ? 1.0 - 4.0 * t : std::min(0.0, 1.0 - 2.0 * t); }, above, polygon,
       [&](double t) { return 1.0 - above(t); }});
}

// 1 mΩ into 1 µF beside bleeders of 1 GΩ: 1 - exp(-t/RC). 1 MΩ and 1 H beside contacts of 1 µΩ: (1 - exp(-tR/L))/R. The others bear on it by 1e-11.
TEST_CASE("small and large resistors keep their time constants beside others far away", "[regression]") {
  const int others = GENERATE(1, 3, 4, 10);
  std::string bleeders, contacts;
  for (int i = 0; i < others; ++i) {
    bleeders += fmt::format("RB{} b 0 1g\n", i);
    contacts += fmt::format("RC{} n{} n{} 1u\n", i, i, i + 1);
  }
  const auto charged = [](const DeckRun& run, double unit) {
    INFO(run.messages << run.answer.message);
    REQUIRE(run.rows.size() == 4);
    for (const auto& row : run.rows) CHECK(row[1] == Approx(unit * -std::expm1(-row[0] / run.rows[2][0])).epsilon(1e-10));
  };
  charged(run_text("t\nV1 a 0 PULSE(0 1)\nR1 a b 1m\nC1 b 0 1u\n" + bleeders + ".tran 0.5n 1.5n\n.save v(b)\n"), 1.0);
  charged(
      run_text(fmt::format("t\nV1 a 0 PULSE(0 1)\nR1 a b 1meg\nL1 b n0 1\n{}V2 n{} 0 0\n.tran 0.5u 1.5u\n.save i(L1)\n", contacts, others)),
      1e-6);
}
