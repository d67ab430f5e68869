#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "deck.hpp"

using namespace pwlsim;
using test::compile_deck;

namespace {

/// The value of an expression, by way of a resistor.
double value_of(const std::string& expression, const std::string& definitions = "") {
  const auto deck = compile_deck(definitions + "R1 a 0 {" + expression + "}\n.tran 1\n");
  INFO(expression << "\n" << deck.messages());
  REQUIRE(deck.compiled.has_value());
  return test::named(deck.network().resistors, "R1").resistance;
}

}  // namespace

TEST_CASE("operators follow the precedence of the contract", "[unit]") {
  // Arithmetic by hand; unary minus binds weaker than power, power is left-associative, ^ is power.
  CHECK(value_of("2+3*4") == 14.0);
  CHECK(value_of("-2^2") == -4.0);
  CHECK(value_of("2^3^2") == 64.0);
  CHECK(value_of("2**-1") == 0.5);
  CHECK(value_of("(1+2)*(3-5)") == -6.0);
  CHECK(value_of("10/4/5") == 0.5);
  CHECK(value_of("7-2-1") == 4.0);
  CHECK(value_of("1 ? 2 : 0 ? 3 : 4") == 2.0);
  CHECK(value_of("0 ? 2 : 0 ? 3 : 4") == 4.0);
  CHECK(value_of("!0 + !5") == 1.0);
  CHECK(value_of("(2>1) + (2>=2) + (1<2) + (1<=0) + (3==3) + (3!=3)") == 4.0);
  CHECK(value_of("(1 && 0) + (1 || 0)*2 + (1 & 2)*4 + (0 | 0)*8") == 6.0);
  CHECK(value_of("1k5 + 2u2*1Meg + 4R7") == Approx(1506.9).epsilon(1e-15));
}

TEST_CASE("functions of expressions have their values", "[unit]") {
  // The C++ library, which evaluates by other code paths only for sgn, int, limit: those by hand.
  CHECK(value_of("sqrt(2)") == std::sqrt(2.0));
  CHECK(value_of("exp(1) - e") == 0.0);
  CHECK(value_of("ln(5) - log(5)") == 0.0);
  CHECK(value_of("log(e^2)") == Approx(2.0).epsilon(1e-15));
  CHECK(value_of("log10(1000)") == Approx(3.0).epsilon(1e-15));
  CHECK(value_of("sin(pi/6)") == Approx(0.5).epsilon(1e-15));
  CHECK(value_of("cos(pi/3)") == Approx(0.5).epsilon(1e-15));
  CHECK(value_of("tan(pi/4)") == Approx(1.0).epsilon(1e-15));
  CHECK(value_of("asin(1)*2 + acos(1)") == Approx(std::numbers::pi).epsilon(1e-15));
  CHECK(value_of("atan(1)*4") == Approx(std::numbers::pi).epsilon(1e-15));
  CHECK(value_of("atan2(1,-1)*4") == Approx(3.0 * std::numbers::pi).epsilon(1e-15));
  CHECK(value_of("cosh(1)^2 - sinh(1)^2") == Approx(1.0).epsilon(1e-14));
  CHECK(value_of("tanh(1) - sinh(1)/cosh(1) + 1") == Approx(1.0).epsilon(1e-15));
  CHECK(value_of("abs(-3) + min(4,2,3) + max(1,5)") == 10.0);
  CHECK(value_of("pow(2,10)") == 1024.0);
  CHECK(value_of("floor(-1.5)") == -2.0);
  CHECK(value_of("ceil(-1.5)") == -1.0);
  CHECK(value_of("int(-1.5)") == -1.0);
  CHECK(value_of("sgn(-7) + sgn(0)*10 + sgn(2)*100") == 99.0);
  CHECK(value_of("limit(5,1,3) + limit(3,5,1)*10 + limit(0,1,3)*100") == 133.0);
  CHECK(value_of("if(2>1, 3, 1/0)") == 3.0);
  CHECK(value_of("ternary_fcn(0, 1/0, 4)") == 4.0);
  CHECK(value_of("LIMIT(7,-inf,INF)") == 7.0);
  CHECK(value_of("round(2.5) + round(-2.5)*10 + round(1.4)*100") == 73.0);
  CHECK(value_of("arcsin(1)*2 + arccos(1) - arctan(1)*4") == Approx(0.0).margin(1e-15));
  CHECK(value_of("sinh(asinh(2)) + cosh(acosh(3)) + tanh(atanh(0.5))") == Approx(5.5).epsilon(1e-14));
  CHECK(value_of("hypot(3,4)") == 5.0);
  CHECK(value_of("pwr(-2,3) + pwrs(-2,3)*10 + pwrs(2,3)*100") == 728.0);
  CHECK(value_of("buf(0.6) + buf(0.5)*10 + inv(0.6)*100 + inv(0.5)*1000") == 1001.0);
}

TEST_CASE("parameters may be used before they are defined and the last definition wins", "[unit]") {
  CHECK(value_of("a", ".param a={b*2} b={c+1}\n.param c=4\n") == 10.0);
  CHECK(value_of("a", ".param a=1\n.param a=2\n.param A=3\n") == 3.0);
  CHECK(value_of("a+b", ".param a='2*3' b=2k\n") == 2006.0);
  CHECK(value_of("e", ".param e=7\n") == 7.0);
}

TEST_CASE("functions of the deck see their arguments first, then the parameters around their definition", "[unit]") {
  CHECK(value_of("f(3,4)", ".param b=100 c=1\n.func f(a,b) {a*b + c}\n") == 13.0);
  CHECK(value_of("g(2)", ".func g(x) {h(x)+1}\n.func h(x) {x*x}\n") == 5.0);
  CHECK(value_of("sin(5)", ".func sin(x) {2*x}\n") == 10.0);
  CHECK(value_of("k()", ".func k() {42}\n") == 42.0);
}

TEST_CASE("long chains of parameters and long sums are evaluated", "[unit]") {
  constexpr int length = 5000;
  std::string forwards = ".param p0=1\n", backwards;
  for (int k = 1; k <= length; ++k) {
    forwards += fmt::format(".param p{}={{p{}+1}}\n", k, k - 1);
    backwards += fmt::format(".param q{}={{q{}+1}}\n", k - 1, k);
  }
  CHECK(value_of(fmt::format("p{}", length), forwards) == length + 1.0);
  CHECK(value_of("q0", backwards + fmt::format(".param q{}=1\n", length)) == length + 1.0);
}

TEST_CASE("an expression that would take for ever is an error within seconds", "[unit]") {
  std::string cards = ".func f0(x) {x}\n";
  for (int k = 1; k < 60; ++k) cards += fmt::format(".func f{0}(x) {{f{1}(x)+f{1}(x)}}\n", k, k - 1);
  const auto deck = compile_deck(cards + "R1 a 0 {f59(1)}\nR2 a 0 {f59(1)}\n.tran 1\n");
  CHECK(deck.count("E-too-deep") == 1);
  for (const char* body : {"sin(sin(sin(sin(sin(f(x+1))))))", "((((f(x+1) ? 1 : 2) ? 1 : 2) ? 1 : 2) ? 1 : 2) ? 1 : 2"}) {
    const auto deep = compile_deck(fmt::format(".func f(x) {{{}}}\nR1 a 0 {{f(1)}}\n.tran 1\n", body));
    CHECK(deep.count("E-too-deep") == 1);
  }
}

TEST_CASE("a result that is not finite is an error where it arises", "[unit]") {
  for (const char* expression :
       {"1/0", "log(0)", "ln(-1)", "sqrt(-1)", "asin(2)", "(-8)^(1/3)", "exp(1000)", "inf-inf", "inf*0", "inf+1", "0/0"}) {
    INFO(expression);
    const auto deck = compile_deck(fmt::format("R1 a 0 {{1+0*({})}}\n.tran 1\n", expression));
    CHECK(deck.count("E-not-finite") == 1);
    CHECK_FALSE(deck.compiled.has_value());
  }
}
