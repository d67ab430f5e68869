/// Sizes far apart: resistances that are too large or too small to matter do not matter, and gains are of any size.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "regression/deck_run.hpp"

using namespace pwlsim;
using namespace pwlsim::test;

namespace {

using std::numbers::pi;
constexpr double rounding = 1e-11;  ///< of closed forms, relative

double last(const DeckRun& run, std::size_t column = 1) { return run.rows.back()[column]; }

bool completed(const DeckRun& run) { return run.messages.empty() && run.answer.outcome == engine::Outcome::completed; }

/// Each stage charges its capacitor to the node before it and then stands on that node, in turns with its neighbours. Between the phases all
/// switches are open.
std::string fibonacci(int stages, double load, bool diodes) {
  std::string deck = "fibonacci\nVin t0 0 6.3\nVa pa 0 PULSE(0 1 0 0 0 4.8u 10u)\nVb pb 0 PULSE(0 1 5u 0 0 4.8u 10u)\n";
  for (int k = 1; k <= stages; ++k) {
    const char* charge = k % 2 == 1 ? "pa" : "pb";
    const char* lift = k % 2 == 1 ? "pb" : "pa";
    deck += diodes ? fmt::format("D{0} t{1} t{0} DX\n", k, k - 1) : fmt::format("Sc{0} t{1} t{0} {2} 0 SX\n", k, k - 1, charge);
    deck += fmt::format("Sg{0} b{0} 0 {2} 0 SX\nSl{0} b{0} t{1} {3} 0 SX\nC{0} t{0} b{0} 1u ic=0\n", k, k - 1, charge, lift);
  }
  deck += diodes ? fmt::format("Do t{} out DX\n", stages) : fmt::format("So t{} out {} 0 SX\n", stages, stages % 2 == 0 ? "pa" : "pb");
  return deck + fmt::format("Co out 0 10u ic=0\nRL out 0 {}\n.model SX SW(Ron=0.1 Vt=0.5)\n.model DX D(Ron=10m)\n.save v(out)\n", load);
}

struct Converter {
  std::string name, deck, card;          ///< `card` goes behind the resistors that are hung in
  std::vector<std::string> nodes;        ///< where they may hang
  double voltage = 0.0, smallest = 0.0;  ///< the largest voltage, and the smallest capacitance that a leak empties
};

std::vector<Converter> converters() {
  const std::string models = ".model SX SW(Ron=10m Vt=0.5)\n.model DX D(Ron=1m Vfwd=0.7)\n";
  return {
      {"fibonacci of switches",
       fibonacci(4, 1e6, false),
       ".tran 1u 500u uic\n",
       {"t1", "t2", "t3", "t4", "b1", "b2", "b3", "b4"},
       51.0,
       1e-6},
      {"fibonacci of diodes", fibonacci(3, 1e4, true), ".tran 1u 500u uic\n", {"t1", "t2", "t3", "b1", "b2", "b3"}, 51.0, 1e-6},
      {"floating capacitors",
       "floating\nV1 in 0 20\nVg g 0 PULSE(0 1 20u 0 0 10u 50u)\nS1 in a g 0 SX\nC1 a b 1u ic=5\nS2 b 0 g 0 SX\nC2 b c 2u ic=1\n"
       "S3 c out g 0 SX\nCo out 0 1u ic=0\nRo out 0 1k\n.save v(a,b)\n" +
           models,
       ".tran 1u 300u uic\n",
       {"a", "b", "c"},
       20.0,
       1e-6},
      {"Cockcroft-Walton",
       "cascade\nVin a0 0 SIN(0 100 1k)\nCa1 a0 a1 1u ic=0\nDa1 0 a1 DX\nCb1 0 b1 1u ic=0\nDb1 a1 b1 DX\nCa2 a1 a2 1u ic=0\nDa2 b1 a2 DX\n"
       "Cb2 b1 b2 1u ic=0\nDb2 a2 b2 DX\nRL b2 0 1meg\n.save v(b2)\n" +
           models,
       ".tran 20u 10m uic\n",
       {"a1", "b1", "a2", "b2"},
       400.0,
       1e-6},
      {"flyback",
       "flyback\nVin in 0 48\nVg g 0 PULSE(0 1 0 0 0 4u 10u)\nL1 in d 100u ic=0\nL2 a s 25u ic=0\nRg a 0 1\nK1 L1 L2 0.98\nS1 d 0 g 0 "
       "SX\nD1 s k DX\n"
       "C1 k a 100u ic=0\nR1 k a 10\nDc d cl DX\nCc cl in 100n ic=0\nRc cl in 1k\n.save v(k,a)\n" +
           models,
       ".tran 1u 300u uic\n",
       {"k", "cl", "d"},
       100.0,
       1e-7},
      {"six-pulse",
       "six-pulse\nVa ps0 nn SIN(0 300 50)\nVb ps1 nn SIN(0 300 50 0 0 -120)\nVc ps2 nn SIN(0 300 50 0 0 -240)\nLa ps0 p0 100u ic=0\n"
       "Lb ps1 p1 100u ic=0\nLc ps2 p2 100u ic=0\nD1 p0 dp DX\nD2 0 p0 DX\nD3 p1 dp DX\nD4 0 p1 DX\nD5 p2 dp DX\nD6 0 p2 DX\n"
       "L1 dp out 10m ic=0\nC1 out 0 100u ic=0\nR1 out 0 10\n.save v(out)\n" +
           models,
       ".tran 0.5m 30m uic\n",
       {"ps0", "ps1", "ps2", "nn", "p0", "p1", "p2", "dp", "out"},
       900.0,
       1e-4}};
}

/// A source that floats behind inductors, and drives a diode and a resistor through them: nothing but the leak holds its potential.
struct FloatingSource {
  static constexpr double amplitude = 100.0, w = 2 * pi * 50.0, r = 10.0, l1 = 1e-3, l2 = 3e-3, l = l1 + l2;

  static std::string deck(double leak) {
    return fmt::format(
        "floating\nV1 a b SIN(0 100 50)\nL1 a c 1m ic=0\nD1 c 0 DX\nR1 0 d 10\nL2 d b 3m ic=0\nRx a 0 {}\n.model DX D(Ron=0)\n"
        ".save i(L1) v(b)\n.tran 1m 4m uic\n",
        leak);
  }
  /// Of the rows, against 10 A and 100 V.
  static double error(const DeckRun& run) {
    const double phase = std::atan2(w * l, r), size = amplitude / std::hypot(r, w * l);
    double worst = 0.0;
    for (std::size_t k = 1; k < run.rows.size(); ++k) {
      const double t = 1e-3 * static_cast<double>(k);
      const double i = size * (std::sin(w * t - phase) + std::sin(phase) * std::exp(-t * r / l));
      const double v = -r * i - l2 / l * (amplitude * std::sin(w * t) - r * i);
      worst = std::max({worst, std::abs(run.rows[k][1] - i) * r / amplitude, std::abs(run.rows[k][2] - v) / amplitude});
    }
    return worst;
  }
};

}  // namespace

// 8 times the input less what switches and load take (Ueno et al. 1991: the Fibonacci numbers): 6.3 V · 8 = 50.4 V.
TEST_CASE("a Fibonacci converter between teraohms gives eight times its input", "[regression]") {
  for (const double leak : {1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16}) {
    std::string deck = fibonacci(4, 1e8, false);
    for (int k = 1; k <= 4; ++k) deck += fmt::format("Rx{0} b{0} 0 {1}\n", k, leak);
    const DeckRun run = run_text(deck + ".tran 1m 20m uic\n");
    INFO(leak << ": " << run.messages << run.answer.message);
    REQUIRE(completed(run));
    CHECK(last(run) == Approx(8 * 6.3).epsilon(1e-4));
  }
}

// Charge that capacitors share within 5e-12 of a pulse is the same for any resistance on its way: what Ron = 0 shares in no time. Half a microsecond
// before an edge; at the edge itself a row holds what is shared so far. The sparse engine gives 13.472791578 at 100 µΩ.
TEST_CASE("a Fibonacci converter with switches of nanoohms shares charge as one without resistance", "[regression]") {
  const char* ron = GENERATE("0", "1n", "10n", "100n", "1u", "100u");
  std::string deck = fibonacci(4, 1e6, false);
  for (const auto& [from, to] : {std::pair<std::string, std::string>{"Ron=0.1 ", fmt::format("Ron={} ", ron)},
                                 {" 1u ic=0", " 0.1u ic=0"},
                                 {" 10u ic=0", " 1u ic=0"}})
    for (std::size_t at = deck.find(from); at != std::string::npos; at = deck.find(from, at + to.size())) deck.replace(at, from.size(), to);
  const DeckRun run = run_text(deck + ".tran 9.99u 499.5u uic\n");
  INFO(ron << ": " << run.messages << run.answer.message);
  REQUIRE(completed(run));
  CHECK(last(run) == Approx(13.472791578).epsilon(1e-9));
}

// What leaves through the leaks is nothing in sum, and the capacitors keep what they have: v(b) of three nodes a, b, c with v(a,b) = 5 V and
// v(b,c) = 1 V.
TEST_CASE("leaks alone place a floating pair of capacitors", "[regression]") {
  for (const auto& [ra, rb, rc] : {std::array{1e11, 1e11, 1e11}, std::array{1e9, 1e12, 1e15}, std::array{1e15, 1e13, 1e16}}) {
    const DeckRun run = run_text(
        fmt::format("floating\nV1 in 0 20\nVg g 0 0\nS1 in a g 0 SX\nC1 a b 1u ic=5\nS2 b 0 g 0 SX\nC2 b c 2u ic=1\nS3 c out g 0 SX\n"
                    "Co out 0 1u ic=0\nRo out 0 1k\nRa a 0 {}\nRb b 0 {}\nRc c 0 {}\n.model SX SW(Ron=10m Vt=0.5)\n.save v(a) v(b) v(c)\n"
                    ".tran 1u 1u uic\n",
                    ra, rb, rc));
    INFO(ra << ' ' << rb << ' ' << rc << ": " << run.messages << run.answer.message);
    REQUIRE(completed(run));
    CHECK(run.answer.remarks.empty());
    const double b = (1.0 / rc - 5.0 / ra) / (1.0 / ra + 1.0 / rb + 1.0 / rc);
    CHECK(run.rows[0][1] == Approx(b + 5.0).epsilon(0).margin(5 * rounding));
    CHECK(run.rows[0][2] == Approx(b).epsilon(0).margin(5 * rounding));
    CHECK(run.rows[0][3] == Approx(b - 1.0).epsilon(0).margin(5 * rounding));
  }
}

// A leak R takes a current of V/R from the circuit, no more: a share of a milliohm or an ohm over R in what is driven, and in time t of t/(R C)
// in what floats. A thousand times that is allowed.
TEST_CASE("leaks of any size change a converter by their own size only", "[regression]") {
  std::mt19937_64 engine(22);
  const auto pick = [&engine](std::size_t count) { return static_cast<std::size_t>(engine() % count); };
  for (const Converter& converter : converters()) {
    const DeckRun clean = run_text(converter.deck + converter.card);
    INFO(converter.name << clean.messages << clean.answer.message);
    REQUIRE(completed(clean));
    for (int round = 0; round < 12; ++round) {
      const double leak = std::pow(10.0, 8.0 + static_cast<double>(engine() % 801) / 100.0);
      std::string hung;
      for (int i = 0; i < 1 + round % 4; ++i) {
        const std::string& from = converter.nodes[pick(converter.nodes.size())];
        const std::string& to = round % 3 == 0 ? converter.nodes[pick(converter.nodes.size())] : "0";
        hung += fmt::format("Rx{} {} {} {}\n", i, from, to == from ? "0" : to, leak * static_cast<double>(1 + i));
      }
      const DeckRun run = run_text(converter.deck + hung + converter.card);
      INFO(converter.name << "\n" << hung << run.messages << run.answer.message);
      REQUIRE(completed(run));
      REQUIRE(run.rows.size() == clean.rows.size());
      double most = 0.0;
      for (std::size_t i = 0; i < run.rows.size(); ++i) most = std::max(most, std::abs(run.rows[i][1] - clean.rows[i][1]));
      CHECK(most <= converter.voltage * (1e3 * run.stop / (leak * converter.smallest) + 1e3 / leak + 1e-9));
    }
  }
}

// Closed form: L i' + R i = V sin ωt from rest, and v(b) = −R i − L₂ i'.
TEST_CASE("a leak that alone holds a floating source leaves its potential to the inductors", "[regression]") {
  for (const double leak : {1e8, 1e9, 1e11, 1e13, 1e15, 1e16}) {
    const DeckRun run = run_text(FloatingSource::deck(leak));
    INFO(leak << ": " << run.messages << run.answer.message);
    REQUIRE(completed(run));
    CHECK(run.answer.certificate.kcl_kvl < 1e-14);
    CHECK(FloatingSource::error(run) <= 10.0 / leak + 1e-12);
  }
}

// What such leaks once did to the run without a word (0.2 V of 94 V at 10¹⁵ Ω) the certificate tells: the rounding of a current times R is a voltage.
TEST_CASE("the certificate notices leaks that take the digits of slow rates", "[regression]") {
  for (const double leak : {1e11, 1e12, 1e13, 1e14, 1e15, 1e16}) {
    const DeckRun run = run_text_with_leaks_as_written(FloatingSource::deck(leak));
    INFO(leak << ": " << run.messages << run.answer.message);
    REQUIRE(completed(run));
    const double error = FloatingSource::error(run);
    CHECK(error > 1e-12 * leak / 1e9);
    CHECK(run.answer.certificate.kcl_kvl * 100.0 > error);
    if (error > 1e-5) CHECK(run.answer.certificate.kcl_kvl > 1e-6);
  }
}

TEST_CASE("controlled sources in no loop have gains of any size", "[regression]") {
  for (const double gain : {1e6, 1e9, 1e12, 1e15}) {
    for (const char* source : {"E1 b 0 a 0", "H1 b 0 V1"}) {
      const bool of_current = source[0] == 'H';
      const DeckRun run =
          run_text(fmt::format("gain\nV1 a 0 SIN(0 1n 1k)\nR1 a 0 1k\n{} {}\nR2 b 0 1k\n.save v(b)\n.tran 0.25m 0.25m\n", source, gain));
      INFO(source << ' ' << gain << ": " << run.messages << run.answer.message);
      REQUIRE(completed(run));
      CHECK(last(run) ==
            Approx((of_current ? -1e-3 : 1.0) * gain * 1e-9).epsilon(rounding));  // sin(2π · 1 kHz · 0.25 ms) = 1; i(V1) = −v/R1
    }
  }
}

TEST_CASE("blocks are as fast as they are, whatever resistors stand beside them", "[regression]") {
  for (const double gain : {1e3, 1e7, 1e9, 1e12}) {
    const DeckRun run = run_text(fmt::format(
        "integrator\nV1 a 0 SIN(0 1 1k)\nR1 a 0 1g\nA1 a x mi\n.model mi int(gain={})\nR2 x 0 1g\n.save v(x)\n.tran 0.25m 0.25m uic\n",
        gain));
    INFO(gain << ": " << run.messages << run.answer.message);
    REQUIRE(completed(run));
    CHECK(last(run) == Approx(gain / (2 * pi * 1e3)).epsilon(rounding));  // ∫ sin over a quarter of a period
  }
  for (const double rate : {1e5, 1e8, 1e12}) {
    const DeckRun run =
        run_text(fmt::format("lag\nV1 a 0 1\nR1 a 0 1g\nA1 a x mi\n.model mi s_xfer(num_coeff=[{0}] den_coeff=[1 {0}])\n"
                             "R2 x 0 1g\n.save v(x)\n.tran 1u 2u uic\n",
                             rate));
    INFO(rate << ": " << run.messages << run.answer.message);
    REQUIRE(completed(run));
    CHECK(last(run) == Approx(1.0 - std::exp(-rate * 2e-6)).epsilon(rounding));
  }
}
