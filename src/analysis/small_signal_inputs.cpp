#include "analysis/small_signal_inputs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "analysis/modulation.hpp"
#include "base/names.hpp"
#include "steady/variation.hpp"

namespace pwlsim::analysis {
namespace {

using circuit::SmallSignalAnalysis;
using Complex = std::complex<double>;

/// "X1:V1" and "X1.V1" are one.
bool is_same_element(std::string a, std::string b) {
  for (std::string* name : {&a, &b}) std::replace(name->begin(), name->end(), ':', '.');
  return same_name(a, b);
}

/// 1/s, of an input of the highest frequency of the card.
double input_rate(const SmallSignalAnalysis& card) {
  double highest = 0.0;
  for (const double f : card.frequencies) highest = std::max(highest, f);
  return highest > 0.0 ? 2.0 * std::numbers::pi * highest : 1.0;
}

void add_input_on(const SmallSignalAnalysis& card, model::Network& network, const std::vector<int>& sources, Complex amplitude,
                  SmallSignalInputs& inputs) {
  const std::string name = fmt::format("ac {}", network.sources[static_cast<std::size_t>(sources.front())].label.name);
  const int input = steady::add_small_input(network, name, {input_rate(card)});
  for (const int source : sources) steady::superpose_input(network, source, input);
  inputs.names.push_back(name);
  inputs.amplitudes.push_back(amplitude);
}

void add_loop_signals(model::Network& network, const std::string& source, SmallSignalInputs& inputs) {
  for (const model::Branch& branch : network.branches) {
    if (!is_same_element(branch.label.name, source)) continue;
    const auto signal_of = [&](model::NodeIndex node) {
      model::LinearForm form;
      if (node != model::ground) form.push_back({model::Term::Kind::node_voltage, node, 1.0});
      network.signals.push_back({fmt::format("loop {}", node), form});
      return static_cast<int>(network.signals.size()) - 1;
    };
    inputs.positive = signal_of(branch.p);
    inputs.negative = signal_of(branch.n);
    return;
  }
}

/// A second input; false where it is no current source at a node of the voltage source.
bool add_loop_current(const SmallSignalAnalysis& card, model::Network& network, SmallSignalInputs& inputs) {
  const std::string &loop = card.loop, &name = card.loop_current;
  const auto is_named = [](const std::string& wanted) {
    return [&wanted](const auto& part) { return is_same_element(part.label.name, wanted); };
  };
  const auto injection = std::find_if(network.injections.begin(), network.injections.end(), is_named(name));
  const auto branch = std::find_if(network.branches.begin(), network.branches.end(), is_named(loop));
  const std::vector<int> sources = sources_named(network, name);
  if (injection == network.injections.end() || branch == network.branches.end() || sources.empty()) return false;
  const auto injected = [&](model::NodeIndex node) { return (injection->n == node ? 1.0 : 0.0) - (injection->p == node ? 1.0 : 0.0); };
  inputs.injected_at_positive = injected(branch->p);
  inputs.injected_at_negative = injected(branch->n);
  if (inputs.injected_at_positive == 0.0 && inputs.injected_at_negative == 0.0) return false;
  add_input_on(card, network, sources, 0.0, inputs);
  const auto number = static_cast<int>(branch - network.branches.begin());
  network.signals.push_back({"loop current", {{model::Term::Kind::branch_current, number, 1.0}}});
  inputs.current = static_cast<int>(network.signals.size()) - 1;
  return true;
}

}  // namespace

std::vector<int> sources_named(const model::Network& network, const std::string& name) {
  std::vector<int> numbers;
  for (std::size_t k = 0; k < network.sources.size(); ++k)
    if (is_same_element(network.sources[k].label.name, name)) numbers.push_back(static_cast<int>(k));
  return numbers;
}

namespace {

void fail(std::string message, SmallSignalInputs& inputs) {
  inputs.id = "E-ac-no-input";
  inputs.message = std::move(message);
}

std::string no_source(const std::string& name) { return fmt::format("{} is not a source of the circuit", name); }

/// One source, or that of a loop gain.
void add_source(const SmallSignalAnalysis& card, model::Network& network, SmallSignalInputs& inputs) {
  const std::string& name = card.loop.empty() ? card.sources.front() : card.loop;
  const std::vector<int> sources = sources_named(network, name);
  if (sources.empty()) return fail(no_source(name), inputs);
  add_input_on(card, network, sources, 1.0, inputs);
  if (card.loop.empty()) return;
  add_loop_signals(network, name, inputs);
  if (inputs.positive < 0) return fail(no_source(name), inputs);
  if (!card.loop_current.empty() && !add_loop_current(card, network, inputs))
    fail(fmt::format("{} is not a current source at a node of {}; try {} 0 n+ 0, n+ being that node of {}", card.loop_current, card.loop,
                     card.loop_current, card.loop),
         inputs);
}

/// Sources whose timing is modulated.
void add_timing(const SmallSignalAnalysis& card, model::Network& network, SmallSignalInputs& inputs) {
  for (const std::string& name : card.sources) {
    const std::vector<int> sources = sources_named(network, name);
    if (sources.empty()) return fail(no_source(name), inputs);
    if (const std::string why = immovable(network.sources[static_cast<std::size_t>(sources.front())].function, card); !why.empty())
      return fail(fmt::format("{} {}", name, why), inputs);
    add_input_on(card, network, sources, 0.0, inputs);
  }
}

/// All sources with an AC value.
void add_marked(const SmallSignalAnalysis& card, model::Network& network, SmallSignalInputs& inputs) {
  const std::size_t count = network.sources.size();
  for (std::size_t k = 0; k < count; ++k)
    if (const Complex amplitude = network.sources[k].alternating; amplitude != 0.0)
      add_input_on(card, network, {static_cast<int>(k)}, amplitude, inputs);
  if (inputs.names.empty()) fail("no source has an AC value; try AC 1 on a source, or from=V1", inputs);
}

}  // namespace

SmallSignalInputs add_small_signal_inputs(const SmallSignalAnalysis& card, model::Network& network) {
  SmallSignalInputs inputs;
  if (!card.loop.empty() || card.input == SmallSignalAnalysis::Input::source)
    add_source(card, network, inputs);
  else if (card.input != SmallSignalAnalysis::Input::marked)
    add_timing(card, network, inputs);
  else
    add_marked(card, network, inputs);
  return inputs;
}

std::string small_signal_problem_of_orbit(const circuit::Compiled& compiled, std::string& id) {
  model::Network network = compiled.network;
  SmallSignalInputs inputs = add_small_signal_inputs(*compiled.analyses.small_signal, network);
  id = std::move(inputs.id);
  return std::move(inputs.message);
}

}  // namespace pwlsim::analysis
