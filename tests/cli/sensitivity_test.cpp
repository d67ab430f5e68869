// .sens: derivatives of measurements against those of closed forms, differentiated by hand.

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "cli/run_in.hpp"
#include "support/json.hpp"

using namespace pwlsim::test;
using Catch::Matchers::Contains;

namespace {

constexpr double wanted = 1e-9;  ///< relative

Json sensitivities_of(const Scratch& scratch, const std::string& deck, int status = 0) {
  scratch.write("deck.net", deck);
  const Finished finished = run_in(scratch, {"deck.net", "--json"});
  INFO(finished.err);
  REQUIRE(finished.status == status);
  return read_json(finished.out);
}

Json entry(const Json& result, const std::string& measurement, const std::string& parameter) {
  for (const Json& s : result["sensitivities"].array)
    if (s["measurement"].string == measurement && s["parameter"].string == parameter) return s;
  FAIL("no derivative of " << measurement << " to " << parameter);
  return {};
}

double derivative(const Json& result, const std::string& measurement, const std::string& parameter) {
  const Json d = entry(result, measurement, parameter);
  INFO(measurement << " to " << parameter << ": " << d["failure"].string);
  CHECK(d["failure"].string.empty());
  CHECK(d["left"].number == d["right"].number);
  return d["derivative"].number;
}

}  // namespace

TEST_CASE("derivatives of an RC circuit from an initial value are those of its exponential", "[unit]") {
  // v = V + (v0 − V) e^{−x}, x = t/RC
  const Scratch scratch;
  const Json result = sensitivities_of(scratch,
                                       "rc\n.param r=1k V=10\nV1 in 0 {V}\nR1 in out {r}\nC1 out 0 1u ic=2\n.tran 1u 2m uic\n"
                                       ".meas tran end FIND v(out) AT=1m\n.meas tran mean AVG v(out)\n.meas tran t5 WHEN v(out)=5\n"
                                       ".meas tran e INTEG v(in)*i(R1)\n.meas tran top MAX v(out)\n.meas tran twice PARAM='2*end+mean'\n"
                                       ".sens param=r,V,R1,C1,ic(C1)\n.end\n");
  const double R = 1e3, C = 1e-6, V = 10.0, v0 = 2.0, t = 1e-3, T = 2e-3, tau = R * C;
  const double x = t / tau, fall = std::exp(-x), end = std::exp(-T / tau);
  const double to_tau = (v0 - V) * fall * x / tau;
  CHECK(derivative(result, "end", "r") == Approx(to_tau * C).epsilon(wanted));
  CHECK(derivative(result, "end", "R1") == Approx(to_tau * C).epsilon(wanted));
  CHECK(derivative(result, "end", "C1") == Approx(to_tau * R).epsilon(wanted));
  CHECK(derivative(result, "end", "V") == Approx(1.0 - fall).epsilon(wanted));
  CHECK(derivative(result, "end", "ic(C1)") == Approx(fall).epsilon(wanted));
  // mean = V + (v0 − V) τ/T (1 − e^{−T/τ})
  const double mean_to_tau = (v0 - V) * ((1.0 - end) / T - end / tau);
  CHECK(derivative(result, "mean", "R1") == Approx(mean_to_tau * C).epsilon(wanted));
  CHECK(derivative(result, "mean", "C1") == Approx(mean_to_tau * R).epsilon(wanted));
  CHECK(derivative(result, "mean", "V") == Approx(1.0 - tau / T * (1.0 - end)).epsilon(wanted));
  // t5 = τ ln((V − v0)/(V − 5))
  CHECK(derivative(result, "t5", "R1") == Approx(C * std::log((V - v0) / (V - 5.0))).epsilon(wanted));
  CHECK(derivative(result, "t5", "V") == Approx(tau * (1.0 / (V - v0) - 1.0 / (V - 5.0))).epsilon(wanted));
  CHECK(derivative(result, "t5", "ic(C1)") == Approx(-tau / (V - v0)).epsilon(wanted));
  // e = V C (V − v0)(1 − e^{−T/τ})
  CHECK(derivative(result, "e", "V") == Approx(C * (2.0 * V - v0) * (1.0 - end)).epsilon(wanted));
  CHECK(derivative(result, "e", "C1") == Approx(V * (V - v0) * (1.0 - end - T / tau * end)).epsilon(wanted));
  CHECK(derivative(result, "top", "R1") == Approx((v0 - V) * end * T / tau * C / tau).epsilon(wanted));
  CHECK(derivative(result, "twice", "r") == Approx(2.0 * to_tau * C + mean_to_tau * C).epsilon(wanted));
  const double normalised = entry(result, "end", "r")["normalised"].number, v = V + (v0 - V) * fall;
  CHECK(normalised == Approx(R / v * to_tau * C).epsilon(wanted));
}

TEST_CASE("what .ic says moves, and keeps its charge where a capacitance moves", "[unit]") {
  // v = v0 e^{−t/RC}; i = i0 e^{−t R2/L}.
  const Scratch scratch;
  const Json result = sensitivities_of(scratch,
                                       "ic\n.param v0=3 i0=2\nR1 b 0 1k\nC1 b 0 1u\nL1 c 0 1m\nR2 c 0 1\n.ic v(b)={v0} i(L1)={i0*i0}\n"
                                       ".tran 1u 2m uic\n.meas tran v FIND v(b) AT=1m\n.meas tran i FIND i(L1) AT=1m\n"
                                       ".sens param=v0,i0,C1,R1,L1\n.end\n");
  const double fall = std::exp(-1.0);
  CHECK(derivative(result, "v", "v0") == Approx(fall).epsilon(wanted));
  CHECK(derivative(result, "v", "i0") == 0.0);
  CHECK(derivative(result, "v", "R1") == Approx(3.0 * fall / 1e3).epsilon(wanted));
  CHECK(derivative(result, "v", "C1") == Approx(3.0 * fall / 1e-6).epsilon(wanted));
  CHECK(derivative(result, "i", "i0") == Approx(4.0 * fall).epsilon(wanted));
  CHECK(derivative(result, "i", "L1") == Approx(4.0 * fall / 1e-3).epsilon(wanted));
}

TEST_CASE("points of PWL move: values, times, the delay", "[unit]") {
  // A triangle of height v from 0 to b through an RC circuit of τ = 1 ms, read at T behind it:
  // y = v e^{−T/τ} [τ/a ((a/τ − 1) e^{a/τ} + 1) + τ/(b − a) (e^{b/τ} − e^{a/τ} (1 + (b − a)/τ))].
  const Scratch scratch;
  const Json result =
      sensitivities_of(scratch,
                       "pwl\n.param a=1m b=3m v=5 d=0\nV1 in 0 PWL(0 0 {a} {v} {b} 0) \nR1 in out 1k\nC1 out 0 1u\n"
                       "V2 q 0 PWL(0 0 {a} 0 {a} {v}) td={d}\nR2 q p 1k\nC2 p 0 1u\n.tran 1u 5m uic\n.meas tran y FIND v(out) AT=4m\n"
                       ".meas tran area INTEG v(in)\n.meas tran late INTEG v(q)\n.meas tran step FIND v(p) AT=4m\n"
                       ".sens param=a,b,v,d\n.end\n");
  const double a = 1e-3, b = 3e-3, v = 5.0, tau = 1e-3, T = 4e-3;
  const double fall = std::exp(-T / tau), ea = std::exp(a / tau), eb = std::exp(b / tau), w = b - a;
  const double rise = tau / a * ((a / tau - 1.0) * ea + 1.0), drop = tau / w * (eb - ea * (1.0 + w / tau));
  // Both by hand: ∂(rise)/∂a and ∂(drop)/∂a, ∂(drop)/∂b.
  const double rise_a = -rise / a + tau / a * (a / tau * ea / tau);
  const double drop_b = -drop / w + tau / w * (eb / tau - ea / tau);
  const double drop_a = drop / w + tau / w * (-ea / tau * (1.0 + w / tau) + ea / tau);
  CHECK(derivative(result, "y", "v") == Approx(fall * (rise + drop)).epsilon(wanted));
  CHECK(derivative(result, "y", "a") == Approx(v * fall * (rise_a + drop_a)).epsilon(wanted));
  CHECK(derivative(result, "y", "b") == Approx(v * fall * drop_b).epsilon(wanted));
  CHECK(derivative(result, "area", "v") == Approx(0.5 * b).epsilon(wanted));
  CHECK(derivative(result, "area", "b") == Approx(0.5 * v).epsilon(wanted));
  CHECK(std::abs(derivative(result, "area", "a")) <= 1e-9 * v);
  // The step lies at a + d: area v (5 ms − a − d), response v (1 − e^{−(T − a − d)/τ}).
  const double after = std::exp(-(T - a) / tau);
  CHECK(derivative(result, "late", "v") == Approx(5e-3 - a).epsilon(wanted));
  CHECK(derivative(result, "late", "a") == Approx(-v).epsilon(wanted));
  CHECK(derivative(result, "late", "d") == Approx(-v).epsilon(wanted));
  CHECK(derivative(result, "step", "a") == Approx(-v * after / tau).epsilon(wanted));
  CHECK(derivative(result, "step", "d") == Approx(-v * after / tau).epsilon(wanted));
}

TEST_CASE("points of a PWL that repeats move in steady state", "[unit]") {
  // A sawtooth of height v and period p: mean v/2; through an RC circuit the mean is the same, and at its end
  // y = v [1 − τ/p] + v e^{−p/τ}/(1 − e^{−p/τ})·(−1)·… : y(p) = v − v τ/p + (y₀ + v τ/p) e^{−p/τ}, y₀ = y(p).
  const Scratch scratch;
  const Json result = sensitivities_of(scratch,
                                       "saw\n.param p=2m v=4\nV1 in 0 PWL(0 0 {p} {v} {p} 0) r=0\nR1 in out 1k\nC1 out 0 1u\n.pss\n"
                                       ".meas pss mean AVG v(out)\n.meas pss t PERIOD\n.meas pss top MAX v(out)\n.sens param=p,v\n.end\n");
  const double p = 2e-3, v = 4.0, tau = 1e-3, e = std::exp(-p / tau);
  // (1 − e) y = v − v τ/p (1 − e)
  const double y_p = v * (tau / (p * p)) - v * e / tau / ((1.0 - e) * (1.0 - e));
  CHECK(derivative(result, "mean", "v") == Approx(0.5).epsilon(wanted));
  CHECK(std::abs(derivative(result, "mean", "p")) <= 1e-9 * v / p);
  CHECK(derivative(result, "t", "p") == Approx(1.0).epsilon(wanted));
  CHECK(derivative(result, "top", "v") == Approx(1.0 / (1.0 - e) - tau / p).epsilon(wanted));
  CHECK(derivative(result, "top", "p") == Approx(y_p).epsilon(wanted));
}

TEST_CASE("the gain of an amplifier whose reference is a source of its own", "[unit]") {
  // e = A (r − e/2): e = A r/(1 + A/2).
  const Scratch scratch;
  const Json result =
      sensitivities_of(scratch,
                       "loop\nVr r 0 2\nE1 e 0 r f 10\nR1 e f 1k\nR2 f 0 1k\nC1 f 0 1n\n.tran 1u 1m\n.meas tran e AVG v(e)\n"
                       ".sens param=E1,Vr\n.end\n");
  CHECK(derivative(result, "e", "E1") == Approx(2.0 / 36.0).epsilon(wanted));
  CHECK(derivative(result, "e", "Vr") == Approx(10.0 / 6.0).epsilon(wanted));
}

TEST_CASE("a chopper in steady state: duty cycle, frequency and inductance move its ripple", "[unit]") {
  // i rises towards V/R for DT and falls towards 0: top = V/R (1 − e^{−DT/τ})/(1 − e^{−T/τ}), mean = D V/R.
  const Scratch scratch;
  const Json result =
      sensitivities_of(scratch,
                       "chopper\n.param fs=10k D=0.4 L=1m\nV1 in 0 20\nS1 in a g 0 SX\nD1 0 a DX\nL1 a b {L}\nR1 b 0 5\n"
                       "Vg g 0 PULSE(0 1 0 0 0 {D/fs} {1/fs})\n.model SX SW(Ron=0 Vt=0.5 Vh=0)\n.model DX D\n.pss\n"
                       ".meas pss mean AVG i(L1)\n.meas pss top MAX i(L1)\n.meas pss rms RMS i(L1)\n.meas pss t PERIOD\n"
                       ".meas pss pin AVG v(in)*i(V1)\n.meas pss half FIND i(L1) AT={0.5/fs}\n.sens param=fs,D,L,V1,R1\n.end\n");
  const double V = 20.0, R = 5.0, L = 1e-3, D = 0.4, T = 1e-4, tau = L / R, fs = 1e4;
  const double a = std::exp(-D * T / tau), b = std::exp(-T / tau), top = V / R * (1.0 - a) / (1.0 - b);
  const double to_d = V / R * a * T / tau / (1.0 - b);
  // By T at fixed D, and by τ.
  const double to_T = V / R * (a * D / tau * (1.0 - b) - (1.0 - a) * b / tau) / ((1.0 - b) * (1.0 - b));
  const double to_tau = -to_T * T / tau;
  CHECK(derivative(result, "mean", "D") == Approx(V / R).epsilon(wanted));
  CHECK(std::abs(derivative(result, "mean", "fs")) <= 1e-12 * V / R / fs * 1e3);
  CHECK(std::abs(derivative(result, "mean", "L")) <= 1e-9 * V / R / L);
  CHECK(derivative(result, "mean", "V1") == Approx(D / R).epsilon(wanted));
  CHECK(derivative(result, "mean", "R1") == Approx(-D * V / (R * R)).epsilon(wanted));
  CHECK(derivative(result, "top", "D") == Approx(to_d).epsilon(wanted));
  CHECK(derivative(result, "top", "fs") == Approx(-to_T * T / fs).epsilon(wanted));
  CHECK(derivative(result, "top", "L") == Approx(to_tau / R).epsilon(wanted));
  CHECK(derivative(result, "top", "R1") == Approx(-top / R - to_tau * L / (R * R)).epsilon(wanted));
  CHECK(derivative(result, "t", "fs") == Approx(-1.0 / (fs * fs)).epsilon(wanted));
  // At T/2 the current falls from its top: i = top e^{−(1/2 − D)T/τ}
  const double decay = std::exp(-(0.5 - D) * T / tau);
  CHECK(derivative(result, "half", "D") == Approx((to_d + top * T / tau) * decay).epsilon(wanted));
  CHECK(derivative(result, "half", "fs") == Approx(-(to_T - top * (0.5 - D) / tau) * decay * T / fs).epsilon(wanted));
}

TEST_CASE("discontinuous conduction: the diode's turn-off moves with everything", "[unit]") {
  // i = (V − E) DT/L at the edge, then falls by E/L: mean = (V − E) V D² T/(2 L E)
  const Scratch scratch;
  const Json result = sensitivities_of(scratch,
                                       "dcm\n.param fs=10k D=0.3\nV1 in 0 20\nS1 in a g 0 SX\nD1 0 a DX\nL1 a b 1m\nV2 b 0 8\n"
                                       "Vg g 0 PULSE(0 1 0 0 0 {D/fs} {1/fs})\n.model SX SW(Ron=0 Vt=0.5 Vh=0)\n.model DX D\n.pss\n"
                                       ".meas pss mean AVG i(L1)\n.meas pss top MAX i(L1)\n.sens param=fs,D,L1,V1,V2\n.end\n");
  const double V = 20.0, E = 8.0, D = 0.3, T = 1e-4, L = 1e-3, fs = 1e4, mean = (V - E) * V * D * D * T / (2.0 * L * E),
               top = (V - E) * D * T / L;
  CHECK(derivative(result, "mean", "fs") == Approx(-mean / fs).epsilon(wanted));
  CHECK(derivative(result, "mean", "D") == Approx(2.0 * mean / D).epsilon(wanted));
  CHECK(derivative(result, "mean", "L1") == Approx(-mean / L).epsilon(wanted));
  CHECK(derivative(result, "mean", "V1") == Approx((2.0 * V - E) * D * D * T / (2.0 * L * E)).epsilon(wanted));
  CHECK(derivative(result, "mean", "V2") == Approx(-V * V * D * D * T / (2.0 * L * E * E)).epsilon(wanted));
  CHECK(derivative(result, "top", "D") == Approx(top / D).epsilon(wanted));
  CHECK(derivative(result, "top", "V2") == Approx(-D * T / L).epsilon(wanted));
}

TEST_CASE("a relay oscillator: the period moves with thresholds and elements", "[unit]") {
  // Charged through R + R2 towards Vcc, discharged through R: T = (R + R2) C ln((Vcc − l)/(Vcc − h)) + R C ln(h/l), h = Vt + Vh, l = Vt − Vh.
  const Scratch scratch;
  const Json result = sensitivities_of(
      scratch,
      "relay\n.param R=1k C=100n Vt=2 Vh=1 Vcc=5\nV1 vcc 0 {Vcc}\nR1 o a {R}\nC1 a 0 {C}\nS1 o 0 a 0 SM\nR2 vcc o 2k\n"
      ".model SM SW(Ron=0 Vt={Vt} Vh={Vh})\n.pss on=S1\n.meas pss t PERIOD\n.meas pss on TRIG v(a) VAL=2 RISE=1 TARG v(a) VAL=2 FALL=1\n"
      ".sens param=R,C,Vt,Vh,Vcc,R2,S1:Vt\n.end\n");
  const double R = 1e3, R2 = 2e3, C = 1e-7, Vcc = 5.0, h = 3.0, l = 1.0;
  const double charge = std::log((Vcc - l) / (Vcc - h)), discharge = std::log(h / l);
  const double to_h = (R + R2) * C / (Vcc - h) + R * C / h, to_l = -(R + R2) * C / (Vcc - l) - R * C / l;
  CHECK(derivative(result, "t", "R") == Approx(C * (charge + discharge)).epsilon(wanted));
  CHECK(derivative(result, "t", "R2") == Approx(C * charge).epsilon(wanted));
  CHECK(derivative(result, "t", "C") == Approx((R + R2) * charge + R * discharge).epsilon(wanted));
  CHECK(derivative(result, "t", "Vt") == Approx(to_h + to_l).epsilon(wanted));
  CHECK(derivative(result, "t", "S1:Vt") == Approx(to_h + to_l).epsilon(wanted));
  CHECK(derivative(result, "t", "Vh") == Approx(to_h - to_l).epsilon(wanted));
  CHECK(derivative(result, "t", "Vcc") == Approx((R + R2) * C * (1.0 / (Vcc - l) - 1.0 / (Vcc - h))).epsilon(wanted));
  // The period begins with the closing: down from h through 2 V and l, then up through 2 V. TARG lies before TRIG.
  CHECK(derivative(result, "on", "R2") == Approx(-C * std::log((Vcc - l) / (Vcc - 2.0))).epsilon(wanted));
}

TEST_CASE("two capacitors share their charge: the jump moves with both", "[unit]") {
  // v = C1 V0/(C1 + C2) behind the closing
  const Scratch scratch;
  const Json result = sensitivities_of(
      scratch,
      "sharing\n.param V0=5\nC1 a 0 1u ic={V0}\nC2 b 0 3u ic=0\nS1 a b g 0 SX\nVg g 0 PULSE(0 1 1m 0 0 9m)\n.model SX SW(Ron=0 Vt=0.5)\n"
      ".tran 10u 2m uic\n.meas tran v FIND v(b) AT=1.5m\n.meas tran mean AVG v(b)\n.sens param=V0,C1,C2,ic(C1),Vg:Td\n.end\n");
  const double C1 = 1e-6, C2 = 3e-6, V0 = 5.0, s = C1 + C2, v = C1 * V0 / s;
  CHECK(derivative(result, "v", "V0") == Approx(C1 / s).epsilon(wanted));
  CHECK(derivative(result, "v", "ic(C1)") == Approx(C1 / s).epsilon(wanted));
  CHECK(derivative(result, "v", "C1") == Approx(V0 * C2 / (s * s)).epsilon(wanted));
  CHECK(derivative(result, "v", "C2") == Approx(-V0 * C1 / (s * s)).epsilon(wanted));
  CHECK(derivative(result, "mean", "Vg:Td") == Approx(-v / 2e-3).epsilon(wanted));
  CHECK(derivative(result, "mean", "C2") == Approx(-V0 * C1 / (s * s) * 0.5).epsilon(wanted));
}

TEST_CASE("a peak detector holds the amplitude", "[unit]") {
  // v = A − Vfwd from the first peak on
  const Scratch scratch;
  const Json result = sensitivities_of(scratch,
                                       "peak\nV1 in 0 SIN(0 10 50)\nD1 in out DX\nC1 out 0 1u\n.model DX D(Vfwd=0.7)\n.tran 10u 12m\n"
                                       ".meas tran v FIND v(out) AT=12m\n.sens param=V1:Vamp,V1:Freq,D1:Vfwd,C1\n.end\n");
  CHECK(derivative(result, "v", "V1:Vamp") == Approx(1.0).epsilon(1e-9));
  CHECK(derivative(result, "v", "D1:Vfwd") == Approx(-1.0).epsilon(1e-9));
  CHECK(std::abs(derivative(result, "v", "V1:Freq")) < 1e-7 * 10.0 / 50.0);
  CHECK(std::abs(derivative(result, "v", "C1")) < 1e-9 * 10.0 / 1e-6);
}

TEST_CASE("the run starts at an operating point that moves", "[unit]") {
  // A divider holds V/2 across C; a step in the current source discharges it: v = V/2 + (I R/2)(1 − e^{−t/τ}), τ = RC/2
  const Scratch scratch;
  const Json result =
      sensitivities_of(scratch,
                       "divider\nV1 in 0 10\nR1 in out 1k\nR2 out 0 1k\nC1 out 0 1u\nI1 0 out PULSE(0 1m 0 0 0 1)\n.tran 1u 1m\n"
                       ".meas tran v FIND v(out) AT=0.5m\n.sens param=V1,R1,C1,I1:V2\n.end\n");
  const double V = 10.0, R = 1e3, C = 1e-6, t = 0.5e-3, I = 1e-3;
  // With R1 = R2 = R: v∞ = (V/R1 + I) P, P = R1 R2/(R1 + R2), v(0) = V P/R1, τ = P C
  const double P = 0.5 * R, tau = P * C, e = std::exp(-t / tau), P1 = 0.25;  // dP/dR1 = (R2/(R1 + R2))²
  CHECK(derivative(result, "v", "V1") == Approx(0.5).epsilon(wanted));
  CHECK(derivative(result, "v", "I1:V2") == Approx(P * (1.0 - e)).epsilon(wanted));
  CHECK(derivative(result, "v", "C1") == Approx(-I * P * e * t / (tau * C)).epsilon(wanted));
  // v = V P/R1 + I P (1 − e^{−t/PC})
  const double to_r1 = V * (P1 / R - P / (R * R)) + I * P1 * (1.0 - e) - I * P * e * t / (P * P * C) * P1;
  CHECK(derivative(result, "v", "R1") == Approx(to_r1).epsilon(wanted));
}

TEST_CASE("parameters act through expressions, functions and calls of subcircuits", "[unit]") {
  const Scratch scratch;
  const Json result = sensitivities_of(
      scratch,
      "subcircuit\n.param k=2 g=3\n.func twice(x) {2*x+k}\nV1 in 0 {sqrt(k)*10}\nX1 in out leg r={k*1k}\n"
      ".subckt leg a b r=1\nR1 a b {r}\nR2 b 0 {twice(r)}\n.ends\nE1 y 0 out 0 {k^2}\nR9 y 0 1\n.tran 1u 10u\n"
      ".meas tran v FIND v(out) AT=5u\n.meas tran y FIND v(y) AT=5u\n.meas tran z PARAM='y*k'\n.sens param=k,g,X1.R2\n.end\n");
  // R1 = 1000 k, R2 = 2001 k, V = 10 √k: v = 10 √k·2001/3001; y = k² v
  const double k = 2.0, share = 2001.0 / 3001.0, v = 10.0 * std::sqrt(k) * share;
  CHECK(derivative(result, "v", "k") == Approx(0.5 * v / k).epsilon(wanted));
  CHECK(derivative(result, "y", "k") == Approx(2.5 * k * k * v / k).epsilon(wanted));
  CHECK(derivative(result, "z", "k") == Approx(3.5 * k * k * v).epsilon(wanted));
  CHECK(derivative(result, "v", "g") == 0.0);
  CHECK(derivative(result, "v", "X1.R2") == Approx(10.0 * std::sqrt(k) * 2000.0 / (6002.0 * 6002.0)).epsilon(wanted));
}

TEST_CASE("an edge at the begin of a window: the derivative is one-sided", "[unit]") {
  // From 1 ms to 2 ms the source is at 1 V; a later edge takes of it, an earlier one does not add: −1 V/1 ms to the right, 0 to the left, and
  // at the end of the window it falls at 2 ms, which an earlier edge moves into it.
  const Scratch scratch;
  scratch.write(
      "deck.net",
      "window\nV1 in 0 PULSE(0 1 1m 0 0 5m 20m)\nR1 in 0 1k\n.tran 1u 4m\n.meas tran v AVG v(in) FROM=1m TO=2m\n.sens param=V1:Td\n.end\n");
  const Finished finished = run_in(scratch, {"deck.net", "--json"});
  REQUIRE(finished.status == 0);
  const Json result = read_json(finished.out);
  const Json d = entry(result, "v", "V1:Td");
  CHECK(d["left"].number == Approx(0.0).margin(1e-9));
  CHECK(d["right"].number == Approx(-1000.0).epsilon(wanted));
  CHECK_THAT(finished.err, Contains("W-sens-one-sided"));
}

// An edge at t = 0 is a passage for the measurement, and one for its derivative: the third rise lies at 2/f.
TEST_CASE("an edge at the start counts as a passage", "[unit]") {
  const Scratch scratch;
  const std::string deck =
      "edges\n.param f=100k\nVg g 0 PULSE(0 1 0 0 0 4u {1/f})\nR1 g 0 1k\n.tran 0 100.5u\n.meas tran w WHEN v(g)=0.5 RISE=3\n"
      ".meas tran a AVG v(g) LAST=5 PERIODS OF Vg\n.sens param=f,Vg:Tper\n.end\n";
  const Json result = sensitivities_of(scratch, deck);
  CHECK(derivative(result, "w", "f") == Approx(-2e-10).epsilon(wanted));
  // Five pulses of 4 µs in 5/f: 4 µs·f; the window's begin moves with the period.
  CHECK(derivative(result, "a", "f") == Approx(4e-6).epsilon(wanted));
  CHECK(derivative(result, "a", "Vg:Tper") == Approx(-4e-6 * 1e10).epsilon(wanted));
}

namespace {

void check_sides(const Json& result, const std::string& measurement, const std::string& parameter, double left, double right) {
  const Json d = entry(result, measurement, parameter);
  INFO(measurement << " to " << parameter << ": " << d["failure"].string);
  CHECK(d["failure"].string.empty());
  CHECK(d["left"].number == Approx(left).epsilon(wanted).margin(1e-12));
  CHECK(d["right"].number == Approx(right).epsilon(wanted).margin(1e-12));
}

}  // namespace

TEST_CASE("an edge at the end of the run: the derivative is one-sided", "[unit]") {
  // The pulse of 1 V ends at Tstop = 3 ms: a shorter one takes 1 V/3 ms of the mean, a longer one adds nothing. Values at its end jump.
  const Scratch scratch;
  const Json result = sensitivities_of(
      scratch,
      "end\nV1 in 0 PULSE(0 1 1m 0 0 2m 20m)\nR1 in 0 1k\n.tran 1u 3m\n.meas tran v AVG v(in)\n.meas tran e FIND v(in) AT=3m\n"
      ".sens param=V1:Ton,V1:Td\n.end\n");
  check_sides(result, "v", "V1:Ton", 1000.0 / 3.0, 0.0);
  check_sides(result, "v", "V1:Td", 0.0, -1000.0 / 3.0);
  CHECK_THAT(entry(result, "e", "V1:Ton")["failure"].string, Contains("V1 has an edge at t = 0.003 s"));
}

TEST_CASE("a corner at the begin of a window: extremes are one-sided", "[unit]") {
  // Ramps of 1 V/ms from 0 to 1 V at 2 ms, and back: its top lies at the begin of the window. Later it lies in the window, of the same height; earlier
  // the window begins behind it, 1 V/ms lower.
  const Scratch scratch;
  const Json result =
      sensitivities_of(scratch,
                       "corner\nV1 in 0 PULSE(0 1 1m 1m 1m 0 20m)\nR1 in 0 1k\nL1 in x 1\nR2 x 0 1\n.tran 1u 4m\n"
                       ".meas tran m MAX v(in) FROM=2m TO=4m\n.meas tran n MIN v(in) FROM=1.5m TO=2m\n.sens param=V1:Td\n.end\n");
  check_sides(result, "m", "V1:Td", 1000.0, 0.0);
  CHECK(derivative(result, "n", "V1:Td") == Approx(-1000.0).epsilon(wanted));
}

TEST_CASE("values that tie: the largest is one-sided", "[unit]") {
  // max(10 + Voff, 10 − Voff)
  const Scratch scratch;
  scratch.write("deck.net",
                "tie\nV1 in 0 SIN(0 10 50)\nR1 in 0 1k\n.tran 1u 40m\n.meas tran m MAX abs(v(in))\n.meas tran p PP v(in)\n"
                ".meas tran h MAX v(in)\n.sens param=V1:Voff,V1:Vamp\n.end\n");
  const Finished finished = run_in(scratch, {"deck.net", "--json"});
  const Json result = read_json(finished.out);
  check_sides(result, "m", "V1:Voff", -1.0, 1.0);
  CHECK_THAT(finished.err, Contains("W-sens-one-sided") && Contains("its largest value occurs at t ="));
  CHECK(derivative(result, "m", "V1:Vamp") == Approx(1.0).epsilon(wanted));
  CHECK(derivative(result, "p", "V1:Vamp") == Approx(2.0).epsilon(wanted));
  CHECK(derivative(result, "h", "V1:Voff") == Approx(1.0).epsilon(wanted));
}

TEST_CASE("the current of a converter reaches zero just at an edge: the derivative is one-sided", "[unit]") {
  // On the border of both conductions, V DT = E T. Discontinuous: every period has the mean (V − E) V D² T/(2 L E). Continuous: what a period adds
  // stays; a change of V raises the current by DT/L in each, in the mean of the n-th by (n + 1 − D/2) DT/L, and of E lowers it by T/L, n + 1/2.
  const Scratch scratch;
  scratch.write("deck.net",
                "border\n.param D=0.5 fs=10k\nV1 in 0 20\nS1 in a g 0 SX\nD1 0 a DX\nL1 a b 1m\nV2 b 0 10\n"
                "Vg g 0 PULSE(0 1 0 0 0 {D/fs} {1/fs})\n.model SX SW(Ron=0 Vt=0.5 Vh=0)\n.model DX D\n.tran 1u 1m\n"
                ".meas tran m AVG i(L1)\n.sens param=L1,V1,V2\n.end\n");
  const Finished finished = run_in(scratch, {"deck.net", "--json"});
  const Json result = read_json(finished.out);
  const double V = 20.0, E = 10.0, D = 0.5, T = 1e-4, L = 1e-3, n = 4.5;
  check_sides(result, "m", "V1", (2.0 * V - E) * D * D * T / (2.0 * L * E), (n + 1.0 - 0.5 * D) * D * T / L);
  check_sides(result, "m", "V2", -(n + 0.5) * T / L, -V * V * D * D * T / (2.0 * L * E * E));
  CHECK_THAT(finished.err, Contains("W-sens-one-sided") && Contains("D1"));
  CHECK(derivative(result, "m", "L1") == Approx(-0.25 / L).epsilon(wanted));
}

TEST_CASE("a family of orbits: measurements that the free offset does not move have derivatives", "[unit]") {
  // A coil across a source: Ohm's law and V/(2πfL) hold at any offset.
  const Scratch scratch;
  const Json result = sensitivities_of(scratch,
                                       "family\n.param L=10m f=50\nV1 a 0 SIN(0 1 {f})\nL1 a 0 {L}\nR1 a b 1k\nC1 b 0 1u\n.pss uic\n"
                                       ".meas pss m RMS v(b)\n.meas pss pp PP i(L1)\n.meas pss a AVG i(L1)\n.sens param=C1,L,f\n.end\n");
  const double pi = std::acos(-1.0), w = 2.0 * pi * 50.0, x = w * 1e3 * 1e-6, m = std::sqrt(0.5 / (1.0 + x * x)), pp = 2.0 / (w * 0.01);
  CHECK(derivative(result, "m", "C1") == Approx(-m * x * x / (1.0 + x * x) / 1e-6).epsilon(wanted));
  CHECK(derivative(result, "pp", "L") == Approx(-pp / 0.01).epsilon(wanted));
  CHECK(derivative(result, "pp", "f") == Approx(-pp / 50.0).epsilon(wanted));
  CHECK_THAT(entry(result, "a", "L")["failure"].string, Contains("multiplier 1"));
}

TEST_CASE("a table, a file, and messages that say what to write", "[unit]") {
  const Scratch scratch;
  const std::string rc = "rc\nV1 in 0 1\nR1 in out 1k\nC1 out 0 1u ic=0\n.tran 1u 1m uic\n.meas tran v FIND v(out) AT=1m\n";
  scratch.write("deck.net", rc + ".sens param=R1\n.end\n");
  const Finished finished = run_in(scratch, {"deck.net"});
  REQUIRE(finished.status == 0);
  CHECK_THAT(finished.out, Contains("measurement  parameter  derivative") && Contains("v            R1"));
  CHECK_THAT(read_file(scratch / "deck.sens.csv"),
             Catch::StartsWith("measurement,parameter,derivative,normalised,left,right,failure\nv,R1,-0.000367879441171"));
  const auto error_of = [&](const std::string& card) {
    scratch.write("deck.net", rc + card + "\n.end\n");
    const Finished refused = run_in(scratch, {"deck.net"});
    CHECK(refused.status == 2);
    return refused.err;
  };
  CHECK_THAT(error_of(".sens param=R3"), Contains("E-sens-unknown-parameter") && Contains("R1"));
  CHECK_THAT(error_of(".sens param=R1 meas=u"), Contains("E-sens-no-measurement"));
  CHECK_THAT(error_of(".sens v(out)"), Contains("E-sens-no-measurement") && Contains(".meas"));
  CHECK_THAT(error_of(".sens objfunc={v(out)} param=R1"), Contains("E-sens-no-measurement") && Contains(".meas"));
}

TEST_CASE("a switch in another part of the circuit moves with the threshold that it passes", "[unit]") {
  // v(b) swings between a/(1 + a) and 1/(1 + a), a = e^{-T/2RC}: the switch is closed for T/2 + RC ln((1 - Vt)/Vt).
  const Scratch scratch;
  const Json result = sensitivities_of(scratch,
                                       "parts\nV1 a 0 PULSE(0 1 0 0 0 0.5m 1m)\nR1 a b 1k\nC1 b 0 1u\nV2 x 0 10\nS1 x y b 0 SX\n"
                                       "R2 y 0 9\n.model SX SW(Ron=1 Vt=0.4 Vh=0)\n.pss\n.meas pss mean AVG v(y)\n.meas pss rms RMS v(y)\n"
                                       ".sens param=R1,S1:Vt,V2,R2\n.end\n");
  const double T = 1e-3, tau = 1e-3, Vt = 0.4, on = 9.0, share = 0.5 + tau / T * std::log((1.0 - Vt) / Vt);
  const double to_threshold = -tau / T / (Vt * (1.0 - Vt));
  CHECK(derivative(result, "mean", "R1") == Approx(on * 1e-6 / T * std::log((1.0 - Vt) / Vt)).epsilon(wanted));
  CHECK(derivative(result, "mean", "S1:Vt") == Approx(on * to_threshold).epsilon(wanted));
  CHECK(derivative(result, "mean", "V2") == Approx(0.9 * share).epsilon(wanted));
  CHECK(derivative(result, "mean", "R2") == Approx(10.0 / 100.0 * share).epsilon(wanted));
  CHECK(derivative(result, "rms", "S1:Vt") == Approx(on * 0.5 / std::sqrt(share) * to_threshold).epsilon(wanted));
}

TEST_CASE("values of a tangent, which follows an exponential model, are refused by name", "[unit]") {
  const Scratch scratch;
  scratch.write("deck.net",
                "exponential\nV1 a 0 SIN(0 10 50)\nD1 a b DX\nR1 b 0 100\n.model DX D(IS=1e-14 RS=10m)\n.tran 10u 20m\n"
                ".meas tran v AVG v(b)\n.sens param=D1:Ron\n.end\n");
  const Finished refused = run_in(scratch, {"deck.net"});
  CHECK(refused.status == 2);
  CHECK_THAT(refused.err, Contains("E-sens-unknown-parameter") && Contains("D1") && Contains("exponential"));
}

namespace {

/// Transients and steady states through guards, edges, jumps of the state, with periods that move.
const std::string both_ways[] = {
    // buck
    "buck ccm\n"
    ".param fs=100k D=0.4\n"
    "V1 in 0 24\n"
    "S1 in a g 0 SX\n"
    "D1 0 a DX\n"
    "L1 a out 47u\n"
    "C1 out e 22u\n"
    "Re e 0 20m\n"
    "R1 out 0 2\n"
    "Vg g 0 PULSE(0 1 0 0 0 {D/fs} {1/fs})\n"
    ".model SX SW(Ron=10m Vt=0.5 Vh=0)\n"
    ".model DX D(Ron=5m Vfwd=0.5)\n"
    ".pss\n"
    ".meas pss v AVG v(out)\n"
    ".meas pss vr RMS v(out)\n"
    ".meas pss pp PP v(out)\n"
    ".meas pss mx MAX i(L1)\n"
    ".meas pss pin AVG v(in)*i(V1)\n"
    ".meas pss pout AVG v(out)*i(R1)\n"
    ".meas pss eff PARAM='-pout/pin'\n"
    ".meas pss w INTEG v(out)*i(L1)*v(out) FROM=1u TO=7u\n"
    ".meas pss at FIND v(out) AT={0.25/fs}\n"
    ".meas pss cr WHEN i(L1)=4.5 RISE=1\n"
    ".meas pss ab AVG abs(i(C1))\n"
    ".sens param=fs,D,L1,C1,Re,R1,V1,S1:Ron,D1:Ron,D1:Vfwd,Vg:V2\n"
    ".end\n",
    // rectifier
    "rectifier\n"
    "V1 a 0 SIN(0 10 50)\n"
    "L1 a b 1m\n"
    "D1 b c DX\n"
    "C1 c 0 470u\n"
    "R1 c 0 50\n"
    ".model DX D(Ron=0.1 Vfwd=0.7)\n"
    ".pss\n"
    ".meas pss v AVG v(c)\n"
    ".meas pss pp PP v(c)\n"
    ".meas pss pk MAX i(L1)\n"
    ".meas pss pf RMS i(L1)\n"
    ".meas pss t0 WHEN i(L1)=0.5 RISE=1\n"
    ".sens param=L1,C1,R1,V1:Vamp,V1:Freq,V1:Voff,D1:Ron,D1:Vfwd\n"
    ".end\n",
    // inrush of a rectifier
    "tran rectifier\n"
    "V1 a 0 SIN(0 10 50)\n"
    "L1 a b 1m\n"
    "D1 b c DX\n"
    "C1 c 0 470u\n"
    "R1 c 0 50\n"
    ".model DX D(Ron=0.1 Vfwd=0.7)\n"
    ".tran 10u 60m\n"
    ".meas tran v AVG v(c) FROM=10m TO=55m\n"
    ".meas tran e INTEG v(c)*i(D1)\n"
    ".meas tran pk MAX i(L1)\n"
    ".meas tran pf RMS i(L1)\n"
    ".meas tran end FIND v(c) AT=60m\n"
    ".meas tran d DERIV v(c) AT=33m\n"
    ".meas tran t0 WHEN i(L1)=0.5 RISE=2\n"
    ".sens param=L1,C1,R1,V1:Vamp,V1:Freq,V1:Voff,D1:Ron,D1:Vfwd\n"
    ".end\n",
    // relay
    "relay\n"
    ".param R=1k C=100n Vt=2 Vh=1 Vcc=5\n"
    "V1 vcc 0 {Vcc}\n"
    "R1 o a {R}\n"
    "C1 a 0 {C}\n"
    "S1 o 0 a 0 SM\n"
    "R2 vcc o 2k\n"
    "L5 vcc q 1m\n"
    "R5 q 0 1k\n"
    ".model SM SW(Ron=1 Vt={Vt} Vh={Vh})\n"
    ".pss on=S1\n"
    ".meas pss t PERIOD\n"
    ".meas pss m AVG v(a)\n"
    ".meas pss r RMS v(o)\n"
    ".meas pss p AVG v(vcc)*i(V1)\n"
    ".meas pss on TRIG v(a) VAL=2 RISE=1 TARG v(a) VAL=2 FALL=1\n"
    ".sens param=R,C,Vt,Vh,Vcc,R2,S1:Vt,S1:Ron\n"
    ".end\n",
    // transformer
    "transformer\n"
    "V1 a 0 SIN(0 100 1k)\n"
    "R1 a b 1\n"
    "L1 b 0 10m\n"
    "L2 c 0 40m\n"
    "K1 L1 L2 0.95\n"
    "D1 c d DX\n"
    "C1 d 0 10u\n"
    "R2 d 0 200\n"
    ".model DX D\n"
    ".tran 1u 5m uic\n"
    ".meas tran v AVG v(d)\n"
    ".meas tran pk MAX v(d)\n"
    ".meas tran i RMS i(L2)\n"
    ".meas tran en FIND v(d) AT=4.5m\n"
    ".sens param=R1,L1,L2,K1,C1,R2,V1:Vamp,V1:Freq\n"
    ".end\n",
    // charge pump
    "charge pump\n"
    ".param f=100k C=1u\n"
    "V1 in 0 5\n"
    "V2 g 0 PULSE(0 1 0 0 0 {0.5/f} {1/f})\n"
    "V3 h 0 PULSE(1 0 0 0 0 {0.5/f} {1/f})\n"
    "S1 in a g 0 SX\n"
    "C1 a b {C}\n"
    "S2 b 0 g 0 SX\n"
    "S3 in b h 0 SX\n"
    "S4 a out h 0 SX\n"
    "C2 out 0 4u\n"
    "R1 out 0 100\n"
    ".model SX SW(Ron=0 Vt=0.5)\n"
    ".pss\n"
    ".meas pss v AVG v(out)\n"
    ".meas pss r PP v(out)\n"
    ".meas pss rr RMS v(out)\n"
    ".sens param=f,C,V1,C2,R1\n"
    ".end\n",
    // run from an orbit
    "from orbit\n"
    ".param fs=100k D=0.4\n"
    "V1 in 0 24\n"
    "S1 in a g 0 SX\n"
    "D1 0 a DX\n"
    "L1 a out 47u\n"
    "C1 out 0 22u\n"
    "R1 out 0 2\n"
    "Vg g 0 PULSE(0 1 0 0 0 {D/fs} {1/fs})\n"
    ".model SX SW(Ron=10m Vt=0.5 Vh=0)\n"
    ".model DX D\n"
    ".pss\n"
    ".tran 1u 30u\n"
    ".meas pss v AVG v(out)\n"
    ".meas tran vt AVG v(out)\n"
    ".meas tran vx MAX i(L1)\n"
    ".sens param=D,L1,C1,R1,V1\n"
    ".end\n",
    // A closed loop on its way, whose segments have lengths of their own each: what they bring is interpolated between lengths.
    "peak current control\nV1 in 0 12\nS1 in a u 0 SL\nD1 0 a DI\nL1 a s 10u\nRs s o 0.1\nRe o c 20m\nC1 c 0 100u\nR1 o 0 1\n"
    "Ra o f 10k\nRb f 0 10k\nVr r 0 2.5\nE0 e 0 r f 100\nR2 f z 20k\nC2 z e 2.2n\nVk k 0 PULSE(0 9 0 0 0 0.2u 10u)\n"
    "Vm m 0 PULSE(0 1 0 9.99u 0.01u 0 10u)\nE1 n1 m s o 10\nE2 n2 e n1 0 -1\nE3 u n2 k 0 1\n.model SL SW(Ron=10m Vt=2 Vh=2)\n"
    ".model DI D(Ron=10m Vfwd=0.4)\n.tran 10u 4m uic\n.meas tran v AVG v(o)\n.meas tran w RMS v(o)\n"
    ".meas tran p AVG v(o)*i(L1) FROM=0.5m\n.sens param=V1,L1,Rs,R1,Vr,R2,E0,E1\n.end\n",
};

}  // namespace

TEST_CASE("averages, products and squares over many periods, forward and backwards", "[unit]") {
  // An RC circuit under a square wave from rest, over 40 periods, half period by half period: v = s + (v₀ − s) e^{−t/τ}, s = 1 or 0. Derivatives to τ by
  // central differences with 64-bit mantissas, step 1e-6 of it: off by 1e-12.
  struct Sums {
    long double mean = 0, square = 0, product = 0, window = 0;
  };
  const auto sums_of = [](long double tau) {
    constexpr int halves = 80;
    const long double h = 0.5e-3L, e = std::exp(-h / tau);
    long double v = 0;
    Sums sums;
    for (int k = 0; k < halves; ++k) {
      const long double s = k % 2 == 0 ? 1 : 0, d = v - s;
      const long double first = s * h + d * tau * (1 - e), second = s * s * h + 2 * s * d * tau * (1 - e) + d * d * tau / 2 * (1 - e * e);
      sums.mean += first / (halves * h);
      sums.square += second / (halves * h);
      sums.product += s * first / (halves * h);
      // From 10.2 to 30.7 ms: 0.2 ms into half period 20, 0.2 ms into half period 61.
      const auto part = [&](long double from, long double to) {
        return s * (to - from) + d * tau * (std::exp(-from / tau) - std::exp(-to / tau));
      };
      if (k == 20) sums.window += part(0.2e-3L, h);
      if (k > 20 && k < 61) sums.window += first;
      if (k == 61) sums.window += part(0, 0.2e-3L);
      v = s + d * e;
    }
    return sums;
  };
  const long double step = 1e-6L * 1e-3L;
  const Sums more = sums_of(1e-3L + step), less = sums_of(1e-3L - step), here = sums_of(1e-3L);
  const auto by = [&](long double Sums::*sum) { return static_cast<double>((more.*sum - less.*sum) / (2 * step)); };
  const double rms = static_cast<double>(std::sqrt(here.square));
  const std::vector<double> by_tau{by(&Sums::mean), by(&Sums::square) / (2.0 * rms), by(&Sums::product), by(&Sums::window),
                                   3.0 * by(&Sums::mean)};
  const Scratch scratch;
  for (const std::string method : {"forward", "adjoint"}) {
    const Json result = sensitivities_of(scratch,
                                         "rc\nV1 a 0 PULSE(0 1 0 0 0 0.5m 1m)\nV2 c 0 2\nR1 a b 1k\nC1 b 0 1u\n.tran 1m 40m uic\n"
                                         ".meas tran m1 AVG v(b)\n.meas tran m2 RMS v(b)\n.meas tran m3 AVG v(a)*v(b)\n"
                                         ".meas tran m4 INTEG v(b) FROM=10.2m TO=30.7m\n.meas tran m5 AVG 3*v(b)+v(c)-v(a)\n"
                                         ".sens param=R1,V2,V1:V2 method=" +
                                             method + "\n.end\n");
    const auto& list = result["sensitivities"].array;
    REQUIRE(list.size() == 15);
    for (std::size_t k = 0; k < 5; ++k) {
      INFO(method << ": " << list[3 * k]["measurement"].string);
      CHECK(list[3 * k]["derivative"].number == Approx(1e-6 * by_tau[k]).epsilon(1e-9));  // τ = R C
      CHECK(list[3 * k + 1]["derivative"].number == Approx(k == 4 ? 1.0 : 0.0).margin(1e-12));
    }
    // To the level of the square wave all are homogeneous.
    CHECK(list[2]["derivative"].number == Approx(static_cast<double>(here.mean)).epsilon(1e-11));
    CHECK(list[5]["derivative"].number == Approx(rms).epsilon(1e-11));
    CHECK(list[8]["derivative"].number == Approx(static_cast<double>(2 * here.product)).epsilon(1e-11));
    CHECK(list[11]["derivative"].number == Approx(static_cast<double>(here.window)).epsilon(1e-11));
    CHECK(list[14]["derivative"].number == Approx(static_cast<double>(3 * here.mean) - 0.5).epsilon(1e-11));
  }
}

TEST_CASE("backwards from the measurement and forward along the parameter the derivatives are the same", "[unit]") {
  constexpr double same = 1e-10;       // of the derivative
  constexpr double cancelled = 1e-14;  // of the measurement against the parameter, where a derivative is a small difference
  const Scratch scratch;
  for (const std::string& deck : both_ways) {
    const auto with_method = [&](const std::string& method) {
      std::string text = deck;
      text.insert(text.find('\n', text.find(".sens ")), " method=" + method);
      return sensitivities_of(scratch, text)["sensitivities"].array;
    };
    const auto forward = with_method("forward"), backward = with_method("adjoint");
    REQUIRE(forward.size() == backward.size());
    REQUIRE(!forward.empty());
    for (std::size_t k = 0; k < forward.size(); ++k) {
      INFO(deck.substr(0, deck.find('\n')) << ": " << forward[k]["measurement"].string << " to " << forward[k]["parameter"].string);
      CHECK(forward[k]["failure"].string == backward[k]["failure"].string);
      const double d = forward[k]["derivative"].number;
      const auto size_of = [](const Json& entry) {  // of the measurement against the parameter
        const double normalised = entry["normalised"].number;
        return normalised != 0.0 ? std::abs(entry["derivative"].number / normalised) : 0.0;
      };
      const double size = std::max(size_of(forward[k]), size_of(backward[k]));
      CHECK(std::abs(backward[k]["derivative"].number - d) <= same * std::abs(d) + cancelled * size + 1e-300);
      CHECK(std::abs(backward[k]["left"].number - forward[k]["left"].number) <= same * std::abs(d) + cancelled * size + 1e-300);
    }
  }
}

// v(b) = √(L2/L1)·V1: the derivatives −1000 and 250 are not followed, as with |k| = 1 the currents are no states of their own; 0 was printed.
TEST_CASE("inductances of perfect couplings are refused by name", "[unit]") {
  const Scratch scratch;
  const Json told =
      sensitivities_of(scratch,
                       "t\nV1 a 0 1\nL1 a 0 1m\nL2 b 0 4m\nK1 L1 L2 1\nR3 b 0 50\n.tran 1u 1m uic\n.meas tran f FIND v(b) AT=0.5m\n"
                       ".sens param=L1,L2\n.end\n");
  REQUIRE(told["sensitivities"].array.size() == 2);
  for (const Json& entry : told["sensitivities"].array) CHECK(entry["failure"].string == "it changes perfectly coupled inductors");
}

// By hand: v(a,b) at the start is 3 V − 1 V whatever C3 is. With C1 and C2 across one resistor, v(out) = 10 V − 8 V·e^{−t/(R(C1+C2))}: to each capacitance −8 V·e^{−1/2}·t/(R(C1+C2)²) at 1 ms.
TEST_CASE("what .ic says of both nodes of a capacitor does not move with it", "[unit]") {
  const Scratch scratch;
  const Json still =
      sensitivities_of(scratch,
                       "t\nC3 a b 2u\nR1 a 0 1k\nR2 b 0 1k\n.ic v(a)=3 v(b)=1\n.tran 1u 3m uic\n.meas tran f FIND v(a,b) AT=0\n"
                       ".sens param=C3\n.end\n");
  REQUIRE(still["sensitivities"].array.size() == 1);
  CHECK(std::abs(still["sensitivities"].array[0]["derivative"].number) < 1e-6);
  const Json moves = sensitivities_of(scratch,
                                      "t\nV1 in 0 10\nR1 in out 1k\nC1 out 0 1u\nC2 out in 1u\n.ic v(out)=2 v(in)=10\n.tran 1u 3m uic\n"
                                      ".meas tran f FIND v(out) AT=1m\n.sens param=C1,C2\n.end\n");
  REQUIRE(moves["sensitivities"].array.size() == 2);
  const double expected = -8.0 * std::exp(-0.5) * 1e-3 / (1e3 * 2e-6 * 2e-6);
  for (const Json& entry : moves["sensitivities"].array) CHECK(entry["derivative"].number == Approx(expected).epsilon(1e-9));
}

// Both time constants are 3 ms, so that after the jump to V = (C1·3.3 V + C2·1.1 V)/(C1 + C2) the diode carries and blocks nothing. Where it then conducts, v(b) = V e^{−t/(R(C1 + C2))}, R = Ra ∥ Rb;
// where it blocks, V e^{−t/(Rb C2)}. It conducts for a larger Ra and C1, and for a smaller Rb and C2.
TEST_CASE("a diode that rests at zero conducts for larger and blocks for smaller values of a parameter", "[unit]") {
  constexpr double same = 1e-8;
  const Scratch scratch;
  const double c1 = 1e-6, c2 = 3e-6, ra = 3e3, rb = 1e3, t = 2e-3, start = (c1 * 3.3 + c2 * 1.1) / (c1 + c2),
               v = start * std::exp(-t / 3e-3);
  const double r = ra * rb / (ra + rb), fall = std::exp(-t / 3e-3), both = r * (c1 + c2);
  const double by_start1 = (3.3 - start) / (c1 + c2) * fall, by_start2 = (1.1 - start) / (c1 + c2) * fall;
  const double by_both = v * t / (both * both);  // to R(C1 + C2)
  const std::vector<std::pair<double, double>> expected{{0.0, by_both * (c1 + c2) * std::pow(rb / (ra + rb), 2)},
                                                        {by_both * (c1 + c2) * std::pow(ra / (ra + rb), 2), v * t / (rb * rb * c2)},
                                                        {by_start1, by_start1 + by_both * r},
                                                        {by_start2 + by_both * r, by_start2 + v * t / (rb * c2 * c2)}};
  for (const std::string method : {"forward", "adjoint"}) {
    const Json told =
        sensitivities_of(scratch,
                         "rest\nC1 a 0 1u ic=3.3\nC2 b 0 3u ic=1.1\nD1 a b DI\nRb b 0 1k\nRa a 0 3k\n.model DI D\n.tran 10u 3m uic\n"
                         ".meas tran v FIND v(b) AT=2m\n.sens param=Ra,Rb,C1,C2 method=" +
                             method + "\n.end\n");
    const auto& list = told["sensitivities"].array;
    REQUIRE(list.size() == expected.size());
    for (std::size_t k = 0; k < list.size(); ++k) {
      INFO(method << ": " << list[k]["parameter"].string);
      const double size = std::abs(expected[k].first) + std::abs(expected[k].second);
      CHECK(std::abs(list[k]["left"].number - expected[k].first) <= same * size);
      CHECK(std::abs(list[k]["right"].number - expected[k].second) <= same * size);
    }
  }
}

// i(L1) = V1/R1·(1 − e^{−(t − Td) R1/L1}) behind the edge: until then the diode rests at zero, whatever the parameters are.
TEST_CASE("a diode that rests until the first edge has derivatives", "[unit]") {
  const Scratch scratch;
  const Json told =
      sensitivities_of(scratch,
                       "edge\nV1 a 0 PULSE(0 10 10u 0 0 1 2)\nD1 a b DI\nL1 b c 1m\nR1 c 0 10\n.model DI D\n.tran 1u 110u uic\n"
                       ".meas tran i FIND i(L1) AT=110u\n.sens param=R1,V1:V2 method=adjoint\n.end\n");
  const auto& list = told["sensitivities"].array;
  REQUIRE(list.size() == 2);
  const double x = std::exp(-1.0);
  CHECK(list[0]["derivative"].number == Approx(-0.1 * (1 - x) + 1.0 * 0.1 * x).epsilon(1e-10));  // (t − Td)/L1 = 0.1/Ω
  CHECK(list[1]["derivative"].number == Approx(0.1 * (1 - x)).epsilon(1e-10));
  for (const Json& each : list) CHECK(each["left"].number == each["right"].number);
}

// v(a) falls to zero where it reaches 4 V. Period and mean of v(b) from matrix exponentials and Brent's method (scipy), differentiated by differences of fourth order.
TEST_CASE("an orbit whose switch closes and opens at one instant has derivatives", "[unit]") {
  const Scratch scratch;
  const std::vector<double> expected{5.22171375e-07, 2.07274018e-02, -2.84517332e-09, -6.89077255e-05, 1.72269314e-04,
                                     8.53276859e-05, 3.10810796e+02, -4.26638429e-05, -3.32827018e-02, 6.47027216e-01};
  for (const std::string method : {"forward", "adjoint"}) {
    const Json told = sensitivities_of(scratch,
                                       "relaxation\nV1 in 0 10\nR1 in a 1k\nC1 a 0 1u\nS1 a 0 a 0 SW\nR2 a b 2k\nC2 b 0 1.5u\n"
                                       ".model SW SW(Ron=0 Vt=3 Vh=1)\n.save v(a)\n.pss uic\n.meas pss t PERIOD\n.meas pss m AVG v(b)\n"
                                       ".sens param=R1,C2,R2,V1,S1:Vt method=" +
                                           method + "\n.end\n");
    const auto& list = told["sensitivities"].array;
    REQUIRE(list.size() == expected.size());
    for (std::size_t k = 0; k < list.size(); ++k) CHECK(list[k]["derivative"].number == Approx(expected[k]).epsilon(1e-7));
  }
}

// By hand: v(b) = k(3 V − m/2)/4 + m, v(e) = 10 Ω·(g v(b) − k·3 mA), v(f) = k²(v(e) − v(b)); k = 2, m = 0.5, g = 0.1. A current z, which is 0, flows into e, too.
TEST_CASE("parameters in expressions of B and E that are sums of signals are followed", "[unit]") {
  const Scratch scratch;
  const double k = 2.0, m = 0.5, g = 0.1;
  const double b = k * (3.0 - m / 2.0) / 4.0 + m, b_k = (3.0 - m / 2.0) / 4.0, b_m = 1.0 - k / 8.0;
  const double e = 10.0 * (g * b - k * 3e-3), e_k = 10.0 * (g * b_k - 3e-3), e_m = 10.0 * g * b_m, e_g = 10.0 * b;
  const std::vector<double> of_b{b_k, b_m, 0.0, 0.0}, of_e{e_k, e_m, e_g, 10.0};
  std::vector<double> expected = of_b;
  expected.insert(expected.end(), of_e.begin(), of_e.end());
  for (std::size_t i = 0; i < of_b.size(); ++i) expected.push_back((i == 0 ? 2.0 * k * (e - b) : 0.0) + k * k * (of_e[i] - of_b[i]));
  for (const std::string method : {"forward", "adjoint"}) {
    const Json told =
        sensitivities_of(scratch,
                         "formulas\n.param k=2 m=0.5 g=0.1 z=0\nV1 a 0 3\nB1 b 0 V={k*(v(a)-m/2)/4+m}\nV3 x 0 0\nR5 a x 1k\n"
                         "B3 0 e I={g*v(b)-k*I(V3)+z}\nR3 e 0 10\nE4 f 0 value={-(v(b)-v(e))*k*k}\nR4 f 0 1\nC4 f 0 1n\n.tran 1u 1m\n"
                         ".meas tran b AVG v(b)\n.meas tran e AVG v(e)\n.meas tran f AVG v(f)\n.sens param=k,m,g,z method=" +
                             method + "\n.end\n");
    const auto& list = told["sensitivities"].array;
    REQUIRE(list.size() == expected.size());
    for (std::size_t i = 0; i < list.size(); ++i) {
      INFO(method << ": " << list[i]["measurement"].string << " to " << list[i]["parameter"].string);
      CHECK(list[i]["derivative"].number == Approx(expected[i]).epsilon(1e-10).margin(1e-12));
    }
  }
}

namespace {

/// The derivatives by both methods against those given, by measurement and parameter.
void check_formulas(const std::string& deck,
                    const std::vector<std::pair<std::string, std::vector<std::pair<std::string, double>>>>& expected, double tolerance) {
  const Scratch scratch;
  for (const std::string method : {"forward", "adjoint"}) {
    const Json told = sensitivities_of(scratch, deck + " method=" + method + "\n.end\n");
    for (const auto& [measurement, list] : expected)
      for (const auto& [parameter, value] : list) {
        INFO(method << ": " << measurement << " to " << parameter);
        CHECK(derivative(told, measurement, parameter) == Approx(value).epsilon(tolerance).margin(1e-12));
      }
  }
}

}  // namespace

// A triangle from 0 to p within 1 ms and back: above k for the share 1 − k/p. So is g·vr.
TEST_CASE("levels and values of comparisons are followed, and the source that is compared", "[unit]") {
  const double k = 1.5, hi = 4.7, lo = 0.3, p = 4.0, g = 0.7, vr = 2.0;
  const double share = 1.0 - k / p;
  check_formulas(
      "comparison\n.param k=1.5 hi=4.7 lo=0.3 p=4 g=0.7 vr=2\nVt t 0 PULSE(0 {p} 0 1m 1m 0 2m)\nVr r 0 {vr}\n"
      "B1 a 0 V=if(V(t)>k,hi,lo)\nR1 a 0 1k\nB2 b 0 V=u(V(t)-g*V(r))*hi\nR2 b 0 1k\n"
      "E3 c 0 VALUE={if(V(t)<k,lo,V(t)*g)}\nR3 c 0 1k\n.tran 1u 4m uic\n"
      ".meas tran a AVG v(a)\n.meas tran b AVG v(b)\n.meas tran c AVG v(c)\n.sens param=k,hi,lo,p,g,vr",
      {{"a", {{"k", -(hi - lo) / p}, {"hi", share}, {"lo", 1.0 - share}, {"p", (hi - lo) * k / (p * p)}, {"g", 0.0}, {"vr", 0.0}}},
       {"b", {{"g", -hi * vr / p}, {"vr", -hi * g / p}, {"hi", 1.0 - g * vr / p}, {"p", hi * g * vr / (p * p)}}},
       // lo·k/p + g·(p² − k²)/(2 p)
       {"c",
        {{"k", (lo - g * k) / p},
         {"lo", k / p},
         {"g", (p * p - k * k) / (2.0 * p)},
         {"p", -lo * k / (p * p) + 0.5 * g * (1.0 + k * k / (p * p))}}}},
      1e-10);
}

// One period of sin x; θ = asin k.
TEST_CASE("kinks, limits, choices and tables move with their numbers", "[unit]") {
  const double pi = std::acos(-1.0), k = 0.4, g = 2.5, m = 0.3, lim = 1.2, y = 1.7;
  const double theta = std::asin(k), of_limit = std::asin(lim / g);
  check_formulas(
      "kinks\n.param k=0.4 g=2.5 m=0.3 lim=1.2 y=1.7\nVs s 0 SIN(0 1 1k)\n"
      "B1 a 0 V=max(V(s),k)\nR1 a 0 1k\nB2 b 0 V=limit(g*V(s),0,lim)\nR2 b 0 1k\nB3 c 0 V=if(V(s)>k,g*V(s)+m,0)\nR3 c 0 1k\n"
      "E4 d 0 TABLE {V(s)} = (0 0) ({k} {y})\nR4 d 0 1k\nB5 0 e I=V(s)>k&V(s)<2?m:0\nR5 e 0 1\n.tran 1u 1m\n"
      ".meas tran a AVG v(a)\n.meas tran b AVG v(b)\n.meas tran c AVG v(c)\n.meas tran d AVG v(d)\n.meas tran e AVG i(B5)\n"
      ".sens param=k,g,m,lim,y",
      {{"a", {{"k", 0.5 + theta / pi}, {"g", 0.0}}},
       {"b", {{"lim", 0.5 - of_limit / pi}, {"g", (1.0 - std::cos(of_limit)) / pi}}},
       {"c", {{"k", -(g * k + m) / (pi * std::cos(theta))}, {"g", std::cos(theta) / pi}, {"m", 0.5 - theta / pi}}},
       {"d", {{"y", ((1.0 - std::cos(theta)) / k + 0.5 * pi - theta) / pi}, {"k", -y * (1.0 - std::cos(theta)) / (pi * k * k)}}},
       {"e", {{"m", 0.5 - theta / pi}, {"k", -m / (pi * std::cos(theta))}}}},
      1e-9);
}

// The instant is that of the carrier: t = (2 + m)/f of a saw, (1 + 5/12)/f of a sine at 1/2, τ ln 2 of a decay, (1 + (2 − b)/4)/f of a triangle.
TEST_CASE("functions of time move with their frequencies and levels", "[unit]") {
  const double m = 0.3, f = 1e3, tau = 1e-3, b = 0.25;
  check_formulas(
      "carriers\n.param m=0.3 f=1k tau=1m b=0.25\nB1 a 0 V=if(m>idtmod(f,0,1),1,0)\nR1 a 0 1\nB2 b 0 V=sin(2*pi*f*time)\nR2 b 0 1\n"
      "B3 c 0 V=exp(-time/tau)\nR3 c 0 1\nB4 d 0 V=if(time>3*tau,m,2)\nR4 d 0 1\nB5 e 0 V=if(b<asin(sin(2*pi*f*time))*2/pi,1,0)\nR5 e 0 1\n"
      ".tran 1u 3.7m\n.meas tran a WHEN v(a)=0.5 FALL=3\n.meas tran b WHEN v(b)=0.5 FALL=2\n.meas tran c WHEN v(c)=0.5\n"
      ".meas tran d INTEG v(d)\n.meas tran e WHEN v(e)=0.5 FALL=2\n.sens param=m,f,tau,b",
      {{"a", {{"m", 1.0 / f}, {"f", -(2.0 + m) / (f * f)}}},
       {"b", {{"f", -(17.0 / 12.0) / (f * f)}}},
       {"c", {{"tau", std::log(2.0)}}},
       {"d", {{"tau", 3.0 * (2.0 - m)}, {"m", 3.7e-3 - 3.0 * tau}}},
       {"e", {{"f", -(1.0 + (2.0 - b) / 4.0) / (f * f)}, {"b", -0.25 / f}}}},
      1e-9);
}

// A relay between hi and lo with the levels k + h·hi/10 and k + h·lo/10: T = RC ln((hi − a)(b − lo)/((hi − b)(a − lo))). Shapes do not change with R.
TEST_CASE("a relay in an expression of itself: its period moves with its levels, its root mean square not with R", "[unit]") {
  const double k = 1.5, h = 0.6, hi = 10.0, lo = -8.0, rc = 1e-3;
  const double a = k + h * lo / 10.0, b = k + h * hi / 10.0;
  const double to_a = -1.0 / (hi - a) - 1.0 / (a - lo), to_b = 1.0 / (hi - b) + 1.0 / (b - lo);
  const double period = rc * std::log((hi - a) * (b - lo) / ((hi - b) * (a - lo)));
  const double to_hi = 1.0 / (hi - a) - 1.0 / (hi - b) + to_b * h / 10.0, to_lo = -1.0 / (b - lo) + 1.0 / (a - lo) + to_a * h / 10.0;
  for (const std::string level : {"1.4", "1.8"})
    check_formulas(
        "relay\n.param k=1.5 h=0.6 hi=10 lo=-8 r=1k\n.options nonunique=stay\nB1 u 0 V=if(V(c)<k+h*V(u)/10,hi,lo)\n"
        "R1 u c {r}\nC1 c 0 1u ic=0\n.pss uic when v(c)=" +
            level +
            " rise\n.meas pss t PERIOD\n.meas pss top MAX v(c)\n"
            ".meas pss q RMS v(c)\n.meas pss s AVG v(c)*v(u)\n.sens param=k,h,hi,lo,r",
        {{"t",
          {{"k", rc * (to_a + to_b)},
           {"h", rc * (to_a * lo + to_b * hi) / 10.0},
           {"hi", rc * to_hi},
           {"lo", rc * to_lo},
           {"r", period / 1e3}}},
         {"top", {{"k", 1.0}, {"h", hi / 10.0}, {"hi", h / 10.0}, {"lo", 0.0}}},
         {"q", {{"r", 0.0}}},
         {"s", {{"r", 0.0}}}},
        1e-8);
}

// ∫ from s of g·2 V: s + 2 g t. A factor that is 0 has the derivative of what it multiplies: 2 V. A current that is no unknown: k·2 V.
TEST_CASE("integrals, factors that are zero, and currents of expressions move", "[unit]") {
  const double t = 0.7e-3, g = 300.0;
  check_formulas(
      "integrals\n.param s=0.5 g=300 z=0 k=0.4\nVa a 0 2\nB1 b 0 V=sdt(g*V(a),s)\nR1 b 0 1k\nB2 c 0 V=V(a)*3+z*V(a)\nR2 c 0 1k\n"
      "B3 0 d I={k*V(a)}\nR3 d 0 1\nB4 e 0 V=if(V(b)>0.6+z*V(a),k,0)\nR4 e 0 1k\n.tran 1u 1m uic\n"
      ".meas tran b FIND v(b) AT=0.7m\n.meas tran c AVG v(c)\n.meas tran d AVG i(B3)\n.meas tran e INTEG v(e)\n.sens param=s,g,z,k",
      {{"b", {{"s", 1.0}, {"g", 2.0 * t}}},
       {"c", {{"z", 2.0}}},
       {"d", {{"k", 2.0}}},
       // k·(1 ms − t₁), s + 2 g t₁ = 0.6 + 2 z
       {"e", {{"s", 0.4 / (2.0 * g)}, {"g", 0.4 * (0.1 / 600.0) / g}, {"z", -0.4 / g}}}},
      1e-9);
}

TEST_CASE("the current of a G element moves with its gain", "[unit]") {
  // 1.5 V at the control
  check_formulas("gain\nV1 a 0 2\nR1 a b 1k\nR2 b 0 3k\nG1 0 c b 0 2m\nR3 c 0 1k\n.tran 1u 1m\n.meas tran g AVG i(G1)\n.sens param=G1",
                 {{"g", {{"G1", 1.5}}}}, 1e-12);
}

TEST_CASE("a voltage that a formula takes as a number is named where a parameter moves it", "[unit]") {
  const Scratch scratch;
  scratch.write("deck.net",
                "folded\n.param x=2 f=1k\nVm m 0 {x}\nB1 a 0 V=V(m)*sin(2*pi*f*time)\nR1 a 0 1k\n.tran 1u 1m\n.meas tran r RMS v(a)\n"
                ".sens param=x,Vm,f\n.end\n");
  const Finished finished = run_in(scratch, {"deck.net"});
  CHECK(finished.status == 0);
  CHECK_THAT(finished.err, Contains("r has no derivative to x: B1 takes the voltage of Vm as a number"));
  CHECK_THAT(finished.err, Contains("r has no derivative to Vm: B1 takes the voltage of Vm as a number"));
}

// A step through g/(1 + sτ): g(1 − e^{−t/τ}); through 1/((1 + s/a)(1 + s/b)): 1 − (b e^{−at} − a e^{−bt})/(b − a).
TEST_CASE("fractions of Laplace= move with their numbers", "[unit]") {
  const double g = 2.2, tau = 0.3e-3, a = 2e3, b = 5e3, t = 0.4e-3;
  const double fall = std::exp(-t / tau), of_a = std::exp(-a * t), of_b = std::exp(-b * t);
  const double rest = b * of_a - a * of_b;
  check_formulas(
      "laplace\n.param g=2.2 tau=0.3m a=2k b=5k\n.func pole(w) {1/(1+s/w)}\nV1 a 0 PWL(0 0 0.1m 0 0.1m 1 1 1)\n"
      "E1 b 0 a 0 Laplace={g/(1+s*tau)}\nR1 b 0 1k\nB2 c 0 V=V(a) Laplace={pole(a)*pole(b)}\nR2 c 0 1k\n.tran 1u 1m\n"
      ".meas tran x FIND v(b) AT=0.5m\n.meas tran y FIND v(c) AT=0.5m\n.sens param=g,tau,a,b",
      {{"x", {{"g", 1.0 - fall}, {"tau", -g * t / (tau * tau) * fall}, {"a", 0.0}}},
       {"y",
        {{"a", -((-b * t * of_a - of_b) * (b - a) + rest) / ((b - a) * (b - a))},
         {"b", -((of_a + a * t * of_b) * (b - a) - rest) / ((b - a) * (b - a))},
         {"g", 0.0}}}},
      1e-9);
}

// A triangle from 0 to 4 within 1 ms and back. Limited at m from above: the mean is m − m²/8. With hysteresis h about d it switches at (d + h)/4 ms and (8 − d + h)/4 ms.
TEST_CASE("models of blocks move with parameters", "[unit]") {
  const double m = 1.5, g = 1.0, d = 2.0, hi = 3.0, lo = 1.0;
  check_formulas(
      "blocks\n.param m=1.5 d=2 h=0.3 hi=3 lo=1 g=1\nV1 a 0 PULSE(0 4 0 1m 1m 0 2m)\nA1 a b LM\n.model LM limit(gain={g} "
      "out_lower_limit=-1 out_upper_limit={m})\n"
      "R1 b 0 1k\nA2 a c HM\n.model HM hyst(in_low={d} in_high={d} hyst={h} out_lower_limit={lo} out_upper_limit={hi})\nR2 c 0 1k\n.tran "
      "1u 2m\n"
      ".meas tran x AVG v(b)\n.meas tran y AVG v(c)\n.meas tran r WHEN v(c)=2 RISE=1\n.meas tran f WHEN v(c)=2 FALL=1\n.sens "
      "param=m,d,h,hi,lo,g",
      {{"x", {{"m", 1.0 - m / (4.0 * g)}, {"g", m * m / (8.0 * g * g)}, {"h", 0.0}}},
       {"y", {{"d", -(hi - lo) / 4.0}, {"h", 0.0}, {"hi", 1.0 - d / 4.0}, {"lo", d / 4.0}}},
       {"r", {{"d", 0.25e-3}, {"h", 0.25e-3}}},
       {"f", {{"d", -0.25e-3}, {"h", 0.25e-3}}}},
      1e-10);
}

// Above k for the share 1 − k/4 of a triangle from 0 to 4, and above m likewise; k = m. Of 1 + 3 sin x: 1/2 − asin((k − 1)/3)/π.
TEST_CASE("two comparisons that change at one instant move by themselves", "[unit]") {
  const Scratch scratch;
  const double k = 1.5, pi = std::acos(-1.0);
  const std::pair<std::string, double> waves[] = {{"PULSE(0 4 0 1m 1m 0 2m)", -0.25},
                                                  {"SIN(1 3 500)", -1.0 / (3.0 * pi * std::sqrt(1.0 - std::pow((k - 1.0) / 3.0, 2)))}};
  for (const auto& [wave, slope] : waves)
    for (const std::string method : {"forward", "adjoint"}) {
      INFO(wave << " " << method);
      const Json told =
          sensitivities_of(scratch, "together\n.param k=1.5 m=1.5\nVt t 0 " + wave +
                                        "\nB1 a 0 V=if(V(t)>k,5,0)\nR1 a 0 1k\nB2 b 0 V=if(V(t)>m,3,0)\nR2 b 0 1k\n.tran 1u 2m\n"
                                        ".meas tran a AVG v(a)\n.meas tran b AVG v(b)\n.sens param=k,m method=" +
                                        method + "\n.end\n");
      const auto is = [&](const std::string& measurement, const std::string& parameter, double value) {
        const Json d = entry(told, measurement, parameter);
        INFO(measurement << " to " << parameter);
        CHECK(d["left"].number == Approx(value).epsilon(1e-6).margin(1e-7));
        CHECK(d["right"].number == Approx(value).epsilon(1e-6).margin(1e-7));
      };
      is("a", "k", 5.0 * slope);
      is("a", "m", 0.0);
      is("b", "k", 0.0);
      is("b", "m", 3.0 * slope);
    }
}

// v(x) = k v(a)' and v(y) = k^2 v(a)'', v(a) = A cos wt: i(C1) = -k C w^2 A cos wt, i(C2) = k^2 C w^3 A sin wt. Over two periods the mean of a square is 1/2 + sin(2wT)/(4wT) of a cosine, 1/2 - that of a sine. S1 opens or
// closes where v(y) = -k^2 w^2 A cos wt is 0.3 V.
TEST_CASE("measurements that follow the second derivative of what a parameter moves, or the third", "[unit]") {
  const double k = 1e-4, A = 3.0, f = 1e3, C = 1e-6, level = 0.3, pi = std::acos(-1.0), w = 2.0 * pi * f;
  const std::string deck =
      "derivatives\n.param A=3 f=1k\nV1 a 0 SIN(0 {A} {f} 0 0 90)\nB1 x 0 V={1e-4*ddt(v(a))}\nC1 x 0 1u\nB2 y 0 V={1e-4*ddt(v(x))}\nC2 y 0 "
      "1u\n"
      "V2 d 0 5\nRL d o 1k\nS1 o 0 y 0 SW\n.model SW SW(Ron=1 Roff=1meg Vt=0.3)\n.tran 1u 2m\n.meas tran second RMS i(C1)\n"
      ".meas tran third RMS i(C2)\n.meas tran when WHEN v(o)=2.5 FALL=1\n.sens param=A,f,C1,C2";
  for (const char* const method : {" method=forward\n.end\n", " method=adjoint\n.end\n"}) {
    const Json result = sensitivities_of(Scratch{}, deck + method);
    const double second = k * C * w * w * A / std::sqrt(2.0), third = k * k * C * w * w * w * A / std::sqrt(2.0);
    CHECK(derivative(result, "second", "A") == Approx(second / A).epsilon(wanted));
    CHECK(derivative(result, "second", "C1") == Approx(second / C).epsilon(wanted));
    CHECK(derivative(result, "second", "f") == Approx(2.5 * second / f).epsilon(wanted));
    CHECK(derivative(result, "third", "A") == Approx(third / A).epsilon(wanted));
    CHECK(derivative(result, "third", "C2") == Approx(third / C).epsilon(wanted));
    CHECK(derivative(result, "third", "f") == Approx(2.5 * third / f).epsilon(wanted));
    const double angle = std::acos(-level / (k * k * w * w * A));
    CHECK(derivative(result, "when", "A") == Approx(1.0 / (A * w * std::tan(angle))).epsilon(wanted));
    CHECK(derivative(result, "when", "f") == Approx((2.0 / std::tan(angle) - angle) / (w * f)).epsilon(wanted));
  }
}

// Five differentiations, a capacitor that a switch connects, and one that follows the current of that: the seventh derivative of V1, which no state stands for.
TEST_CASE("a parameter of which too many derivatives count is named", "[unit]") {
  std::string deck = "too many\n.param A=2\nV1 a 0 SIN(0 {A} 10k 0 0 90)\nB1 f1 0 V={1e-5*ddt(v(a))}\n";
  for (int k = 2; k <= 5; ++k)
    deck += "B" + std::to_string(k) + " f" + std::to_string(k) + " 0 V={1e-5*ddt(v(f" + std::to_string(k - 1) + "))}\n";
  deck +=
      "Vg g 0 PULSE(0 1 0 1n 1n 4u 10u)\nS3 f5 e g 0 SX\nC3 e 0 1u\nB20 h 0 V={i(C3)}\nS4 h k2 g 0 SX\nC4 k2 0 1u\n"
      ".model SX SW(Ron=0 Vt=0.5)\n.tran 1u 200u\n.meas tran r AVG i(C4) FROM=102u TO=103u\n.sens param=A\n.end\n";
  const Scratch scratch;
  scratch.write("deck.net", deck);
  const Finished finished = run_in(scratch, {"deck.net"});
  CHECK(finished.status == 0);
  CHECK_THAT(finished.err, Contains("W-sens-failed") && Contains("more derivatives"));
}
