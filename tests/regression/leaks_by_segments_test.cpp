/// Converters with leaks so large that rounding of a current is a voltage: by Krylov segments as by dense modes, which share no equations.

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "regression/comparison.hpp"
#include "regression/deck_run.hpp"

namespace {

using namespace pwlsim;

struct LeakCase {
  std::string what, deck;
};

/// Two diodes of each phase, to dp and from ground.
std::string bridge(const std::vector<std::string>& phases) {
  std::string cards;
  int number = 0;
  for (const std::string& phase : phases) {
    cards += "D" + std::to_string(++number) + " " + phase + " dp DX0\n";
    cards += "D" + std::to_string(++number) + " 0 " + phase + " DX0\n";
  }
  return cards;
}

// Random converters of tests/converters.
const std::vector<LeakCase> leak_cases{
    {"behind a passage its guard is at zero, and falls in the position that it has left",
     "full-bridge\n"
     "Vg0 g0 0 PULSE(0 1 1.252e-05 4.52e-08 4.52e-08 2.0635e-05 4.52e-05)\n"
     "Vg1 g1 0 PULSE(0 1 3.512e-05 4.52e-08 4.52e-08 2.0635e-05 4.52e-05)\n"
     "Vg2 g2 0 PULSE(0 1 2.6848e-05 4.52e-08 4.52e-08 2.0635e-05 4.52e-05)\n"
     "Vg3 g3 0 PULSE(0 1 4.9448e-05 4.52e-08 4.52e-08 2.0635e-05 4.52e-05)\n"
     "V1 in 0 325\n"
     "S1 in a g0 0 SX1\n"
     "D1 a in DX0\n"
     "S2 a 0 g1 0 SX1\n"
     "D2 0 a DX0\n"
     "S3 in b g2 0 SX1\n"
     "D3 b in DX0\n"
     "S4 b 0 g3 0 SX1\n"
     "D4 0 b DX0\n"
     "L1 a b 0.0434 ic=0\n"
     "L2 sa sb 0.00184172 ic=0\n"
     "D5 sa f DX0\n"
     "D6 0 sa DX0\n"
     "D7 sb f DX0\n"
     "D8 0 sb DX0\n"
     "L3 f out 0.0017 ic=0\n"
     "C1 out 0 8.26e-05 ic=0\n"
     "R1 out 0 19.7\n"
     "K1 L1 L2 0.99\n"
     ".model DX0 D(Ron=0 Roff=10000000000 Vfwd=1)\n"
     ".model SX1 SW(Ron=0 Roff=1000000000 Vt=0.5)\n"
     ".tran 2.2087e-05 0.00088348 uic\n"
     ".save i(L1) i(L2) i(L3) v(out,0)\n"
     ".end\n"},
    {"the current of a leak of 10^12 Ohm is gone before a snubber's capacitor has moved",
     "push-pull\n"
     "Vg0 g0 0 PULSE(0 1 7.38e-08 0 0 1.1513e-06 3.69e-06)\n"
     "Vg1 g1 0 PULSE(0 1 1.9188e-06 0 0 1.1513e-06 3.69e-06)\n"
     "V1 in 0 48\n"
     "L1 in a 2.5e-05 ic=0\n"
     "L2 b in 2.5e-05 ic=0\n"
     "S1 a 0 g0 0 SX1\n"
     "D1 0 a DX0\n"
     "S2 b 0 g1 0 SX1\n"
     "D2 0 b DX0\n"
     "R1 a sna 12.7\n"
     "C1 sna 0 3.11e-10 ic=0\n"
     "R2 b snb 3.75\n"
     "C2 snb 0 1.77e-09 ic=0\n"
     "L3 sa 0 4.55625e-05 ic=0\n"
     "L4 0 sb 4.55625e-05 ic=0\n"
     "D3 sa f DX0\n"
     "D4 sb f DX0\n"
     "L5 f out 0.00085 ic=0\n"
     "C3 out 0 6.74e-07 ic=0\n"
     "R3 out 0 48.5\n"
     "K1 L1 L2 L3 L4 0.99\n"
     ".model DX0 D(Ron=0.00647 Roff=1000000000000 Vfwd=0.3)\n"
     ".model SX1 SW(Ron=0.0289 Vt=0.5)\n"
     ".tran 1.8161e-06 7.2644e-05 uic\n"
     ".save i(L1) i(L2) v(sna,0) v(snb,0) i(L3) i(L4) i(L5) v(out,0)\n"
     ".end\n"},
    {"the same from the start on",
     "forward\n"
     "Vg0 g0 0 PULSE(0 1 1.0232e-06 5.21e-09 5.21e-09 1.0055e-06 5.21e-06)\n"
     "V1 in 0 400\n"
     "S1 in pa g0 0 SX1\n"
     "S2 pb 0 g0 0 SX1\n"
     "D1 0 pa DX0\n"
     "D2 pb in DX0\n"
     "L1 pa pb 0.00019 ic=0\n"
     "L2 s 0 5.95251e-06 ic=0\n"
     "D3 s f DX0\n"
     "D4 0 f DX0\n"
     "L3 f out 1.95e-06 ic=0\n"
     "C1 out 0 4.92e-05 ic=0\n"
     "R1 out 0 1.07\n"
     "K1 L1 L2 0.95\n"
     ".model DX0 D(Ron=0.00306 Roff=1000000000000 Vfwd=0.3)\n"
     ".model SX1 SW(Ron=0.00306 Roff=10000000 Vt=0.5)\n"
     ".tran 2.5848e-06 0.000103392 uic\n"
     ".save i(L1) i(L2) i(L3) v(out,0)\n"
     ".end\n"},
    {"a current that is zero to rounding makes a voltage across 10^11 Ohm",
     "single-phase\n"
     "V1 s p1 SIN(0 622 60 0 0 0)\n"
     "R1 s p0 0.0149\n"
     "D1 p0 dp DX0\n"
     "D2 0 p0 DX0\n"
     "D3 p1 dp DX0\n"
     "D4 0 p1 DX0\n"
     "C1 dp 0 4.61e-05 ic=0\n"
     "R2 dp 0 490\n"
     ".model DX0 D(Ron=0.00131 Roff=100000000 Vfwd=0.85)\n"
     ".model SX1 SW(Ron=0.0106 Roff=71200000 Vt=0.5)\n"
     ".tran 0.0020583 0.082332 uic\n"
     ".save v(dp,0)\n"
     ".end\n"},
    {"two diodes in series pass at one instant",
     "single-phase\n"
     "V1 s p1 SIN(0 17 60 0 0 35.5)\n"
     "L1 s p0 6.24e-06 ic=0\n"
     "D1 p0 dp DX0\n"
     "D2 0 p0 DX0\n"
     "D3 p1 dp DX0\n"
     "D4 0 p1 DX0\n"
     "C1 dp 0 0.000626 ic=0\n"
     "R1 dp 0 102\n"
     "R2 p0 x 2.2\n"
     "C2 x p1 2.84e-08 ic=0\n"
     ".model DX0 D(Ron=0.00623 Roff=10000000000 Vfwd=0.55)\n"
     ".model SX1 SW(Ron=0.00623 Roff=825000000 Vt=0.5)\n"
     ".tran 0.0020704 0.082816 uic\n"
     ".save i(L1) v(dp,0) v(x,p1)\n"
     ".end\n"},
    {"the second of two diodes that turn on together has no sign in a segment that is short out of habit",
     "six-phase\n"
     "V1 ps0 nn SIN(0 325 60 0 0 -75.3)\n"
     "L1 ps0 p0 1.4e-05 ic=0\n"
     "V2 ps1 nn SIN(0 325 60 0 0 -135.3)\n"
     "L2 ps1 p1 1.4e-05 ic=0\n"
     "V3 ps2 nn SIN(0 325 60 0 0 -195.3)\n"
     "L3 ps2 p2 1.4e-05 ic=0\n"
     "V4 ps3 nn SIN(0 325 60 0 0 -255.3)\n"
     "L4 ps3 p3 1.4e-05 ic=0\n"
     "V5 ps4 nn SIN(0 325 60 0 0 -315.3)\n"
     "L5 ps4 p4 1.4e-05 ic=0\n"
     "V6 ps5 nn SIN(0 325 60 0 0 -375.3)\n"
     "L6 ps5 p5 1.4e-05 ic=0\n" +
         bridge({"p0", "p1", "p2", "p3", "p4", "p5"}) +
         "C1 dp 0 1.76e-05 ic=0\n"
         "R1 dp 0 136\n"
         ".model DX0 D(Ron=0.00647 Roff=1000000 Vfwd=1)\n"
         ".model SX1 SW(Ron=0.012 Roff=100000000 Vt=0.5)\n"
         ".tran 0.0012285 0.04914 uic\n"
         ".save i(L1) i(L2) i(L3) i(L4) i(L5) i(L6) v(dp,0)\n"
         ".end\n"},
    {"small pivots leave the voltage of a diode that conducts six digits",
     "twelve-pulse\n"
     "V1 ps0 n1 SIN(0 325 60 0 0 0)\n"
     "L1 ps0 p0 2.25e-05 ic=0\n"
     "V2 ps1 n1 SIN(0 325 60 0 0 -120)\n"
     "L2 ps1 p1 2.25e-05 ic=0\n"
     "V3 ps2 n1 SIN(0 325 60 0 0 -240)\n"
     "L3 ps2 p2 2.25e-05 ic=0\n"
     "V4 qs0 n2 SIN(0 325 60 0 0 -30)\n"
     "L4 qs0 q0 2.25e-05 ic=0\n"
     "V5 qs1 n2 SIN(0 325 60 0 0 -150)\n"
     "L5 qs1 q1 2.25e-05 ic=0\n"
     "V6 qs2 n2 SIN(0 325 60 0 0 -270)\n"
     "L6 qs2 q2 2.25e-05 ic=0\n" +
         bridge({"p0", "p1", "p2", "q0", "q1", "q2"}) +
         "L7 dp out 0.00017 ic=0\n"
         "C1 out 0 0.000164 ic=0\n"
         "R1 out 0 13.1\n"
         ".model DX0 D(Ron=0.0276 Roff=41800000000 Vfwd=0.7)\n"
         ".model SX1 SW(Ron=0.0276 Roff=1000000000 Vt=0.5)\n"
         ".tran 0.00082508 0.0330032 uic\n"
         ".save i(L1) i(L2) i(L3) i(L4) i(L5) i(L6) i(L7) v(out,0)\n"
         ".end\n"},
    {"a decay that an event ends leaves the rate of a capacitor no digits",
     "cuk\n"
     "Vg0 g0 0 PULSE(0 1 9.48e-08 0 0 2.7065e-06 4.74e-06)\n"
     "V1 in 0 12\n"
     "L1 in fi 4.05e-05 ic=0\n"
     "C1 fi 0 5.73e-07 ic=12\n"
     "R1 in fi 10.5\n"
     "L2 fi a 0.000185 ic=0\n"
     "S1 a 0 g0 0 SX1\n"
     "C2 a b 3.88e-06 ic=0\n"
     "D1 b 0 DX0\n"
     "L3 b out 0.000136 ic=0\n"
     "C3 out 0 1.23e-06 ic=0\n"
     "R2 out 0 8.24\n"
     ".model DX0 D(Ron=0.0603 Roff=100000000 Vfwd=1)\n"
     ".model SX1 SW(Ron=0.0603 Roff=1000000000000 Vt=0.5)\n"
     ".tran 2.8246e-06 0.000112984 uic\n"
     ".save i(L1) v(fi,0) i(L2) v(a,b) i(L3) v(out,0)\n"
     ".end\n"},
    {"a decay turns a diode on while it lasts",
     "forward\n"
     "Vg0 g0 0 PULSE(0 1 1.129e-06 1.01e-08 1.01e-08 2.4543e-06 1.01e-05)\n"
     "V1 in 0 24\n"
     "S1 in pa g0 0 SX1\n"
     "S2 pb 0 g0 0 SX1\n"
     "D1 0 pa DX0\n"
     "D2 pb in DX0\n"
     "L1 pa pb 0.00282 ic=0\n"
     "L2 s 0 0.00106313 ic=0\n"
     "D3 s f DX0\n"
     "D4 0 f DX0\n"
     "L3 f out 0.000187 ic=0\n"
     "C1 out 0 5.82e-06 ic=0\n"
     "R1 out 0 52.4\n"
     "K1 L1 L2 0.95\n"
     ".model DX0 D(Ron=0.016 Roff=1000000000000 Vfwd=0.7)\n"
     ".model SX1 SW(Ron=0.016 Roff=114000000000 Vt=0.5)\n"
     ".tran 4.9466e-06 0.000197864 uic\n"
     ".save i(L1) i(L2) i(L3) v(out,0)\n"
     ".end\n"},
    {"too few vectors hide what a decay does to a diode",
     "forward\n"
     "Vg0 g0 0 PULSE(0 1 4.3116e-06 6.58e-08 6.58e-08 1.5266e-06 6.58e-06)\n"
     "V1 in 0 48\n"
     "S1 in pa g0 0 SX1\n"
     "S2 pb 0 g0 0 SX1\n"
     "D1 0 pa DX0\n"
     "D2 pb in DX0\n"
     "L1 pa pb 8.2e-05 ic=0\n"
     "L2 s 0 6.80141e-06 ic=0\n"
     "D3 s f DX0\n"
     "D4 0 f DX0\n"
     "L3 f out 5.17e-06 ic=0\n"
     "C1 out 0 0.000161 ic=0\n"
     "R1 out 0 0.854\n"
     "K1 L1 L2 0.99\n"
     ".model DX0 D(Ron=0.0266 Vfwd=0.55)\n"
     ".model SX1 SW(Ron=0.00157 Roff=32300000000 Vt=0.5)\n"
     ".tran 3.248e-06 0.00012992 uic\n"
     ".save i(L1) i(L2) i(L3) v(out,0)\n"
     ".end\n"},
    {"a decay that more vectors do not show has a segment of its own",
     "llc\n"
     "Vg0 g0 0 PULSE(0 1 1.02e-06 0 0 2.298e-06 4.95e-06)\n"
     "Vg1 g1 0 PULSE(1 0 1.02e-06 0 0 2.298e-06 4.95e-06)\n"
     "V1 in 0 12\n"
     "S1 in sw g0 0 SX1\n"
     "D1 sw in DX0\n"
     "S2 sw 0 g1 0 SX1\n"
     "D2 0 sw DX0\n"
     "C1 sw r 3.81e-10 ic=0\n"
     "L1 r p 0.0019 ic=0\n"
     "L2 p 0 0.012 ic=0\n"
     "L3 sa 0 0.000380208 ic=0\n"
     "L4 0 sb 0.000380208 ic=0\n"
     "D3 sa out DX0\n"
     "D4 sb out DX0\n"
     "C2 out 0 2.48e-06 ic=0\n"
     "R1 out 0 34.2\n"
     "K1 L2 L3 L4 0.995\n"
     ".model DX0 D(Ron=0.00704 Roff=133000000000 Vfwd=0.7)\n"
     ".model SX1 SW(Ron=0.0546 Vt=0.5)\n"
     ".tran 2.4112e-06 9.6448e-05 uic\n"
     ".save v(sw,r) i(L1) i(L2) i(L3) i(L4) v(out,0)\n"
     ".end\n"},
    {"an event within 2 ns of a leak's decay is below zero by less than its time has digits",
     "forward\n"
     "Vg0 g0 0 PULSE(0 1 3.9424e-06 4.12e-09 4.12e-09 1.4791e-06 4.12e-06)\n"
     "V1 in 0 24\n"
     "S1 in pa g0 0 SX1\n"
     "S2 pb 0 g0 0 SX1\n"
     "D1 0 pa DX0\n"
     "D2 pb in DX0\n"
     "L1 pa pb 4.5e-06 ic=0\n"
     "L2 s 0 9.8568e-06 ic=0\n"
     "D3 s f DX0\n"
     "D4 0 f DX0\n"
     "L3 f out 3.95e-05 ic=0\n"
     "C1 out 0 4.08e-06 ic=0\n"
     "R1 out 0 8.13\n"
     "K1 L1 L2 0.995\n"
     ".model DX0 D(Ron=0.0748 Roff=7330000000 Vfwd=0)\n"
     ".model SX1 SW(Ron=0.00159 Roff=5870000000 Vt=0.5)\n"
     ".tran 2.0315e-06 8.126e-05 uic\n"
     ".save i(L1) i(L2) i(L3) v(out,0)\n"
     ".end\n"},
    {"rates are in doubt for as long as a decay of picoseconds lasts",
     "llc\n"
     "Vg0 g0 0 PULSE(0 1 1.732e-05 0 0 1.603e-05 3.47e-05)\n"
     "Vg1 g1 0 PULSE(0 1 3.467e-05 0 0 1.603e-05 3.47e-05)\n"
     "V1 in 0 400\n"
     "S1 in sw g0 0 SX1\n"
     "D1 sw in DX0\n"
     "S2 sw 0 g1 0 SX1\n"
     "D2 0 sw DX0\n"
     "C1 sw r 1.82e-05 ic=0\n"
     "L1 r p 2.79e-06 ic=0\n"
     "L2 p 0 2.29e-05 ic=0\n"
     "L3 sa 0 7.41413e-06 ic=0\n"
     "L4 0 sb 7.41413e-06 ic=0\n"
     "D3 sa out DX0\n"
     "D4 sb out DX0\n"
     "C2 out 0 0.000834 ic=0\n"
     "R1 out 0 0.512\n"
     "K1 L2 L3 L4 0.99\n"
     ".model DX0 D(Ron=0.0245 Vfwd=0.3)\n"
     ".model SX1 SW(Ron=0.00544 Roff=156000000000 Vt=0.5)\n"
     ".tran 1.7118e-05 0.00068472 uic\n"
     ".save v(sw,r) i(L1) i(L2) i(L3) i(L4) v(out,0)\n"
     ".end\n"},
    {"what a decay that is over leaves of a voltage has no sign",
     "vienna\n"
     "Vg0 g0 0 PULSE(0 1 3.2027e-05 7.09e-08 7.09e-08 9.1461e-06 7.09e-05)\n"
     "Vg1 g1 0 PULSE(0 1 5.3297e-05 7.09e-08 7.09e-08 2.9353e-05 7.09e-05)\n"
     "Vg2 g2 0 PULSE(0 1 7.4567e-05 7.09e-08 7.09e-08 3.5875e-05 7.09e-05)\n"
     "V1 ps0 nn SIN(0 325 400 0 0 0)\n"
     "L1 ps0 p0 0.000408 ic=0\n"
     "V2 ps1 nn SIN(0 325 400 0 0 -120)\n"
     "L2 ps1 p1 0.000408 ic=0\n"
     "V3 ps2 nn SIN(0 325 400 0 0 -240)\n"
     "L3 ps2 p2 0.000408 ic=0\n"
     "D1 p0 dp DX0\n"
     "D2 dn p0 DX0\n"
     "D3 p1 dp DX0\n"
     "D4 dn p1 DX0\n"
     "D5 p2 dp DX0\n"
     "D6 dn p2 DX0\n"
     "S1 p0 m g0 0 SX1\n"
     "S2 p1 m g1 0 SX1\n"
     "S3 p2 m g2 0 SX1\n"
     "C1 dp m 5.7e-05 ic=0\n"
     "C2 m dn 5.7e-05 ic=0\n"
     "R1 dp m 34.8\n"
     "R2 m dn 68.9\n"
     "R3 m 0 1000\n"
     ".model DX0 D(Ron=0.0535 Vfwd=0)\n"
     ".model SX1 SW(Ron=0.0535 Roff=1000000000000 Vt=0.5)\n"
     ".tran 4.1939e-05 0.00167756 uic\n"
     ".save i(L1) i(L2) i(L3) v(dp,m) v(m,dn)\n"
     ".end\n"},
    {"a diode turns on once a decay is over that holds it off, however small it is beside a large store",
     "llc and solar cells\n"
     "Vg0 g0 0 PULSE(0 1 7.45e-07 1.7e-09 1.7e-09 7.7533e-06 1.7e-05)\n"
     "Vg1 g1 0 PULSE(0 1 9.245e-06 1.7e-09 1.7e-09 7.7533e-06 1.7e-05)\n"
     "V1 in 0 12\n"
     "S1 in sw g0 0 SX1\n"
     "D1 sw in DX0\n"
     "S2 sw 0 g1 0 SX1\n"
     "C1 sw r 2.29e-07\n"
     "L1 r p 2.69e-05\n"
     "L2 p 0 9.81e-05\n"
     "L3 sa sb 0.000290219\n"
     "D3 sa out DX0\n"
     "D4 0 sa DX0\n"
     "D5 sb out DX0\n"
     "D6 0 sb DX0\n"
     "C2 out 0 8.93e-05\n"
     "K1 L2 L3 0.98\n"
     ".model DX0 D(Ron=0.00868 Roff=10000000 Vfwd=0)\n"
     ".model SX1 SW(Ron=0.00868 Roff=6920000 Vt=0.5)\n"
     "I1_0 0 s1m1 8.0\n"
     "RP1_0 s1m1 0 50\n"
     "I1_1 s1m1 s1m2 PWL(0 8 1.666667e-03 8 3.666667e-03 1)\n"
     "RP1_1 s1m2 s1m1 50\n"
     "I1_2 s1m2 s1m3 PWL(0 8 2.000000e-03 8 4.000000e-03 1)\n"
     "RP1_2 s1m3 s1m2 50\n"
     "DS1 s1m3 bus DI\n"
     "I2_0 0 s2m1 8.0\n"
     "D2_1 s2m1 s2m2 DI\n"
     "D2_2 s2m2 s2m3 DI\n"
     "DS2 s2m3 bus DI\n"
     "CB bus 0 3.000000e-04 ic=90\n"
     "RB bus 0 3.750000e+00\n"
     ".model DI D\n"
     "RT1 sw s1m1 417\n"
     ".save i(L1) i(L2) i(L3) v(out)\n"
     ".tran 8.306e-06 0.00033224\n"
     ".end\n"},
    {"a decay that is a hundred times as fast as a ring holds a diode off, and no longer",
     "forward and buck\n"
     "Vg0 g0 0 PULSE(0 1 1.282e-07 6.41e-08 6.41e-08 1.5192e-06 6.41e-06)\n"
     "S1 in pa g0 0 SX1\n"
     "S2 pb 0 g0 0 SX1\n"
     "D1 0 pa DX0\n"
     "D2 pb in DX0\n"
     "L1 pa pb 0.000174\n"
     "L2 s 0 0.00032183\n"
     "D3 s f DX0\n"
     "K1 L1 L2 0.99\n"
     ".model DX0 D(Ron=0.00197 Roff=10000000000 Vfwd=0.3)\n"
     ".model SX1 SW(Ron=0.0468 Roff=100000000 Vt=0.5)\n"
     "V1b inb 0 24\n"
     "VGb gateb 0 PULSE(0 1 0 10n 10n 4.49u 10u)\n"
     "RPb inb hb 0.2\n"
     "LPb hb db 10n\n"
     "S1b db swb gateb 0 SWIb\n"
     "CSb db swb 200p\n"
     "D1b 0 swb DIb\n"
     "L1b swb outb 47u\n"
     "C1b outb 0 100u\n"
     ".model SWIb SW(Ron=0 Vt=0.5 Vh=0)\n"
     ".model DIb D\n"
     "RT1 f db 34.7\n"
     ".save i(L2) i(L1b) v(outb)\n"
     ".tran 0.4u 125u\n"
     ".end\n"},
    {"what follows a decay is below zero by less than a minimum that counts as a touch",
     "llc and half-bridge\n"
     "Vg0 g0 0 PULSE(0 1 5.178e-06 8.93e-08 8.93e-08 4.1477e-06 8.93e-06)\n"
     "Vg1 g1 0 PULSE(0 1 9.643e-06 8.93e-08 8.93e-08 4.1477e-06 8.93e-06)\n"
     "V1 in 0 48\n"
     "S1 in sw g0 0 SX1\n"
     "D1 sw in DX0\n"
     "S2 sw 0 g1 0 SX1\n"
     "D2 0 sw DX0\n"
     "C1 sw r 8.96e-09\n"
     "L1 r p 0.000258\n"
     "L2 p 0 0.00116\n"
     "L3 sa sb 4.36578e-05\n"
     "D3 sa out DX0\n"
     "D4 0 sa DX0\n"
     "D5 sb out DX0\n"
     "D6 0 sb DX0\n"
     "C2 out 0 0.000328\n"
     "R1 out 0 0.522\n"
     "K1 L2 L3 0.98\n"
     ".model DX0 D(Ron=0.0294 Roff=2690000000 Vfwd=0.7)\n"
     ".model SX1 SW(Ron=0.0202 Roff=100000000 Vt=0.5)\n"
     "V1b inb 0 48\n"
     "D2b 0 swb DX0b\n"
     "R1b inb cinb 0.452\n"
     "C1b cinb midb 8.83e-05 ic=24\n"
     "L1b swb midb 0.000119\n"
     "L2b sab 0 2.19009e-05\n"
     "L3b 0 sbb 2.19009e-05\n"
     "D4b sbb fb DX0b\n"
     "L4b fb outb 3.27e-06\n"
     "C3b outb 0 0.000206\n"
     "R2b outb 0 0.68\n"
     "K1b L1b L2b L3b 0.98\n"
     ".model DX0b D(Ron=0.0553 Roff=4350000000 Vfwd=0.3)\n"
     "RT1 p outb 1428\n"
     ".save i(L1) i(L2) i(L3) v(out)\n"
     ".tran 9.0046e-06 0.000360184\n"
     ".end\n"},
};

}  // namespace

TEST_CASE("converters behind large leaks agree between dense modes and Krylov segments", "[regression]") {
  constexpr double expected = 1e-7;  // of the largest value of a signal
  for (const LeakCase& c : leak_cases) {
    INFO(c.what << "\n" << c.deck);
    const auto [modes, segments] = test::run_both(c.deck);
    CHECK(test::largest_difference(modes, segments) <= expected);
  }
}

// An integral at its limit of 3 V, reached within 1 µs, stops an input that would move it by megavolts a second. D10 and D11 lead the ends of a floating winding to it. Where w, the winding's
// voltage, is negative, D11 conducts the leak of D10 (1 MΩ): by Kirchhoff's law v(n7) = 3.4 V and v(n6) = v(n7) + w. Where it is positive, D10 does that of D11: v(n6) = 3 V.
TEST_CASE("an integral at its limit does not hide the leak of a diode", "[regression]") {
  const std::string deck =
      "t\nBs1 s1 0 V={100*exp(-time*1e4)}\nR3 s1 n2 317.3\nA2 n2 o3 AM2\n.model AM2 int(gain=5e4 out_upper_limit=3)\nR5 o3 n8 163.82\n"
      "Vs7 s5 0 SIN(0 5 30k)\nX8 s5 0 n6 n7 xfmr\nD10 n6 n8 DZ\nD11 n7 n8 DX\n.model DX D(Roff=1G Vfwd=0.4)\n.model DZ D(Ron=10m "
      "Roff=1Meg)\n"
      ".save v(n6) v(n7)\n.tran 1.028u 100u\n";
  for (const auto& run : {test::run_text(deck), test::run_text_segments(deck)}) {
    INFO(run.messages << run.answer.message);
    REQUIRE(run.answer.outcome == engine::Outcome::completed);
    for (const auto& row : run.rows) {
      const double w = 5.0 * std::sin(2.0 * std::numbers::pi * 3e4 * row[0]);
      CHECK(row[1] - row[2] == Approx(w).margin(1e-10));
      if (row[0] < 1.5e-6 || std::abs(w) < 0.5) continue;
      CHECK((w < 0.0 ? row[2] - 3.4 : row[1] - 3.0) == Approx(0.0).margin(1e-9));
    }
  }
}
