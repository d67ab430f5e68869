// .ac: transfer functions against formulas and against a simulation of the test's own.

#include <catch2/catch.hpp>
#include <cmath>
#include <complex>
#include <filesystem>
#include <sstream>

#include "cli/json_result.hpp"
#include "cli/run_in.hpp"
#include "support/json.hpp"

using namespace pwlsim::test;
using Catch::Matchers::Contains;
using Complex = std::complex<double>;

namespace {

constexpr double two_pi = 2.0 * M_PI;
const std::string pulsed_rc = "rc\nV1 a 0 PULSE(0 1 0 0 0 0.5m 1m) AC 1\nR1 a b 1k\nC1 b 0 1u\n.save v(b)\n";
constexpr Complex j{0.0, 1.0};

Complex response(const Json& result, std::size_t frequency, const std::string& signal) {
  for (const Json& s : result["ac"]["signals"].array)
    if (s["name"].string == signal) return {s["re"][frequency].number, s["im"][frequency].number};
  FAIL("no signal " << signal);
  return {};
}

void check_equal(Complex value, Complex reference, double tolerance) {
  INFO(value << " beside " << reference);
  CHECK(std::abs(value - reference) <= tolerance * std::abs(reference));
}

/// 1/(1 + sL/R + s²LC)
Complex filter(double f, double l, double c, double r) {
  const Complex s = j * two_pi * f;
  return 1.0 / (1.0 + s * l / r + s * s * l * c);
}

const std::string synchronous_buck =
    "buck\nVin in 0 12\nVg g 0 PULSE(0 1 0 0 0 4u 10u)\nS1 in sw g 0 SX\nS2 sw 0 0 g SY\nL1 sw out 10u\nC1 out 0 100u\nR1 out 0 1\n"
    ".model SX SW(Ron=0 Vt=0.5)\n.model SY SW(Ron=0 Vt=-0.5)\n.save v(out)\n.pss\n";
const std::vector<double> around{100.0, 1e3, 1e4, 49e3, 120e3};
const std::string list = ".ac list 100 1k 10k 49k 120k";

}  // namespace

TEST_CASE("a linear circuit needs no orbit: magnitude and phase as rows", "[unit]") {
  const Scratch scratch;
  scratch.write("rlc.net", "rlc\nV1 in 0 DC 1 AC 2 90\nR1 in a 10\nL1 a out 1m\nC1 out 0 1u\n.save v(out) i(L1)\n.ac lin 3 1k 3k\n.end\n");
  CHECK(run_in(scratch, {"rlc.net"}).status == 0);
  std::istringstream rows(read_file(scratch / "rlc.ac.csv"));
  std::string line;
  std::getline(rows, line);
  CHECK(line == "frequency,vm(out),vp(out),im(L1),ip(L1)");
  for (const double f : {1e3, 2e3, 3e3}) {
    std::getline(rows, line);
    double frequency = 0.0, magnitude = 0.0, phase = 0.0;
    REQUIRE(std::sscanf(line.c_str(), "%lf,%lf,%lf", &frequency, &magnitude, &phase) == 3);
    const Complex s = j * two_pi * f;
    CHECK(frequency == f);
    check_equal(std::polar(magnitude, phase * M_PI / 180.0), 2.0 * j / (1.0 + s * 1e-5 + s * s * 1e-9), 1e-12);
  }
}

TEST_CASE("the response of a line of 1,000 sections is that of its transfer matrix", "[unit]") {
  constexpr int sections = 1000;
  constexpr double inductance = 1e-6, capacitance = 1e-9, leak = 1e6, load = 30.0;
  std::ostringstream deck;
  deck << "line\nV1 x0 0 DC 1 AC 1\n";
  for (int k = 1; k <= sections; ++k)
    deck << 'L' << k << " x" << k - 1 << " x" << k << " 1u\nC" << k << " x" << k << " 0 1n\nR" << k << " x" << k << " 0 1meg\n";
  deck << "RL x1000 0 30\n.save v(x1000)\n.ac list 0 1k 100k 3meg 9meg\n.end\n";
  const Json result = result_of(Scratch{}, deck.str());
  const std::vector<double> frequencies{0.0, 1e3, 1e5, 3e6, 9e6};
  for (std::size_t k = 0; k < frequencies.size(); ++k) {
    const Complex s = j * two_pi * frequencies[k];
    // From the load back to the source, for 1 V at the load.
    Complex voltage = 1.0, current = 1.0 / load;
    for (int i = 0; i < sections; ++i) {
      current += voltage * (1.0 / leak + s * capacitance);
      voltage += current * s * inductance;
    }
    check_equal(response(result, k, "v(x1000)"), 1.0 / voltage, 1e-11);
  }
}

TEST_CASE("a response may follow the second derivative of its source", "[unit]") {
  // The current of C1 in R1, differentiated: 5e-10 (jw)^2.
  const Json result =
      result_of(Scratch{},
                "second derivative\nV1 a 0 AC 1\nC1 a 0 1u\nF1 0 b V1 -0.5\nR1 b 0 1k\nB1 m 0 V={1e-6*ddt(v(b))}\nR2 m 0 1k\n.save v(m)\n"
                ".ac list 1k 1meg\n.end\n");
  for (const std::size_t k : {0U, 1U}) {
    const double omega = two_pi * (k == 0 ? 1e3 : 1e6);
    check_equal(response(result, k, "v(m)"), -5e-10 * omega * omega, 1e-12);
  }
}

TEST_CASE("at 0 Hz a node that only capacitors hold has no response, and others have theirs", "[unit]") {
  const Json result = result_of(Scratch{},
                                "divider\nV1 a 0 AC 1\nR1 a b 1k\nR2 b 0 3k\nC1 b c 1n\nC2 c 0 2n\nC3 d 0 1u\nR3 d b 1meg\nG1 0 e c 0 "
                                "1m\nR4 e 0 1k\n.save v(b) v(c) v(d) "
                                "v(e)\n.ac list 0 1m\n.end\n");
  const Json& signals = result["ac"]["signals"];
  for (const std::size_t defined : {0U, 2U}) CHECK(signals[defined]["re"][0].number == Approx(0.75).epsilon(1e-8));
  for (const std::size_t free : {1U, 3U}) CHECK(signals[free]["re"][0].kind == Json::Kind::null);
  check_equal(response(result, 1, "v(c)"), response(result, 1, "v(b)") / 3.0, 1e-12);
}

TEST_CASE("line and duty to output of an ideal buck are those of its filter, below and beyond half the switching frequency", "[unit]") {
  // The switch node is V_in·q(t): its component at f is D·v_in for the line, and V_in·d for a falling edge that moves by d·T (natural sampling).
  const Scratch scratch;
  const Json line = result_of(scratch, synchronous_buck + list + " from=Vin\n.end\n");
  const Json duty = result_of(scratch, synchronous_buck + list + " from=duty(Vg)\n.end\n");
  for (std::size_t k = 0; k < around.size(); ++k) {
    const Complex h = filter(around[k], 10e-6, 100e-6, 1.0);
    check_equal(response(line, k, "v(out)"), 0.4 * h, 1e-11);
    check_equal(response(duty, k, "v(out)"), 12.0 * h, 1e-11);
  }
}

TEST_CASE("a comparator with a ramp moves edges by what its input is then", "[unit]") {
  const Scratch scratch;
  std::string deck = synchronous_buck;
  deck.replace(deck.find("Vg g 0 PULSE(0 1 0 0 0 4u 10u)"), 30, "Vr r 0 PULSE(0 2 0 10u 0 0 10u)\nVc g 0 0.8 AC 1");
  deck.replace(deck.find("S1 in sw g 0"), 12, "S1 in sw g r");
  deck.replace(deck.find("S2 sw 0 0 g"), 11, "S2 sw 0 r g");
  deck.replace(deck.find("Vt=0.5"), 6, "Vt=0");
  deck.replace(deck.find("Vt=-0.5"), 7, "Vt=0");
  const Json result = result_of(scratch, deck + list + "\n.end\n");
  for (std::size_t k = 0; k < around.size(); ++k)
    check_equal(response(result, k, "v(out)"), 6.0 * filter(around[k], 10e-6, 100e-6, 1.0), 1e-11);  // V_in over the ramp's 2 V
}

TEST_CASE("sidebands of a switched voltage", "[unit]") {
  // v(sw) = V_in·q(t): a line component at f comes back at f + m·f_s with the m-th Fourier coefficient of q, (1 − e^{−j2πmD})/(j2πm), D = 0.4.
  const Scratch scratch;
  const Json result = result_of(scratch, synchronous_buck + ".save v(sw)\n.ac list 1k from=Vin harm=2\n.end\n");
  check_equal(response(result, 0, "v(sw)"), (1.0 - std::exp(-j * two_pi * 2.0 * 0.4)) / (j * two_pi * 2.0), 1e-11);
}

TEST_CASE("a closed loop with a comparator, beside a simulation of small sines", "[unit]") {
  // RC filter, R = 1 kΩ, C = 1 µF, switched to 10 V while v_c − 0.05·v + ε·cos ωt lies above a ramp of 0 … 1 V in T = 1 ms. The reference follows the same
  // circuit by closed forms and bisection, over 40 periods that hold 13 of the sine, after it has settled; ε = ±1e-5, so that its error is of the order ε².
  const double period = 1e-3, tau = 1e-3, supply = 10.0, control = 0.7, gain = 0.05;
  const int periods = 40, cycles = 13;
  const double f = cycles / (periods * period), omega = two_pi * f;
  const auto mean = [&](double epsilon) {  // (2/N T) ∫ v e^{−jωt} dt over the 40 periods
    double v = 4.0;
    Complex sum = 0.0;
    for (int k = 0; k < 25 * periods; ++k) {
      const double begin = k * period;
      const auto rising = [&](double t) { return supply + (v - supply) * std::exp(-t / tau); };
      const auto margin = [&](double t) { return control - gain * rising(t) + epsilon * std::cos(omega * (begin + t)) - t / period; };
      double low = 0.0, high = period;
      for (int step = 0; step < 60; ++step) (margin(0.5 * (low + high)) > 0.0 ? low : high) = 0.5 * (low + high);
      const double edge = low, top = rising(edge);
      const auto integral = [&](double level, double start, double from,
                                double length) {  // of (level + (start − level)e^{−t/τ})·e^{−jω(from + t)}
        const Complex turn = std::exp(-j * omega * from);
        return turn * (level * (1.0 - std::exp(-j * omega * length)) / (j * omega) +
                       (start - level) * (1.0 - std::exp(-(1.0 / tau + j * omega) * length)) / (1.0 / tau + j * omega));
      };
      if (k >= 24 * periods) sum += integral(supply, v, begin, edge) + integral(0.0, top, begin + edge, period - edge);
      v = top * std::exp(-(period - edge) / tau);
    }
    return 2.0 * sum / (periods * period);
  };
  const double epsilon = 1e-5;
  const Complex reference = (mean(epsilon) - mean(-epsilon)) / (2.0 * epsilon);
  const Scratch scratch;
  std::ostringstream deck;
  deck.precision(17);
  deck << "loop\nVs p 0 10\nVr r 0 PULSE(0 1 0 1m 0 0 1m)\nVc c 0 0.7 AC 1\nE1 e 0 VALUE={V(c)-0.05*V(o)}\nS1 p a e r SX\nS2 a 0 r e "
          "SX\nR1 a o 1k\nC1 o 0 1u "
          "ic=4\n.model SX SW(Ron=0 Vt=0)\n.save v(o)\n.pss uic\n.ac list "
       << f << "\n.end\n";
  check_equal(response(result_of(scratch, deck.str()), 0, "v(o)"), reference, 1e-7);
}

TEST_CASE("the sampled response of an RC circuit is that of its difference equation", "[unit]") {
  // The switch is closed for h = T/2, then the resistor is grounded: v(nT + T) = a·(a·v(nT) + g·e^{jωnT}), a = e^{−h/τ}, where the input e^{jωt} leaves
  // g = (e^{jωh} − a)/(1 + jωτ) after h. With v(nT) = r·e^{jωnT}: r = a·g/(e^{jωT} − a²).
  const Scratch scratch;
  const Json result = result_of(scratch,
                                "rc\nV1 p 0 5 AC 1\nVg g 0 PULSE(0 1 0 0 0 0.5m 1m)\nS1 p a g 0 SX\nS2 a 0 0 g SY\nR1 a o 1k\nC1 o 0 1u\n"
                                ".model SX SW(Ron=0 Vt=0.5)\n.model SY SW(Ron=0 Vt=-0.5)\n.save v(o)\n.pss\n.ac list 130 sample=0\n.end\n");
  const double period = 1e-3, half = 0.5e-3, tau = 1e-3, omega = two_pi * 130.0, a = std::exp(-half / tau);
  const Complex gained = (std::exp(j * omega * half) - a) / (1.0 + j * omega * tau);
  check_equal(response(result, 0, "v(o)"), a * gained / (std::exp(j * omega * period) - a * a), 1e-11);
}

TEST_CASE("a loop gain with its crossover and phase margin", "[unit]") {
  // T = 100/(1 + sRC): |T| = 1 at √(100² − 1)/(2πRC), where its phase is −atan √(100² − 1).
  const Scratch scratch;
  const Json result =
      result_of(scratch, "loop\nE1 o 0 0 fb 100\nR1 o x 1k\nC1 x 0 1u\nVinj fb x 0\n.save v(x)\n.ac dec 5 10 100k loop=Vinj\n.end\n");
  const Json& loop = result["ac"]["loops"][0];
  CHECK(loop["source"].string == "Vinj");
  REQUIRE(loop["crossovers"].array.size() == 1);
  const double root = std::sqrt(1e4 - 1.0);
  CHECK(loop["crossovers"][0]["frequency"].number == Approx(root / (two_pi * 1e-3)).epsilon(1e-10));
  CHECK(loop["crossovers"][0]["phase_margin"].number == Approx(180.0 - std::atan(root) * 180.0 / M_PI).epsilon(1e-10));
  CHECK(loop["gain_margins"].array.empty());
  check_equal({loop["re"][5].number, loop["im"][5].number}, 100.0 / (1.0 + j * two_pi * 100.0 * 1e-3), 1e-11);
}

TEST_CASE("voltage and current injected: a loop gain where both sides have the same impedance", "[unit]") {
  // T = 100·Z/(R1 + Z) with Z = R2 beside C1; Middlebrook 1975: the ratio of voltages alone is T + Zo/Zi, neither side being open.
  const Scratch scratch;
  const std::string deck = "loop\nE1 o 0 0 fb 100\nR1 o x 1k\nC1 x 0 1u\nR2 fb 0 1k\nVinj fb x 0\n.save v(x)\n";
  const double r = 1e3, c = 1e-6;
  const std::complex<double> s = j * two_pi * 100.0, z = r / (1.0 + s * r * c), expected = 100.0 * z / (r + z);
  for (const char* source : {"Iinj 0 fb 0", "Iinj fb 0 0", "Iinj 0 x 0"}) {
    INFO(source);
    const Json result = result_of(scratch, deck + source + "\n.ac list 100 loop=Vinj,Iinj\n.end\n");
    const Json& loop = result["ac"]["loops"][0];
    check_equal({loop["re"][0].number, loop["im"][0].number}, expected, 1e-12);
  }
  scratch.write("apart.net", deck + "Iinj 0 o 0\n.ac list 100 loop=Vinj,Iinj\n.end\n");
  const Finished finished = run_in(scratch, {"apart.net"});
  CHECK(finished.status == 2);
  CHECK_THAT(finished.err, Contains("error[E-ac-no-input]") && Contains("Iinj is not a current source at a node of Vinj"));
}

TEST_CASE("an .ac that cannot be is refused by name, beside a .tran too; nothing is written then", "[unit]") {
  const Scratch scratch;
  const std::string rectifier = "rectifier\nV1 a 0 SIN(0 1 50) AC 1\nD1 a b DX\nR1 b 0 1k\n.model DX D\n.ac dec 1 1 10\n";
  scratch.write("switches.net", rectifier + ".end\n");
  const Finished needs = run_in(scratch, {"switches.net"});
  CHECK(needs.status == 2);
  CHECK_THAT(needs.err, Contains("error[E-ac-needs-pss]: D1 switches"));
  scratch.write("tran.net", rectifier + ".tran 1m 20m\n.end\n");
  const Finished beside = run_in(scratch, {"tran.net"});
  CHECK(beside.status == 2);
  CHECK_THAT(beside.err, Contains("tran.net:6:1: error[E-ac-needs-pss]: D1 switches"));
  CHECK_FALSE(std::filesystem::exists(scratch / "tran.csv"));
  scratch.write("still.net", "still\nV1 a 0 1\nR1 a b 1k\nC1 b 0 1u\n.ac dec 1 1 10\n.end\n");
  const Finished still = run_in(scratch, {"still.net"});
  CHECK(still.status == 2);
  CHECK_THAT(still.err, Contains("error[E-ac-no-input]"));
  scratch.write("both.net", "both\nV1 a 0 1\nR1 a b 1k\nC1 b 0 1u\n.tran 1m 2m\n.ac dec 1 1 10\n.end\n");
  const Finished both = run_in(scratch, {"both.net"});
  CHECK(both.status == 2);
  CHECK_THAT(both.err, Contains("error[E-ac-no-input]"));
  CHECK_FALSE(std::filesystem::exists(scratch / "both.csv"));
}

TEST_CASE(".print ac chooses columns", "[unit]") {
  // 1/(1 + jωRC) at ωRC = 1: 1/√2, −45 degrees, 1/2 − j/2.
  const Scratch scratch;
  scratch.write("rc.net",
                "rc\nV1 a 0 AC 1\nR1 a b 1k\nC1 b 0 1u\n.save v(a)\n.print ac vdb(b) vr(b) vi(b) i(R1)\n.ac list {1/(2*pi*1m)}\n.end\n");
  CHECK(run_in(scratch, {"rc.net"}).status == 0);
  std::istringstream rows(read_file(scratch / "rc.ac.csv"));
  std::string head, row;
  std::getline(rows, head);
  std::getline(rows, row);
  CHECK(head == "frequency,vdb(b),vr(b),vi(b),im(R1),ip(R1)");
  double values[6] = {};
  REQUIRE(std::sscanf(row.c_str(), "%lf,%lf,%lf,%lf,%lf,%lf", &values[0], &values[1], &values[2], &values[3], &values[4], &values[5]) == 6);
  CHECK(values[1] == Approx(-10.0 * std::log10(2.0)).epsilon(1e-12));
  CHECK(values[2] == Approx(0.5).epsilon(1e-12));
  CHECK(values[3] == Approx(-0.5).epsilon(1e-12));
  CHECK(values[4] == Approx(1e-3 / std::sqrt(2.0)).epsilon(1e-12));  // 1 V·jωC/(1 + jωRC)
  CHECK(values[5] == Approx(45.0).epsilon(1e-12));
}

TEST_CASE("standard output takes the rows of one analysis", "[unit]") {
  const Scratch scratch;
  scratch.write("two.net", pulsed_rc + ".pss\n.tran 1m 2m\n.end\n");
  const Finished two = run_in(scratch, {"two.net", "-o", "-"});
  CHECK(two.status == 2);
  CHECK_THAT(two.err, Contains("error[E-option-conflict]"));
  scratch.write("run.net", pulsed_rc + ".tran 1m 2m\n.ac lin 1 100 100\n.end\n");
  const Finished run = run_in(scratch, {"run.net", "-o", "-"});
  CHECK(run.status == 0);
  CHECK(run.out.starts_with("time,v(b)\n0,0"));
  CHECK_THAT(run.err, Contains("the rows of .ac are left out"));
  scratch.write("alone.net", pulsed_rc + ".ac lin 1 100 100\n.end\n");
  CHECK(run_in(scratch, {"alone.net", "-o", "-"}).out.starts_with("frequency,vm(b),vp(b)\n100,"));
}

// /dev/null.ac.csv is a file that nobody asked for, and most may not write.
TEST_CASE("a device takes the rows of one analysis", "[unit]") {
  const Scratch scratch;
  scratch.write("two.net", pulsed_rc + ".pss\n.tran 1m 2m\n.end\n");
  const Finished two = run_in(scratch, {"two.net", "-o", "/dev/null"});
  CHECK(two.status == 2);
  CHECK_THAT(two.err, Contains("/dev/null takes one table"));
  scratch.write("run.net", pulsed_rc + ".tran 1m 2m\n.meas tran m AVG v(b)\n.sens param=R1\n.ac lin 1 100 100\n.end\n");
  const Finished run = run_in(scratch, {"run.net", "-o", "/dev/null"});
  CHECK(run.status == 0);
  CHECK_THAT(run.err, Contains("the rows of .ac are left out: /dev/null takes those of .tran"));
  scratch.write("alone.net", pulsed_rc + ".ac lin 1 100 100\n.end\n");
  CHECK(run_in(scratch, {"alone.net", "-o", "/dev/null"}).status == 0);
  for (const char* name : {"/dev/null.ac.csv", "/dev/null.sens.csv", "/dev/null.pss.csv"}) CHECK_FALSE(std::filesystem::exists(name));
}

TEST_CASE("runs of .step have their responses in one table", "[unit]") {
  // |1/(1 + jωRC)| at ωRC = 1 and 2.
  const Scratch scratch;
  const std::string deck =
      "rc\n.param r=1k\nV1 a 0 PULSE(0 1 0 0 0 0.5m 1m) AC 1\nR1 a b {r}\nC1 b 0 1u\n.save v(b)\n.step param r list 1k 2k\n.ac list "
      "{1/(2*pi*1m)}\n";
  for (const std::string card : {"", ".pss\n", ".tran 1m 2m\n"}) {
    scratch.write("rc.net", deck + card + ".end\n");
    const Finished finished = run_in(scratch, {"rc.net", "--json"});
    REQUIRE(finished.status == 0);
    std::istringstream rows(read_file(scratch / "rc.ac.csv"));
    std::string line;
    std::getline(rows, line);
    CHECK(line == "r,frequency,vm(b),vp(b)");
    for (const double r : {1000.0, 2000.0}) {
      double stepped = 0.0, f = 0.0, magnitude = 0.0, phase = 0.0;
      char comma = 0;
      rows >> stepped >> comma >> f >> comma >> magnitude >> comma >> phase;
      CHECK(stepped == r);
      CHECK(magnitude == Approx(std::abs(1.0 / (1.0 + j * r * 1e-3))).epsilon(1e-12));
      CHECK(phase == Approx(-std::atan(r * 1e-3) * 180.0 / M_PI).epsilon(1e-12));
    }
    const Json result = read_json(finished.out);
    CHECK(result["runs"][1]["failure"].kind == Json::Kind::null);
    check_equal(response(result["runs"][1], 0, "v(b)"), 1.0 / (1.0 + 2.0 * j), 1e-12);
  }
}

TEST_CASE("an .ac around the operating point of an amplifier does not stop the .tran or .op beside it", "[unit]") {
  const Scratch scratch;
  // Without the transistor's base current, 1.9 V - 0.7 V over 1 kΩ flow through 4.7 kΩ, too: near 12 V - 5.64 V.
  const std::string amplifier =
      "amplifier\nVCC vcc 0 12\nVB b 0 DC 1.9 AC 1\nRC vcc c 4.7k\nRE e 0 1k\nQ1 c b e QM\n.model QM NPN(IS=1e-15 BF=200)\n.ac dec 1 1 "
      "10\n";
  scratch.write("tran.net", amplifier + ".tran 1u 1m\n.meas c AVG v(c)\n.end\n");
  const Finished beside = run_in(scratch, {"tran.net"});
  INFO(beside.err);
  REQUIRE(beside.status == 0);
  CHECK_THAT(beside.err, Contains("tran.net:8:1: warning[W-ignored-card]: this .ac is left out: Q1"));
  CHECK(value_of(beside.out, "c") == Approx(6.36).epsilon(0.05));
  CHECK_FALSE(std::filesystem::exists(scratch / "tran.ac.csv"));
  scratch.write("op.net", amplifier + ".op\n.end\n");
  CHECK(run_in(scratch, {"op.net"}).status == 0);
  scratch.write("step.net", amplifier + ".tran 1u 1m\n.step param r list 1 2\n.param r=1\n.end\n");
  CHECK(run_in(scratch, {"step.net"}).status == 0);
  scratch.write("alone.net", amplifier + ".end\n");
  const Finished alone = run_in(scratch, {"alone.net"});
  CHECK(alone.status == 2);
  CHECK_THAT(alone.err, Contains("error[E-ac-needs-pss]: Q1"));
  scratch.write("own.net",
                "own\nV1 p 0 9\nV3 i 0 SINE(4 0.05 1k) AC 1\nX1 i o p 0 o UniversalOpAmp2 Avol=1Meg GBW=1Meg Slew=1Meg\nR1 o 0 1k\n"
                ".ac dec 1 1 10\n.tran 10u 1m\n.end\n");
  const Finished own = run_in(scratch, {"own.net"});
  INFO(own.err);
  CHECK(own.status == 0);
  CHECK_THAT(own.err, Contains("this .ac is left out: X1."));
}

TEST_CASE("runs of .step that have no response are refused, beside a .tran too", "[unit]") {
  const Scratch scratch;
  const std::string rectifier =
      "rectifier\n.param r=1k\nV1 a 0 SIN(0 1 50) AC 1\nD1 a b DX\nR1 b 0 {r}\n.model DX D\n.step param r list 1k 2k\n.ac dec 1 1 10\n";
  scratch.write("switches.net", rectifier + ".end\n");
  const Finished needs = run_in(scratch, {"switches.net"});
  CHECK(needs.status == 2);
  CHECK_THAT(needs.err, Contains("error[E-ac-needs-pss]"));
  scratch.write("tran.net", rectifier + ".tran 1m 20m\n.end\n");
  const Finished beside = run_in(scratch, {"tran.net"});
  CHECK(beside.status == 2);
  CHECK_THAT(beside.err, Contains("error[E-ac-needs-pss]"));
  CHECK_FALSE(std::filesystem::exists(scratch / "tran.csv"));
}

TEST_CASE("an input that is not there is shown on its card, before an orbit is written; one within a subcircuit has a dot or a colon",
          "[unit]") {
  const Scratch scratch;
  const std::string deck =
      "rc\n.subckt s a b\nV1 a m PULSE(0 1 0 0 0 0.5m 1m)\nR1 m b 1k\n.ends\nX1 0 b s\nC1 b 0 1u\n.save v(b)\n.pss\n.ac list {1/(2*pi*1m)} "
      "from=";
  scratch.write("none.net", deck + "V1\n.end\n");
  const Finished none = run_in(scratch, {"none.net"});
  CHECK(none.status == 2);
  CHECK_THAT(none.err, Contains("none.net:10:29: error[E-ac-no-input]: V1 is not a source"));
  CHECK_FALSE(std::filesystem::exists(scratch / "none.csv"));
  // −1/(1 + j): the source's n+ is at ground.
  for (const std::string name : {"x1.v1", "X1:V1"})
    check_equal(response(result_of(scratch, deck + name + "\n.end\n"), 0, "v(b)"), -1.0 / (1.0 + j), 1e-12);
}

TEST_CASE("what belongs to a period needs one", "[unit]") {
  const Scratch scratch;
  for (const std::string what : {"harm=1", "sample=0.1m", "from=freq(V1)", "from=duty(V1)"}) {
    scratch.write("rc.net", "rc\nV1 a 0 PULSE(0 1 0 0 0 0.5m 1m) AC 1\nR1 a b 1k\nC1 b 0 1u\n.ac list 1k " + what + "\n.end\n");
    const Finished finished = run_in(scratch, {"rc.net"});
    CHECK(finished.status == 2);
    CHECK_THAT(finished.err, Contains("error[E-ac-needs-pss]: " + what.substr(what.starts_with("from=") ? 5 : 0, 4)));
  }
}

TEST_CASE("frequency modulation moves ramps, too: a triangle through an RC circuit and onto a loop of capacitors", "[unit]") {
  // s(t + δτ), δτ = e^{jωt}/(jω f₀): the m-th sideband of the triangle is jmω₀ S_m δτ, S_m its Fourier coefficient.
  const Scratch scratch;
  const double period = 1e-5, ramp = 0.4, w0 = two_pi / period;
  const auto sideband = [&](int m, double f) {
    const Complex k = j * (m * w0 * period);  // by parts: S_m = Σ slope·(e^{−k t₀} − e^{−k t₁})/k², t in periods
    const Complex s = ((1.0 - std::exp(-k * ramp)) / ramp - (std::exp(-k * ramp) - std::exp(-k)) / (1.0 - ramp)) / (k * k);
    return j * (m * w0) * s * period / (j * two_pi * f);
  };
  const std::string rc = "rc\nV1 a 0 PULSE(0 1 0 4u 6u 0 10u)\nR1 a b 1k\nC1 b 0 2n\n.save v(b)\n.pss\n",
                    pair = "pair\nV1 a 0 PULSE(0 1 0 4u 6u 0 10u)\nC1 a b 1n\nC2 b 0 1n\nR1 b 0 1k\n.save v(b) i(C1)\n.pss\n";
  for (const int m : {1, -2}) {
    const std::string card = list + " from=freq(V1) harm=" + std::to_string(m) + "\n.end\n";
    const Json by_resistor = result_of(scratch, rc + card), by_capacitor = result_of(scratch, pair + card);
    for (std::size_t k = 0; k < around.size(); ++k) {
      const Complex u = sideband(m, around[k]), s = j * (two_pi * around[k] + m * w0);
      check_equal(response(by_resistor, k, "v(b)"), u / (1.0 + s * 2e-6), 1e-12);
      const Complex b = u * s * 1e-9 / (s * 2e-9 + 1e-3);
      check_equal(response(by_capacitor, k, "v(b)"), b, 1e-12);
      check_equal(response(by_capacitor, k, "i(C1)"), (u - b) * s * 1e-9, 1e-12);
    }
  }
}

TEST_CASE("frequency modulation of a ramp that meets a sine: the crossing moves by the ramp's share of the slope", "[unit]") {
  // r(t) = t/T meets c(t) = 0.5 + 0.2 sin(ω₀t + 30°) at t₁, found by bisection: δt₁ = −δτ·r′/(r′ − c′); the reset of the ramp moves by −δτ.
  const Scratch scratch;
  const double period = 1e-5, w0 = two_pi / period;
  const auto apart = [&](double t) { return t / period - 0.5 - 0.2 * std::sin(w0 * t + M_PI / 6.0); };
  double low = 0.0, high = period;
  for (int k = 0; k < 100; ++k) (apart(0.5 * (low + high)) < 0.0 ? low : high) = 0.5 * (low + high);
  const double slope = 1.0 / period, sine = 0.2 * w0 * std::cos(w0 * low + M_PI / 6.0);
  const std::string deck =
      "pwm\nV1 r 0 PULSE(0 1 0 10u 0 0 10u)\nV2 c 0 SIN(0.5 0.2 100k 0 0 30)\nVin in 0 12\nS1 in sw c r SX\nR1 sw 0 1\n.model SX SW(Ron=0 "
      "Vt=0)\n.save v(sw)\n.pss uic\n";
  for (const int m : {0, 1}) {
    const Json result = result_of(scratch, deck + list + " from=freq(V1) harm=" + std::to_string(m) + "\n.end\n");
    for (std::size_t k = 0; k < around.size(); ++k) {
      const Complex tau = period / (j * two_pi * around[k]);
      const Complex expected = 12.0 / period * (tau - tau * slope / (slope - sine) * std::exp(-j * (m * w0 * low)));
      check_equal(response(result, k, "v(sw)"), expected, 1e-10);
    }
  }
}

TEST_CASE("a constant input of a self-timed orbit: the response is the derivative of the mean", "[unit]") {
  // C1 charges from a to b towards V over R1, and is shorted over R2 back to a: T = t₁ + t₂, mean = (V t₁ + W t₂ − (b − a)(τ₁ − τ₂))/T with
  // W = V R2/(R1 + R2), t₁ = τ₁ ln((V − a)/(V − b)), t₂ = τ₂ ln((b − W)/(a − W)). The derivative by a central difference in 80 bits, step 1e-5.
  const Scratch scratch;
  const auto mean = [](long double v) {
    const long double a = 3, b = 7, tau1 = 1e-3L, tau2 = 1e-6L * 1000 * 100 / 1100, w = v * 100 / 1100;
    const long double t1 = tau1 * std::log((v - a) / (v - b)), t2 = tau2 * std::log((b - w) / (a - w));
    return (v * t1 + w * t2 - (b - a) * (tau1 - tau2)) / (t1 + t2);
  };
  const long double h = 1e-5L;
  const auto expected = static_cast<double>((mean(10 + h) - mean(10 - h)) / (2 * h));
  const Json result = result_of(scratch,
                                "osc\nV1 vcc 0 10 AC 1\nR1 vcc a 1k\nC1 a 0 1u\nS1 a b a 0 SX\nR2 b 0 100\n.model SX SW(Ron=0 Vt=5 "
                                "Vh=2)\n.save v(a)\n.pss\n.ac list 0 0.01\n.end\n");
  CHECK(response(result, 0, "v(a)").real() == Approx(expected).epsilon(1e-9));
  CHECK(response(result, 0, "v(a)").imag() == 0.0);
  CHECK(response(result, 1, "v(a)").real() == Approx(expected).epsilon(1e-7));
}

namespace {

std::string pump(const std::string& card) {
  return "pump\nVin in 0 5\nVg g 0 PULSE(0 1 0 0 0 5u 10u)\nS1 in a g 0 SX\nC1 a 0 1u\nS2 a out 0 g SY\nC2 out 0 10u\nR1 out 0 1k\n"
         ".model SX SW(Vt=0.5)\n.model SY SW(Vt=-0.5)\n.save v(out) i(Vin)\n.pss\n" +
         card + "\n.end\n";
}

}  // namespace

// C₁ is charged at t = 0 from what v(out) has become, C₁(1 − x₀), and follows the source until 5 µs, C₁jω; then it shares its charge, and both discharge, later C₂ alone:
// x₀ e^{jωT} = E₂ (C₁ e^{jωT/2} + C₂ E₁ x₀)/(C₁ + C₂).
TEST_CASE("a current that is impulses has a response", "[unit]") {
  const Scratch scratch;
  const Json result = result_of(scratch, pump(".meas pss mean AVG v(out)\n.meas pss i AVG i(Vin)\n.ac list 0 1k 77k from=Vin"));
  const double c1 = 1e-6, c2 = 10e-6, period = 10e-6, half = 5e-6;
  const double e1 = std::exp(-half / (1e3 * c2)), e2 = std::exp(-half / (1e3 * (c1 + c2)));
  const double frequencies[] = {0.0, 1e3, 77e3};
  for (std::size_t k = 0; k < 3; ++k) {
    const Complex s = j * two_pi * frequencies[k];
    const Complex x = e2 * c1 * std::exp(s * half) / (c1 + c2) / (std::exp(s * period) - e2 * c2 * e1 / (c1 + c2));
    check_equal(response(result, k, "i(Vin)"), -(c1 / period * (1.0 - x) + s * c1 * half / period), 1e-10);
  }
  // Linear in Vin: at 0 Hz the responses are the means over Vin.
  check_equal(response(result, 0, "v(out)"), result["measurements"][0]["value"].number / 5.0, 1e-11);
  check_equal(response(result, 0, "i(Vin)"), result["measurements"][1]["value"].number / 5.0, 1e-11);
}

TEST_CASE("impulses at edges that move have no response, with a warning; voltages beside them have theirs", "[unit]") {
  const Scratch scratch;
  scratch.write("pump.net", pump(".ac list 1k from=duty(Vg)"));
  const Finished finished = run_in(scratch, {"pump.net", "--json"});
  REQUIRE(finished.status == 0);
  CHECK_THAT(finished.err, Contains("warning[W-ac-impulse]: no response of i(Vin)"));
  const Json result = read_json(finished.out);
  CHECK(result["ac"]["signals"][0]["re"][0].kind == Json::Kind::number);
  CHECK(result["ac"]["signals"][1]["re"][0].kind == Json::Kind::null);
  CHECK_THAT(read_file(scratch / "pump.ac.csv"), Contains(",,\n"));
}

namespace {

/// A capacitor that a current charges for the first half of each period: multiplier 1.
const std::string half_charged =
    "half\nI1 0 a AC 1\nS1 a b c 0 SM\nS2 a 0 d 0 SM\nC1 b 0 1u ic=0\nV1 c 0 PULSE(0 1 0 0 0 0.5m 1m)\nV2 d 0 PULSE(1 0 0 0 0 0.5m 1m)\n"
    "V3 g 0 PULSE(0 1 0.1m 0 0 0.2m 1m)\nB1 o 0 V={V(b)*V(g)}\nR1 o 0 1\n.model SM SW(Vt=0.5)\n.pss uic\n.save v(b) v(o)\n";

}  // namespace

TEST_CASE("an infinite response is empty, with a warning", "[unit]") {
  // The integral of e^{jωt} over half a period is not zero at the frequency of the switching.
  const Scratch scratch;
  scratch.write("half.net", half_charged + ".ac list 500 1k\n.end\n");
  const Finished finished = run_in(scratch, {"half.net", "--json"});
  CHECK(finished.status == 0);
  CHECK_THAT(finished.err, Contains("warning[W-ac-singular]") && Contains("1 kHz"));
  CHECK_THAT(read_file(scratch / "half.ac.csv"), Contains("\n1000,,"));
  const Json result = read_json(finished.out);
  CHECK(result["ac"]["signals"][0]["re"][1].kind == Json::Kind::null);
  CHECK(result["ac"]["signals"][0]["im"][1].kind == Json::Kind::null);
}

TEST_CASE("a resonance that the input does not excite has a response", "[unit]") {
  const Scratch scratch;
  scratch.write("half.net", half_charged + ".ac list 1.9995k 1.9999k 2k 2.0001k 2.0005k\n.end\n");
  const Finished finished = run_in(scratch, {"half.net", "--json"});
  CHECK(finished.status == 0);
  CHECK_THAT(finished.err, !Contains("W-ac-singular"));
  const Json result = read_json(finished.out);
  // v = (e^{jωt} − 1)/(jωC) while it is charged, the same before and behind: c₀ = 1/(2jωC).
  check_equal(response(result, 2, "v(b)"), 1.0 / (2.0 * j * two_pi * 2e3 * 1e-6), 1e-10);
  // An output that sees the free direction, from both sides: by h, 2h, … the mean is off by h².
  const auto mean = [&](std::size_t a, std::size_t b) { return 0.5 * (response(result, a, "v(o)") + response(result, b, "v(o)")); };
  check_equal(response(result, 2, "v(o)"), (25.0 * mean(1, 3) - mean(0, 4)) / 24.0, 1e-9);
}

TEST_CASE("a current into a capacitor has its response at multiples of the period's frequency", "[unit]") {
  const Scratch scratch;
  scratch.write(
      "family.net",
      "family\nI1 0 a SIN(0 1m 1k) AC 1\nC1 a 0 1u\nS1 b 0 c 0 SX\nVc c 0 SIN(0 1 1k)\nR1 b a2 1\nVa a2 0 1\n.model SX SW(Vt=0.5)\n"
      ".pss\n.save v(a) v(b)\n.ac list 500 1k 1.5k 2k\n.end\n");
  const Finished finished = run_in(scratch, {"family.net", "--json"});
  CHECK(finished.status == 0);
  CHECK_THAT(finished.err, !Contains("W-ac-singular"));
  const Json result = read_json(finished.out);
  for (std::size_t k = 0; k < 4; ++k) check_equal(response(result, k, "v(a)"), 1.0 / (j * two_pi * (500.0 * (k + 1.0)) * 1e-6), 1e-10);
}

TEST_CASE("a Bode plot beside the waveforms; multipliers and a Nyquist plot on the page", "[unit]") {
  const Scratch scratch;
  scratch.write("buck.net", read_file(std::string(PWLSIM_SOURCE_DIR) + "/netlists/steady_state/buck_type3.net"));
  CHECK(run_in(scratch, {"buck.net", "--plot", "buck.svg", "--report", "buck.html"}).status == 0);
  const std::string bode = read_file(scratch / "buck.ac.svg"), page = read_file(scratch / "buck.html");
  CHECK_THAT(bode,
             Contains(">magnitude<") && Contains(">phase<") && Contains(">crossover<") && Contains(">10k<") && Contains("frequency (Hz)"));
  CHECK_THAT(read_file(scratch / "buck.svg"), Contains("time ("));
  CHECK_THAT(page, Contains("Floquet multipliers") && Contains("Nyquist plot of the loop gain"));
  scratch.write("rc.net", "rc\nV1 a 0 AC 1\nR1 a b 1k\nC1 b 0 1u\n.ac dec 5 10 10k\n.end\n");
  CHECK(run_in(scratch, {"rc.net", "--plot", "rc.svg"}).status == 0);
  CHECK_THAT(read_file(scratch / "rc.svg"), Contains(">magnitude<"));
}

// The phase of A sin(ω₀t + φ) follows the frequency by 2π/(jω): c₁ = A e^{jφ}/(2 jf) at f + f₀, through 1/(1 + j(ω + ω₀)RC).
TEST_CASE("frequency modulation of a sinusoid: its sidebands, and the mean of what rectifies it", "[unit]") {
  const Scratch scratch;
  const Json told =
      result_of(scratch, "sine\nV1 a 0 SIN(0.3 2 1k 0 0 30)\nR1 a b 1k\nC1 b 0 1u\n.pss\n.ac list 50 130 from=freq(V1) harm=1\n.end\n");
  const double frequencies[] = {50.0, 130.0};
  for (std::size_t k = 0; k < 2; ++k) {
    const double f = frequencies[k];
    const Complex input = 2.0 * std::exp(j * M_PI / 6.0) / (2.0 * j * f);
    check_equal(response(told, k, "v(a)"), input, 1e-10);
    check_equal(response(told, k, "v(b)"), input / (1.0 + j * two_pi * (f + 1e3) * 1e-3), 1e-10);
  }
  // Slow modulation moves the mean by its derivative to the frequency, which .sens finds along the orbit instead of at a frequency.
  const Json slow = result_of(
      scratch,
      "rectifier\n.param f=1k\nV1 a 0 SIN(0 5 {f})\nL1 a b 10m\nD1 b c DX\nR1 c 0 100\nC1 c 0 2u\n.model DX D(Ron=0.1 Vfwd=0.3)\n.pss\n"
      ".meas pss m AVG v(c)\n.ac list 1m from=freq(V1)\n.sens param=f\n.end\n");
  check_equal(response(slow, 0, "v(c)").real(), slow["sensitivities"][0]["derivative"].number, 1e-8);
}

// A triangle from 0 to 4 above 1.5 from t₁ = 0.375·T/2 to t₂ = T − t₁: both edges move by −1/(jω f₀), the comparison by −h δ(t − t₁) + h δ(t − t₂) of it.
TEST_CASE("the comparison of a source with a level moves with the source's frequency", "[unit]") {
  const Scratch scratch;
  const Json told = result_of(scratch,
                              "comparison\nVt t 0 PULSE(0 4 0 1m 1m 0 2m)\nB1 g 0 V=if(V(t)>1.5,5,0)\nR1 g b 1k\nC1 b 0 1u\n.pss\n"
                              ".ac list 50 130 from=freq(Vt) harm=1\n.end\n");
  const double period = 2e-3, f0 = 500.0, t1 = 0.375e-3, t2 = period - t1;
  const double frequencies[] = {50.0, 130.0};
  for (std::size_t k = 0; k < 2; ++k) {
    const double f = frequencies[k];
    const Complex shift = -1.0 / (j * two_pi * f * f0);
    const Complex input = 5.0 / period * shift * (std::exp(-j * two_pi * f0 * t2) - std::exp(-j * two_pi * f0 * t1));
    check_equal(response(told, k, "v(g)"), input, 1e-9);
    check_equal(response(told, k, "v(b)"), input / (1.0 + j * two_pi * (f + f0) * 1e-3), 1e-9);
  }
}

// The comparison with a triangle between ±1/2 has the mean 2 v(x), which the integrator holds at v(r): v(x) is v(r)/2 up to terms of ω². A filter that only listens stands
// beside the integrator, whose A − jω is nearly singular.
TEST_CASE("an integrator at frequencies far below that of the switching", "[unit]") {
  const Scratch scratch;
  const Json told = result_of(scratch,
                              "integrator\nVr r 0 0.6\nVt t 0 PULSE(-0.5 0.5 0 50u 50u 0 0.1m)\nB1 q 0 V=if(V(x)>V(t),1,-1)\n"
                              "B2 x 0 V=sdt(2k*(V(r)-V(q)),0)\nR1 q f 1k\nC1 f 0 1u\n.pss uic\n.ac list 0 1e-5 1e-4 1e-3 from=Vr\n.end\n");
  const double frequencies[] = {0.0, 1e-5, 1e-4, 1e-3};
  for (std::size_t k = 0; k < 4; ++k) {
    CHECK(response(told, k, "v(x)").real() == Approx(0.5).epsilon(1e-11));
    CHECK(response(told, k, "v(q)").real() == Approx(1.0).epsilon(1e-10));
    check_equal(response(told, k, "v(f)"), response(told, k, "v(q)") / (1.0 + j * two_pi * frequencies[k] * 1e-3), 1e-12);
  }
}

// Two cells that do not depend on each other pass their guards at the same instants. A source in one of them moves that one alone, and as it does without the other; the other's guard, which comes first,
// took both of them along (14 times the response at 100 Hz).
TEST_CASE("parts that pass their guards at one instant respond each by itself", "[unit]") {
  const auto cell = [](const std::string& n, const std::string& input) {
    return "V" + n + " i" + n + " 0 12 " + input + "\nB" + n + " g" + n + " 0 V=if(V(ck)>2.5,5,if(I(L" + n + ")*0.1>0.3,0,V(h" + n +
           ")))\nRg" + n + " g" + n + " h" + n + " 10\nCg" + n + " h" + n + " 0 100p ic=0\nS" + n + " i" + n + " s" + n + " h" + n +
           " 0 SX\nD" + n + " 0 s" + n + " DX\nL" + n + " s" + n + " o" + n + " 10u ic=1\nC" + n + " o" + n + " 0 47u ic=5\nR" + n + " o" +
           n + " 0 1.2\n";
  };
  const std::string frame =
      "cells\nVck ck 0 PULSE(0 5 0 1n 1n 50n 5u)\n.model SX SW(Ron=20m Vt=2.5)\n.model DX D(Ron=20m Vfwd=0.4)\n.pss uic\n.ac list 100 "
      "40k\n";
  const Scratch scratch;
  const Json one = result_of(scratch, frame + cell("1", "AC 1") + ".end\n");
  const Json two = result_of(scratch, frame + cell("2", "") + cell("1", "AC 1") + ".end\n");
  for (std::size_t k = 0; k < 2; ++k) {
    check_equal(response(two, k, "v(o1)"), response(one, k, "v(o1)"), 1e-9);
    CHECK(std::abs(response(two, k, "v(o2)")) < 1e-12 * std::abs(response(one, k, "v(o1)")));
  }
}

namespace {

/// v(b) = 1 ms·u′, and a capacitor across it: i(C1) = 1e-9 u″, which F1 sends into 1 kΩ, 500 Ω for 4 of 10 µs, and which moves the edge of S2 beside a sawtooth.
std::string around_an_orbit(const std::string& more, const std::string& saved) {
  return "derivatives\nV1 a 0 AC 1\nB1 b 0 V={1e-3*ddt(v(a))}\nC1 b 0 1u\nVg g 0 PULSE(0 1 0 0 0 4u 10u)\nB2 l 0 I={-i(C1)}\nR1 l 0 1k\n"
         "S1 l k g 0 SX\nR2 k 0 1k\nVr r 0 PULSE(0 1 0 10u 0 0 10u)\nB3 m 0 V={0.5+1e-3*i(C1)}\nVin in 0 12\nS2 in w m r SY\nR3 w 0 1\n" +
         more + ".model SX SW(Ron=0 Vt=0.5)\n.model SY SW(Ron=0 Vt=0)\n.save " + saved + "\n.pss\n" + list;
}

}  // namespace

// R(t) has the mean 0.6·1 kΩ + 0.4·500 Ω, and the first harmonic −500 Ω (1 − e^{−0.8πj})/(2πj). The duty is what the sawtooth, 1 V a period, is compared with.
TEST_CASE("a response around an orbit may follow the second derivative of its source, and the third", "[unit]") {
  const Scratch scratch;
  const std::string third = "B4 d 0 V={1e-3*ddt(v(b))}\nC2 d 0 1u\n", signals = "i(C1) v(l) v(w) i(C2)";
  const Json mean = result_of(scratch, around_an_orbit(third, signals) + "\n.end\n");
  const Json first = result_of(scratch, around_an_orbit(third, signals) + " harm=1\n.end\n");
  const Complex resistance = -500.0 * (1.0 - std::exp(-0.8 * M_PI * j)) / (two_pi * j);
  for (std::size_t k = 0; k < around.size(); ++k) {
    const Complex s = j * two_pi * around[k], current = 1e-9 * s * s;
    check_equal(response(mean, k, "i(C1)"), current, 1e-12);
    check_equal(response(mean, k, "v(l)"), 800.0 * current, 1e-12);
    check_equal(response(first, k, "v(l)"), resistance * current, 1e-12);
    check_equal(response(mean, k, "v(w)"), 12e-3 * current, 1e-12);
    check_equal(response(mean, k, "i(C2)"), 1e-12 * s * s * s, 1e-12);
  }
}

// A capacitor on v(b) = 1 ms·u′ for 4 of 10 µs: it follows that, and is charged when it is connected from what v(b) was 6 µs before.
TEST_CASE("a switch connects a capacitor to the derivative of a source", "[unit]") {
  const Json result = result_of(Scratch{}, around_an_orbit("S3 b e g 0 SX\nC2 e 0 1u\n", "i(C2)") + "\n.end\n");
  for (std::size_t k = 0; k < around.size(); ++k) {
    const Complex s = j * two_pi * around[k], voltage = 1e-3 * s;
    check_equal(response(result, k, "i(C2)"), 1e-6 * voltage * (s * 4e-6 + 1.0 - std::exp(-s * 6e-6)) / 1e-5, 1e-11);
  }
}

// Five differentiations, a capacitor that a switch connects, and one that follows the current of that: 1e-42 u^(7) while both are.
TEST_CASE("a response that follows too many derivatives of its source is refused", "[unit]") {
  const Scratch scratch;
  std::string chain = "B6 f1 0 V={1e-6*ddt(v(a))}\n";
  for (int k = 2; k <= 5; ++k)
    chain += "B" + std::to_string(5 + k) + " f" + std::to_string(k) + " 0 V={1e-6*ddt(v(f" + std::to_string(k - 1) + "))}\n";
  chain += "S3 f5 e g 0 SX\nC3 e 0 1u\n";
  const Json result = result_of(scratch, around_an_orbit(chain, "v(f5) i(C3)") + "\n.end\n");
  for (std::size_t k = 0; k < around.size(); ++k) {
    const Complex s = j * two_pi * around[k], voltage = std::pow(s * 1e-6, 5);
    check_equal(response(result, k, "v(f5)"), voltage, 1e-11);
    check_equal(response(result, k, "i(C3)"), 1e-6 * voltage * (s * 4e-6 + 1.0 - std::exp(-s * 6e-6)) / 1e-5, 1e-11);
  }
  scratch.write("deck.net", around_an_orbit(chain + "B20 h 0 V={i(C3)}\nS4 h k2 g 0 SX\nC4 k2 0 1u\n", "i(C4)") + "\n.end\n");
  const Finished finished = run_in(scratch, {"deck.net"});
  CHECK(finished.status != 0);
  CHECK_THAT(finished.err, Contains("E-ac-no-derivative"));
}
