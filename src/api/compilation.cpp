#include "api/compilation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <span>
#include <utility>

#include "analysis/fitted_diodes.hpp"
#include "api/controllers.hpp"
#include "api/element_value.hpp"
#include "api/messages.hpp"
#include "base/names.hpp"
#include "circuit/dangling.hpp"
#include "netlist/load.hpp"

namespace pwlsim {
namespace {

constexpr std::string_view of_node = "Vheld_";  ///< begins the name of the source that an output at a node adds

}  // namespace

analysis::EngineChoice api::choice_of(Engine engine) {
  return engine == Engine::exact    ? analysis::EngineChoice::exact
         : engine == Engine::sparse ? analysis::EngineChoice::sparse
                                    : analysis::EngineChoice::automatic;
}

Compilation::Compilation(const Circuit& circuit, const Options& options, const Wanted& wanted) {
  read(circuit, options);
  std::erase_if(deck_.cards, [&](const netlist::Card& card) {
    return std::any_of(wanted.replaced.begin(), wanted.replaced.end(), [&](const std::string& name) { return same_name(card.name, name); });
  });
  if (options.stop != 0.0) set_transient(options);
  if (!wanted.cards.empty()) append_lines("options", wanted.cards);
  hold_outputs(circuit.controllers_);
  of_reading_ = diagnostics_;
  compile(options, wanted);
  if (held_.empty()) return;
  check_outputs();
  if (saves_inputs(circuit.controllers_)) {
    diagnostics_ = of_reading_;
    compile(options, wanted);
  }
  warn_of_idle_outputs();
}

void Compilation::compile(const Options& options, const Wanted& wanted) {
  compiled_ = circuit::compile(deck_, sources_, diagnostics_,
                               {.analysis_required = wanted.analysis_required,
                                .measure = true,
                                .run = options.run,
                                .keep_circuit = wanted.keeps_circuit || !held_.empty(),
                                .held = held_});
  check();
}

Compilation::Compilation(const Compilation& read, const Options& options, const std::vector<GivenValue>& given)
    : sources_(read.sources_), diagnostics_(read.of_reading_), of_reading_(read.of_reading_), deck_(read.deck_) {
  for (const auto& [name, value] : given) {
    if (api::has_parameter(deck_.cards, name))
      append_lines("values", fmt::format(".param {}={}", name, Value(value).text()));
    else
      give_value(name, Value(value).text());
  }
  compile(options, {.analysis_required = true});
}

/// Each output is a source of the deck, or a new one at the node of that name.
void Compilation::hold_outputs(const std::vector<Controller>& controllers) {
  for (const Controller& controller : controllers)
    for (std::size_t k = 0; k < controller.outputs.size(); ++k) {
      const std::string& output = controller.outputs[k];
      const char letter = lower_letter(output.front());
      const bool is_element = api::find_card(deck_.cards, output) != nullptr, is_source = (letter == 'v' || letter == 'i') && is_element;
      const char last = lower_letter(output[output.rfind('.') + 1]);  // of none at the end: the first of all
      if (!is_source && (is_element || (output.find('.') != std::string::npos && (last == 'v' || last == 'i'))))
        throw api::error("E-controller",
                         fmt::format("the output {} of a controller is {}; try a source of constant value of the deck itself, or a node",
                                     output, is_element ? "an element that is no source" : "within a subcircuit"));
      const std::string name = is_source ? output : std::string(of_node) + output;
      if (std::any_of(held_.begin(), held_.end(), [&](const std::string& other) { return same_name(other, name); }))
        throw api::error("E-controller", fmt::format("two outputs of controllers set {}", output));
      held_.push_back(name);
      if (!is_source) append_lines("outputs", fmt::format("{} {} 0 0", name, output));
      if (!controller.initial.empty()) give_value(name, Value(controller.initial[k]).text());
    }
}

void Compilation::check_outputs() const {
  std::vector<char> found(held_.size(), 0);
  for (const model::Source& source : compiled_->network.sources)
    if (const auto* held = std::get_if<model::Held>(&source.function)) found[static_cast<std::size_t>(held->channel)] = 1;
  for (std::size_t k = 0; k < held_.size(); ++k)
    if (found[k] == 0)
      throw api::error("E-controller",
                       fmt::format("a controller cannot set {}, which has a waveform; try a constant value for it", held_[k]));
}

void Compilation::warn_of_idle_outputs() {
  for (const std::string& name : held_)
    if (name.starts_with(of_node) && circuit::hangs_alone(*compiled_->circuit, std::string_view(name).substr(of_node.size())))
      diagnostics_.warning("W-dangling", {},
                           fmt::format("a controller sets the node {}, to which nothing else connects and which nothing reads",
                                       name.substr(of_node.size())));
}

/// The runs that find tangents would call the functions of controllers.
void Compilation::check_tangents() const {
  if (held_.empty()) return;
  for (const model::Diode& diode : compiled_->network.diodes)
    if (diode.law)
      throw api::error(
          "E-controller",
          fmt::format("with controllers no preliminary run finds the tangent of {}, an exponential diode; try .options i0= with the "
                      "current that it carries, or a model with Ron and Vfwd",
                      diode.label.name));
}

/// What a controller reads is a signal. True: cards were added.
bool Compilation::saves_inputs(const std::vector<Controller>& controllers) {
  std::string missing;
  for (const Controller& controller : controllers)
    for (const std::string& input : controller.inputs) {
      const auto& signals = compiled_->network.signals;
      if (std::none_of(signals.begin(), signals.end(), [&](const model::Signal& signal) { return same_name(signal.name, input); }))
        missing += fmt::format(".save {}\n", input);
    }
  if (missing.empty()) return false;
  append_lines("inputs", (compiled_->names_signals ? "" : ".save all\n") + missing);
  return true;
}

std::vector<Message> Compilation::messages() const { return api::messages_of(diagnostics_, sources_); }

analysis::PreparedEngine Compilation::engine(const Options& options) {
  const auto choice = api::choice_of(options.engine);
  const double reltol = analysis::relative_tolerance(options.reltol, compiled_->analyses);
  check_tangents();
  const Diagnostics notes = analysis::fit_diodes(*compiled_, choice, reltol, nullptr);
  for (const Diagnostic& note : notes.all()) diagnostics_.note(note.id, note.span, note.text);
  analysis::PreparedEngine engine = analysis::prepare_engine(compiled_->network, choice, reltol, diagnostics_);
  check();
  return engine;
}

void Compilation::check() const {
  if (diagnostics_.has_errors()) throw Error(messages());
}

void Compilation::read(const Circuit& circuit, const Options&) {
  if (circuit.base_ == Circuit::Base::file) load(circuit.base_text_);
  if (circuit.base_ == Circuit::Base::text) deck_ = netlist::parse("deck", circuit.base_text_, sources_, diagnostics_);
  const bool has_cards = circuit.text_.find('\n') + 1 < circuit.text_.size();
  if (has_cards || circuit.base_ == Circuit::Base::none) append(netlist::parse("code", circuit.text_, sources_, diagnostics_));
  for (const auto& [element, value] : circuit.values_) give_value(element, value);
}

void Compilation::load(const std::string& path) {
  netlist::Loaded loaded = netlist::load(path, sources_, diagnostics_);
  if (!loaded.readable) check();
  deck_ = std::move(loaded.deck);
}

void Compilation::append(netlist::Deck deck) {
  std::move(deck.cards.begin(), deck.cards.end(), std::back_inserter(deck_.cards));
  if (deck_.title.empty()) deck_.title = std::move(deck.title);
}

void Compilation::append_lines(std::string_view name, std::string_view lines) {
  append(netlist::parse(std::string(name), fmt::format("\n{}\n", lines), sources_, diagnostics_));
}

void Compilation::set_transient(const Options& options) {
  std::erase_if(deck_.cards, [](const netlist::Card& card) { return same_name(card.name, ".tran"); });
  append_lines("options", fmt::format(".tran {} {} {}{}", Value(options.step).text(), Value(options.stop).text(),
                                      Value(options.start).text(), options.use_initial_conditions ? " uic" : ""));
}

void Compilation::give_value(const std::string& element, const std::string& value) {
  netlist::Card* const card = api::find_card(deck_.cards, element);
  if (card == nullptr)
    throw api::error("E-unknown-element",
                     fmt::format("there is no element '{}' outside of subcircuits; try a parameter for those inside", element));
  const std::optional<api::ValuePlace> place = api::place_of_value(*card);
  if (!place)
    throw api::error("E-no-value", fmt::format("the card of {} has no value that can be replaced; try a parameter on it", element));
  const netlist::Deck parsed =
      netlist::parse(element, fmt::format("\n{} {}\n", api::head_of_value(*card, *place), value), sources_, diagnostics_);
  check();
  if (!parsed.cards.empty()) api::replace_value(*card, *place, parsed.cards.front());
}

}  // namespace pwlsim
