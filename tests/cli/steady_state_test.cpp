// .pss: orbits, multipliers and messages as a user sees them, against closed forms.

#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <sstream>

#include "cli/json_result.hpp"
#include "cli/run_in.hpp"
#include "support/json.hpp"

using namespace pwlsim::test;
using Catch::Matchers::Contains;

namespace {

Json steady_state_of(const Scratch& scratch, const std::string& deck, int status = 0) {
  scratch.write("deck.net", deck);
  const Finished finished = run_in(scratch, {"deck.net", "--json"});
  REQUIRE(finished.status == status);
  return read_json(finished.out);
}

double state(const Json& pss, const std::string& name) {
  for (const Json& s : pss["states"].array)
    if (s["name"].string == name) return s["value"].number;
  FAIL("no state " << name);
  return 0.0;
}

// Deane & Hamill's buck: 24.51657282856338 V is where its period doubles (shared contract of the project, 60 digits; 24.516 in Fossas & Olivar 1996).
std::string deane_hamill(const std::string& vin, const std::string& card) {
  return "buck under voltage-mode control\nVin in 0 " + vin +
         "\nVr r 0 PULSE(3.8 8.2 0 400u 0 0 400u)\nBc c 0 V=8.4*(v(out)-11.3)\nS1 in sw r c SX\nD1 0 sw DX\n"
         "L1 sw out 20m\nC1 out 0 47u\nR1 out 0 22\n.model SX SW(Ron=0 Vt=0)\n.model DX D\n" +
         card + "\n.end\n";
}

}  // namespace

TEST_CASE("where .ic contradicts the circuit there is no start for an orbit", "[unit]") {
  const Scratch scratch;
  scratch.write("s.net", "t\nV1 a 0 SIN(0 1 1k)\nR1 a b 1k\nC1 b 0 1u\nV2 b 0 2\n.ic v(b)=3\n.pss\n.end\n");
  const Finished finished = run_in(scratch, {"s.net"});
  CHECK(finished.status == 1);
  CHECK_THAT(finished.err, Catch::Matchers::Contains("error[E-ic-contradiction]: on the way to the orbit, .ic forces voltages"));
}

TEST_CASE("an RC circuit under a square wave: orbit and multiplier are exponentials", "[unit]") {
  // From v₀ towards 1 V for T/2, then towards 0: v₀ = (1 − a)a/(1 − a²), a = e^{−T/2RC}; the multiplier is a².
  const Scratch scratch;
  const Json result =
      steady_state_of(scratch,
                      "rc\nV1 a 0 PULSE(0 1 0 0 0 0.5m 1m)\nR1 a b 1k\nC1 b 0 1u\n.pss\n"
                      ".meas pss mean AVG v(b)\n.meas pss t PERIOD\n.meas pss three INTEG v(b) FROM=0.25m TO=3.25m\n.end\n");
  const Json& pss = result["pss"];
  const double a = std::exp(-0.5);
  CHECK(pss["kind"].string == "driven");
  CHECK(pss["period"].number == 1e-3);
  CHECK(pss["stability"].string == "stable");
  CHECK(pss["unique"].truth == true);
  CHECK(state(pss, "v(C1)") == Approx((1.0 - a) * a / (1.0 - a * a)).epsilon(1e-13));
  REQUIRE(pss["multipliers"].array.size() == 1);
  CHECK(pss["multipliers"][0]["re"].number == Approx(a * a).epsilon(1e-13));
  CHECK(pss["condition"].number == Approx(1.0 / (1.0 - a * a)).epsilon(1e-13));
  CHECK(measured(result, "mean") == Approx(0.5).epsilon(1e-13));
  CHECK(measured(result, "t") == 1e-3);
  CHECK(measured(result, "three") == Approx(1.5e-3).epsilon(1e-13));  // three whole periods
}

TEST_CASE("Deane and Hamill's buck has the multiplier -1 where its period doubles", "[unit]") {
  const Scratch scratch;
  const Json edge = steady_state_of(scratch, deane_hamill("24.51657282856338", ".pss uic"));
  const Json& multipliers = edge["pss"]["multipliers"];
  REQUIRE(multipliers.array.size() == 2);
  CHECK(multipliers[0]["re"].number == Approx(-1.0).epsilon(1e-11));
  CHECK(edge["pss"]["stability"].string == "marginal");
  // Liouville: the product of both is e^{−T/RC}, whatever the switch does; |λ| = e^{−T/2RC} where they are a pair.
  const double product = multipliers[0]["re"].number * multipliers[1]["re"].number;
  CHECK(product == Approx(std::exp(-400e-6 / (22.0 * 47e-6))).epsilon(1e-11));
  const Json below = steady_state_of(scratch, deane_hamill("20", ".pss uic"));
  CHECK(below["pss"]["stability"].string == "stable");
  // The ramp falls back below the control voltage at t = 0, and rises above it once a period.
  const std::vector<Json>& modes = below["pss"]["modes"].array;
  REQUIRE(modes.size() == 2);
  CHECK_THAT(modes[0]["event"].string, Contains("S1 opens"));
  CHECK_THAT(modes[1]["event"].string, Contains("S1 closes"));
  CHECK(below["pss"]["multipliers"][0]["abs"].number == Approx(std::exp(-200e-6 / (22.0 * 47e-6))).epsilon(1e-11));
}

TEST_CASE("an unstable orbit is found, called unstable, and ends with status 0; k=2 finds the doubled one", "[unit]") {
  const Scratch scratch;
  scratch.write("unstable.net", deane_hamill("25", ".pss uic"));
  const Finished finished = run_in(scratch, {"unstable.net"});
  CHECK(finished.status == 0);
  CHECK_THAT(finished.err, Contains("warning[W-pss-unstable]") && Contains("the period doubles") && Contains("k=2"));
  const Json doubled = steady_state_of(scratch, deane_hamill("25", ".pss uic k=2"));
  CHECK(doubled["pss"]["stability"].string == "stable");
  CHECK(doubled["pss"]["period"].number == 8e-4);
}

TEST_CASE("a self-timed circuit gives its period: the 555", "[unit]") {
  // ln 2·(R1 + 2 R2)·C
  const Scratch scratch;
  const std::string timer = "timer\nVcc vcc 0 9\nR1 vcc d 1k\nR2 d c 10k\nC1 c 0 100n\nS1 d 0 c 0 SX\n.model SX SW(Vt=4.5 Vh=1.5 Ron=0)\n";
  for (const char* card : {".pss", ".pss on=S1", ".pss off=S1", ".pss when v(c)=4 rise", ".pss 700 0 c 1000 10",
                           ".pop trig_gate=S1 trig_cond=0_to_1 max_period=2m"}) {
    INFO(card);
    const Json result = steady_state_of(scratch, timer + card + "\n.meas pss t PERIOD\n.end\n");
    CHECK(result["pss"]["kind"].string == "autonomous");
    CHECK(result["pss"]["period"].number == Approx(std::log(2.0) * 21e3 * 100e-9).epsilon(1e-12));
    CHECK(measured(result, "t") == result["pss"]["period"].number);
  }
}

TEST_CASE("a trigger that never comes is told, also where other events go on for ever", "[unit]") {
  const Scratch scratch;
  scratch.write("never.net",
                "timer\nVcc vcc 0 9\nR1 vcc d 1k\nR2 d c 10k\nC1 c 0 100n\nS1 d 0 c 0 SX\nS2 x 0 c 0 SY\nR3 x 0 1\n"
                ".model SX SW(Vt=4.5 Vh=1.5 Ron=0)\n.model SY SW(Vt=30 Vh=1)\n.pss on=S2\n.end\n");
  const Finished finished = run_in(scratch, {"never.net"});
  CHECK(finished.status == 1);
  CHECK_THAT(finished.err, Contains("error[E-pss-no-trigger]") && Contains("on=S2"));
}

TEST_CASE("a relay around an RLC circuit: the second half of the orbit is minus the first", "[unit]") {
  // x = (i, v): x(h) = x_s + e^{Ah}(x₀ − x_s) with x_s = (0, −1 V) right of the closing of S1; by symmetry x(h) = −x₀, the period is 2h, and v(0) = 0.1 V.
  // e^{Ah} = e^{−σh}(cos ωh·I + sin ωh/ω·(A + σI)), σ = R/2L, ω² = 1/LC − σ².
  const Scratch scratch;
  const Json result =
      steady_state_of(scratch,
                      "relay\nVp p 0 1\nS1 p q c 0 SX\nRq q 0 1k\nB1 a 0 V=1-2*V(q)\nR1 a b 10\nL1 b c 1m\nC1 c 0 10u ic=0.2\n"
                      ".model SX SW(Vt=0 Vh=0.1 Ron=0)\n.pss on=S1 uic\n.end\n");
  const Json& pss = result["pss"];
  const double l = 1e-3, c = 10e-6, sigma = 10.0 / (2.0 * l), omega = std::sqrt(1.0 / (l * c) - sigma * sigma);
  const double h = 0.5 * pss["period"].number, i0 = state(pss, "i(L1)"), v0 = state(pss, "v(C1)");
  CHECK(v0 == Approx(0.1).epsilon(1e-12));
  const double decay = std::exp(-sigma * h), cosine = decay * std::cos(omega * h), sine = decay * std::sin(omega * h) / omega;
  const double di = i0, dv = v0 + 1.0;  // x₀ − x_s
  const double i1 = cosine * di + sine * (-sigma * di - dv / l), v1 = -1.0 + cosine * dv + sine * (di / c + sigma * dv);
  CHECK(i1 == Approx(-i0).epsilon(1e-11));
  CHECK(v1 == Approx(-v0).epsilon(1e-10));
  // The trivial multiplier is 1.
  bool has_trivial = false;
  for (const Json& m : pss["multipliers"].array)
    if (m["trivial"].truth == true) {
      has_trivial = true;
      CHECK(m["re"].number == Approx(1.0).epsilon(1e-10));
    }
  CHECK(has_trivial);
}

TEST_CASE("charge that nothing takes away: no orbit, with the amount", "[unit]") {
  const Scratch scratch;
  scratch.write("drift.net", "drift\nI1 0 a SIN(1m 1m 1k)\nC1 a 0 1u\n.pss\n.end\n");
  const Finished finished = run_in(scratch, {"drift.net"});
  CHECK(finished.status == 1);
  CHECK_THAT(finished.err, Contains("error[E-pss-no-orbit]") && Contains("1 µC to C1"));  // 1 mA for 1 ms
}

TEST_CASE("a family of orbits is one of them, with a note", "[unit]") {
  const Scratch scratch;
  scratch.write("family.net", "family\nI1 0 a SIN(0 1m 1k)\nC1 a 0 1u ic=3\n.pss uic\n.meas pss mean AVG v(a)\n.end\n");
  const Finished finished = run_in(scratch, {"family.net"});
  CHECK(finished.status == 0);
  CHECK_THAT(finished.err, Contains("note[N-pss-not-unique]") && Contains("v(C1)"));
  // 3 V + ∫ 1 mA sin dt/C: the mean lies 1 mA/(2πf·C) above the start.
  CHECK(value_of(finished.out, "mean") == Approx(3.0 + 1e-3 / (2.0 * M_PI * 1e3 * 1e-6)).epsilon(1e-6));
}

TEST_CASE("what a card asks for and cannot be had is refused by name", "[unit]") {
  const Scratch scratch;
  const auto ends = [&](const std::string& deck, int status, const std::string& id) {
    scratch.write("bad.net", "bad\n" + deck + "\n.end\n");
    const Finished finished = run_in(scratch, {"bad.net"});
    INFO(deck);
    CHECK(finished.status == status);
    CHECK_THAT(finished.err, Contains("[" + id + "]"));
  };
  const std::string rc = "V1 a 0 PULSE(0 1 0 0 0 5m 10m)\nR1 a b 1k\nC1 b 0 1u\n";
  ends(rc + ".pss period=15m", 2, "E-pss-not-a-multiple");
  ends(rc + ".pss k=0", 2, "E-pss-bad-multiple");
  ends(rc + ".pss perid=10m", 2, "E-unexpected");
  ends("V1 a 0 SIN(0 1 50)\nV2 c 0 SIN(0 1 70.710678118654755)\nR1 a b 1k\nR2 c b 1k\nC1 b 0 1u\n.pss", 1, "E-pss-no-period");
  ends("V1 a 0 5\nR1 a b 1k\nC1 b 0 1u\n.pss", 1, "E-pss-no-oscillation");
  ends("V1 a 0 5\nR1 a b 1k\nC1 b 0 1u\nS1 b 0 b 0 SX\n.model SX SW(Vt=9)\n.pss on=S1 uic", 1, "E-pss-no-trigger");
}

TEST_CASE("rows hold one period; beside .tran they have a file of their own, and the run starts on the orbit", "[unit]") {
  const Scratch scratch;
  scratch.write("rc.net", "rc\nV1 a 0 PULSE(0 1 0 0 0 0.5m 1m)\nR1 a b 1k\nC1 b 0 1u\n.pss points=10\n.save v(b)\n.tran 0.5m 2m\n.end\n");
  CHECK(run_in(scratch, {"rc.net"}).status == 0);
  const std::string orbit = read_file(scratch / "rc.pss.csv"), rows = read_file(scratch / "rc.csv");
  CHECK(std::count(orbit.begin(), orbit.end(), '\n') == 12);
  CHECK(std::count(rows.begin(), rows.end(), '\n') == 6);
  // On the orbit from the first row on: v(b) = a/(1 + a) at whole periods.
  const double a = std::exp(-0.5);
  CHECK(std::stod(rows.substr(rows.find("\n0,") + 3)) == Approx(a / (1.0 + a)).epsilon(1e-12));
}

TEST_CASE("a sweep of orbits: measurements as a table, multipliers in --json", "[unit]") {
  // The RC circuit of above: the mean is 0.5 V, the multiplier e^{−T/RC}.
  const Scratch scratch;
  const std::string deck =
      "rc\n.param r=1k\nV1 a 0 PULSE(0 1 0 0 0 0.5m 1m)\nR1 a b {r}\nC1 b 0 1u\n.step param r 1k 2k 1k\n.pss\n.meas pss mean AVG "
      "v(b)\n.end\n";
  const Json result = steady_state_of(scratch, deck);
  REQUIRE(result["runs"].array.size() == 2);
  for (const double r : {1.0, 2.0}) {
    const Json& run = result["runs"][static_cast<std::size_t>(r) - 1];
    CHECK(measured(run, "mean") == Approx(0.5).epsilon(1e-13));
    CHECK(run["pss"]["multipliers"][0]["re"].number == Approx(std::exp(-1.0 / r)).epsilon(1e-12));
  }
  const Finished table = run_in(scratch, {"deck.net"});
  CHECK(table.out.starts_with("r,mean\n1000,0.49999999"));
}

TEST_CASE("the shipped decks of steady states are what the tutorial says", "[unit]") {
  const Scratch scratch;
  scratch.write("buck.net", read_file(std::string(PWLSIM_SOURCE_DIR) + "/netlists/steady_state/buck_type3.net"));
  const Json buck = read_json(run_in(scratch, {"buck.net", "--json"}).out);
  // The integrator holds the mean at 2·V_ref but for the amplifier's finite gain: v_c/1e5 at its input, twice that at the output.
  CHECK(measured(buck, "vout") == Approx(5.0).epsilon(1e-5));
  CHECK(buck["ac"]["loops"][0]["crossovers"].array.size() == 1);
  scratch.write("peak.net", read_file(std::string(PWLSIM_SOURCE_DIR) + "/netlists/steady_state/peak_current_buck.net"));
  const Json peak = read_json(run_in(scratch, {"peak.net", "--json"}).out);
  // Peak-current control with ideal elements and no slope: λ ≈ −D/(1 − D) for a stiff output; D = v/12 here.
  const double d = measured(peak, "vout") / 12.0;
  CHECK(peak["pss"]["multipliers"][0]["re"].number == Approx(-d / (1.0 - d)).epsilon(0.05));
}

namespace {

// Charged through R1 + R2 towards 5 V, discharged through R1 while S1 is closed, between 1 V and 3 V: T = RC-times of logarithms.
const std::string relay = "relay\nV1 vcc 0 5\nR1 o a 1k\nC1 a 0 100n\nS1 o 0 a 0 SM\nR2 vcc o 2k\n.model SM SW(Ron=0 Vt=2 Vh=1)\n";
const double relay_period = 3e3 * 1e-7 * std::log(4.0 / 2.0) + 1e3 * 1e-7 * std::log(3.0);

}  // namespace

TEST_CASE("a self-timed period may begin where a signal crosses a level, or another signal", "[unit]") {
  const Scratch scratch;
  const auto orbit_of = [&](const std::string& card) { return steady_state_of(scratch, relay + card + "\n.end\n")["pss"]; };
  for (const std::string card : {".pss when v(a)=2 rise", ".pss when v(a)=2 rise=1", ".pss when v(a)=2 cross=1",
                                 ".pss when v(a,x)=0\nV2 x 0 2", ".pss when v(a)=v(x)\nV2 x 0 2"}) {
    INFO(card);
    const Json pss = orbit_of(card);
    CHECK(pss["period"].number == Approx(relay_period).epsilon(1e-12));
    CHECK(pss["unique"].truth == true);
    CHECK(pss["stability"].string == "stable");
    CHECK(state(pss, "v(C1)") == Approx(2.0).epsilon(1e-12));
  }
  const Json falls = orbit_of(".pss when v(a)=1.5 fall");
  CHECK(state(falls, "v(C1)") == Approx(1.5).epsilon(1e-12));
  REQUIRE(falls["modes"].array.size() == 3);
  CHECK(falls["modes"][0]["closed"].array.size() == 1);
}

TEST_CASE("ngspice's .pss begins where its node rises through the mean", "[unit]") {
  const Scratch scratch;
  const Json pss = steady_state_of(scratch, relay + ".pss 3k 1m a 1024 10 50 1e-3 uic\n.end\n")["pss"];
  CHECK(pss["period"].number == Approx(relay_period).epsilon(1e-12));
  // The mean of an exponential between l and h towards e is e − (h − l)·τ/t, of the one that rises and of the one that falls.
  const double rise = 3e-4 * std::log(2.0), fall = 1e-4 * std::log(3.0);
  const double mean = (5.0 * rise - 2.0 * 3e-4 + 2.0 * 1e-4) / (rise + fall);
  CHECK(state(pss, "v(C1)") == Approx(mean).epsilon(1e-3));  // 4096 rows of 16 guessed periods
  scratch.write("deck.net", relay + ".pss 3k 1m zz 1024 10\n.end\n");
  const Finished refused = run_in(scratch, {"deck.net"});
  CHECK(refused.status == 2);
  CHECK_THAT(refused.err, Contains("E-unknown-node") && Contains("zz"));
}

TEST_CASE("the event that begins a self-timed period belongs to it once", "[unit]") {
  const Scratch scratch;
  const Json pss = steady_state_of(scratch, relay + ".pss on=S1\n.end\n")["pss"];
  REQUIRE(pss["modes"].array.size() == 2);
  CHECK(pss["modes"][0]["time"].number == 0.0);
  CHECK(pss["modes"][0]["event"].string == "S1 closes");
  CHECK(pss["modes"][1]["event"].string == "S1 opens");
  CHECK(pss["modes"][1]["time"].number == Approx(1e-4 * std::log(3.0)).epsilon(1e-12));
}

TEST_CASE("a self-timed orbit of k=2 that repeats sooner is told", "[unit]") {
  const Scratch scratch;
  scratch.write("deck.net", relay + ".pss on=S1 k=2\n.end\n");
  const Finished finished = run_in(scratch, {"deck.net"});
  CHECK(finished.status == 0);
  CHECK_THAT(finished.err, Contains("N-pss-shorter-period") && Contains("that of k=1"));
}

TEST_CASE("the event that ends a self-timed period is no control that rests", "[unit]") {
  const Scratch scratch;
  scratch.write("deck.net",
                "osc\nV1 vcc 0 10\nR1 vcc a 1k\nC1 a 0 1u\nS1 a b a 0 SX\nR2 b 0 100\n.model SX SW(Ron=0 Vt=5 Vh=2)\n.pss on=S1\n.end\n");
  const Finished finished = run_in(scratch, {"deck.net"});
  CHECK(finished.status == 0);
  CHECK_THAT(finished.err, !Contains("W-switch-at-threshold"));
}

TEST_CASE("a resonance without losses has no orbit", "[unit]") {
  // An undamped LC at its own frequency: the sine adds π/ω·(V/L)·… each period; in charge π·C·V = 3.14159 µC.
  const Scratch scratch;
  scratch.write("lc.net", "lc\nV1 a 0 SIN(0 1 {1/(2*pi*sqrt(1m*1u))})\nL1 a b 1m\nC1 b 0 1u\n.pss\n.end\n");
  const Finished finished = run_in(scratch, {"lc.net"});
  CHECK(finished.status == 1);
  CHECK_THAT(finished.err, Contains("error[E-pss-no-orbit]") && Contains("a resonance without losses") && Contains("3.14159 µC to C1"));
}

TEST_CASE("an orbit that is not found: residuals, the best state, and whether its modes repeat", "[unit]") {
  const Scratch scratch;
  scratch.write("deck.net", deane_hamill("33", ".pss uic maxiter=3 maxperiods=5"));
  const Finished finished = run_in(scratch, {"deck.net"});
  CHECK(finished.status == 1);
  CHECK_THAT(finished.err, Contains("error[E-pss-not-converged]") && Contains("the last residuals are 0.") &&
                               Contains("begins at v(C1) = ") && Contains("its modes "));
  CHECK(read_file(scratch / "deck.csv").starts_with("time,"));
}

// Converter 32 of `converters --print`, whose map has two pieces between which Newton's method went to and fro. On an orbit the mean voltage of every inductor is zero, and the output's mean current is that of the load.
TEST_CASE("a dual active bridge has its orbit where Newton's method goes round", "[unit]") {
  const Scratch scratch;
  const auto gate = [](const char* name, const char* delay) {
    return std::string("V") + name + " " + name + " 0 PULSE(0 1 " + delay + " 0 0 5.582u 11.9u)\n";
  };
  const Json result = steady_state_of(
      scratch,
      "dual active bridge\n" + gate("g0", "0.368u") + gate("g1", "6.318u") + gate("g2", "6.318u") + gate("g3", "12.268u") +
          gate("g4", "2.4386u") + gate("g5", "8.3886u") + gate("g6", "8.3886u") + gate("g7", "14.339u") +
          "V1 in 0 24\nS1 in a g0 0 SX1\nD1 a in DX0\nS2 a 0 g1 0 SX1\nD2 0 a DX0\nS3 in b g2 0 SX1\nD3 b in DX0\nS4 b 0 g3 0 SX1\n"
          "D4 0 b DX0\nL1 a p 12.9u ic=0\nL2 p b 106u ic=0\nL3 sa sb 207.76u ic=0\nS5 out sa g4 0 SX1\nD5 sa out DX0\nS6 sa 0 g5 0 SX1\n"
          "D6 0 sa DX0\nS7 out sb g6 0 SX1\nD7 sb out DX0\nS8 sb 0 g7 0 SX1\nD8 0 sb DX0\nC1 out 0 176u ic=0\nR1 out 0 2.86\n"
          "K1 L2 L3 0.99\n.model DX0 D(Ron=7.53m Vfwd=0.7)\n.model SX1 SW(Ron=10.1m Vt=0.5)\n.pss uic\n.meas pss leakage AVG v(a,p)\n"
          ".meas pss primary AVG v(p,b)\n.meas pss secondary AVG v(sa,sb)\n.meas pss charge AVG i(C1)\n.end\n");
  CHECK(result["pss"]["iterations"].number <= 40.0);  // 10 today
  for (const char* name : {"leakage", "primary", "secondary"}) CHECK(std::abs(measured(result, name)) <= 1e-10 * 24.0);
  CHECK(std::abs(measured(result, "charge")) <= 1e-10 * state(result["pss"], "v(C1)") / 2.86);
}

TEST_CASE("what happens at the begin of a period counts once: charges of jumps and edges", "[unit]") {
  // A pump: C2 between two charges holds v₁ = v₀ e^{−T/2RC₂}-like values; what the source gives is what R takes, so the averages of both currents are one, and
  // so is that of the charge that S2 passes on. The same with the gate's edges elsewhere in the period.
  const Scratch scratch;
  for (const std::string delay : {"0", "2u"}) {
    const Json result = steady_state_of(
        scratch, "pump\nVin in 0 5\nVg g 0 PULSE(0 1 " + delay +
                     " 0 0 5u 10u)\nS1 in a g 0 SX\nC1 a 0 1u\nS2 a out 0 g SY\nC2 out 0 10u\nR1 out 0 1k\n"
                     ".model SX SW(Vt=0.5)\n.model SY SW(Vt=-0.5)\n.pss\n.meas pss load AVG i(R1)\n.meas pss taken AVG i(Vin)\n"
                     ".meas pss passed AVG i(S2)\n.meas pss held INTEG i(C1)\n.meas pss three INTEG i(S1) FROM=1u TO=31u\n.meas pss power "
                     "AVG v(in)*i(Vin)\n"
                     ".meas pss on WHEN v(g)=0.5 RISE=1\n.meas pss width TRIG v(g)=0.5 RISE=1 TARG v(g)=0.5 FALL=1\n.end\n");
    INFO("edges at " << delay);
    const double load = measured(result, "load");
    CHECK(load > 4.9e-3);
    CHECK(measured(result, "taken") == Approx(-load).epsilon(1e-11));
    CHECK(measured(result, "passed") == Approx(load).epsilon(1e-11));
    CHECK(std::abs(measured(result, "held")) <= 1e-12 * load * 1e-5);
    CHECK(measured(result, "three") == Approx(load * 3e-5).epsilon(1e-11));
    CHECK(measured(result, "power") == Approx(-5.0 * load).epsilon(1e-11));
    CHECK(measured(result, "on") == Approx(delay == "0" ? 0.0 : 2e-6).margin(1e-18));
    CHECK(measured(result, "width") == Approx(5e-6).epsilon(1e-12));
  }
}

TEST_CASE("the event that begins a self-timed period is a passage at its begin, once", "[unit]") {
  // v(b) jumps at both events of the switch: it is on for t₂ = τ₂ ln((7 − W)/(3 − W)), τ₂ = C (R₁ ∥ R₂), W = 10 V R₂/(R₁ + R₂), off for t₁ = τ₁ ln(7/3).
  const double w = 10.0 * 100.0 / 1100.0, on = 1e-6 * (1000.0 * 100.0 / 1100.0) * std::log((7.0 - w) / (3.0 - w)),
               off = 1e-3 * std::log(7.0 / 3.0);
  const Scratch scratch;
  for (const std::string card : {"on=S1", "off=S1"}) {
    INFO(card);
    const bool begins_on = card == "on=S1";
    const Json result = steady_state_of(
        scratch, "osc\nV1 vcc 0 10\nR1 vcc a 1k\nC1 a 0 1u\nS1 a b a 0 SX\nR2 b 0 100\n.model SX SW(Ron=0 Vt=5 Vh=2)\n.pss " + card +
                     "\n.meas pss rises WHEN v(b)=1 RISE=1\n.meas pss falls WHEN v(b)=1 FALL=1\n.meas pss last WHEN v(b)=1 " +
                     (begins_on ? "RISE" : "FALL") + "=LAST\n.meas pss next WHEN v(b)=1 CROSS=3 TO=" + std::to_string(1.5 * (on + off)) +
                     "\n.end\n");
    CHECK(measured(result, "rises") == Approx(begins_on ? 0.0 : off).epsilon(1e-11));
    CHECK(measured(result, "falls") == Approx(begins_on ? on : 0.0).epsilon(1e-11));
    CHECK(measured(result, "last") == 0.0);
    CHECK(measured(result, "next") == Approx(on + off).epsilon(1e-11));
  }
}

TEST_CASE("cycles_before_pop are periods before the search", "[unit]") {
  const Scratch scratch;
  const Json result =
      steady_state_of(scratch, "rc\nV1 a 0 PULSE(0 1 0 0 0 0.5m 1m)\nR1 a b 1k\nC1 b 0 1u\n.pop cycles_before_pop=7\n.end\n");
  CHECK(result["pss"]["periods_simulated"].number >= 8.0);  // and one at least of the search
  CHECK(result["pss"]["multipliers"][0]["re"].number == Approx(std::exp(-1.0)).epsilon(1e-13));
}

TEST_CASE("a sweep of orbits beside runs: rows and derivatives in tables of their own", "[unit]") {
  // v₀ and v₁ of the RC circuit above: a/(1 + a) and 1/(1 + a), a = e^{−T/2RC}; dv₁/dC = −a·(T/2RC²)/(1 + a)².
  const Scratch scratch;
  scratch.write(
      "deck.net",
      "rc\n.param r=1k\nV1 a 0 PULSE(0 1 0 0 0 0.5m 1m)\nR1 a b {r}\nC1 b 0 1u\n.save v(b)\n.step param r list 1k 2k\n.pss points=2\n.tran "
      "0.5m 1m\n.meas pss peak MAX v(b)\n.sens param=C1\n.end\n");
  REQUIRE(run_in(scratch, {"deck.net"}).status == 0);
  std::istringstream rows(read_file(scratch / "deck.pss.csv")), derivatives(read_file(scratch / "deck.sens.csv"));
  std::string line;
  std::getline(rows, line);
  CHECK(line == "r,time,v(b)");
  std::getline(derivatives, line);
  CHECK(line == "r,measurement,parameter,derivative,normalised,left,right,failure");
  for (const double r : {1000.0, 2000.0}) {
    const double share = 0.5e-3 / (r * 1e-6), a = std::exp(-share);
    for (const double expected : {a / (1.0 + a), 1.0 / (1.0 + a), a / (1.0 + a)}) {
      double stepped = 0.0, time = 0.0, value = 0.0;
      char comma = 0;
      rows >> stepped >> comma >> time >> comma >> value;
      CHECK(stepped == r);
      CHECK(value == Approx(expected).epsilon(1e-12));
    }
    std::getline(derivatives, line);
    const std::string head = (r == 1000.0 ? "1000" : "2000") + std::string(",peak,C1,");
    REQUIRE(line.starts_with(head));
    CHECK(std::stod(line.substr(head.size())) == Approx(-a * share * 1e6 / ((1.0 + a) * (1.0 + a))).epsilon(1e-10));
  }
}

TEST_CASE("--no-rows writes no rows of an orbit beside a run", "[unit]") {
  const Scratch scratch;
  scratch.write("deck.net", "rc\nV1 a 0 PULSE(0 1 0 0 0 0.5m 1m)\nR1 a b 1k\nC1 b 0 1u\n.pss\n.tran 0.5m 1m\n.end\n");
  const Finished finished = run_in(scratch, {"deck.net", "--no-rows"});
  CHECK(finished.status == 0);
  CHECK_FALSE(std::filesystem::exists("/dev/null.pss"));
}

TEST_CASE("an unknown switch of on= is named, in driven circuits too", "[unit]") {
  const Scratch scratch;
  for (const std::string& deck : {relay, std::string("rc\nV1 a 0 PULSE(0 1 0 0 0 0.5m 1m)\nR1 a b 1k\nC1 b 0 1u\n")}) {
    scratch.write("deck.net", deck + ".pss on=S7\n.end\n");
    const Finished refused = run_in(scratch, {"deck.net"});
    CHECK(refused.status == 2);
    CHECK_THAT(refused.err, Contains("E-unknown-element") && Contains("S7"));
  }
}

TEST_CASE("parts beside a self-timed one settle, with multipliers of their own", "[unit]") {
  // i(L5) = 5 V/1 kΩ; its deviation falls by e^{−T R5/L5} in a period.
  const Scratch scratch;
  const Json pss = steady_state_of(scratch, relay + "L5 vcc q 0.2\nR5 q 0 1k\n.pss on=S1\n.end\n")["pss"];
  CHECK(pss["unique"].truth == true);
  CHECK(pss["period"].number == Approx(relay_period).epsilon(1e-12));
  CHECK(state(pss, "i(L5)") == Approx(5e-3).epsilon(1e-12));
  bool is_there = false;
  for (const Json& m : pss["multipliers"].array)
    is_there |= !m["trivial"].truth && std::abs(m["re"].number - std::exp(-relay_period * 1e3 / 0.2)) < 1e-12;
  CHECK(is_there);
}

TEST_CASE("a self-timed orbit that begins with a jump of charge: its impulse counts once, whatever rounding makes of its time", "[unit]") {
  // S1 dumps C1 into C2 when v(a) rises to 5 V. Over a period C2 takes no charge: the mean current of S1 is that of R2.
  const Scratch scratch;
  for (int k = 0; k < 12; ++k) {
    const double r = 1000.0 + 170.0 * k, r2 = 20.0 + 2.3 * k;
    INFO("R1 = " << r << ", R2 = " << r2);
    scratch.write("dump.net", "dump\nV1 in 0 10\nR1 in a " + std::to_string(r) + "\nC1 a 0 1u\nS1 a b a 0 SX\nC2 b 0 1u\nR2 b 0 " +
                                  std::to_string(r2) + "\n.model SX SW(Ron=0 Vt=3 Vh=2)\n.pss on=S1 uic\n.meas pss s AVG i(S1)\n" +
                                  ".meas pss r AVG i(R2)\n.meas pss t PERIOD\n.meas pss three INTEG i(S1) FROM=0 TO='3*t'\n.end\n");
    const Finished finished = run_in(scratch, {"dump.net", "--json", "--no-rows"});
    REQUIRE(finished.status == 0);
    const Json result = read_json(finished.out);
    const auto value = [&](std::size_t m) { return result["measurements"][m]["value"].number; };
    CHECK(value(0) == Approx(value(1)).epsilon(1e-9));
  }
}

TEST_CASE("sources without a common period: period= must hold whole numbers of their periods", "[unit]") {
  // 0.6 s hold 42.43 periods of 50·√2 Hz, 1.4 s 98.995.
  const Scratch scratch;
  const std::string deck = "two\nV1 a 0 SIN(0 1 50)\nV2 b a SIN(0 1 {50*sqrt(2)})\nR1 b c 1k\nC1 c 0 1u\n";
  scratch.write("none.net", deck + ".pss period=0.6\n.end\n");
  const Finished none = run_in(scratch, {"none.net"});
  CHECK(none.status == 2);
  CHECK_THAT(none.err, Contains("error[E-pss-not-a-multiple]") && Contains("periods of V2"));
  scratch.write("near.net", deck + ".pss period=1.4\n.end\n");
  const Finished near = run_in(scratch, {"near.net", "--no-rows"});
  CHECK(near.status == 0);
  CHECK_THAT(near.err, Contains("warning[W-pss-cut-source]") && Contains("periods of V2"));
}

// The capacitor charges towards 10 V, and is empty at once where it reaches 4 V: T = RC ln(10/6). With R2 and C2 beside it the map of v(b) from one discharge to the next was
// iterated by another program (scipy: matrix exponentials, Brent's method), and differentiated by a central difference.
TEST_CASE("a switch that closes and opens at one instant makes an oscillator", "[unit]") {
  const Scratch scratch;
  const std::string head = "relaxation\nV1 in 0 10\nR1 in a 1k\nC1 a 0 1u\nS1 a 0 a 0 SW\n.model SW SW(Ron=0 Vt=3 Vh=1)\n.save v(a)\n";
  for (const std::string card : {".pss uic", ".pss uic on=S1", ".pss uic off=S1", ".pss uic when v(a)=3 rise"}) {
    INFO(card);
    const Json orbit = steady_state_of(scratch, head + card + "\n.end\n")["pss"];
    CHECK(orbit["period"].number == Approx(1e-3 * std::log(10.0 / 6.0)).epsilon(1e-11));
    bool is_told = false;
    for (const Json& mode : orbit["modes"].array) is_told |= mode["event"].string == "S1 closes and opens";
    CHECK(is_told);
  }
  for (const std::string card : {".pss uic", ".pss uic when v(a)=3 rise"}) {
    const Json orbit = steady_state_of(scratch, head + "R2 a b 2k\nC2 b 0 1.5u\n" + card + "\n.end\n")["pss"];
    CHECK(orbit["period"].number == Approx(0.0005164810287712603).epsilon(1e-10));
    REQUIRE(orbit["multipliers"].array.size() == 2);
    const double largest = std::min(orbit["multipliers"].array[0]["re"].number, orbit["multipliers"].array[1]["re"].number);
    CHECK(largest == Approx(0.8394060).epsilon(1e-6));  // the difference has so many digits
  }
}

// A relay without hysteresis before 1/(LCs² + …): the locus of G(jω) meets the negative real axis at ω → ∞ only (Tsypkin), so that oscillations die away in ever shorter
// periods and there is no orbit. What the last steps of the search leave is a motion, no rounding.
TEST_CASE("oscillations that die away in ever shorter periods are no orbit", "[unit]") {
  const Scratch scratch;
  scratch.write("deck.net",
                "relay\nB1 u 0 V=if(V(c)>0.1,-5,5)\nS9 s9 0 c 0 SX\nR9 s9 0 1k\nR1 u a 5\nL1 a c 1m ic=0\nC1 c 0 1u ic=0\nR2 c 0 50\n"
                ".model SX SW(Ron=1 Roff=1meg Vt=0.1)\n.pss uic on=S9\n.end\n");
  const Finished finished = run_in(scratch, {"deck.net"});
  CHECK(finished.status == 1);
  CHECK_THAT(finished.err, Contains("error[E-pss-not-converged]"));
}

// The integrator of the compensator holds the mean of its input at zero: v(o) = 2·2.5 V on the mean. Its fraction is written with numbers that are far from 1, so that states
// which take the size of them would be nothing beside the rest, and a drifting one no motion.
TEST_CASE("a compensator as a fraction in s: the mean of its input is zero, however the fraction is written", "[unit]") {
  const std::string power =
      "loop\nVin in 0 12\nVt t 0 PULSE(0 3 0 9.9u 0.1u 0 10u)\nS1 in sw g 0 SX\nD1 0 sw DX\nL1 sw o 22u ic=2\nC1 o x 100u ic=5\nRe x 0 "
      "20m\n"
      "R1 o 0 2.5\nRa o fb 10k\nRb fb 0 10k\nVr ref 0 2.5\nB2 er 0 V=V(ref)-V(fb)\nRer er 0 1k\n"
      "B1 g 0 V=if(limit(V(ea),0.05,2.9)>V(t),5,0)\n.model SX SW(Ron=20m Vt=2.5)\n.model DX D(Ron=20m Vfwd=0.4)\n.meas pss vo AVG v(o)\n";
  const Scratch scratch;
  for (const std::string fraction : {"500*(1+s/2e4)/(s*(1+s/4e5))", "1e12*(2e4+s)*4e5/(2e4*s*(4e5+s)*2e9)"})
    for (const std::string start : {".pss\n", ".pss uic\n"}) {
      INFO(fraction << " " << start);
      const Json result = steady_state_of(scratch, power + "E1 ea 0 er 0 Laplace={" + fraction + "}\n" + start + ".end\n");
      CHECK(measured(result, "vo") == Approx(5.0).epsilon(1e-9));
      CHECK(result["pss"]["stability"].string == "stable");
    }
  // Ten times the gain: the double pole of the filter makes the loop unstable, its orbit is there all the same.
  const Json unstable = steady_state_of(scratch, power + "E1 ea 0 er 0 Laplace={9k*(1+s/2e4)/(s*(1+s/4e5))}\n.pss\n.end\n");
  CHECK(measured(unstable, "vo") == Approx(5.0).epsilon(1e-9));
  CHECK(unstable["pss"]["stability"].string == "unstable");
}

// A triangle by an integrator alone: from −0.7 to 0.7 with the slope 2000·1 V/s, and back with 2000·1.5 V/s. No mode has a time constant.
TEST_CASE("an oscillator of an integrator and a relay has an orbit, though no mode has a time constant", "[unit]") {
  const Scratch scratch;
  const std::string switched =
      "S1 s 0 x 0 SX\nVs v 0 1\nRs v s 1k\nB2 q 0 V=if(V(s)>0.5,1,-1.5)\n.model SX SW(Ron=1 Roff=1meg Vt=0 Vh=0.7)\n";
  for (const std::string integrator : {"B1 x 0 V=sdt(2k*V(q),0)\n", "G1 0 x q 0 2m\nC1 x 0 1u ic=0\n"}) {
    const Json result =
        steady_state_of(scratch, "vco\n" + integrator + switched + ".pss uic on=S1\n.meas pss t PERIOD\n.meas pss m AVG v(x)\n.end\n");
    CHECK(measured(result, "t") == Approx(1.4 / 2000.0 + 1.4 / 3000.0).epsilon(1e-11));
    CHECK(std::abs(measured(result, "m")) < 1e-12);
  }
}

// Two cells that do not depend on each other pass their guards at the same instants; their multipliers are those of one cell, twice.
TEST_CASE("parts that pass their guards at one instant have the multipliers of each", "[unit]") {
  const auto cell = [](const std::string& n) {
    return "B" + n + " g" + n + " 0 V=if(V(ck)>2.5,5,if(I(L" + n + ")*0.1>0.3,0,V(h" + n + ")))\nRg" + n + " g" + n + " h" + n + " 10\nCg" +
           n + " h" + n + " 0 100p ic=0\nS" + n + " in s" + n + " h" + n + " 0 SX\nD" + n + " 0 s" + n + " DX\nL" + n + " s" + n + " o" +
           n + " 10u ic=1\nC" + n + " o" + n + " 0 47u ic=5\nR" + n + " o" + n + " 0 1.2\n";
  };
  const std::string frame =
      "cells\nVin in 0 12\nVclk ck 0 PULSE(0 5 0 1n 1n 50n 5u)\n.model SX SW(Ron=20m Vt=2.5)\n.model DX D(Ron=20m Vfwd=0.4)\n.pss uic\n";
  const Scratch scratch;
  const auto one = steady_state_of(scratch, frame + cell("1") + ".end\n")["pss"]["multipliers"].array;
  const auto two = steady_state_of(scratch, frame + cell("1") + cell("2") + ".end\n")["pss"]["multipliers"].array;
  REQUIRE(two.size() == 2 * one.size());
  for (std::size_t k = 0; k < two.size(); ++k) {
    CHECK(two[k]["re"].number == Approx(one[k / 2]["re"].number).epsilon(1e-8));
    CHECK(std::abs(two[k]["im"].number) < 1e-8);
  }
}
