// Twins run in ngspice against closed forms. Bounds: the smoothing at X = 1e-4 and ngspice's reltol of 1e-5 leave 1e-3 of the largest value.

#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <set>

#include "spice/smooth.hpp"
#include "support/scratch.hpp"

using namespace pwlsim;
using namespace pwlsim::test;
using std::numbers::pi;

namespace {

constexpr double bound = 1e-3;

struct Case {
  const char* name;
  const char* cards;
  double time, expected, scale;
};

const Case cases[] = {
    {"RC charging: 1 - exp(-t)", "V1 a 0 1\nR1 a b 1\nC1 b 0 1 ic=0\n.save v(b)\n.tran 1m 1 uic\n", 1.0, 1.0 - std::exp(-1.0), 1.0},
    {"RL current: 1 - exp(-t)", "V1 a 0 1\nR1 a b 1\nL1 b 0 1 ic=0\n.save i(L1)\n.tran 1m 1 uic\n", 1.0, 1.0 - std::exp(-1.0), 1.0},
    {"coupled coils with k = 1 transform 1:2",
     "V1 a 0 SIN(0 1 1)\nR1 a c 1m\nL1 c 0 1\nL2 b 0 4\nK1 L1 L2 1\nR2 b 0 1k\n.save v(b)\n.tran 1m 1\n", 0.25, 2.0, 2.0},
    {"half wave of a diode", "V1 a 0 SIN(0 1 1)\nD1 a b D\nR1 b 0 1\n.model D D\n.save i(D1)\n.tran 1m 1\n", 0.25, 1.0, 1.0},
    {"the other half", "V1 a 0 SIN(0 1 1)\nD1 a b D\nR1 b 0 1\n.model D D\n.save i(D1)\n.tran 1m 1\n", 0.75, 0.0, 1.0},
    {"forward drop", "V1 a 0 2\nD1 a b D\nR1 b 0 1\n.model D D(Vfwd=0.7)\n.save v(b)\n.tran 1m 1\n", 0.5, 1.3, 2.0},
    {"breakdown", "V1 a 0 -5\nD1 a b D\nR1 b 0 1\n.model D D(Vrev=3)\n.save v(b)\n.tran 1m 1\n", 0.5, -2.0, 5.0},
    {"switch on", "V1 a 0 1\nVC c 0 PULSE(0 1 0.2 0 0 0.4 1)\nS1 a b c 0 M\nR1 b 0 1\n.model M SW(Vt=0.5)\n.save v(b)\n.tran 1m 1\n", 0.3,
     1.0, 1.0},
    {"switch off", "V1 a 0 1\nVC c 0 PULSE(0 1 0.2 0 0 0.4 1)\nS1 a b c 0 M\nR1 b 0 1\n.model M SW(Vt=0.5)\n.save v(b)\n.tran 1m 1\n", 0.7,
     0.0, 1.0},
    {"current switch",
     "I1 0 c PULSE(0 1 0.2 0 0 0.4 1)\nR0 c 0 1\nV1 a 0 1\nW1 a b R0 M\nR1 b 0 1\n.model M CSW(It=0.5)\n.save v(b)\n.tran 1m 1\n", 0.3, 1.0,
     1.0},
    {"F, G and H of 2 times", "V1 a 0 1\nR1 a 0 1\nF1 0 b R1 2\nRb b 0 1\nG1 0 c b 0 2\nRc c 0 1\nH1 d 0 Rc 2\n.save v(d)\n.tran 1m 1\n",
     0.5, 8.0, 8.0},
    {"limit", "V1 a 0 SIN(0 3 1)\nA1 a b m\nR1 b 0 1\n.model m limit(out_lower_limit=-1 out_upper_limit=2)\n.save v(b)\n.tran 1m 1\n", 0.25,
     2.0, 3.0},
    {"gain and summer",
     "V1 a 0 1\nV2 b 0 2\nA1 [a b] c m\nA2 c d g\nR1 d 0 1\n.model m summer(in_gain=[3 4] out_offset=1)\n.model g gain(gain=2)\n.save "
     "v(d)\n.tran 1m 1\n",
     0.5, 24.0, 24.0},
    {"int of a sine", "V1 a 0 SIN(0 1 1)\nA1 a b m\nR1 b 0 1\n.model m int(gain=2 out_ic=0)\n.save v(b)\n.tran 1m 1\n", 0.5, 2.0 / pi, 1.0},
    {"int with a stop", "V1 a 0 1\nA1 a b m\nR1 b 0 1\n.model m int(out_upper_limit=0.5)\n.save v(b)\n.tran 1m 1\n", 0.9, 0.5, 1.0},
    {"d_dt of a sine", "V1 a 0 SIN(0 1 1)\nA1 a b m\nR1 b 0 1\n.model m d_dt\n.save v(b)\n.tran 1m 1\n", 0.5, -2.0 * pi, 2.0 * pi},
    {"s_xfer 1/(s+1)", "V1 a 0 PULSE(0 1)\nA1 a b m\nR1 b 0 1\n.model m s_xfer(num_coeff=[1] den_coeff=[1 1])\n.save v(b)\n.tran 1m 1\n",
     1.0, 1.0 - std::exp(-1.0), 1.0},
    {"s_xfer of second order, s/(s^2+1)",
     "V1 a 0 PULSE(0 1)\nA1 a b m\nR1 b 0 1\n.model m s_xfer(num_coeff=[1 0] den_coeff=[1 0 1])\n.save v(b)\n.tran 1m 2\n", pi / 2.0, 1.0,
     1.0},
    {"pwl", "V1 a 0 SIN(0 2 1)\nA1 a b m\nR1 b 0 1\n.model m pwl(x_array=[-1 0 1] y_array=[0 0 3])\n.save v(b)\n.tran 1m 1\n", 0.25, 6.0,
     6.0},
    {"hyst, up", "V1 a 0 SIN(0 1 1)\nA1 a b m\nR1 b 0 1\n.model m hyst(in_low=0 in_high=0 hyst=0.5)\n.save v(b)\n.tran 1m 1\n", 0.5, 1.0,
     1.0},
    {"hyst, down", "V1 a 0 SIN(0 1 1)\nA1 a b m\nR1 b 0 1\n.model m hyst(in_low=0 in_high=0 hyst=0.5)\n.save v(b)\n.tran 1m 1\n", 0.95, 0.0,
     1.0},
    {"relay that slides at 0", "C1 x 0 1 ic=0.5\nA1 x %i x m\n.model m relay\n.save v(x)\n.tran 1m 1 uic\n", 0.9, 0.0, 1.0},
    {"dead zone", "V1 a 0 0.5\nA1 a b m\nR1 b 0 1\n.model m deadzone(d=1)\n.save v(b)\n.tran 1m 1\n", 0.5, 0.0, 1.0},
    {"friction slows a mass, 2 - t", "C1 v 0 1 ic=2\nA1 v %i v m\n.model m friction\n.save v(v)\n.tran 1m 1 uic\n", 0.5, 1.5, 2.0},
    {"three cycles of a sine and no more", "V1 a 0 SIN(1 2 10 0 0 0 3)\nR1 a 0 1\n.save v(a)\n.tran 1m 1\n", 0.525, 1.0, 3.0},
    {"two pulses and no more", "V1 a 0 PULSE(0 1 0 0 0 0.1 0.2 2)\nR1 a 0 1\n.save v(a)\n.tran 1m 1\n", 0.45, 0.0, 1.0},
    {"a polyline that repeats", "V1 a 0 PWL REPEAT FOREVER (0 0 0.1 1 0.2 0) ENDREPEAT\nR1 a 0 1\n.save v(a)\n.tran 1m 1\n", 0.65, 0.5,
     1.0},
    {"sin of time", "B1 a 0 V={sin(2*pi*time)*exp(-time)}\nR1 a 0 1\n.save v(a)\n.tran 1m 1\n", 0.25, std::exp(-0.25), 1.0},
    {"an operating point with a forced voltage", "R1 a 0 1\nC1 a 0 1\n.ic V(a)=3\n.save v(a)\n.tran 1m 1\n", 1.0, 3.0 * std::exp(-1.0),
     3.0},
};

std::vector<std::filesystem::path> netlists() {
  std::vector<std::filesystem::path> list;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(std::filesystem::path(PWLSIM_SOURCE_DIR) / "netlists"))
    if (entry.path().extension() == ".net") list.push_back(entry.path());
  std::sort(list.begin(), list.end());
  return list;
}

CompiledDeck load(const std::filesystem::path& path) {
  CompiledDeck result;
  const netlist::Loaded loaded = netlist::load(path.string(), result.sources, result.diagnostics);
  result.compiled = circuit::compile(loaded.deck, result.sources, result.diagnostics, {.analysis_required = true, .keep_circuit = true});
  return result;
}

/// 100 of its 100,000 cycles: ngspice needs half a minute and gigabytes for all.
void shorten(const std::string& name, circuit::FlatCircuit& circuit) {
  if (name == "tank_clamp") circuit.analyses.transient->stop.seconds *= 1e-3;
}

}  // namespace

TEST_CASE("each twin follows its closed form in ngspice", "[unit]") {
  if (!has_ngspice()) return;
  const Case& c = GENERATE(from_range(std::begin(cases), std::end(cases)));
  INFO(c.name);
  CHECK(std::abs(smooth_value(c.cards, 0, c.time) - c.expected) <= bound * c.scale);
}

TEST_CASE("a raw system: a bouncing slack, x' = -1 + u, y = x", "[unit]") {
  if (!has_ngspice()) return;
  const Scratch scratch;
  scratch.write("s.lcs", "A\n0\nB\n1\nC\n1\nx0\n0.5\nE\n1\nw\nDC -1\n");
  const std::string card = ".lcs s \"" + scratch / "s.lcs" + "\"\n.tran 1m 1\n";
  CHECK(std::abs(smooth_value(card, 0, 0.25) - 0.25) <= bound);  // x = 0.5 - t until it reaches 0
  CHECK(std::abs(smooth_value(card, 0, 0.75)) <= bound);
  CHECK(std::abs(smooth_value(card, 1, 0.75) - 1.0) <= bound);   // u holds it there
  CHECK(std::abs(smooth_value(card, 2, 0.25) - 0.25) <= bound);  // y = x
}

TEST_CASE("every transient deck of netlists/ runs in ngspice to its end", "[unit]") {
  if (!has_ngspice()) return;
  const auto path = GENERATE(from_range(netlists()));
  INFO(path);
  CompiledDeck deck = load(path);
  REQUIRE(deck.compiled);
  if (!deck.compiled->circuit->analyses.transient) return;  // steady states
  shorten(path.stem().string(), *deck.compiled->circuit);
  const spice::SmoothDeck written = smooth(deck);
  const waveform::RawFile raw = run_smooth(written);
  const double stop = deck.compiled->circuit->analyses.transient->stop.seconds;
  REQUIRE(raw.rows() != 0);
  CHECK(raw.at(raw.rows() - 1, 0) >= stop * (1.0 - 1e-9));
  for (const spice::SignalVectors& signal : written.signals) CHECK(spice::SignalReader(raw, signal).known());
}

TEST_CASE("a deck that ngspice cannot run gives its words", "[unit]") {
  if (!has_ngspice()) return;
  const auto run = spice::run_ngspice(*spice::find_ngspice(), "* no such model\nD1 a 0 missing\nV1 a 0 1\n.tran 1m 1\n.end\n");
  CHECK_THAT(run.words, Catch::Matchers::Contains("missing", Catch::CaseSensitive::No));
  CHECK((!run.raw || run.raw->rows() == 0));
}

TEST_CASE("a run that takes too long is stopped and says so", "[unit]") {
  if (!has_ngspice()) return;
  const auto run =
      spice::run_ngspice(*spice::find_ngspice(), "* long\nV1 a 0 SIN(0 1 1Meg)\nR1 a 0 1\n.tran 1n 10 0 1n\n.end\n", {0.2, nullptr});
  CHECK_FALSE(run.ended);
  CHECK(run.words == "stopped: it took too long");
}
