#include "circuit/parameter_moves.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/names.hpp"
#include "circuit/parameter_slots.hpp"

namespace pwlsim::circuit {
namespace {

using elements::Instance;
using elements::Model;
using elements::Values;
using model::NetworkMove;
using model::NetworkMoves;
using Moved = NetworkMove::Item;
/// "S1" and "Vt" of "S1:Vt", "C1" and "ic" of "ic(C1)".
struct SlotName {
  std::string element, value;
};

SlotName slot_name(const std::string& name) {
  const std::size_t open = name.find('(');
  if (open != std::string::npos && name.back() == ')') return {name.substr(open + 1, name.size() - open - 2), name.substr(0, open)};
  const std::size_t colon = name.rfind(':');
  if (colon != std::string::npos) return {name.substr(0, colon), name.substr(colon + 1)};
  return {name, ""};
}

class Follower {
 public:
  Follower(FlatCircuit& circuit, const model::Network& network, Reporter& reporter)
      : circuit_(circuit), network_(network), reporter_(reporter), card_(*circuit.analyses.sensitivities) {}

  void run() {
    for (SensitivityAnalysis::Parameter& parameter : card_.parameters)
      if (parameter.number < 0) follow_element(parameter);
    for (const Instance& instance : circuit_.instances) follow_numbers(instance);
    for (SensitivityAnalysis::Parameter& parameter : card_.parameters) follow_formulas(parameter);
    for (const FlatCircuit::Folded& folded : circuit_.folded)
      for (SensitivityAnalysis::Parameter& parameter : card_.parameters) refuse_folded(folded, parameter);
    for (const InitialCondition& condition : circuit_.conditions) follow_condition(condition);
    for (const elements::Written& number : circuit_.unfollowed) give_up(number.gradient, reporter_.text(number.span), "");
  }

 private:
  [[nodiscard]] const Instance* find(const std::string& name) const {
    const auto same = [&](const Instance& i) {
      return i.name.size() == name.size() && std::equal(name.begin(), name.end(), i.name.begin(), [](char a, char b) {
               const auto plain = [](char c) { return c == ':' ? '.' : c; };
               return same_name({&a, 1}, {&b, 1}) || plain(a) == plain(b);
             });
    };
    const auto found = std::find_if(circuit_.instances.begin(), circuit_.instances.end(), same);
    return found == circuit_.instances.end() ? nullptr : &*found;
  }

  void unknown(const SensitivityAnalysis::Parameter& parameter, std::string_view why) {
    reporter_.error("E-sens-unknown-parameter", parameter.span, fmt::format("{}", why));
  }

  void follow_element(SensitivityAnalysis::Parameter& parameter) {
    // An element within a subcircuit may be written X1:R1.
    const Instance* instance = find(parameter.name);
    const SlotName slot = instance != nullptr ? SlotName{parameter.name, ""} : slot_name(parameter.name);
    if (instance == nullptr) instance = find(slot.element);
    if (instance == nullptr || instance->kind == nullptr) return unknown_name(parameter, slot);
    if (slot.value.empty()) return follow_main(parameter, *instance);
    follow_value(parameter, *instance, slot.value);
  }

  void unknown_name(const SensitivityAnalysis::Parameter& parameter, const SlotName& slot) {
    std::vector<std::string> names;
    for (const Instance& instance : circuit_.instances) names.push_back(instance.name);
    for (const std::string& name : circuit_.parameter_names) names.push_back(name);
    std::string cure = suggestion(slot.element, names);
    constexpr std::size_t most_named = 8;
    if (cure.empty() && names.size() <= most_named) cure = fmt::format("; try {}", fmt::join(names, ", "));
    unknown(parameter, fmt::format("'{}' is neither a parameter nor an element{}", slot.element, cure));
  }

  void follow_main(SensitivityAnalysis::Parameter& parameter, const Instance& instance) {
    const Slots slots(network_, circuit_, instance);
    const char letter = instance.kind->letter;
    bool done = false;
    if (letter == 'V' || letter == 'I') {
      if (const auto* dc = instance.waveform ? std::get_if<model::Dc>(&*instance.waveform) : nullptr) parameter.value = dc->value;
      done = slots.constant_value(1.0, parameter.moves);
    } else if (letter == 'E' || letter == 'F' || letter == 'G' || letter == 'H') {
      if (instance.coefficients.size() == 2) parameter.value = instance.coefficients[1];
      done = slots.gain(1.0, parameter.moves);
    } else if ((letter == 'R' || letter == 'L' || letter == 'C' || letter == 'K') && !instance.values.table().empty()) {
      const std::string_view name = instance.values.table().front().name;
      parameter.value = instance.values.get(name);
      done = slots.element_value(name, 1.0, parameter.moves);
    }
    if (!done) unknown(parameter, fmt::format("{} has no single value to vary{}", instance.name, values_of(instance)));
  }

  /// "; try S1:Ron, S1:Vt"
  [[nodiscard]] std::string values_of(const Instance& instance) const {
    std::vector<std::string> names;
    const Slots slots(network_, circuit_, instance);
    NetworkMoves scratch;
    const auto add = [&](elements::ParameterTable table, auto accepts) {
      for (const elements::Parameter& value : table)
        if (accepts(value.name)) names.push_back(fmt::format("{}:{}", instance.name, value.name));
    };
    add(instance.waveform_values.table(), [&](std::string_view name) { return slots.waveform_value(name, 1.0, scratch); });
    if (instance.model >= 0)
      add(circuit_.models[static_cast<std::size_t>(instance.model)].values.table(),
          [&](std::string_view name) { return slots.model_value(name, 1.0, scratch); });
    add(instance.values.table(), [&](std::string_view name) { return slots.element_value(name, 1.0, scratch); });
    return names.empty() ? std::string() : fmt::format("; try {}", fmt::join(names, ", "));
  }

  void follow_value(SensitivityAnalysis::Parameter& parameter, const Instance& instance, const std::string& name) {
    const Slots slots(network_, circuit_, instance);
    const auto known = [&](const Values& values) { return elements::find_parameter(values.table(), name) != nullptr; };
    if (same_name(name, "dc") && slots.constant_value(1.0, parameter.moves)) {
      parameter.value = std::get<model::Dc>(*instance.waveform).value;
      return;
    }
    if (known(instance.waveform_values) && slots.waveform_value(name, 1.0, parameter.moves)) {
      parameter.value = instance.waveform_values.get(name);
      return;
    }
    const Model* model = instance.model >= 0 ? &circuit_.models[static_cast<std::size_t>(instance.model)] : nullptr;
    if (model != nullptr && known(model->values) && slots.model_value(name, 1.0, parameter.moves)) {
      parameter.value = model->values.get(name);
      return;
    }
    if (known(instance.values) && slots.element_value(name, 1.0, parameter.moves)) {
      parameter.value = instance.values.get(name);
      return;
    }
    unknown(parameter,
            fmt::format("{} has no value '{}' that can be varied{}{}", instance.name, name, slots.tangent_note(), values_of(instance)));
  }

  void give_up(const std::vector<double>& gradient, std::string_view text, const std::string& element) {
    for (SensitivityAnalysis::Parameter& parameter : card_.parameters) {
      if (parameter.number < 0 || static_cast<std::size_t>(parameter.number) >= gradient.size()) continue;
      if (gradient[static_cast<std::size_t>(parameter.number)] == 0.0 || !parameter.failure.empty()) continue;
      const std::string where = element.empty() ? fmt::format("'{}'", text)
                                : text.empty()  ? element
                                                : fmt::format("'{}' of {}", text, element);
      parameter.failure = fmt::format("{} depends on it in a way that is not followed", where);
    }
  }

  /// Numbers of the card, and of its model.
  void follow_numbers(const Instance& instance) {
    if (instance.kind == nullptr) return;
    const Slots slots(network_, circuit_, instance);
    for (SensitivityAnalysis::Parameter& parameter : card_.parameters) {
      if (parameter.number < 0 || static_cast<std::size_t>(parameter.number) >= instance.waveform_moves.size()) continue;
      const auto& moved = instance.waveform_moves[static_cast<std::size_t>(parameter.number)];
      if (moved && parameter.failure.empty()) (void)slots.source_moves(*moved, parameter.moves);
    }
    for (const elements::Written& number : instance.written) {
      const auto name = name_of(number, instance.values), waveform = name_of(number, instance.waveform_values);
      distribute(instance, number, [&](double p, NetworkMoves& moves) {
        if (!name.empty()) return slots.element_value(name, p, moves);
        if (!waveform.empty()) return slots.waveform_value(waveform, p, moves);
        if (!number.span.known() || instance.written.size() != 1) return false;
        const char letter = instance.kind->letter;
        return letter == 'V' || letter == 'I' ? slots.constant_value(p, moves) : slots.gain(p, moves);
      });
    }
    if (instance.model < 0) return;
    const Model& model = circuit_.models[static_cast<std::size_t>(instance.model)];
    for (const elements::Written& number : model.written) {
      const auto name = name_of(number, model.values);
      distribute(instance, number, [&](double p, NetworkMoves& moves) {
        return !name.empty() && (slots.follows_block(name) || slots.model_value(name, p, moves));
      });
    }
  }

  /// The values of a source that a formula has taken as numbers.
  void refuse_folded(const FlatCircuit::Folded& folded, SensitivityAnalysis::Parameter& parameter) {
    const Instance& source = circuit_.instances[static_cast<std::size_t>(folded.source)];
    const Instance& reader = circuit_.instances[static_cast<std::size_t>(folded.reader)];
    if (parameter.failure.empty() && moves_values(source, parameter))
      parameter.failure = fmt::format("{} takes the voltage of {} as a number, which is not followed", reader.name, source.name);
  }

  [[nodiscard]] bool moves_values(const Instance& source, const SensitivityAnalysis::Parameter& parameter) const {
    const auto is_value = [](std::string_view name) { return name.empty() || same_name(name, "V1") || same_name(name, "V2"); };
    if (parameter.number < 0) {
      const SlotName slot = slot_name(parameter.name);
      return find(parameter.name) == &source || (find(slot.element) == &source && (is_value(slot.value) || same_name(slot.value, "dc")));
    }
    const auto number = static_cast<std::size_t>(parameter.number);
    const auto moves = [&](const elements::AffineSum& sum) {
      const auto is_moved = [&](const elements::Varied& each) { return each.moved(number) != 0.0; };
      return is_moved(sum.constant) || std::any_of(sum.terms.begin(), sum.terms.end(), [&](const auto& t) { return is_moved(t.second); });
    };
    if (source.formula &&
        (moves(source.formula->value) || std::any_of(source.formula->parts.begin(), source.formula->parts.end(),
                                                     [&](const auto& part) { return moves(part.above) || moves(part.below); })))
      return true;
    if (number < source.waveform_moves.size() && source.waveform_moves[number])
      if (const auto* pwl = std::get_if<model::Pwl>(&*source.waveform_moves[number]))
        if (std::any_of(pwl->points.begin(), pwl->points.end(), [](const auto& point) { return point.value != 0.0; })) return true;
    return std::any_of(source.written.begin(), source.written.end(), [&](const elements::Written& own) {
      return number < own.gradient.size() && own.gradient[number] != 0.0 && is_value(name_of(own, source.waveform_values));
    });
  }

  /// Expressions of B, E, F, G and H, and blocks.
  void follow_formulas(SensitivityAnalysis::Parameter& parameter) {
    if (parameter.number < 0 || static_cast<std::size_t>(parameter.number) >= circuit_.formula_moves.size()) return;
    for (const NetworkMove& move : circuit_.formula_moves[static_cast<std::size_t>(parameter.number)]) {
      const bool is_known = std::isfinite(move.derivative) && std::all_of(move.form.begin(), move.form.end(), [](const model::Term& term) {
                              return std::isfinite(term.coefficient);
                            });
      if (!is_known && parameter.failure.empty())
        parameter.failure = fmt::format("{} depends on it in a way that is not followed", name_of(move));
      parameter.moves.push_back(move);
    }
  }

  /// The element whose formula has become this part of the network.
  [[nodiscard]] const std::string& name_of(const NetworkMove& move) const {
    const auto of = [&](const auto& list) -> const std::string& { return list[static_cast<std::size_t>(move.index)].label.name; };
    switch (move.item) {
      case Moved::branch_form:
        return of(network_.branches);
      case Moved::injection_form:
        return of(network_.injections);
      case Moved::slack_form:
        return of(network_.complementarities);
      case Moved::signal_form:
        return network_.signals[static_cast<std::size_t>(move.index)].name;
      case Moved::node_condition:
        return of(network_.node_conditions);
      case Moved::initial_voltage:
        return of(network_.capacitors);
      case Moved::source:
        return of(network_.sources);
      default:
        return of(network_.switches);
    }
  }

  static std::string name_of(const elements::Written& number, const Values& values) {
    if (!number.span.known()) return "";
    for (const Values::Given& given : values.all())
      if (given.span.file == number.span.file && given.span.begin == number.span.begin && given.span.end == number.span.end &&
          given.list.size() == 1)
        return std::string(given.parameter->name);
    return "";
  }

  template <class Add>
  void distribute(const Instance& instance, const elements::Written& number, const Add& add) {
    for (SensitivityAnalysis::Parameter& parameter : card_.parameters) {
      if (parameter.number < 0 || static_cast<std::size_t>(parameter.number) >= number.gradient.size()) continue;
      const double p = number.gradient[static_cast<std::size_t>(parameter.number)];
      if (p == 0.0 || !parameter.failure.empty()) continue;
      if (!std::isfinite(p))
        parameter.failure = fmt::format("'{}' of {} has no derivative to it", reporter_.text(number.span), instance.name);
      else if (!add(p, parameter.moves))
        give_up(number.gradient, number.span.known() ? reporter_.text(number.span) : std::string_view(), instance.name);
    }
  }

  /// Of several for one node or inductor the network has the last.
  void follow_condition(const InitialCondition& condition) {
    const auto add = [&](const auto& list, Moved item) {
      for (std::size_t i = 0; i < list.size(); ++i) {
        const SourceSpan& span = list[i].label.span;
        if (span.file != condition.span.file || span.begin != condition.span.begin) continue;
        for (SensitivityAnalysis::Parameter& parameter : card_.parameters) {
          if (parameter.number < 0 || static_cast<std::size_t>(parameter.number) >= condition.gradient.size()) continue;
          const double p = condition.gradient[static_cast<std::size_t>(parameter.number)];
          if (p != 0.0) parameter.moves.push_back({.item = item, .index = static_cast<int>(i), .derivative = p});
        }
      }
    };
    if (condition.is_current)
      add(network_.current_conditions, Moved::current_condition);
    else
      add(network_.node_conditions, Moved::node_condition);
  }

  FlatCircuit& circuit_;
  const model::Network& network_;
  Reporter& reporter_;
  SensitivityAnalysis& card_;
};

}  // namespace

void follow_parameters(FlatCircuit& circuit, const model::Network& network, Reporter& reporter) {
  if (circuit.analyses.sensitivities) Follower(circuit, network, reporter).run();
}

}  // namespace pwlsim::circuit
