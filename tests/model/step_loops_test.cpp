/// Which steps feed themselves, on structures in which that is plain.
#include "model/step_loops.hpp"

#include <catch2/catch.hpp>

using namespace pwlsim::model;

namespace {

using Kind = Term::Kind;

Term voltage(int node) { return {Kind::node_voltage, node, 1.0}; }

/// Two complementarities of a step, whose slacks read what theirs do.
Step add_step(Network& network, const LinearForm& argument) {
  const auto first = static_cast<int>(network.complementarities.size());
  LinearForm slack = argument;
  slack.push_back({Kind::slack_input, first + 1, 1.0});
  network.complementarities.push_back({{}, slack});
  network.complementarities.push_back({{}, {{Kind::one, 0, 1.0}, {Kind::slack_input, first, -1.0}}});
  return {first, argument, 0.0};
}

LinearForm value_of(const Step& step) { return {{Kind::one, 0, 1.0}, {Kind::slack_input, step.first, -1.0}}; }

/// Node 0: R and C to ground, fed through R from node 1. Node 1: a source to ground. Node 2: what the step holds.
struct Filter {
  Network network;
  Filter() {
    network.nodes.resize(3);
    network.resistors.push_back({{}, 1, 0, 1.0});
    network.capacitors.push_back({{}, 0, ground, 1.0, false, 0.0, false, {}});
    network.branches.push_back({{}, 1, ground, {{Kind::one, 0, 1.0}}});
  }
};

}  // namespace

TEST_CASE("a step that only holds a node of its own is in no loop, whatever hangs on that node", "[unit]") {
  Filter f;
  const Step step = add_step(f.network, {voltage(0)});
  f.network.branches.push_back({{}, 2, ground, value_of(step)});
  f.network.resistors.push_back({{}, 2, ground, 1.0});
  CHECK(steps_in_loops(f.network, {step}) == std::vector<char>{0});
}

TEST_CASE("a step whose node feeds the circuit that it reads is in a loop, through states and through a chain of steps too", "[unit]") {
  Filter f;
  const bool is_chained = GENERATE(false, true);
  std::vector<Step> steps{add_step(f.network, {voltage(0)})};
  if (is_chained) steps.push_back(add_step(f.network, value_of(steps[0])));
  f.network.branches.push_back({{}, 2, ground, value_of(steps.back())});
  f.network.resistors.push_back({{}, 2, 0, 1.0});
  CHECK(steps_in_loops(f.network, steps) == std::vector<char>(steps.size(), 1));
}

TEST_CASE("a step that reads the current of its own source is in a loop, one that reads another held node is not", "[unit]") {
  Filter f;
  const bool reads_own = GENERATE(false, true);
  const int branch = static_cast<int>(f.network.branches.size());
  const Step step = add_step(f.network, {{reads_own ? Kind::branch_current : Kind::node_voltage, reads_own ? branch : 1, 1.0}});
  f.network.branches.push_back({{}, 2, ground, value_of(step)});
  f.network.resistors.push_back({{}, 2, 0, 1.0});
  CHECK(steps_in_loops(f.network, {step}) == std::vector<char>{static_cast<char>(reads_own)});
}

TEST_CASE("a step whose node is held on top of another held node feeds nothing back to that", "[unit]") {
  Filter f;
  const bool feeds_filter = GENERATE(false, true);
  const Step step = add_step(f.network, {voltage(0)});
  f.network.branches.push_back({{}, 2, 1, value_of(step)});
  f.network.resistors.push_back({{}, 2, feeds_filter ? 0 : ground, 1.0});
  CHECK(steps_in_loops(f.network, {step}) == std::vector<char>{static_cast<char>(feeds_filter)});
}

TEST_CASE("a loop through the control of a switch does not count", "[unit]") {
  Filter f;
  const Step step = add_step(f.network, {voltage(0)});
  f.network.branches.push_back({{}, 2, ground, value_of(step)});
  Switch contact;
  contact.p = 1;
  contact.n = 0;
  contact.control = {voltage(2)};
  contact.on_level = contact.off_level = 0.5;
  f.network.switches.push_back(contact);
  CHECK(steps_in_loops(f.network, {step}) == std::vector<char>{0});
}

TEST_CASE("a source whose law reads its own node holds nothing", "[unit]") {
  // v(2) = v(2) + step: an ideal amplifier, which makes what it reads zero by what hangs on it.
  Filter f;
  const Step step = add_step(f.network, {voltage(0)});
  LinearForm law = value_of(step);
  law.push_back(voltage(2));
  f.network.branches.push_back({{}, 2, ground, law});
  f.network.resistors.push_back({{}, 2, 0, 1.0});
  CHECK(steps_in_loops(f.network, {step}) == std::vector<char>{1});
}
