/// Products with comparisons, rounded time and conditions without a comparison, beside C++'s own arithmetic at each row.

#include <catch2/catch.hpp>

#include <cmath>
#include <functional>
#include <numbers>

#include "regression/deck_run.hpp"

namespace {

using pwlsim::test::DeckRun;
using pwlsim::test::run_text;

/// 0 or 1: PULSE(0 1 td 1n 1n 5u 10u), where the time is not on a ramp.
double gate(double t, double delay) { return t >= delay && std::fmod(t - delay, 10e-6) < 5e-6 ? 1.0 : 0.0; }

struct ProductCase {
  const char* expression;
  std::function<double(double)> value;
};

/// Rows lie 0.1 µs beside every edge.
constexpr const char* product_frame =
    "a product\nV1 a 0 PULSE(0 1 0 1n 1n 5u 10u)\nV2 b 0 PULSE(0 1 2u 1n 1n 5u 10u)\nV3 s 0 SIN(0 3 20k)\nR3 s 0 1\nB1 c 0 V=";

}  // namespace

TEST_CASE("an expression with products, roundings and conditions has its value", "[regression]") {
  const auto sine = [](double t) { return 3.0 * std::sin(2.0 * std::numbers::pi * 20e3 * t); };
  const auto tone = [](double t) { return std::sin(2.0 * std::numbers::pi * 1e5 * t); };
  const ProductCase one =
      GENERATE_REF(ProductCase{"V(s)*(V(b)>0.5)", [&](double t) { return sine(t) * gate(t, 2e-6); }},
                   ProductCase{"(V(a)>0.5)*(V(b)>0.5)", [](double t) { return gate(t, 0.0) * gate(t, 2e-6); }},
                   ProductCase{"(V(a)>0.5)*V(s)*(V(b)>0.5)", [&](double t) { return gate(t, 0.0) * gate(t, 2e-6) * sine(t); }},
                   ProductCase{"V(s)*(1-2*u(V(b)-0.5))", [&](double t) { return sine(t) * (1.0 - 2.0 * gate(t, 2e-6)); }},
                   ProductCase{"V(s)*sgn(V(b)-0.5)", [&](double t) { return sine(t) * (gate(t, 2e-6) > 0.5 ? 1.0 : -1.0); }},
                   ProductCase{"V(s)*if(V(a)>0.5,2,if(V(b)>0.5,1,0)+1)",
                               [&](double t) { return sine(t) * (gate(t, 0.0) > 0.5 ? 2.0 : gate(t, 2e-6) + 1.0); }},
                   ProductCase{"6/if(V(b)>0.5,3,2)", [](double t) { return gate(t, 2e-6) > 0.5 ? 2.0 : 3.0; }},
                   ProductCase{"V(s)/if(time>20.05u,2,if(V(a)>0.5,4,1))",
                               [&](double t) {
                                 return sine(t) / (t > 20.05e-6 ? 2.0 : gate(t, 0.0) > 0.5 ? 4.0 : 1.0);
                               }},
                   ProductCase{"V(s)/V(a)", nullptr}, ProductCase{"V(s)/(V(a)>0.5)", nullptr},
                   ProductCase{"if(time>20.05u,1,0)*sin(2*pi*1e5*time)", [&](double t) { return t > 20.05e-6 ? tone(t) : 0.0; }},
                   ProductCase{"V(s)*(time>20.05u)", [&](double t) { return t > 20.05e-6 ? sine(t) : 0.0; }},
                   ProductCase{"if(V(a),5,1)", [](double t) { return gate(t, 0.0) > 0.5 ? 5.0 : 1.0; }},
                   ProductCase{"V(a)&V(b)", [](double t) { return gate(t, 0.0) * gate(t, 2e-6); }},
                   ProductCase{"buf(V(a))+2*inv(V(b))", [](double t) { return gate(t, 0.0) + 2.0 * (1.0 - gate(t, 2e-6)); }},
                   ProductCase{"floor(time*1e5+0.365)", [](double t) { return std::floor(t * 1e5 + 0.365); }},
                   ProductCase{"ceil(2-time*1e5)", [](double t) { return std::ceil(2.0 - t * 1e5); }},
                   ProductCase{"round(time*3e4)", [](double t) { return std::round(t * 3e4); }},
                   ProductCase{"int(time*3e4)", [](double t) { return std::trunc(t * 3e4); }},
                   ProductCase{"mod(time,7u)*1e6", [](double t) { return std::fmod(t, 7e-6) * 1e6; }},
                   ProductCase{"time*1e5-floor(time*1e5)", [](double t) { return t * 1e5 - std::floor(t * 1e5); }});
  INFO(one.expression);
  const DeckRun run = run_text(std::string(product_frame) + one.expression + "\nR1 c 0 1k\n.save v(c)\n.tran 0.2u 59.9u 0.1u\n.end\n");
  if (!one.value) {  // the factor is no switched form, or zero in one of its positions
    CHECK(run.messages.find("E-not-piecewise-linear") != std::string::npos);
    return;
  }
  REQUIRE(run.messages.empty());
  REQUIRE(run.rows.size() == 300);
  for (const auto& row : run.rows) {
    INFO(row[0]);
    CHECK(row[1] == Approx(one.value(row[0])).margin(1e-11));
  }
}

TEST_CASE("a resistor whose resistance is an expression divides as it says", "[regression]") {
  const DeckRun run = run_text(
      "load steps\nV1 a 0 10\nVg g 0 PULSE(0 1 0 1n 1n 0.1m 0.2m)\nR1 a b 1\nR2 b 0 R=if(time<0.51m,9,4)\nR3 a c 1\n"
      "R4 c 0 {if(time<0.27m,9,if(time<0.51m,4,1))}\nR5 a d 1\nR6 d 0 R={V(g)>0.5 ? 4 : 9}\n.save v(b) v(c) v(d) i(R2)\n.tran 0.02m 1m "
      "0.01m\n");
  REQUIRE(run.messages.empty());
  REQUIRE(run.rows.size() > 40);
  for (std::size_t k = 0; k + 1 < run.rows.size(); ++k) {
    const double t = run.rows[k][0];
    const auto divided = [](double r) { return 10.0 * r / (1.0 + r); };
    const double first = t < 0.505e-3 ? 9.0 : 4.0, second = t < 0.265e-3 ? 9.0 : t < 0.505e-3 ? 4.0 : 1.0;
    INFO(t);
    CHECK(run.rows[k][1] == Approx(divided(first)));
    CHECK(run.rows[k][2] == Approx(divided(second)));
    CHECK(run.rows[k][3] == Approx(divided(std::fmod(t, 0.2e-3) < 0.1e-3 ? 4.0 : 9.0)));
    CHECK(run.rows[k][4] == Approx(10.0 / (1.0 + first)));
  }
}
