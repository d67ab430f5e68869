#include <pwlsim/circuit.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "api/messages.hpp"
#include "base/names.hpp"

namespace pwlsim {
namespace {

/// What ends a word, or a line, of the deck language.
bool ends_word(char c) {
  return static_cast<unsigned char>(c) <= ' ' || std::string_view("()[]{}=,;'\"").find(c) != std::string_view::npos;
}

std::string_view checked_word(std::string_view word) {
  const bool is_comment = word.starts_with('*') || word.starts_with('$') || word.find("//") != std::string_view::npos;
  if (word.empty() || is_comment || std::any_of(word.begin(), word.end(), ends_word))
    throw api::error(
        "E-name", fmt::format("'{}' is not a valid name: it is empty, or contains a blank, a bracket, a quote, = , ; or //; try letters, "
                              "digits, _ and others",
                              word));
  return word;
}

/// One card is one line.
std::string_view checked_text(std::string_view text) {
  if (std::any_of(text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; }))
    throw api::error("E-name", fmt::format("'{}' contains a line end; try Circuit::cards for more than one card", text));
  return text;
}

std::string words_of(const Parameters& parameters) {
  std::string text;
  for (const auto& [name, value] : parameters) text += fmt::format(" {}={}", checked_word(name), checked_text(value.text()));
  return text;
}

std::string in_braces(std::string_view expression) { return fmt::format("{{{}}}", checked_text(expression)); }

constexpr std::string_view ideal_diode = "pwlsim_ideal_diode";

}  // namespace

Circuit::Circuit(std::string title) : text_(fmt::format("{}\n", checked_text(title))) {}

Circuit Circuit::from_file(std::string path) {
  Circuit circuit;
  circuit.base_ = Base::file;
  circuit.base_text_ = std::move(path);
  return circuit;
}

Circuit Circuit::from_text(std::string deck) {
  Circuit circuit;
  circuit.base_ = Base::text;
  circuit.base_text_ = std::move(deck);
  return circuit;
}

Circuit& Circuit::add(char letter, std::string_view name, std::initializer_list<std::string_view> nodes, std::string_view rest,
                      const Parameters& more) {
  if (lower_letter(checked_word(name).front()) != lower_letter(letter))
    throw api::error("E-name", fmt::format("the name of this element begins with {0}; try '{0}{1}'", letter, name));
  text_ += name;
  for (const std::string_view node : nodes) text_ += fmt::format(" {}", checked_word(node));
  text_ += fmt::format(" {}{}\n", checked_text(rest), words_of(more));
  return *this;
}

Circuit& Circuit::resistor(std::string_view name, std::string_view p, std::string_view n, const Value& resistance, const Parameters& more) {
  return add('R', name, {p, n}, resistance.text(), more);
}

Circuit& Circuit::capacitor(std::string_view name, std::string_view p, std::string_view n, const Value& capacitance,
                            const Parameters& more) {
  return add('C', name, {p, n}, capacitance.text(), more);
}

Circuit& Circuit::inductor(std::string_view name, std::string_view p, std::string_view n, const Value& inductance, const Parameters& more) {
  return add('L', name, {p, n}, inductance.text(), more);
}

Circuit& Circuit::coupling(std::string_view name, const std::vector<std::string>& inductors, const Value& coefficient) {
  std::string rest;
  for (const std::string& inductor : inductors) rest += fmt::format("{} ", checked_word(inductor));
  return add('K', name, {}, rest + coefficient.text());
}

Circuit& Circuit::voltage_source(std::string_view name, std::string_view p, std::string_view n, const Waveform& voltage,
                                 const Parameters& more) {
  return add('V', name, {p, n}, voltage.text(), more);
}

Circuit& Circuit::current_source(std::string_view name, std::string_view p, std::string_view n, const Waveform& current,
                                 const Parameters& more) {
  return add('I', name, {p, n}, current.text(), more);
}

Circuit& Circuit::diode(std::string_view name, std::string_view anode, std::string_view cathode, std::string_view model,
                        const Parameters& more) {
  add('D', name, {anode, cathode}, checked_word(model.empty() ? ideal_diode : model), more);
  if (model.empty() && !has_ideal_diode_) this->model(ideal_diode, "D");
  has_ideal_diode_ |= model.empty();
  return *this;
}

Circuit& Circuit::voltage_switch(std::string_view name, std::string_view p, std::string_view n, std::string_view cp, std::string_view cn,
                                 std::string_view model, bool on) {
  return add('S', name, {p, n, cp, cn, model}, on ? "on" : "");
}

Circuit& Circuit::current_switch(std::string_view name, std::string_view p, std::string_view n, std::string_view element,
                                 std::string_view model, bool on) {
  return add('W', name, {p, n, element, model}, on ? "on" : "");
}

Circuit& Circuit::voltage_controlled_voltage(std::string_view name, std::string_view p, std::string_view n, std::string_view cp,
                                             std::string_view cn, const Value& gain) {
  return add('E', name, {p, n, cp, cn}, gain.text());
}

Circuit& Circuit::voltage_controlled_current(std::string_view name, std::string_view p, std::string_view n, std::string_view cp,
                                             std::string_view cn, const Value& gain) {
  return add('G', name, {p, n, cp, cn}, gain.text());
}

Circuit& Circuit::current_controlled_voltage(std::string_view name, std::string_view p, std::string_view n, std::string_view element,
                                             const Value& gain) {
  return add('H', name, {p, n, element}, gain.text());
}

Circuit& Circuit::current_controlled_current(std::string_view name, std::string_view p, std::string_view n, std::string_view element,
                                             const Value& gain) {
  return add('F', name, {p, n, element}, gain.text());
}

Circuit& Circuit::expression_voltage(std::string_view name, std::string_view p, std::string_view n, std::string_view expression) {
  return add('B', name, {p, n}, "V=" + in_braces(expression));
}

Circuit& Circuit::expression_current(std::string_view name, std::string_view p, std::string_view n, std::string_view expression) {
  return add('B', name, {p, n}, "I=" + in_braces(expression));
}

Circuit& Circuit::subcircuit(std::string_view name, const std::vector<std::string>& nodes, std::string_view definition,
                             const Parameters& more) {
  std::string rest;
  for (const std::string& node : nodes) rest += fmt::format("{} ", checked_word(node));
  return add('X', name, {}, rest + std::string(checked_word(definition)), more);
}

Circuit& Circuit::model(std::string_view name, std::string_view type, const Parameters& parameters) {
  text_ += fmt::format(".model {} {}{}\n", checked_word(name), checked_word(type), words_of(parameters));
  return *this;
}

Circuit& Circuit::parameter(std::string_view name, const Value& value) {
  text_ += fmt::format(".param {}={}\n", checked_word(name), checked_text(value.text()));
  return *this;
}

Circuit& Circuit::option(std::string_view name, const Value& value) {
  text_ += fmt::format(".options {}={}\n", checked_word(name), checked_text(value.text()));
  return *this;
}

Circuit& Circuit::initial_voltage(std::string_view node, const Value& voltage) {
  text_ += fmt::format(".ic v({})={}\n", checked_word(node), checked_text(voltage.text()));
  return *this;
}

Circuit& Circuit::initial_current(std::string_view inductor, const Value& current) {
  text_ += fmt::format(".ic i({})={}\n", checked_word(inductor), checked_text(current.text()));
  return *this;
}

Circuit& Circuit::save(const std::vector<std::string>& signals) {
  for (const std::string& signal : signals) text_ += fmt::format(".save {}\n", checked_text(signal));
  return *this;
}

Circuit& Circuit::measure(std::string_view name, std::string_view what) {
  text_ += fmt::format(".meas tran {} {}\n", checked_word(name), checked_text(what));
  return *this;
}

Circuit& Circuit::controller(Controller controller) {
  const auto& outputs = controller.outputs;
  const auto& initial = controller.initial;
  if (!controller.function) throw api::error("E-controller", "a controller needs a function");
  if (outputs.empty()) throw api::error("E-controller", "a controller needs an output; try the name of a node");
  if (!(controller.every > 0.0 && std::isfinite(controller.every)))
    throw api::error("E-controller", "a controller needs a sampling interval `every` greater than 0 s");
  if (!(controller.delay >= 0.0 && std::isfinite(controller.delay)))
    throw api::error("E-controller", "the delay of a controller must not be negative");
  if (!initial.empty() && initial.size() != outputs.size())
    throw api::error("E-controller", fmt::format("a controller of {} outputs has {} initial values", outputs.size(), initial.size()));
  for (const std::string& output : outputs) (void)checked_word(output);
  for (const std::string& input : controller.inputs) (void)checked_text(input);
  controllers_.push_back(std::move(controller));
  return *this;
}

Circuit& Circuit::cards(std::string_view lines) {
  text_ += lines;
  if (!lines.ends_with('\n')) text_ += '\n';
  return *this;
}

}  // namespace pwlsim
