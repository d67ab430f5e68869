/// sdt, idt and ddt in expressions beside closed forms.

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include "regression/deck_run.hpp"

namespace {

using pwlsim::test::DeckRun;
using pwlsim::test::run_text;
using pwlsim::test::run_text_sparse;

constexpr double omega = 2.0 * std::numbers::pi * 50.0;

struct MemoryCase {
  const char* card;
  std::function<double(double)> value;
};

double unit_sine(double t) { return std::sin(omega * t); }
/// ∫ sin
double area(double t) { return (1.0 - std::cos(omega * t)) / omega; }

const MemoryCase memory_cases[] = {
    {"B1 o 0 V=sdt(V(b))", [](double t) { return 3.0 * t; }},
    {"B1 o 0 V=2*V(a)+sdt(V(b))", [](double t) { return 2.0 * unit_sine(t) + 3.0 * t; }},
    {"B1 o 0 V=idt(V(b),4)-idt(V(b),1)", [](double) { return 3.0; }},
    {"B1 o 0 V=sdt(2)", [](double t) { return 2.0 * t; }},
    {"B1 o 0 V=1k*sdt(sdt(V(b)))", [](double t) { return 1500.0 * t * t; }},
    {"B1 o 0 V=100*sdt(V(a))", [](double t) { return 100.0 * area(t); }},
    {"B1 o 0 V=100*sdt(abs(V(a)))", [](double t) { return 100.0 * (t <= 0.01 ? area(t) : 4.0 / omega - area(t)); }},
    {"B1 o 0 V=max(sdt(V(b)),10m)", [](double t) { return std::max(3.0 * t, 0.01); }},
    {"B1 o 0 V=(V(a)>0)*100*sdt(V(b))", [](double t) { return unit_sine(t) > 0.0 && t < 0.01 ? 300.0 * t : 0.0; }},
    {"B1 o 0 V=ddt(V(a))/314", [](double t) { return omega / 314.0 * std::cos(omega * t); }},
    {"B1 o 0 V=d(3*V(a)+5)/314", [](double t) { return 3.0 * omega / 314.0 * std::cos(omega * t); }},
    {"B1 o 0 V=ddt(max(V(a),0.5))/314", [](double t) { return unit_sine(t) > 0.5 ? omega / 314.0 * std::cos(omega * t) : 0.0; }},
    {"B1 o 0 V=ddt(abs(V(a)))/314", [](double t) { return (unit_sine(t) > 0.0 ? omega : -omega) / 314.0 * std::cos(omega * t); }},
    {"B1 o 0 V=ddt(2*sdt(V(a))+V(b))", [](double t) { return 2.0 * unit_sine(t); }},
    {"B1 o 0 V=ddt(4*time)+ddt(7)", [](double) { return 4.0; }},
    {"B1 0 o I=ddt(V(a))/314", [](double t) { return omega / 314.0 * std::cos(omega * t); }},
    {"G1 0 o value={sdt(V(b))}", [](double t) { return 3.0 * t; }},
    {"E1 o 0 value={twice(V(b))}", [](double t) { return 6.0 * t; }},
    // x = 1 - 1000 ∫ x
    {"B1 o 0 V=1-sdt(1k*V(o))", [](double t) { return std::exp(-1000.0 * t); }},
};

}  // namespace

TEST_CASE("integrals and derivatives in expressions have their values", "[regression]") {
  const MemoryCase& one = GENERATE_REF(from_range(std::begin(memory_cases), std::end(memory_cases)));
  INFO(one.card);
  const std::string text = std::string("memory\nV1 a 0 SIN(0 1 50)\nV2 b 0 3\n.func twice(x) {2*sdt(x)}\n") + one.card +
                           "\nR1 o 0 1\n.save v(o)\n.tran 0.3m 18.15m 0.15m\n.end\n";
  const DeckRun run = run_text(text);
  REQUIRE(run.messages.empty());
  REQUIRE(run.rows.size() == 61);
  const DeckRun sparse = run_text_sparse(text, 1e-6);
  REQUIRE(sparse.messages.empty());
  for (std::size_t k = 0; k < run.rows.size(); ++k) {
    const double time = run.rows[k][0];
    INFO(time);
    CHECK(run.rows[k][1] == Approx(one.value(time)).margin(1e-10));
    CHECK(sparse.rows[k][1] == Approx(one.value(time)).margin(1e-3));
  }
}
