/// Perfectly and nearly perfectly coupled inductors on the sparse engine, where they once carried the rounding of C/h.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <string>

#include "regression/comparison.hpp"
#include "regression/deck_run.hpp"

using namespace pwlsim;
using namespace pwlsim::test;

namespace {

constexpr double volts = 12.0, henry = 47e-6, farad = 100e-6, ohms = 10.0, on_time = 4e-6, switching_period = 10e-6;
/// Of the largest value: what the steps of a run may gather, in tolerances.
constexpr double gathered = 300.0;
constexpr double winding_rounding = 1e-9;

std::string sepic(const std::string& coupling, const std::string& time) {
  return "sepic\nVin in 0 12\nL1 in a 47u ic=0\nS1 a 0 g 0 SX\nVg g 0 PULSE(0 1 0 0 0 4u 10u)\nC1 a b 1u ic=0\nL2 b 0 47u ic=0\n"
         "K1 L1 L2 " +
         coupling +
         "\nD1 b out DX\nC2 out 0 100u ic=0\nR1 out 0 10\n.model SX SW(Ron=0 Roff=inf Vt=0.5)\n.model DX D\n"
         ".save v(out) i(L1) i(L2) v(b)\n.tran " +
         time + " uic\n";
}

/// Output voltage and magnetising current within the first period: a coil that is charged, then joined to C and R, an oscillation that R damps.
struct Magnetising {
  double output = 0.0, current = 0.0;
  explicit Magnetising(double t) : current(volts * std::min(t, on_time) / henry) {
    if (t <= on_time) return;
    const double decay = 0.5 / (ohms * farad), omega = std::sqrt(1.0 / (henry * farad) - decay * decay), s = t - on_time;
    const double amplitude = current / (farad * omega) * std::exp(-decay * s);
    output = amplitude * std::sin(omega * s);
    const double slope = amplitude * (omega * std::cos(omega * s) - decay * std::sin(omega * s));
    current = farad * slope + output / ohms;
  }
};

}  // namespace

// K = −1 holds C1 at the input voltage, without a current: L1 carries all while S1 is closed, L2 all while it is open. With C1 empty at first the
// row at t = 0 held its impulse, and rows on edges 300 A.
TEST_CASE("a SEPIC with K = -1 magnetises one winding at a time", "[regression]") {
  const double reltol = GENERATE(1e-4, 1e-5, 1e-6, 1e-7);
  const DeckRun run = run_text_sparse(sepic("-1", "0.5u 1m"), reltol);
  INFO(reltol << run.messages << run.answer.message);
  REQUIRE(run.rows.size() == 2001);
  double most = 0.0, share = 0.0;
  for (const auto& row : run.rows) {
    most = std::max({most, std::abs(row[2]), std::abs(row[3])});
    share = std::max(share, std::min(std::abs(row[2]), std::abs(row[3])));
  }
  CHECK(share <= winding_rounding * most);
  for (const auto& row : run.rows) {
    if (row[0] >= switching_period) break;
    const Magnetising expected(row[0]);
    INFO(row[0]);
    CHECK(std::abs(row[1] - expected.output) <= gathered * reltol * Magnetising(switching_period).output);
    CHECK(std::abs(row[2] - row[3] - expected.current) <= gathered * reltol * Magnetising(on_time).current);
  }
}

TEST_CASE("a SEPIC with K = 1 is the exact engine's", "[regression]") {
  const double reltol = GENERATE(1e-5, 1e-6, 1e-7);
  const std::string deck = sepic("1", "1u 0.3m");
  const DeckRun run = run_text_sparse(deck, reltol), exact = run_text(deck);
  INFO(reltol << run.messages << run.answer.message);
  CHECK(largest_difference(exact, run) <= gathered * reltol);
}

// A leakage of 10 pH rings with 1 µF 50 times a microsecond, and v(b) is what a ten-millionth of the flux leaves: it was 6 to 30 kV at one edge.
TEST_CASE("a SEPIC with K = 0.9999999 is the exact engine's", "[regression]") {
  const std::string deck = sepic("0.9999999", "1u 15u");
  const DeckRun run = run_text_sparse(deck, 1e-6), exact = run_text(deck);
  INFO(run.messages << run.answer.message);
  CHECK(largest_difference(exact, run) <= gathered * 1e-6);
}

// Three windings of one core, one of them the other way round with respect to one of the others only.
TEST_CASE("couplings that contradict each other are an error on both engines", "[regression]") {
  const std::string deck =
      "t\nV1 a 0 1\nL1 a 0 1m\nL2 b 0 1m\nL3 c 0 1m\nR2 b 0 1\nR3 c 0 1\nK1 L1 L2 1\nK2 L2 L3 1\nK3 L1 L3 -1\n.tran 1u 1m uic\n.save "
      "i(L2)\n";
  for (const DeckRun& run : {run_text(deck), run_text_sparse(deck, 1e-4)}) CHECK(run.messages.find("E-coupling") != std::string::npos);
}
