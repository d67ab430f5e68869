// Measurements against closed forms.

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "measure/measured.hpp"

using pwlsim::test::exact;
using pwlsim::test::measure_deck;
using pwlsim::test::Measured;
using pwlsim::test::near;
using std::numbers::pi;

namespace {

/// v(out) = 1 − e^{−t/τ}, τ = 1 ms.
const std::string charging =
    "charging\n"
    "V1 in 0 PULSE(0 1 0 0 0 1 2)\n"
    "R1 in out 1k\n"
    "C1 out 0 1u\n"
    ".tran 1m 5m\n"
    ".save v(in)\n";
constexpr double tau = 1e-3;
double charge(double t) { return 1.0 - std::exp(-t / tau); }
/// ∫ v from a to b.
double area(double a, double b) { return (b - a) - tau * (std::exp(-a / tau) - std::exp(-b / tau)); }

}  // namespace

TEST_CASE("means, integrals and extrema of an RC step response", "[unit]") {
  const Measured m = measure_deck(charging +
                                  ".meas tran mean AVG v(out)\n"
                                  ".meas late AVG v(out) FROM 1m TO 2m\n"
                                  ".meas same AVG v(out) FROM=1m TO=2m\n"
                                  ".meas tran rms RMS v(out) FROM=1m TO=3m\n"
                                  ".meas tran energy INTEG v(in,out)*i(R1)\n"
                                  ".meas tran square INTEG i(R1)**2*1k\n"
                                  ".meas tran charge INTEG i(C1)\n"
                                  ".meas tran least MIN v(out) FROM=1m\n"
                                  ".meas tran most MAX v(out)\n"
                                  ".meas tran most_at MAX_AT v(out)\n"
                                  ".meas tran least_at MIN_AT v(out) FROM=1m\n"
                                  ".meas tran span PP v(out) FROM=1m TO=2m\n");
  REQUIRE(m.messages.empty());
  CHECK(m.passes == 1);
  CHECK(m.value.at("mean") == near(area(0.0, 5e-3) / 5e-3));
  CHECK(m.value.at("late") == near(area(1e-3, 2e-3) / 1e-3));
  CHECK(m.value.at("same") == m.value.at("late"));
  const double square = 2e-3 - 2.0 * tau * (std::exp(-1.0) - std::exp(-3.0)) + 0.5 * tau * (std::exp(-2.0) - std::exp(-6.0));
  CHECK(m.value.at("rms") == near(std::sqrt(square / 2e-3)));
  CHECK(m.value.at("energy") == near(1e-3 * 0.5 * tau * (1.0 - std::exp(-10.0))));
  CHECK(m.value.at("square") == near(1e-3 * 0.5 * tau * (1.0 - std::exp(-10.0))));
  CHECK(m.value.at("charge") == near(1e-6 * charge(5e-3)));
  CHECK(m.value.at("least") == near(charge(1e-3)));
  CHECK(m.value.at("most") == near(charge(5e-3)));
  CHECK(m.value.at("most_at") == near(5e-3));
  CHECK(m.value.at("least_at") == near(1e-3));
  CHECK(m.value.at("span") == near(charge(2e-3) - charge(1e-3)));
  CHECK(m.result("energy").unit == "J");
  CHECK(m.result("charge").unit == "C");
  CHECK(m.result("rms").unit == "V");
}

TEST_CASE("values at times and times of values", "[unit]") {
  const Measured m = measure_deck(charging +
                                  ".meas tran v1 FIND v(out) AT=1m\n"
                                  ".meas tran end FIND v(out) AT 5m\n"
                                  ".meas tran slope DERIV v(out) AT=1m\n"
                                  ".meas tran half WHEN v(out)=0.5\n"
                                  ".meas tran i_half FIND i(R1) WHEN v(out)=0.5 RISE=1\n"
                                  ".meas tran slope_half DERIV v(out) WHEN v(out)=0.5\n"
                                  ".meas tran meet WHEN v(out)=v(in,out)\n"
                                  ".meas tran rise TRIG v(out) VAL=0.1 RISE=1 TARG v(out) VAL=0.9 RISE=1\n"
                                  ".meas tran delay TRIG v(in) VAL=0.5 RISE=1 TARG v(out)=0.5 CROSS=1\n"
                                  ".meas tran from_time TRIG AT=0.1m TARG v(out)=0.5 CROSS=LAST\n"
                                  ".meas tran clock WHEN time=2m\n");
  REQUIRE(m.messages.empty());
  CHECK(m.value.at("v1") == near(charge(1e-3)));
  CHECK(m.value.at("end") == near(charge(5e-3)));
  CHECK(m.value.at("slope") == near(std::exp(-1.0) / tau));
  CHECK(m.value.at("half") == near(tau * std::log(2.0)));
  CHECK(m.value.at("i_half") == near(0.5e-3));
  CHECK(m.value.at("slope_half") == near(0.5 / tau));
  CHECK(m.value.at("meet") == near(tau * std::log(2.0)));
  CHECK(m.value.at("rise") == near(tau * std::log(9.0)));
  CHECK(m.value.at("delay") == near(tau * std::log(2.0)));  // the edge at t = 0 counts: the run starts from the operating point
  CHECK(m.value.at("from_time") == near(tau * std::log(2.0) - 1e-4));
  CHECK(m.value.at("clock") == near(2e-3));
  CHECK(m.result("half").unit == "s");
  CHECK(m.result("slope").unit == "V/s");
}

TEST_CASE("what a measurement does not find it says, with its number of passages", "[unit]") {
  const Measured m = measure_deck(charging +
                                  ".meas tran never WHEN v(out)=2\n"
                                  ".meas tran second FIND i(R1) WHEN v(out)=0.5 CROSS=2\n"
                                  ".meas tran fall WHEN v(out)=0.5 FALL=1\n"
                                  ".meas tran after PARAM 2*never\n"
                                  ".meas tran outside AVG v(out) FROM=4m TO=6m\n"
                                  ".meas tran empty AVG v(out) FROM=4m TO=4m\n"
                                  ".meas tran late FIND v(out) AT=6m\n"
                                  ".meas tran divide AVG 1/(v(in)-v(in))\n"
                                  ".meas tran width TRIG v(out)=0.5 RISE=1 TARG v(out)=0.5 FALL=1\n");
  REQUIRE(m.messages.empty());
  CHECK(m.value.empty());
  CHECK(m.result("never").failure == "v(out) crosses 2 at no time from 0 s to 0.005 s");
  CHECK(m.result("second").failure == "v(out) crosses 0.5 once from 0 s to 0.005 s, not 2 times");
  CHECK(m.result("fall").failure == "v(out) falls through 0.5 at no time from 0 s to 0.005 s");
  CHECK(m.result("after").failure == "it needs never, which failed");
  CHECK(m.result("outside").failure == "the window 0.004 s … 0.006 s is not within the run, 0 … 0.005 s");
  CHECK(m.result("empty").failure == "the window from 0.004 s to 0.004 s is empty");
  CHECK(m.result("late").failure == "AT = 0.006 s is not within the run, 0 … 0.005 s");
  CHECK(m.result("divide").failure == "the expression is not finite everywhere in its window");
  CHECK(m.result("width").failure == "v(out) falls through 0.5 at no time from 0 s to 0.005 s");
}

TEST_CASE("results of measurements in other measurements, in any order", "[unit]") {
  const Measured m = measure_deck(charging +
                                  ".param f=1k\n"
                                  ".func twice(x) {2*x}\n"
                                  ".meas tran ratio PARAM twice(half)/(tau_ns*1n)\n"
                                  ".meas tran tau_ns PARAM {1/f/1n}\n"
                                  ".meas tran half WHEN v(out)=0.5\n"
                                  ".meas tran window AVG v(out) FROM=half TO={half+1/f}\n"
                                  ".meas tran between INTEG v(out) TRIG v(out)=0.25 RISE=1 TARG v(out)=0.75 RISE=1\n"
                                  ".meas tran above AVG twice(v(out)-window) FROM=half TO='half+1/f'\n");
  REQUIRE(m.messages.empty());
  const double half = tau * std::log(2.0);
  CHECK(m.passes == 3);
  CHECK(m.value.at("ratio") == near(2.0 * std::log(2.0)));
  CHECK(m.value.at("window") == near(area(half, half + 1e-3) / 1e-3));
  CHECK(m.value.at("between") == near(area(tau * std::log(4.0 / 3.0), tau * std::log(4.0))));
  CHECK(std::abs(m.value.at("above")) < exact);
}

TEST_CASE("functions with corners and jumps are integrated to their corners", "[unit]") {
  const Measured m = measure_deck(
      "ramp\n"
      "B1 in 0 V={1000*time-1}\n"
      "R1 in 0 1k\n"
      ".tran 1m 2m uic\n"
      ".meas size AVG abs(v(in)-0.1234567)\n"
      ".meas positive AVG max(v(in),0)\n"
      ".meas sign AVG sgn(v(in)+0.3)\n"
      ".meas part AVG (v(in)>0.25)\n"
      ".meas root AVG sqrt(abs(v(in)))\n"
      ".meas choice AVG if(v(in)>0.5,2,0)\n"
      ".meas peak MAX 1-abs(v(in)-0.3)\n"
      ".meas at MAX_AT 1-abs(v(in)-0.3)\n"
      ".meas quotient AVG 1/(v(in)+2)\n");
  REQUIRE(m.messages.empty());
  const double a = 0.1234567;
  CHECK(m.value.at("size") == near(0.25 * ((1.0 + a) * (1.0 + a) + (1.0 - a) * (1.0 - a))));
  CHECK(m.value.at("positive") == near(0.25));
  CHECK(m.value.at("sign") == near(0.3));
  CHECK(m.value.at("part") == near(0.375));
  CHECK(m.value.at("root") == near(2.0 / 3.0));
  CHECK(m.value.at("choice") == near(0.5));
  CHECK(m.value.at("peak") == near(1.0));
  CHECK(m.value.at("at") == near(1.3e-3));
  CHECK(m.value.at("quotient") == near(0.5 * std::log(3.0)));
}

TEST_CASE("mean, rms and form factor of rectified sines", "[unit]") {
  const Measured m = measure_deck(
      "rectifiers\n"
      "V1 a 0 SIN(0 10 50)\n"
      "D1 a h DI\n"
      "R1 h 0 10\n"
      "D2 p q DI\nD3 n q DI\nD4 0 p DI\nD5 0 n DI\n"
      "V2 p n SIN(0 10 50)\n"
      "R2 q 0 10\n"
      ".model DI D\n"
      ".tran 1m 40m\n"
      ".meas half AVG v(h)\n"
      ".meas half_rms RMS v(h)\n"
      ".meas full AVG v(q)\n"
      ".meas full_rms RMS v(q)\n"
      ".meas power AVG v(q)*i(R2)\n"
      ".meas form PARAM full_rms/full\n"
      ".meas peak MAX v(q) FROM=1m\n"
      ".meas when MAX_AT v(h) FROM=20m\n"
      ".meas zeros WHEN v(a)=0 FALL=LAST\n"
      ".four 50 v(h)\n");
  REQUIRE(m.messages.empty());
  CHECK(m.value.at("half") == near(10.0 / pi));
  CHECK(m.value.at("half_rms") == near(5.0));
  CHECK(m.value.at("full") == near(20.0 / pi));
  CHECK(m.value.at("full_rms") == near(10.0 / std::sqrt(2.0)));
  CHECK(m.value.at("power") == near(5.0));
  CHECK(m.value.at("form") == near(pi / (2.0 * std::sqrt(2.0))));
  CHECK(m.value.at("peak") == near(10.0));
  CHECK(m.value.at("when") == near(25e-3, 1e-8));  // a maximum is flat: its place is known to the root of rounding
  CHECK(m.value.at("zeros") == near(30e-3));
  const auto& h = m.results.fourier.at(0).harmonics;  // half wave: 1/π + sin/2 − (2/π) Σ cos(2k)/(4k²−1)
  CHECK(h[0].magnitude == near(10.0 / pi));
  CHECK(h[1].magnitude == near(5.0));
  CHECK(h[2].magnitude == near(20.0 / (3.0 * pi)));
  CHECK(h[2].phase == near(-90.0));
  CHECK(h[4].magnitude == near(20.0 / (15.0 * pi)));
}

TEST_CASE("jumps of value: rms of pulse trains, values right of an edge, passages by edges", "[unit]") {
  const Measured m = measure_deck(
      "pulses\n"
      "V1 a 0 PULSE(-2 3 0.1m 0 0 0.25m 1m)\n"
      "R1 a 0 1k\n"
      ".tran 1m 10m\n"
      ".meas rms RMS v(a) FROM=1.1m TO=9.1m\n"
      ".meas mean AVG v(a) FROM=1.1m TO=9.1m\n"
      ".meas right FIND v(a) AT=1.1m\n"
      ".meas left FIND v(a) AT=1.35m\n"
      ".meas low MAX v(a) FROM=1.35m TO=2.1m\n"
      ".meas high MIN v(a) FROM=1.1m TO=1.35m\n"
      ".meas third WHEN v(a)=0 RISE=3\n"
      ".meas last WHEN v(a)=0 FALL=LAST\n"
      ".meas fifth WHEN v(a)=0 CROSS=5 TD=2m\n"
      ".meas width TRIG v(a)=0 RISE=2 TARG v(a)=0 FALL=2\n"
      ".meas never WHEN v(a)=3.5\n"
      ".meas reach WHEN v(a)=3 RISE=2\n");
  REQUIRE(m.messages.empty());
  CHECK(m.value.at("rms") == near(std::sqrt(0.25 * 9.0 + 0.75 * 4.0)));
  CHECK(m.value.at("mean") == near(-0.75));
  CHECK(m.value.at("right") == 3.0);
  CHECK(m.value.at("left") == -2.0);
  CHECK(m.value.at("low") == -2.0);
  CHECK(m.value.at("high") == 3.0);
  CHECK(m.value.at("third") == near(2.1e-3));
  CHECK(m.value.at("last") == near(9.35e-3));
  CHECK(m.value.at("fifth") == near(4.1e-3));  // 2.1, 2.35, 3.1, 3.35, 4.1
  CHECK(m.value.at("width") == near(0.25e-3));
  CHECK(m.value.count("never") == 0);
  CHECK(m.value.at("reach") == near(1.1e-3));  // what arrives at the value and rests there has crossed
}

TEST_CASE("currents behind a blocked diode pass zero with the diode only, also where they are differences of voltages", "[unit]") {
  // A half-wave rectifier with a resistive load: 10 V at 50 Hz pass zero every 10 ms. Between two half waves all currents and drops are zero.
  const std::string deck =
      "half wave\n"
      "V1 s 0 SIN(0 10 50)\n"
      "RS s b 1.3\n"
      "R3 b c 0.37\n"
      "R4 b c 7.7\n"
      "D1 c out DI\n"
      "R1 out 0 50\n"
      ".model DI D\n"
      ".tran 1m 0.1 uic\n"
      ".meas current WHEN i(RS)=0 FALL=3\n"
      ".meas again WHEN i(RS)=0 RISE=3\n"
      ".meas branch WHEN i(R3)=0 FALL=4\n"
      ".meas final WHEN v(b,c)=0 FALL=LAST\n";
  for (const double reltol : {0.0, 1e-6}) {
    INFO(reltol);
    const double place = reltol > 0.0 ? 1e-4 : exact;
    const Measured m = measure_deck(deck, reltol);
    REQUIRE(m.messages.empty());
    CHECK(m.value.at("current") == near(50e-3, place));
    CHECK(m.value.at("again") == near(60e-3, place));
    CHECK(m.value.at("branch") == near(70e-3, place));
    CHECK(m.value.at("final") == near(90e-3, place));
  }
}

TEST_CASE("an expression that varies too fast has no value", "[unit]") {
  const Measured m = measure_deck(
      "fast\n"
      "V1 a 0 SIN(0 1 50)\n"
      "R1 a 0 1k\n"
      ".tran 1m 0.1\n"
      ".meas slow AVG cos(10*v(a)) TO=20m\n"
      ".meas mean AVG sin(1e16*v(a))\n"
      ".meas place WHEN sin(1e16*v(a))=2\n"
      ".meas slope DERIV sin(1e16*v(a)) AT=3m\n");
  REQUIRE(m.messages.empty());
  CHECK(m.value.at("slow") == near(-0.2459357644513483));  // the Bessel function J0(10): Abramowitz & Stegun, table 9.1
  for (const char* name : {"mean", "place", "slope"}) {
    INFO(name);
    CHECK(m.result(name).failure.find("varies too fast") != std::string::npos);
  }
}

TEST_CASE("a sine has no harmonics, by Parseval neither", "[unit]") {
  const Measured m = measure_deck("sine\nV1 a 0 SIN(0 1 1k)\nR1 a 0 1k\nC1 a 0 1u\n.tran 1m 5m\n.four 1k v(a) i(R1)\n");
  REQUIRE(m.results.fourier.size() == 2);
  for (const auto& result : m.results.fourier) CHECK(result.total_distortion < 1e-12);
}

TEST_CASE("total harmonic distortion of a square wave is sqrt(pi^2/8 - 1)", "[unit]") {
  const Measured m = measure_deck(
      "square\n"
      "V1 a 0 PULSE(-1 1 0 0 0 0.5m 1m)\n"
      "R1 a 0 1k\n"
      ".tran 1m 5m\n"
      ".four 1k v(a)\n"
      ".four 1k 3 -1 i(R1) v(a,0)\n"
      ".four 1 v(a)\n");
  REQUIRE(m.messages.empty());
  REQUIRE(m.results.fourier.size() == 4);
  const auto& all = m.results.fourier[0];
  CHECK(all.total_distortion == near(std::sqrt(pi * pi / 8.0 - 1.0)));
  REQUIRE(all.harmonics.size() == 10);
  double listed = 0.0;
  for (int k = 3; k < 10; k += 2) listed += 1.0 / (k * k);
  CHECK(all.listed_distortion == near(std::sqrt(listed)));
  for (std::size_t k = 1; k < 10; ++k) {
    const double magnitude = k % 2 == 0 ? 0.0 : 4.0 / (pi * static_cast<double>(k));
    CHECK(std::abs(all.harmonics[k].magnitude - magnitude) < exact);
    CHECK(std::abs(all.harmonics[k].phase) < 1e-9);
  }
  CHECK(m.results.fourier[1].harmonics.size() == 4);
  CHECK(m.results.fourier[1].harmonics[3].magnitude == near(4e-3 / (3.0 * pi)));
  CHECK(!m.results.fourier[3].failure.empty());  // no period of 1 Hz in 5 ms
}

TEST_CASE("a lossless ring over hundreds of periods", "[unit]") {
  const Measured m = measure_deck(
      "ring\n"
      "L1 a 0 1u ic=1\n"
      "C1 a 0 1n\n"
      ".tran 1u 100u uic\n"
      ".meas most MAX v(a)\n"
      ".meas period TRIG v(a)=0 RISE=100 TARG v(a)=0 RISE=200\n");
  REQUIRE(m.messages.empty());
  CHECK(m.value.at("most") == near(std::sqrt(1e-6 / 1e-9)));  // i √(L/C)
  CHECK(m.value.at("period") == near(100.0 * 2.0 * pi * std::sqrt(1e-6 * 1e-9)));
}

TEST_CASE("a transient of picoseconds at the begin of a segment of milliseconds is not missed", "[unit]") {
  const Measured m = measure_deck(
      "stiff\n"
      "V1 in 0 PULSE(0 1 0 0 0 1 2)\n"
      "R1 in a 1\n"
      "C1 a 0 1p\n"
      ".tran 1m 1m\n"
      ".meas peak MAX i(R1)\n"
      ".meas charge INTEG i(R1)\n"
      ".meas energy INTEG i(R1)*v(in,a)\n"
      ".meas rise TRIG v(a)=0.1 RISE=1 TARG v(a)=0.9 RISE=1\n");
  REQUIRE(m.messages.empty());
  CHECK(m.value.at("peak") == near(1.0));
  // 1 A − 1 A leaves rounding of 1e-16 A, over 1 ms 1e-19 C beside 1e-12 C.
  CHECK(m.value.at("charge") == near(1e-12, 1e-6));
  CHECK(m.value.at("energy") == near(0.5e-12));
  CHECK(m.value.at("rise") == near(1e-12 * std::log(9.0)));
}

TEST_CASE("a buck converter in discontinuous conduction: output voltage and efficiency", "[unit]") {
  // Ideal: M = 2/(1 + √(1 + 4K/D²)), K = 2L/(R T) (Erickson & Maksimović, Fundamentals of Power Electronics, eq. 5.20), and nothing is lost. The output is a
  // source here, so that the ratio holds without ripple: the mean current through it is V_out/R at that ratio.
  const double d = 0.4, period = 10e-6, inductance = 10e-6, resistance = 10.0;
  const double k = 2.0 * inductance / (resistance * period);
  const double ratio = 2.0 / (1.0 + std::sqrt(1.0 + 4.0 * k / (d * d)));
  const Measured m = measure_deck(
      "buck\n"
      "V1 in 0 12\n"
      "S1 in sw g 0 SI\n"
      "Vg g 0 PULSE(0 1 0 0 0 4u 10u)\n"
      "D1 0 sw DI\n"
      "L1 sw out 10u\n"
      "V2 out 0 " +
      std::to_string(12.0 * ratio) +
      "\n"
      ".model SI SW(Vt=0.5)\n"
      ".model DI D\n"
      ".tran 10u 100u\n"
      ".meas pin AVG -v(in)*i(V1)\n"
      ".meas pout AVG v(out)*i(V2)\n"
      ".meas eta PARAM pout/pin\n"
      ".meas load AVG i(V2)\n"
      ".meas peak MAX i(L1)\n"
      ".meas idle WHEN i(L1)=0 FALL=1\n");
  REQUIRE(m.messages.empty());
  constexpr double printed = 1e-6;  // to_string keeps six decimals of the output voltage
  CHECK(m.value.at("eta") == near(1.0, 1e-11));
  CHECK(m.value.at("load") == near(12.0 * ratio / resistance, 10.0 * printed));
  CHECK(m.value.at("peak") == near((12.0 - 12.0 * ratio) / inductance * d * period, printed));
  CHECK(m.value.at("idle") == near(d * period / ratio, printed));  // volt-seconds balance
  CHECK(m.result("pin").unit == "W");
  CHECK(m.result("eta").unit.empty());
}

TEST_CASE("parts of the circuit without a common state meet in one expression", "[unit]") {
  const Measured m = measure_deck(
      "two islands\n"
      "V1 a 0 SIN(0 1 50)\n"
      "D1 a b DI\nR1 b 0 1\n"
      "V2 c 0 PULSE(0 1 0 0 0 5m 20m)\n"
      "R2 c 0 1\n"
      ".model DI D\n"
      ".tran 1m 20m\n"
      ".save v(c)\n"
      ".meas product AVG v(b)*v(c)\n"
      ".meas sum MAX v(b)+v(c)\n");
  REQUIRE(m.messages.empty());
  CHECK(m.value.at("product") == near(1.0 / (2.0 * pi)));  // a quarter of a sine of 20 ms: 20 ms/2π
  CHECK(m.value.at("sum") == near(2.0));
}

// The inductor holds 1 A; of the step of 1 µA the resistor's share is R·1 µA once R·C = 13 ps has passed and long before L/R = 50 s has. The rounding of what
// cancels in v(a) once kept pieces at the length of R·C: 10^8 of them.
TEST_CASE("a signal that is a small difference is measured beside a fast time constant", "[unit]") {
  const Measured m = measure_deck(
      "a step of a millionth\nI1 0 a PULSE(1 1.000001 100n)\nL1 a 0 1\nC1 a 0 668p\nR1 a 0 20m\n.save v(a)\n.tran 0.1m 1m\n.meas top MAX "
      "v(a)\n");
  constexpr double cancellation = 5e-9;  // 1e-16 of 1 A, against 1 µA, fifty times
  REQUIRE(m.messages.empty());
  CHECK(m.value.at("top") == near(20e-3 * 1e-6, cancellation));
}

// Found by tests/random_decks: the rounding of large states excites the fast mode in each interval anew, and so kept them short. max x = -min(-x).
TEST_CASE("a circuit with states of very different sizes is measured", "[unit]") {
  const Measured m = measure_deck(
      "random deck 41298\n"
      "V1 in out SIN(0 10.5 279) Rser=121\n"
      "C2 0 a 7.38e-08\n"
      "R3 0 b 680\n"
      "R4 a out 1.63e+03\n"
      "L5 0 in 36.3m\n"
      "R6 out n1 279\n"
      ".model mPNP7 PNP( RC=1 RE=0.1 VAF=100 )\n"
      "Q8 out in 0 mPNP7\n"
      "R10 o9 a 407\n"
      "H11 o9 0 R3 -6.56\n"
      "R12 b 0 R=10.7k\n"
      "C13 in a 4.66e-08 ic=-4.3\n"
      "B14 b o9 I={if(-10.6>=V(0),table(V(o9),-2.57,-2.81,-1.7,-1.33,-1.7,-0.468),limit(2.54*V(n1),-2.71,2.71))}\n"
      "C15 in out 674n\n"
      "C16 0 n1 C=3.07e-06 ic=-15.3\n"
      "F17 o9 b value={2.14*i(C15)}\n"
      "L18 o9 n1 3.31\n"
      "B19 a in I={1.48*V(out,n1)-1.76*v(b)}\n"
      ".tran 429u 8.87m uic\n"
      ".options max_rows=3000\n"
      ".options nonunique=first\n"
      ".options nonunique=stay\n"
      ".meas top MAX v(in)\n"
      ".meas low MIN -v(in)\n");
  REQUIRE(m.messages.empty());
  CHECK(m.value.at("top") == -m.value.at("low"));
}

TEST_CASE("an interrupted run gives no value to what it has not measured", "[unit]") {
  const std::atomic<int> interrupt = 1;
  const Measured m = measure_deck(
      "ring\nV1 in 0 SIN(0 1 1meg)\nR1 in 0 1\n.tran 1 20\n.save v(in)\n.meas tran whole INTEG v(in)\n.meas tran late INTEG v(in) FROM=11 "
      "TO=12\n",
      0.0, &interrupt);
  CHECK(m.value.empty());
}

// v(n1) is rounding after 10⁻¹⁵ s, somewhat more of it than eight units, and asked for pieces of picoseconds. Integrals are additive.
TEST_CASE("a signal that is rounding beside a very fast time constant does not hold the measurements up", "[unit]") {
  const Measured m = measure_deck(
      "rounding\nV1 out n1 SIN(117 35.1 653m) Rser=105\nR2 a 0 4.93\nR3 b a 9.3\nC4 out 0 336m\nC5 in out 327m\nV6 in n1 EXP(58.7 17 0.418 "
      "2.03 2.29 4.9)\n"
      "R7 n1 a 8.2e-15\n.model mPJF8 PJF( Beta=1m Is=1e-14 )\nJ9 a b in mPJF8\nL10 a in L=0.62\n.model mVSWITCH11 VSWITCH( Von=-76.6 )\n"
      "S12 in out 0 a mVSWITCH11\n.model mD13 D( )\nD14 a 0 mD13 m=2\nR15 0 n1 29.4\n.model mNPN16 NPN IS=1e-15 BR=2 RC=1 RE=0.1 VAF=100 "
      "I0=1m\n"
      "Q17 0 0 a mNPN16\nR19 a o18 196\nH20 o18 0 D14 -1.39\n.tran 368m 7.8 uic\n.save v(in)\n"
      ".meas tran passes TRIG V(n1)=-62.7 TARG I(C4)=141 RISE=7\n.meas tran whole INTEG time*v(in)\n"
      ".meas tran first INTEG time*v(in) TO=3.9\n.meas tran second INTEG time*v(in) FROM=3.9\n");
  CHECK(m.value.at("whole") == near(m.value.at("first") + m.value.at("second")));
}

TEST_CASE("the sparse engine measures to its tolerance", "[unit]") {
  const std::string deck = charging +
                           ".meas tran mean AVG v(out)\n"
                           ".meas tran half WHEN v(out)=0.5\n"
                           ".meas tran energy INTEG v(in,out)*i(R1)\n"
                           ".meas tran edge WHEN v(in)=0.5 RISE=1\n";
  constexpr double reltol = 1e-7;
  constexpr double tolerance = 100.0 * reltol;  // errors of steps add up
  const Measured m = measure_deck(deck, reltol);
  REQUIRE(m.messages.empty());
  CHECK(m.value.at("mean") == near(area(0.0, 5e-3) / 5e-3, tolerance));
  CHECK(m.value.at("half") == near(tau * std::log(2.0), tolerance));
  CHECK(m.value.at("energy") == near(1e-3 * 0.5 * tau * (1.0 - std::exp(-10.0)), tolerance));
  CHECK(m.value.at("edge") == 0.0);
}
