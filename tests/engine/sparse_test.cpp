/// The sparse engine's parts on systems with closed forms.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "engine/sparse/sparse.hpp"
#include "engine/sparse/stepper.hpp"
#include "support/circuit.hpp"

using namespace pwlsim;
using namespace pwlsim::test;
using namespace pwlsim::engine::sparse;

namespace {

constexpr double rounding = 1e-12;

/// What a step needs, around one network.
struct StepRig {
  explicit StepRig(const model::Network& network)
      : descriptor(network),
        factors(network, descriptor),
        ports(descriptor, factors, 1.0),
        sources(network),
        stepper(descriptor, ports, sources),
        scale(descriptor, 1.0) {
    point.on.assign(descriptor.ports().size(), 0);
    point.z.assign(static_cast<std::size_t>(descriptor.size()), 0.0);
    point.k = point.z;
    sources.evaluate(0.0, point.w);
  }
  void set_states(const std::vector<double>& values) {
    if (!descriptor.unknowns_of_states(values, point.w, point.on, point.z, memory)) memory.clear();
  }
  /// Of a network whose only unknown is a node's voltage.
  void set_node(double voltage) {
    point.z[0] = voltage;
    descriptor.rates(point.z.data(), point.w.data(), point.k.data());
  }
  [[nodiscard]] double state(std::size_t i, const Point& p) const { return descriptor.states()[i].value(p.z.data()); }

  Descriptor descriptor;
  Factors factors;
  PortSolver ports;
  Sources sources;
  Stepper stepper;
  StateScale scale;
  Point point;
  std::vector<double> memory;  ///< charges of the start beside those of point
};

}  // namespace

// R(x) = (1 + (1 − 2d) x)/(1 − d x)² with x = −h/RC: of order 2, with a double pole at 1/d and zero at infinity there is no other.
TEST_CASE("a step of an RC discharge is the stability function of either method", "[unit]") {
  TestCircuit c;
  c.c("a", "0", 2.0);
  c.r("a", "0", 3.0);
  StepRig rig(c.network());
  rig.set_node(5.0);
  for (const double h : {1e-3, 1.0, 60.0, 6e4}) {
    const double x = -h / 6.0;
    const double expected = 5.0 * (1.0 + (1.0 - 2.0 * diagonal) * x) / std::pow(1.0 - diagonal * x, 2);
    Stepper::Trial trial;
    rig.stepper.tr_bdf2(rig.point, h, rig.scale, trial);
    REQUIRE(trial.solved == Solved::yes);
    CHECK(rig.state(0, trial.end) == Approx(expected).epsilon(rounding).margin(rounding));
    rig.stepper.sdirk2(rig.point, h, rig.scale, trial);
    REQUIRE(trial.solved == Solved::yes);
    CHECK(rig.state(0, trial.end) == Approx(expected).epsilon(rounding).margin(rounding));
  }
}

// With the stages R1 = (1 + d x)/(1 − d x) and R the estimate is e = x ((4b − 1) − R1 + 2d R)/(3 − 3 d x); R − e/(1 − d x) is left: zero at infinity, and
// in small steps of e^x with an error of the fourth order.
TEST_CASE("a step without its estimated error is of order 3, and as stable", "[unit]") {
  TestCircuit c;
  c.c("a", "0", 2.0);
  c.r("a", "0", 3.0);
  StepRig rig(c.network());
  rig.set_node(5.0);
  double error[2] = {0.0, 0.0};
  for (const double h : {0.12, 0.06, 60.0, 6e4, 6e8}) {
    const double x = -h / 6.0, pole = 1.0 - diagonal * x;
    const double end = (1.0 + (1.0 - 2.0 * diagonal) * x) / (pole * pole);
    const double estimate = x * ((4.0 * step_weight - 1.0) - (1.0 + diagonal * x) / pole + 2.0 * diagonal * end) / (3.0 * pole);
    Stepper::Trial trial;
    rig.stepper.tr_bdf2(rig.point, h, rig.scale, trial);
    REQUIRE(rig.stepper.improve(h, trial) == Solved::yes);
    const double found = rig.state(0, trial.end);
    CHECK(found == Approx(5.0 * (end - estimate / pole)).epsilon(rounding).margin(rounding));
    std::vector<double> rates(trial.end.k.size());
    rig.descriptor.rates(trial.end.z.data(), trial.end.w.data(), rates.data());
    CHECK(trial.end.k[0] == Approx(rates[0]).epsilon(1e-9).margin(rounding));
    if (h < 1.0) error[h < 0.1] = std::abs(found - 5.0 * std::exp(x));
  }
  CHECK(error[0] / error[1] == Approx(16.0).epsilon(0.1));
}

// zᵀ E z is twice the stored energy, R0 (C v² + L i²), which is what the certificate's balance is made of.
TEST_CASE("the energy does not depend on whether a capacitor's current is an unknown", "[unit]") {
  constexpr double farads = 2.0, henries = 3.0, volts = 5.0, amperes = -7.0;
  const bool is_read = GENERATE(false, true);
  TestCircuit c;
  const int capacitor = c.c("a", "b", farads);
  c.l("a", "b", henries);
  c.r("a", "0", 4.0);
  c.r("b", "0", 11.0);
  if (is_read) c.network().signals.push_back({"i(C)", {{model::Term::Kind::capacitor_current, capacitor, 1.0}}});
  StepRig rig(c.network());
  rig.set_states({volts, rig.descriptor.r0() * amperes});
  if (is_read) rig.point.z[static_cast<std::size_t>(rig.descriptor.unknowns().capacitor(0))] = 1e3;  // the energy does not read it
  std::vector<double> memory(rig.point.z.size());
  rig.descriptor.memory(rig.point.z.data(), memory.data());
  CHECK(rig.descriptor.product(rig.point.z, memory) ==
        Approx(rig.descriptor.r0() * (farads * volts * volts + henries * amperes * amperes)).epsilon(rounding));
}

// |R(iy) − e(iy)/(1 − iy d)²| is one at most, for every y: no step gives a tank energy.
TEST_CASE("a step without its estimated error gives a tank no energy", "[unit]") {
  TestCircuit c;
  c.c("a", "0", 1.0);
  c.l("a", "0", 1.0);
  StepRig rig(c.network());
  rig.set_states({1.0, 0.5});
  rig.descriptor.rates(rig.point.z.data(), rig.point.w.data(), rig.point.k.data());
  for (double h = 1e-3; h < 1e6; h *= 1.3) {
    Stepper::Trial trial;
    rig.stepper.tr_bdf2(rig.point, h, rig.scale, trial);
    REQUIRE(rig.stepper.improve(h, trial) == Solved::yes);
    const double v = rig.state(0, trial.end), i = rig.state(1, trial.end);
    CHECK(v * v + i * i <= 1.25 * (1.0 + rounding));
  }
}

// The local error of a step of e^(−t), from R(x) and e^x; the estimates are right to the leading order. That of SDIRK2 takes the step before into account.
TEST_CASE("the error estimate of a small step is its local error", "[unit]") {
  TestCircuit c;
  c.c("a", "0", 1.0);
  c.r("a", "0", 1.0);
  StepRig rig(c.network());
  rig.set_node(1.0);
  Stepper::Trial first, second;
  const double h = 1e-2;
  rig.stepper.tr_bdf2(rig.point, h, rig.scale, first);
  CHECK(first.error == Approx(std::abs(rig.state(0, first.end) - std::exp(-h))).epsilon(0.05));
  rig.stepper.sdirk2(first.end, h, rig.scale, second);
  const double begun = rig.state(0, first.end);
  CHECK(second.error == Approx(std::abs(rig.state(0, second.end) - begun * std::exp(-h)) / begun).epsilon(0.05));
}

// A capacitor across v(t) = t²/2: its current C t at the end of a step is a derivative, and exact for a parabola after the first stage's
// k0 = 0; SDIRK2 has it to first order only.
TEST_CASE("currents of capacitors across sources are of order 2", "[unit]") {
  TestCircuit c;
  c.v("a", "0", model::Sin{0.0, 1.0, 1.0});
  c.c("a", "0", 2.0);
  StepRig rig(c.network());
  const double omega = 2.0 * std::numbers::pi;
  rig.point.time = 0.1;
  const Form current = rig.descriptor.form({{model::Term::Kind::branch_current, 0, -1.0}});
  double error[2];
  for (const int refined : {0, 1}) {
    const double h = refined ? 5e-3 : 1e-2;
    Stepper::Trial trial;
    Point from = rig.point;
    rig.sources.evaluate(from.time, from.w);
    from.z[0] = from.w[0];
    from.k[0] = 0.0;  // a rate of the wrong size does not last
    rig.stepper.tr_bdf2(from, h, rig.scale, trial);
    error[refined] = std::abs(current.value(trial.end.z.data(), trial.end.w.data()) - 2.0 * omega * std::cos(omega * (0.1 + h)));
  }
  CHECK(error[0] / error[1] == Approx(4.0).epsilon(0.1));
}

// A source steps onto 1 F in series with 3 F: the upper one takes 3/4 of the step, whatever the step length.
TEST_CASE("an Euler step takes the jump of a capacitive divider", "[unit]") {
  TestCircuit c;
  c.v("s", "0", model::Dc{4.0});
  c.c("s", "m", 1.0);
  c.c("m", "0", 3.0);
  StepRig rig(c.network());
  rig.set_states({0.0, 0.0});
  Point end;
  REQUIRE(rig.stepper.euler(rig.point, 1e-6, end, rig.memory) == Solved::yes);
  CHECK(rig.state(0, end) == Approx(3.0).epsilon(rounding));
  CHECK(rig.state(1, end) == Approx(1.0).epsilon(rounding));
}

// 1 F at 3 V over a diode onto 2 F: 1 V on both; the diode ends conducting.
TEST_CASE("charge is shared through a diode in one Euler step", "[unit]") {
  TestCircuit c;
  c.c("a", "0", 1.0);
  c.d("a", "b");
  c.c("b", "0", 2.0);
  StepRig rig(c.network());
  rig.set_states({3.0, 0.0});
  Point end;
  REQUIRE(rig.stepper.euler(rig.point, 1e-6, end, rig.memory) == Solved::yes);
  CHECK(rig.state(0, end) == Approx(1.0).epsilon(rounding));
  CHECK(rig.state(1, end) == Approx(1.0).epsilon(rounding));
  CHECK(end.on == Position{1});
}

// M = [[1,0,2],[2,1,0],[0,2,1]], q = −1 makes Newton's method cycle from {1} (Ben Gharbia and Gilbert, INRIA RR-7160); z = 1/3.
TEST_CASE("ports in dispute are decided by Lemke's method", "[unit]") {
  using model::Term;
  model::Network network;
  const double m[3][3] = {{1, 0, 2}, {2, 1, 0}, {0, 2, 1}};
  for (const auto& row : m) {
    model::Complementarity item;
    item.slack.push_back({Term::Kind::one, 0, -1.0});
    for (int j = 0; j < 3; ++j) item.slack.push_back({Term::Kind::slack_input, j, row[j]});
    network.complementarities.push_back(item);
  }
  StepRig rig(network);
  rig.point.on = {1, 0, 0};
  Point end;
  REQUIRE(rig.stepper.euler(rig.point, 1.0, end) == Solved::yes);
  for (int i = 0; i < 3; ++i) {
    const Form u = rig.descriptor.form({{Term::Kind::slack_input, i, 1.0}});
    CHECK(u.value(end.z.data(), end.w.data()) == Approx(1.0 / 3.0).epsilon(rounding));
  }
  CHECK(rig.ports.pivots() > 0);
}

// Two ideal diodes side by side carry 2 A: nothing but the closing rows' ε shares it, one half each.
TEST_CASE("parallel diodes share their current", "[unit]") {
  TestCircuit c;
  c.i("0", "a", model::Dc{2.0});
  c.d("a", "b");
  c.d("a", "b");
  c.r("b", "0", 1.0);
  StepRig rig(c.network());
  Point end;
  REQUIRE(rig.stepper.euler(rig.point, 1.0, end) == Solved::yes);
  for (int i = 0; i < 2; ++i) {
    const Form current = rig.descriptor.form({{model::Term::Kind::diode_current, i, 1.0}});
    CHECK(current.value(end.z.data(), end.w.data()) == Approx(1.0).epsilon(1e-5));
  }
}

TEST_CASE("a network that leaves a node open is refused with its name", "[unit]") {
  TestCircuit c;
  c.v("a", "0", model::Dc{1.0});
  c.v("a", "0", model::Dc{1.0});
  c.r("a", "0", 1.0);
  Diagnostics diagnostics;
  CHECK(prepare(c.network(), diagnostics) == nullptr);
  REQUIRE(diagnostics.error_count() == 1);
  CHECK(diagnostics.all()[0].id == "E-singular");
}

// 12 V over 1 Ω, a short (the inductor), 2 Ω and 3 Ω: 2 A, and 6 V across the 3 Ω and its capacitor.
TEST_CASE("the operating point of the sparse engine has capacitors open and inductors short", "[unit]") {
  TestCircuit c;
  c.v("s", "0", model::Dc{12.0});
  c.r("s", "a", 1.0);
  c.l("a", "b", 1e-3);
  c.r("b", "o", 2.0);
  c.r("o", "0", 3.0);
  c.c("o", "0", 1e-6);
  c.save_v("o");
  Diagnostics diagnostics;
  const auto model = prepare(c.network(), diagnostics);
  REQUIRE(model);
  const engine::OperatingPoint point = operating_point(*model);
  REQUIRE(point.answer.outcome == engine::Outcome::completed);
  CHECK(point.values.at(0) == Approx(6.0).epsilon(1e-8));
}

TEST_CASE("many small parts are no large circuit, one large part is", "[unit]") {
  constexpr int stages = 450;
  TestCircuit apart, chain;
  const auto name = [](int i) { return "n" + std::to_string(i); };
  for (int i = 0; i < stages; ++i) {
    apart.c(name(i), "0", 1.0);
    apart.r(name(i), "0", 1.0);
    apart.save_v(name(i));
    chain.c(name(i), "0", 1.0);
    chain.r(name(i), i == 0 ? "0" : name(i - 1), 1.0);
  }
  chain.save_v(name(0));
  CHECK(largest_part(apart.network()) == 1);
  CHECK(largest_part(chain.network()) == stages);
  TestCircuit unread = chain;
  unread.network().signals.clear();
  CHECK(largest_part(unread.network()) == 0);
}
