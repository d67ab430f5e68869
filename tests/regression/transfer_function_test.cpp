/// Laplace= on E, G and B beside the closed forms of step responses.

#include <catch2/catch.hpp>

#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include "regression/comparison.hpp"
#include "regression/deck_run.hpp"

namespace {

using pwlsim::test::DeckRun;
using pwlsim::test::run_text;
using pwlsim::test::run_text_sparse;

struct FractionCase {
  const char* card;  ///< a source that holds node b, or its current through 1 ohm
  std::function<double(double)> value;
};

/// The response to 1 V from t = 0 on, T = 1 ms.
const FractionCase fraction_cases[] = {
    {"E1 b 0 in 0 Laplace=1/(1+s*1e-3)", [](double t) { return 1.0 - std::exp(-t / 1e-3); }},
    {"E1 b 0 in 0 Laplace={1/(1+s*tau)}", [](double t) { return 1.0 - std::exp(-t / 1e-3); }},
    {"E1 b 0 LAPLACE {V(in)} = {1/(1+s/1000)}", [](double t) { return 1.0 - std::exp(-t / 1e-3); }},
    {"E1 b 0 LAPLACE {2*V(in)-1} {1/(1+s/1000)}", [](double t) { return 1.0 - std::exp(-t / 1e-3); }},
    {"E1 b 0 value={3*V(in)} Laplace=1/(1+s*tau)", [](double t) { return 3.0 - 3.0 * std::exp(-t / 1e-3); }},
    {"G1 0 b in 0 Laplace=2/(s*tau+1)", [](double t) { return 2.0 - 2.0 * std::exp(-t / 1e-3); }},
    {"H1 b 0 Vin Laplace=1/(1+s*tau)", [](double t) { return 1.0 - std::exp(-t / 1e-3); }},  // of 1 A
    {"B1 b 0 V=-V(in) Laplace=1/(1+s*tau)", [](double t) { return std::exp(-t / 1e-3) - 1.0; }},
    {"B1 0 b I=V(in) Laplace=s*tau/(1+s*tau)", [](double t) { return std::exp(-t / 1e-3); }},
    {"E1 b 0 in 0 Laplace=5", [](double) { return 5.0; }},
    {"E1 b 0 in 0 Laplace=1/s", [](double t) { return t; }},
    {"E1 b 0 in 0 Laplace=1/s**2", [](double t) { return 0.5 * t * t; }},
    {"E1 b 0 in 0 Laplace=lag(tau)*lag(2*tau)", [](double t) { return 1.0 - 2.0 * std::exp(-t / 2e-3) + std::exp(-t / 1e-3); }},
    {"E1 b 0 in 0 Laplace=pow(lag(tau),2)", [](double t) { return 1.0 - (1.0 + t / 1e-3) * std::exp(-t / 1e-3); }},
    // Sums of fractions: 1/s + 1/s is 2/s and not 2 s/s^2, whose second pole would be free.
    {"E1 b 0 in 0 Laplace=1/s+1/s", [](double t) { return 2.0 * t; }},
    {"E1 b 0 in 0 Laplace=lag(tau)-lag(2*tau)", [](double t) { return std::exp(-t / 2e-3) - std::exp(-t / 1e-3); }},
    // ω²/(s² + ωs + ω²), ω = 2000: damping 1/2, oscillating with ω√3/2.
    {"E1 b 0 in 0 Laplace=4e6/(s*s+2k*s+4e6)",
     [](double t) {
       const double w = 2000.0 * std::sqrt(0.75);
       return 1.0 - std::exp(-1000.0 * t) * (std::cos(w * t) + 1000.0 / w * std::sin(w * t));
     }},
};

std::string fraction_deck(const char* card) {
  return std::string("a fraction\nV1 in 0 PULSE(0 1 0 0 0 1 2)\nR1 in inr 1\nVin inr 0 0\n.param tau=1m\n.func lag(t) {1/(1+s*t)}\n") +
         card + "\nR2 b 0 1\n.save v(b)\n.tran 0.2m 4m uic\n.end\n";
}

}  // namespace

TEST_CASE("a fraction in s has its step response", "[regression]") {
  const FractionCase& one = GENERATE_REF(from_range(std::begin(fraction_cases), std::end(fraction_cases)));
  INFO(one.card);
  const std::string text = fraction_deck(one.card);
  const DeckRun run = run_text(text);
  REQUIRE(run.messages.empty());
  REQUIRE(run.rows.size() == 21);
  const DeckRun sparse = run_text_sparse(text, 1e-6);
  REQUIRE(sparse.messages.empty());
  for (std::size_t k = 0; k < run.rows.size(); ++k) {
    const double time = run.rows[k][0];
    INFO(time);
    const double expected = one.value(time);
    CHECK(run.rows[k][1] == Approx(expected).margin(1e-11));
    CHECK(sparse.rows[k][1] == Approx(expected).margin(1e-3));
  }
}

TEST_CASE("a fraction starts at its operating point", "[regression]") {
  // The input is -1 V before t = 0 and 1 V from then on: from H(0)·(-1) to H(0)·1 with the time constant.
  const DeckRun run =
      run_text("start\nV1 in 0 PULSE(-1 1 0 0 0 1 2)\nE1 b 0 in 0 Laplace=3/(1+s*1m)\nR1 b 0 1\n.save v(b)\n.tran 0.5m 4m\n.end\n");
  REQUIRE(run.messages.empty());
  for (const auto& row : run.rows) CHECK(row[1] == Approx(3.0 - 6.0 * std::exp(-row[0] / 1e-3)).margin(1e-11));
}

TEST_CASE("a fraction closes a loop", "[regression]") {
  // (1+sT)/(sT) before 1/(1+sT), fed back: 1/(1+sT).
  const DeckRun run = run_text(
      "loop\nV1 ref 0 PULSE(0 1 1m 0 0 1 2)\nE1 u 0 ref y Laplace=(1+s*1m)/(s*1m)\nR1 u y 1k\nC1 y 0 1u\n.save v(y)\n.tran 0.5m "
      "8m\n.end\n");
  REQUIRE(run.messages.empty());
  for (const auto& row : run.rows) CHECK(row[1] == Approx(row[0] < 1e-3 ? 0.0 : 1.0 - std::exp(-(row[0] - 1e-3) / 1e-3)).margin(1e-10));
}

namespace {

/// Average-current control of a PFC at 25 kHz: the fraction's integrator is a state of hundreds of volts, 50 of its output with a lag of 4 µs.
std::string average_pfc(const std::string& inductance, const std::string& lag) {
  return "average-current control\n"
         "V1 l n SIN(0 325 50)\n"
         "D1 l p DI\nD2 n p DI\nD3 0 l DI\nD4 0 n DI\n"
         ".model DI D(Ron=10m Roff=10Meg Vfwd=0.7)\n"
         "L1 p sw " +
         inductance +
         "\n"
         "S1 sw 0 g 0 SI\nD5 sw out DI\nV2 out 0 400\n"
         "B1 err 0 V=abs(V(l,n))/325*4-I(L1)\n"
         "E2 ctl 0 err 0 Laplace=0.2*(1+s*200u)/(s*200u)/(1+s*" +
         lag +
         ")\n"
         "V3 saw 0 PULSE(0 1 0 39.9u 0.1u 0 40u)\n"
         "B3 g 0 V=if(V(ctl)>V(saw),1,0)\n"
         ".model SI SW(Ron=10m Roff=10Meg Vt=0.5)\n"
         ".save v(err) v(ctl) i(L1)\n"
         ".tran 5u 40m uic\n.end\n";
}

/// The mean of rows in a half period of the line.
double mean(const DeckRun& run, std::size_t column) {
  double sum = 0.0;
  int count = 0;
  for (const auto& row : run.rows) {
    if (row[0] < 10e-3 || row[0] > 20e-3) continue;
    sum += row[column];
    ++count;
  }
  return sum / count;
}

}  // namespace

TEST_CASE("a fraction whose state is hundreds of volts agrees between dense modes and Krylov segments", "[regression]") {
  // With 1 F as states the rows were up to 2e-5 apart behind a zero of the line, and the last of these ended in E-certificate.
  const auto [inductance, lag] = GENERATE(table<std::string, std::string>({{"2m", "1.5u"}, {"2m", "2u"}, {"3m", "1u"}}));
  const std::string text = average_pfc(inductance, lag);
  INFO(text);
  const auto [modes, segments] = pwlsim::test::run_both(text);
  constexpr double expected = 1e-9;  // of the largest value of a signal
  CHECK(pwlsim::test::largest_difference(modes, segments) <= expected);
  // The reference's mean is 4·2/π. The integrator, 0.2/200 µs times what the error adds up to, moves by less than the saw's volt in 10 ms.
  constexpr double most_error = 1.0 / (0.2 / 200e-6) / 10e-3;
  CHECK(mean(segments, 3) == Approx(8.0 / std::numbers::pi).margin(most_error));
}
