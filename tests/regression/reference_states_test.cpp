/// Four small circuits whose states at a few instants are known from an independent event-driven solution in 80-bit arithmetic:
/// a tank of 1 µF (10 V) and 10 mH with a resistor and a diode; with a diode bridge; with a bridge and a filter capacitor; and a bridge
/// with forward voltages on a cosine source. The numbers are printed to 13 or 14 decimals.
#include <catch2/catch.hpp>
#include <cmath>

#include "regression/deck_run.hpp"

using namespace pwlsim;
using namespace pwlsim::test;

namespace {

constexpr double start_bound = 1e-12;  ///< relative to the largest value of the signal, which is at least its value at the start
constexpr double millisecond = 1e-3;

struct Column {
  std::string signal;
  double scale = 1.0;                   ///< its largest magnitude in the run
  std::vector<double> at_milliseconds;  ///< at 1, 2, … ms
};

std::string deck(const std::string& cards, const std::string& saved, int milliseconds) {
  return "reference states\n" + cards + ".model DI D\n.model DF D(Vfwd=0.21)\n.save " + saved + "\n.tran 1m " +
         std::to_string(milliseconds) + "m uic\n.end\n";
}

void check(const DeckRun& run, const std::vector<Column>& columns) {
  INFO(run.messages << run.answer.message);
  REQUIRE(run.messages.empty());
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  for (std::size_t column = 0; column < columns.size(); ++column) {
    REQUIRE(run.rows.size() == columns[column].at_milliseconds.size() + 1);
    REQUIRE(run.signals[column] == columns[column].signal);
    for (std::size_t i = 0; i < columns[column].at_milliseconds.size(); ++i) {
      INFO(columns[column].signal << " at " << i + 1 << " ms");
      REQUIRE(run.rows[i + 1][0] == Approx(static_cast<double>(i + 1) * millisecond));
      CHECK(std::abs(run.rows[i + 1][column + 1] - columns[column].at_milliseconds[i]) <= start_bound * columns[column].scale);
    }
  }
}

const std::string tank = "C1 1 0 1u ic=10\nL1 1 0 10m\n";
const std::string diode_bridge = "D1 1 2 DI\nD2 3 1 DI\nD3 0 2 DI\nD4 3 0 DI\nR1 2 3 1k\n";
constexpr double tank_voltage = 10.0, tank_current = 0.1;  ///< 10 V / √(10 mH / 1 µF)

}  // namespace

TEST_CASE("tank with a resistor and a diode: reference states", "[regression]") {
  const std::string cards = tank + "R1 1 2 1k\nD1 2 0 DI\n";
  check(run_text(deck(cards, "v(1) i(L1)", 5)),
        {{"v(1)", tank_voltage, {-6.4472632148001, 2.2081874159696, 0.9110380674146, -2.4705842561313, 2.8004033362933}},
         {"i(L1)", tank_current, {-0.04596960608386, 0.05354719239179, -0.04854090271778, 0.02627640014561, -0.00843961704360}}});
}

TEST_CASE("tank with a resistor and a diode: first events", "[regression]") {
  const std::string cards = tank + "R1 1 2 1k\nD1 2 0 DI\n";
  const DeckRun run = run_text(deck(cards, "v(1) i(L1)", 5), true);
  std::vector<double> times;
  for (std::size_t i = 1; i < run.rows.size(); ++i)
    if (run.rows[i][0] == run.rows[i - 1][0]) times.push_back(run.rows[i][0]);
  REQUIRE(times.size() >= 2);
  CHECK(times[0] == Approx(152.26800110860626e-6).epsilon(start_bound));
  CHECK(times[1] == Approx(466.42726646758557e-6).epsilon(start_bound));
}

TEST_CASE("tank with a diode bridge: reference states", "[regression]") {
  check(run_text(deck(tank + diode_bridge, "v(1) i(L1)", 5)),
        {{"v(1)", tank_voltage, {-4.9681086359698, 1.4185828336088, 0.3721711201347, -0.9037223546013, 0.7903228196444}},
         {"i(L1)", tank_current, {-0.03239795531004, 0.03324093982098, -0.02218731682670, 0.01053596540079, -0.00264785016009}}});
}

TEST_CASE("tank with a bridge and an empty filter capacitor: reference states", "[regression]") {
  const DeckRun run = run_text(deck(tank + diode_bridge + "CF 2 3 300n ic=0\n", "v(1) i(L1) v(2,3)", 4));
  check(run, {{"v(1)", tank_voltage, {-4.4372669652681, 2.4199574607127, -1.2160478547025, 0.5415247433440}},
              {"i(L1)", tank_current, {-0.01136058722904, 0.01322932853432, -0.01132335819945, 0.00841976872923}},
              {"v(2,3)", tank_voltage, {4.4372669652681, 2.4652637062205, 1.3667509751709, 0.7577316063256}}});
  CHECK(run.rows[0][1] == Approx(10.0 / 1.3).epsilon(start_bound));  // charge of 1 µF shared with 300 nF
  CHECK(run.rows[0][3] == Approx(10.0 / 1.3).epsilon(start_bound));
}

TEST_CASE("bridge with forward voltages on a cosine source: reference states", "[regression]") {
  const std::string cards =
      "V1 1 0 SIN(0 10 {1e4/(2*pi)} 0 0 90)\nD1 1 2 DF\nD2 3 1 DF\nD3 0 2 DF\nD4 3 0 DF\nR1 2 3 1k\nCF 2 3 300n ic=0\n";
  const DeckRun run = run_text(deck(cards, "v(2,3)", 5));
  check(run, {{"v(2,3)", 10.0, {8.333094849152, 6.879144084925, 5.678877319628, 6.249380616523, 9.229660284921}}});
  CHECK(run.rows[0][1] == Approx(10.0 - 2 * 0.21).epsilon(start_bound));
}
