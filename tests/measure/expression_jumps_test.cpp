// Jumps, corners, flat and narrow extremes of measured expressions, against closed forms. In each deck v(a) = 2 sin 2πt and v(b) = 4t − 2, from 0 to 1 s.

#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "measure/measured.hpp"

using pwlsim::test::exact;
using pwlsim::test::measure_deck;
using pwlsim::test::Measured;
using pwlsim::test::near;
using std::numbers::pi;

namespace {

const std::string sine_and_ramp = "sine and ramp\nVa a 0 SIN(0 2 1)\nRa a 0 1\nVb b 0 PWL(0 -2 1 2)\nRb b 0 2\n.tran .1 1\n";
/// Of values that are sums of terms of size one.
constexpr double rounding_margin = 1e-12;

struct Expected {
  std::string text;  ///< of the measurement, after its name
  double value;
};

/// Each measured in a deck of its own, and all in one deck: the others must not matter.
void check_alone_and_together(const std::vector<Expected>& list, double margin = rounding_margin) {
  std::string together = sine_and_ramp;
  for (std::size_t i = 0; i < list.size(); ++i) together += fmt::format(".meas m{} {}\n", i, list[i].text);
  const Measured all = measure_deck(together);
  REQUIRE(all.messages.empty());
  for (std::size_t i = 0; i < list.size(); ++i) {
    INFO(list[i].text);
    const Measured alone = measure_deck(sine_and_ramp + ".meas m " + list[i].text + "\n");
    REQUIRE(alone.value.count("m") == 1);
    CHECK(alone.value.at("m") == Approx(list[i].value).epsilon(0.0).margin(margin));
    REQUIRE(all.value.count(fmt::format("m{}", i)) == 1);
    CHECK(all.value.at(fmt::format("m{}", i)) == Approx(list[i].value).epsilon(0.0).margin(margin));
  }
}

}  // namespace

// v(a) > 1 for 1/12 < t < 5/12: there the sine is above a half.
TEST_CASE("a crossing by a jump is at the jump, whatever the level", "[regression]") {
  for (const double level : {1e-3, 0.1, 2.5, 4.9, 4.999}) {
    const std::string pulse = fmt::format("if(V(a)>1,5,0)={}", level), value = fmt::format("if(V(a)>1,5,0) VAL={}", level);
    check_alone_and_together({{"WHEN " + pulse + " RISE=1", 1.0 / 12.0},
                              {"WHEN " + pulse + " FALL=1", 5.0 / 12.0},
                              {"WHEN " + pulse + " CROSS=2", 5.0 / 12.0},
                              {"TRIG " + value + " RISE=1 TARG " + value + " FALL=1", 1.0 / 3.0}});
  }
  for (const char* never : {"if(V(a)>1,5,0)=5.2", "if(V(a)>1,5,0)=5.0001", "if(V(a)>1,5,0)=-.3", "if(V(a)>1,5,0)=4.9 RISE=2",
                            "if(V(a)<0,10,0)=10.5 FROM=.5 TO=.7", "floor(V(a))=1.5"}) {
    INFO(never);
    const Measured m = measure_deck(sine_and_ramp + ".meas m WHEN " + never + "\n");
    const std::string& failure = m.result("m").failure;
    CHECK((failure.find("at no time") != std::string::npos || failure.find(" once ") != std::string::npos));
    CHECK(m.value.count("m") == 0);
  }
}

// At 0.5 s, where v(a) falls through zero; the functions have the values that are given and no others.
TEST_CASE("a window that begins at a jump has the values after it", "[regression]") {
  check_alone_and_together({{"MAX if(time>.5,1,0) FROM=.5", 1.0},
                            {"MIN if(time>.5,1,0) FROM=.5", 1.0},
                            {"MAX if(time>.5,1,0) FROM=.4", 1.0},
                            {"MIN if(time>.5,1,0) FROM=.4", 0.0},
                            {"MAX 5*(V(a)<0) FROM=.5 TO=.9", 5.0},
                            {"AVG 5*(V(a)<0) FROM=.5 TO=.9", 5.0},
                            {"MIN 5*(time<.5) TO=.5", 5.0}});
  for (const char* text : {"PP sgn(V(a)) FROM=.5", "MAX u(-V(a)) FROM=.5 TO=.64", "MIN u(-V(a)) FROM=.5 TO=.64"}) {
    INFO(text);
    const double value = measure_deck(sine_and_ramp + ".meas m " + text + "\n").value.at("m");
    CHECK(value == std::round(value));
    CHECK(value <= 2.0);
  }
}

TEST_CASE("conditions within conditions", "[regression]") {
  // u is 1 to 0.5 s, 0 to 0.505 s, and 1 again, as −v(a) is positive then
  check_alone_and_together({{"AVG u(if(time<.505,V(a),-V(a))) FROM=.42 TO=.56", 1.0 - 0.005 / 0.14},
                            {"AVG u(if(time<.501,V(a),-V(a)))", 0.999},
                            {"MAX tanh(20*max(tanh(20*time),sin(7*V(b))))", 1.0},  // tanh 20
                            {"AVG if(abs(V(b))<1,if(V(b)>0,1,2),3)", 0.25 * 1.0 + 0.25 * 2.0 + 0.5 * 3.0}});
}

TEST_CASE("many jumps and corners in one piece", "[regression]") {
  // ⌊x⌋ is x − 1/2 in the mean over whole steps, and v(b) is 0 in the mean; int is odd; |sin| by its primitive
  const double half_waves = std::floor(300.0 / pi), rest = 300.0 - half_waves * pi;
  const double area = (2.0 * half_waves + 1.0 - std::cos(rest)) / 300.0;
  const double above = (std::ceil(std::floor(100.0 / pi) / 2.0) * pi +
                        (100.0 - std::floor(100.0 / pi) * pi) * (std::fmod(std::floor(100.0 / pi), 2.0) == 0.0)) /
                       100.0;
  check_alone_and_together({{"AVG floor(V(b)*5)", -0.5},
                            {"AVG floor(V(b)*10)", -0.5},
                            {"AVG ceil(V(b)*10)", 0.5},
                            {"AVG int(V(b)*10)", 0.0},
                            {"AVG round(V(b)*10)", 0.0},
                            {"AVG mod(V(b),.1)", 0.05},
                            {"AVG u(sin(100*time))", above},
                            {"AVG abs(sin(300*time))", area},
                            {"INTEG if(sin(20*V(b))>0,1,0)", 0.5}});  // an odd sine
}

// v(b) is zero at 0.5 s, v(a) at 0.5 s.
TEST_CASE("flat and narrow extremes and flat crossings", "[regression]") {
  check_alone_and_together({{"MIN V(b)^4", 0.0},
                            {"MAX V(b)^4", 16.0},
                            {"MIN V(b)^4 FROM=.21 TO=.83", 0.0},
                            {"MIN V(a)^4 FROM=.21 TO=.83", 0.0},
                            {"MIN V(b)*V(b)*V(b)*V(b)", 0.0},
                            {"MIN (V(a)*V(b))^2 FROM=.2 TO=.8", 0.0},
                            {"MAX V(a)^8", 256.0},
                            {"WHEN V(b)^3=0", 0.5},
                            {"WHEN V(b)*V(b)*V(b)=0 RISE=1", 0.5},
                            {"WHEN V(b)^7=0", 0.5},
                            {"AVG u(V(b)^3)", 0.5},
                            {"MAX exp(-1e6*V(b)^2)", 1.0},
                            {"MAX V(b)+5*exp(-1e8*(V(b)-.1)^2)-V(b)", 5.0},
                            {"MAX 1/(1+1e9*V(b)^2)", 1.0},
                            {"MAX 1/cosh(1e4*(V(b)-.3))", 1.0},
                            {"AVG if(exp(-1e6*V(b)^2)>.5,1,0)", 2.0 * std::sqrt(std::log(2.0) * 1e-6) / 4.0}},
                           1e-11);
  // ∫ e^{−x²/s²} dx = s √π, and dx = 4 dt
  CHECK(measure_deck(sine_and_ramp + ".meas m AVG exp(-1e6*V(b)^2)\n").value.at("m") == near(1e-3 * std::sqrt(pi) / 4.0, 1e-11));
}
