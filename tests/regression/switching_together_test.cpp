/// Switches that pass at one instant change together, whatever is saved.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "regression/deck_run.hpp"
#include "regression/gate_decks.hpp"
#include "support/random.hpp"

namespace {

using namespace pwlsim;
using test::DeckRun;
using test::GateDeck;

std::size_t column_of(const DeckRun& run, const std::string& signal) {
  const auto at = std::find(run.signals.begin(), run.signals.end(), signal);
  REQUIRE(at != run.signals.end());
  return static_cast<std::size_t>(at - run.signals.begin()) + 1;
}

std::vector<double> values_of(const DeckRun& run, const std::string& signal) {
  std::vector<double> values;
  const std::size_t column = column_of(run, signal);
  for (const auto& row : run.rows) values.push_back(row[column]);
  return values;
}

bool has_remark(const DeckRun& run, const std::string& id) {
  return std::any_of(run.answer.remarks.begin(), run.answer.remarks.end(), [&](const engine::Remark& remark) { return remark.id == id; });
}

/// Inductor and capacitor of a synchronous buck converter, in extended precision. Between two edges x' = M x + b is followed by its Taylor series in
/// steps that are short against M.
struct Buck {
  long double input, inductance, capacitance, load, on_resistance;
  long double current = 0.0L, voltage = 0.0L;

  void advance(long double time, bool upper) {
    constexpr long double longest = 2e-6L;
    const int steps = std::max(1, static_cast<int>(std::ceil(time / longest)));
    const long double h = time / steps;
    for (int i = 0; i < steps; ++i) {
      long double di = 0.0L, dv = 0.0L, factor = 1.0L, i_sum = current, v_sum = voltage, i_term = current, v_term = voltage;
      for (int order = 1; order < 30; ++order) {
        di = (-on_resistance * i_term - v_term + (order == 1 && upper ? input : 0.0L)) / inductance;
        dv = (i_term - v_term / load) / capacitance;
        i_term = di;
        v_term = dv;
        factor *= h / order;
        i_sum += factor * i_term;
        v_sum += factor * v_term;
      }
      current = i_sum;
      voltage = v_sum;
    }
  }
};

/// Whatever is saved, the answer is the same to the last digit. `compare_engines`: the sparse engine's is the same to its tolerance.
void check_deck(std::uint64_t seed, bool compare_engines, bool to_last_digit) {
  const GateDeck deck = test::random_gate_deck(seed);
  INFO("seed " << seed << "\n" << deck.text);
  const DeckRun one = test::run_text(deck.with_save(deck.signal));
  REQUIRE(one.messages == "");
  REQUIRE(one.answer.outcome == engine::Outcome::completed);
  CHECK_FALSE(has_remark(one, "W-jump-loses-energy"));
  const std::vector<double> values = values_of(one, deck.signal);
  std::string gates;
  for (const auto& gate : deck.gates) gates += gate + " ";
  for (const std::string& saved : {std::string(), gates + deck.signal}) {
    INFO("saved: " << (saved.empty() ? "all" : saved));
    // What a difference of two nodes is among all that is saved, it is not by itself.
    if (saved.empty() && deck.signal.find(',') != std::string::npos) continue;
    const DeckRun other = test::run_text(deck.with_save(saved));
    REQUIRE(other.answer.outcome == engine::Outcome::completed);
    if (!to_last_digit || (deck.shares && saved.empty()))
      REQUIRE_THAT(values_of(other, deck.signal), Catch::Approx(values).epsilon(1e-11).margin(1e-11));
    else
      REQUIRE((values_of(other, deck.signal) == values));
    REQUIRE(other.answer.statistics.jumps == one.answer.statistics.jumps);
  }
  if (!compare_engines) return;
  constexpr double reltol = 1e-6;
  // Errors of some hundred events, each within the tolerance, and rows beside an edge that the other engine has on its other side.
  constexpr double expected = 3e-3;
  const DeckRun sparse = test::run_text_sparse(deck.with_save(deck.signal), reltol);
  REQUIRE(sparse.answer.outcome == engine::Outcome::completed);
  REQUIRE(sparse.rows.size() == one.rows.size());
  double largest = 0.0, worst = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    largest = std::max(largest, std::abs(values[i]));
    worst = std::max(worst, std::abs(values[i] - sparse.rows[i][1]));
  }
  CHECK(worst <= expected * largest);
}

std::string buck_deck(const std::string& on_resistance, const std::string& save) {
  return "sync buck\nVin in 0 12\nVh h 0 PULSE(0 1 0 10n 10n 4u 10u)\nVl l 0 PULSE(1 0 0 10n 10n 4u 10u)\nS1 in sw h 0 SX\n"
         "S2 sw 0 l 0 SX\nL1 sw out 10u ic=0\nC1 out 0 100u ic=0\nR1 out 0 1\n.model SX SW(Ron=" +
         on_resistance + " Vt=0.5)\n.tran 10u 1m uic\n" + save + ".end\n";
}

}  // namespace

// The gates are at half their swing 5 ns after an edge begins: the upper switch conducts from n·10 µs + 5 ns for 4.01 µs.
TEST_CASE("a synchronous buck converter with ramped gates is that of its formulas", "[regression]") {
  for (const std::string on_resistance : {"10m", "0"}) {
    Buck buck{12.0L, 10e-6L, 100e-6L, 1.0L, on_resistance == "0" ? 0.0L : 10e-3L};
    buck.advance(5e-9L, false);
    for (int n = 0; n < 99; ++n) {
      buck.advance(4.01e-6L, true);
      buck.advance(5.99e-6L, false);
    }
    buck.advance(4.01e-6L, true);
    buck.advance(5.985e-6L, false);
    if (on_resistance == "10m") CHECK(static_cast<double>(buck.voltage) == Approx(4.7402).epsilon(1e-5));  // ngspice
    for (const std::string save : {"", ".save v(out) i(L1)\n", ".save v(h) v(out) v(l) i(L1)\n"}) {
      INFO("Ron = " << on_resistance << ", " << save);
      const DeckRun run = test::run_text(buck_deck(on_resistance, save));
      REQUIRE(run.answer.outcome == engine::Outcome::completed);
      CHECK(run.answer.statistics.jumps == 0);
      constexpr double rounding = 1e-12;  // of a hundred periods
      CHECK(values_of(run, "v(out)").back() == Approx(static_cast<double>(buck.voltage)).epsilon(rounding));
      CHECK(values_of(run, "i(L1)").back() == Approx(static_cast<double>(buck.current)).epsilon(rounding));
    }
  }
}

// The same of other times, written in decimals: from Td + Tr/2 on, for Tr + Ton, every T.
TEST_CASE("synchronous buck converters with ramped gates are those of their formulas", "[regression]") {
  constexpr std::array<double, 4> periods{10e-6, 20e-6, 12.5e-6, 33.3e-6};
  constexpr std::array<double, 5> ramps{1e-9, 10e-9, 33.3e-9, 250e-9, 1e-6};
  constexpr int cycles = 40;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    test::Random random(seed);
    const double period = random.one_of(periods), ramp = random.one_of(ramps),
                 on = std::round(random.between(0.2, 0.7) * period * 1e9) * 1e-9;
    const double load = random.whole(3, 20) * 0.1, delay_part = random.whole(1, 2), resistance = random.whole(0, 3) * 5e-3;
    Buck buck{12.0L, 10e-6L, 100e-6L, load, resistance};
    const long double first = delay_part * 1e-6L / 3.0L + 0.5L * ramp, conducts = static_cast<long double>(ramp) + on;
    buck.advance(first, false);
    for (int n = 0; n < cycles; ++n) {
      buck.advance(conducts, true);
      buck.advance(n + 1 < cycles ? period - conducts : period - conducts - first, false);
    }
    const auto gate = [&](int from, int to) {
      return fmt::format("PULSE({} {} {{{}*1u/3}} {} {} {} {})", from, to, delay_part, ramp, ramp, on, period);
    };
    const std::string deck = fmt::format(
        "random sync buck\nVin in 0 12\nVh h 0 {}\nVl l 0 {}\nS1 in sw h 0 SX\nS2 sw 0 l 0 SX\nL1 sw out 10u ic=0\nC1 out 0 100u ic=0\n"
        "R1 out 0 {}\n.model SX SW(Ron={} Vt=0.5)\n.tran {} {{{}*{}}} uic\n",
        gate(0, 1), gate(1, 0), load, resistance, period, cycles, period);
    INFO("seed " << seed << "\n" << deck);
    const DeckRun run = test::run_text(deck);
    REQUIRE(run.answer.outcome == engine::Outcome::completed);
    CHECK(run.answer.statistics.jumps == 0);
    constexpr double rounding = 1e-11;  // of times of some 1e-4 s against edges 1e-9 s long, and of eighty segments
    CHECK(values_of(run, "v(out)").back() == Approx(static_cast<double>(buck.voltage)).epsilon(rounding));
    CHECK(values_of(run, "i(L1)").back() == Approx(static_cast<double>(buck.current)).epsilon(rounding).margin(rounding * 12.0));
  }
}

// Each control reads a source of its own, in a part of its own: both pass 0.5 where sin = 0.5, one upwards and one downwards, at times that differ by
// rounding. No instant is without a path for the current of L1, which so never jumps.
TEST_CASE("guards of different parts that pass at one instant flip together", "[regression]") {
  const std::string deck = R"(two sinusoids
Va a 0 SIN(0 1 {1/7u} {1u/3})
Vb b 0 SIN(1 -1 {1/7u} {1u/3})
Ca ca 0 1n
Ra ca a 1m
Vin in 0 12
S1 in sw a 0 SX
S2 sw 0 b 0 SX
L1 sw out 10u ic=0
R1 out 0 1
.model SX SW(Ron=10m Vt=0.5)
.tran 1u 1m uic
)";
  for (const std::string save : {".save i(L1)\n", ".save i(L1) v(a)\n", "", ".save i(L1) v(b) v(ca)\n"}) {
    INFO(save);
    const DeckRun run = test::run_text(deck + save);
    REQUIRE(run.answer.outcome == engine::Outcome::completed);
    CHECK(run.answer.statistics.jumps == 0);
    CHECK(values_of(run, "i(L1)") == values_of(test::run_text(deck + ".save i(L1)\n"), "i(L1)"));
  }
}

// Comparisons of states: two copies of one RC circuit, and the switches that they drive.
TEST_CASE("guards that read states and pass at one instant flip together", "[regression]") {
  const std::string deck = R"(two filters
Va a 0 PULSE(0 1 {1u/3} 10n 10n 4u 10u)
Vb b 0 PULSE(1 0 {1u/3} 10n 10n 4u 10u)
Ra a x 1k
Ca x 0 0.3n
Rb b y 1.7k
Cb y 0 {0.3n/1.7}
Vin in 0 12
S1 in sw x 0 SX
S2 sw 0 y 0 SX
L1 sw out 10u ic=0
R1 out 0 1
.model SX SW(Ron=10m Vt=0.5)
.tran 1u 1m
)";
  const DeckRun run = test::run_text(deck + ".save i(L1)\n");
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  CHECK(run.answer.statistics.jumps == 0);
}

namespace {

/// Where a sinusoid of 0.5 + 0.4·sin is above a triangle of 0 to 1, in extended precision; and the current of 10 µH and 1.01 Ω at 12 V then, at 0 V else.
long double compared_current(long double stop) {
  constexpr long double triangle = 7.3e-6L, delay = 1e-6L / 3.0L, tau = 10e-6L / 1.01L;
  const auto above = [&](long double t) {
    const long double phase = t < delay ? 0.0L : std::fmod(t - delay, triangle) / (0.5L * triangle);
    return 0.5L + 0.4L * std::sin(2.0L * std::numbers::pi_v<long double> * t / (10.0L * triangle)) > (phase < 1.0L ? phase : 2.0L - phase);
  };
  long double current = 0.0L, time = 0.0L;
  const auto go_on = [&](long double to, bool on) {
    const long double end = on ? 12.0L / 1.01L : 0.0L;
    current = end + (current - end) * std::exp(-(to - time) / tau);
    time = to;
  };
  bool on = above(0.0L);
  for (int half = 0; time < stop; ++half) {  // one crossing in each half of a triangle
    long double low = delay + 0.5L * triangle * half, high = low + 0.5L * triangle;
    for (int i = 0; i < 80; ++i) (above(0.5L * (low + high)) == on ? low : high) = 0.5L * (low + high);
    go_on(std::min(low, stop), on);
    on = !on;
  }
  return current;
}

std::string compared_deck(const std::string& drives) {
  return "compared\nVr r 0 SIN(0.5 0.4 {1/73u})\nVt t 0 PULSE(0 1 {1u/3} {7.3u/2} {7.3u/2} 0 7.3u)\n" + drives +
         "Vin in 0 12\nL1 sw out 10u ic=0\nR1 out 0 1\n.model SX SW(Ron=10m Vt=0.5)\n.model SZ SW(Ron=10m)\n.tran 10u 1m uic\n";
}

}  // namespace

// One comparison with one sinusoid and triangle, the other with copies of them of another size, which round otherwise.
TEST_CASE("comparisons in parts of their own change together", "[regression]") {
  const double expected = static_cast<double>(compared_current(1e-3L));
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const double k = test::Random(seed).between(0.1, 30.0);
    const std::string deck = compared_deck(
        fmt::format("Vr2 r2 0 SIN({{0.5*{0}}} {{0.4*{0}}} {{1/73u}})\nVt2 t2 0 PULSE(0 {0} {{1u/3}} {{7.3u/2}} {{7.3u/2}} 0 7.3u)\n"
                    "B1 h 0 V={{if(v(r)>v(t),1,0)}}\nB2 l 0 V={{if(v(t2)>v(r2),1,0)}}\nS1 in sw h 0 SX\nS2 sw 0 l 0 SX\n",
                    k));
    for (const std::string save : {".save i(L1)\n", ".save i(L1) v(l) v(r2)\n", ""}) {
      INFO("k = " << k << " " << save);
      const DeckRun run = test::run_text(deck + save);
      REQUIRE(run.answer.outcome == engine::Outcome::completed);
      CHECK(run.answer.statistics.jumps == 0);
      CHECK(values_of(run, "i(L1)").back() == Approx(expected).epsilon(1e-9));  // of crossings whose slopes nearly agree
    }
  }
}

// S1 follows the comparison at once, S2 an inverter: a switch and a resistor. The half bridge has its turn when the inverter has settled.
TEST_CASE("what steers a part settles before it", "[regression]") {
  const std::string deck = compared_deck("Vp p 0 1\nRp p q 1k\nSq q 0 r t SZ\nS1 in sw r t SZ\nS2 sw 0 q 0 SX\n");
  for (const std::string save : {".save i(L1)\n", ""}) {
    const DeckRun run = test::run_text(deck + save);
    REQUIRE(run.answer.outcome == engine::Outcome::completed);
    CHECK(run.answer.statistics.jumps == 0);
    CHECK(values_of(run, "i(L1)").back() == Approx(static_cast<double>(compared_current(1e-3L))).epsilon(1e-9));
  }
}

// S1 opens on 10 A that nothing else carries: ½·1 mH·(10 A)² = 50 mJ, once a period.
TEST_CASE("a switch that breaks a current is told", "[regression]") {
  const std::string deck = R"(broken current
V1 a 0 10
Vg g 0 PULSE(1 0 1m 0 0 1m 2m)
S1 a b g 0 SX
L1 b c 1m ic=10
R1 c 0 1
.model SX SW(Ron=0 Vt=0.5)
.tran 0.1m 6.5m uic
)";
  for (const std::string save : {"", ".save i(L1)\n"}) {
    const DeckRun run = test::run_text(deck + save);
    REQUIRE(run.answer.outcome == engine::Outcome::completed);
    REQUIRE(has_remark(run, "W-jump-loses-energy"));
    for (const auto& remark : run.answer.remarks) {
      if (remark.id != "W-jump-loses-energy") continue;
      CHECK(remark.text.find("at t = 0.001 s S1 breaks") != std::string::npos);
      CHECK(remark.text.find("i(L1) from 10 A to 0 A): 0.05 J of the 0.05 J") != std::string::npos);
      CHECK(remark.text.find("2 more instants") != std::string::npos);
    }
  }
  const DeckRun clamped = test::run_text(deck + "D1 0 b DX\n.model DX D(Ron=0)\n");
  CHECK_FALSE(has_remark(clamped, "W-jump-loses-energy"));
}

TEST_CASE("what is saved does not change what switches do", "[regression]") {
  for (std::uint64_t seed = 1; seed <= 150; ++seed) check_deck(seed, seed % 3 == 0, true);
}

// A full bridge whose transformer has K = 0.98, and one without resistance whose lower gates are the upper ones' complements by controlled sources, were E-no-solution
// on the sparse engine.
TEST_CASE("what is saved does not change what the switches of these bridges do", "[regression]") {
  for (const std::uint64_t seed : {1880, 4600}) check_deck(seed, true, false);
}

// Where the corner of a saved gate meets the flip of another switch (seed 3570) the instant has another last digit.
TEST_CASE("what is saved does not change what switches do in 5000 decks", "[long]") {
  for (std::uint64_t seed = 1001; seed <= 6000; ++seed) check_deck(seed, seed % 10 == 0, false);
}

// S1 opens with Q, S2 closes behind a chain of gates, and the comparator reads the current of the inductor that both carry. By hand: while S1 conducts, from i = 0 and with 12 V across 10 µH, the
// latch is reset at 6 A; with S2 then closed at once the current goes on from there.
TEST_CASE("switches behind chains of gates of any length change together", "[regression]") {
  const std::string head =
      "peak current\nVin in 0 12\nS1 in sw q 0 SX\nS2 sw 0 nq 0 SX\nL1 sw out 10u\nC1 out 0 100u\nR1 out 0 1\nBs sense 0 V=i(L1)\nVref ref "
      "0 6\n"
      "Bc cmp 0 V=u(v(sense)-v(ref))\nVclk ck 0 PULSE(0 1 0 1n 1n 100n 10u)\nA1 ck cmp 0 0 0 0 q 0 SRFLOP\n.model SX SW(Ron=10m "
      "Vt=0.5)\n.save i(L1) v(out)\n";
  const std::string tail = ".tran 0.1u 200u uic\n.end\n";
  const std::string one_gate = head + "A2 q 0 0 0 0 nq 0 0 INV\n" + tail;
  const std::string three_gates = head + "A2 q 0 0 0 0 n1 0 0 INV\nA3 n1 0 0 0 0 0 n2 0 BUF\nA4 n2 0 0 0 0 0 nq 0 BUF\n" + tail;
  const DeckRun one = test::run_text(one_gate), three = test::run_text(three_gates);
  REQUIRE(one.answer.outcome == engine::Outcome::completed);
  REQUIRE(three.answer.outcome == engine::Outcome::completed);
  CHECK(three.answer.statistics.jumps == 0);
  CHECK((values_of(three, "i(L1)") == values_of(one, "i(L1)")));
  CHECK((values_of(three, "v(out)") == values_of(one, "v(out)")));
  // The upper switch alone decides when the latch is reset: the inductor's current never exceeds the reference, and it falls with v(out)/L, not at once.
  const std::vector<double> current = values_of(three, "i(L1)");
  CHECK(*std::max_element(current.begin(), current.end()) <= 6.0 + 1e-9);
  const std::vector<double> voltage = values_of(three, "v(out)");
  for (std::size_t i = 1; i < current.size(); ++i) {
    const double most = (std::max(voltage[i], voltage[i - 1]) + 0.1) * 0.1e-6 / 10e-6;  // 0.1 V: across the switch
    REQUIRE(current[i - 1] - current[i] <= most);
  }
}

// The reset of a latch counts while it is there, and set and reset fall at one instant: the set by a gate that its own source drives.
TEST_CASE("gates settle before latches", "[regression]") {
  const std::string deck =
      "set behind a gate\nVs s 0 PULSE(1 0 5u 1n 1n 1 2)\nVr r 0 PULSE(1 0 5u 1n 1n 1 2)\nA1 s 0 0 0 0 0 g 0 BUF\nA2 g r 0 0 0 0 q 0 "
      "SRFLOP\n"
      "R1 q 0 1k\n.save v(q)\n.tran 1u 10u\n.end\n";
  const DeckRun run = test::run_text(deck);
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  for (const double q : values_of(run, "v(q)")) CHECK(std::abs(q) < 1e-9);
}

// Without resistance in the switches a position in which both are closed has no solution, and the comparator reads what they drive. By hand: q turns on where v(t) = 1, and off where
// v(t) + 1.2 = 1, so that it is high from asin(1/5) to π + asin(0.2/5) of each period of the sine.
TEST_CASE("a position that waits for gates need not have a solution", "[regression]") {
  const DeckRun run = test::run_text(
      "sensed load\nVin in 0 12\nVt t 0 SIN(0 5 10k)\nS1 in sw q 0 SX\nS2 sw 0 nq 0 SX\nR1 sw 0 10\nBc cmp 0 V=u(v(t)+0.1*v(sw)-1)\nA1 cmp "
      "0 0 0 0 0 q 0 BUF\n"
      "A2 q 0 0 0 0 n1 0 0 INV\nA3 n1 0 0 0 0 0 n2 0 BUF\nA4 n2 0 0 0 0 0 nq 0 BUF\n.model SX SW(Ron=0 Vt=0.5)\n.save v(sw)\n.tran 1u 200u "
      "uic\n.end\n");
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  for (const auto& row : run.rows) {
    INFO("t = " << row[0]);
    constexpr double pi = 3.14159265358979324;
    const double phase = std::fmod(2.0 * pi * 1e4 * row[0], 2.0 * pi);
    const bool is_high = phase > std::asin(0.2) && phase < pi + std::asin(0.04);
    REQUIRE(row[1] == Approx(is_high ? 12.0 : 0.0).margin(1e-9));
  }
}

// By hand: the clock is still high when the comparator trips, so that the latch is set again at the current that resets it; a contact that cuts its own coil is between its
// two thresholds in neither position; and a valve is told to close and to open by what it carries. In each deck these elements have no position, and no others change.
TEST_CASE("each engine names the elements that keep toggling, and no others", "[regression]") {
  using Names = std::vector<std::string>;
  const auto [deck, expected] = GENERATE(table<std::string, Names>(
      {{"peak current\nV1 in 0 48\nS1 in sw q 0 SX\nD1 0 sw DX\nL1 sw out 10u\nC1 out 0 100u\nR1 out 0 0.5\nVr ref 0 12\nB1 sense 0 "
        "V=i(L1)\nB2 cmp 0 V=u(v(sense)-v(ref))\nVc ck 0 PULSE(0 1 1u 1n 1n 0.2u 10u)\nA1 ck cmp 0 0 0 0 q 0 SRFLOP\n.model SX SW(Ron=10m "
        "Vt=0.5)\n.model DX D(Ron=10m)\n.tran 1u 1m uic\n",
        {"A1.Sb2", "A1.Sy", "B2", "S1"}},
       {"relay\nV1 p 0 PULSE(0 2 1m 1u 1u 5 10)\nR1 p c 1k\nS1 c 0 c 0 SI\nR2 p d 1k\nS2 d 0 p 0 SI\n.model SI SW(Vt=0.5 Vh=0.2)\n.tran 1m "
        "20m "
        "uic\n",
        {"S1"}},
       {"gates\nV1 p 0 PULSE(0 1 1m 1u 1u 5 10)\nA1 q3 0 0 0 p 0 q1 0 AND\nA2 q1 0 0 0 0 q2 0 0 BUF\nA3 q2 0 0 0 0 0 q3 0 BUF\nR1 q3 0 "
        "1k\nA4 p 0 0 0 0 0 o 0 BUF\nR2 o 0 1k\n.tran 1m 20m uic\n",
        {"A1.Sb1", "A1.Sy", "A2.Sy", "A3.Sy"}},
       {"thyristor\nV1 p 0 PULSE(0 10 1m 1u 1u 5 10)\nR1 p a 1k\nD1 a k g T\nRk k 0 1\nBg g k V=if(i(Rk)>1m,0,1)\n.model T SCR(Vgt=0.5 "
        "Ih=20m)\n.tran 1m 20m uic\n",
        {"D1 (gate)"}}}));
  for (const DeckRun& run : {test::run_text(deck), test::run_text_segments(deck), test::run_text_sparse(deck, 1e-4)}) {
    INFO(deck << run.messages << run.answer.message);
    CHECK(run.answer.id == "E-no-settle");
    Names names = run.answer.elements;
    std::sort(names.begin(), names.end());
    CHECK(names == expected);
  }
}
