#include "elements/formula_emission.hpp"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "elements/complementarity.hpp"
#include "elements/dynamics.hpp"

namespace pwlsim::elements {
namespace {

using PartKind = FormulaPart::Kind;
using model::LinearForm;

class FormulaEmission {
 public:
  FormulaEmission(Emission& emission, const Formula& formula, const Signals& signals)
      : emission_(emission), formula_(formula), signals_(signals), needed_(formula.parts.size(), 0), forms_(formula.parts.size()) {}

  MovingForm run() {
    mark(formula_.value);
    for (std::size_t k = formula_.parts.size(); k-- > 0;)
      if (needed_[k] != 0) mark_arguments(formula_.parts[k]);
    for (std::size_t k = 0; k < formula_.parts.size(); ++k)
      if (needed_[k] != 0) forms_[k] = form_of(formula_.parts[k]);
    return form(formula_.value);
  }

 private:
  void mark(const AffineSum& sum) {
    for (const auto& term : sum.terms) needed_[static_cast<std::size_t>(term.first)] = 1;
  }

  void mark_arguments(const FormulaPart& part) {
    mark(part.argument);
    mark(part.above);
    mark(part.below);
  }

  MovingForm form(const AffineSum& sum) const {
    MovingForm result = constant_form(sum.constant);
    for (const auto& [part, coefficient] : sum.terms) accumulate(result, forms_[static_cast<std::size_t>(part)], coefficient);
    return result;
  }

  MovingForm form_of(const FormulaPart& part) {
    switch (part.kind) {
      case PartKind::voltage:
      case PartKind::current:
        return signals_(part);
      case PartKind::time:
        return quantity(Quantity::source, add_source(part));
      case PartKind::positive:
        return add_positive_part(emission_, form(part.argument));
      case PartKind::step:
        return add_step(emission_, form(part.argument), part.at_zero);
      case PartKind::choice:
        return add_choice(emission_.builder(), emission_.label(), {form(part.argument), part.on_level, part.off_level}, form(part.above),
                          form(part.below));
      case PartKind::product:  // they are gone by now
      case PartKind::quotient:
      case PartKind::call:
        return {};
      case PartKind::integral:
        return add_integral(emission_, next_name("integral"), form(part.argument), {part.start}, resets_of(part));
      case PartKind::derivative:
        return add_derivative(emission_, next_name("derivative"), form(part.argument));
      case PartKind::transfer:
        return add_transfer(emission_, next_name("fraction"), part.fraction, 1.0, form(part.argument));
    }
    return {};
  }

  int add_source(const FormulaPart& part) {
    model::NetworkBuilder& builder = emission_.builder();
    // Each has a name of its own, by which derivatives find it.
    const model::Label label = sources_ == 0 ? emission_.label() : emission_.label(fmt::format("time {}", sources_ + 1));
    ++sources_;
    const int index = builder.add(model::Source{label, part.function});
    for (std::size_t k = 0; k < part.function_moves.size(); ++k)
      if (part.function_moves[k])
        builder.move(k, {.item = model::NetworkMove::Item::source, .index = index, .function = part.function_moves[k]});
    return index;
  }

  Resets resets_of(const FormulaPart& part) const {
    Resets resets;
    if (part.is_held) resets.hold = Hold{form(part.above), part.on_level.value};
    resets.from = part.from;
    resets.to = part.to;
    return resets;
  }

  /// Of the inner nodes of a part with states.
  std::string next_name(std::string_view what) { return fmt::format("{} {}", what, ++parts_with_states_); }

  Emission& emission_;
  const Formula& formula_;
  const Signals& signals_;
  std::vector<char> needed_;
  std::vector<MovingForm> forms_;
  int parts_with_states_ = 0, sources_ = 0;
};

}  // namespace

MovingForm emit_formula(Emission& emission, const Formula& formula) {
  return emit_formula(emission, formula, [&](const FormulaPart& part) -> LinearForm {
    const auto index = static_cast<std::size_t>(part.index);
    if (part.kind == PartKind::current) return emission.referenced_result(index).current;
    const NodePair& pair = emission.instance().control_nodes[index];
    return model::voltage_between(pair.p, pair.n);
  });
}

MovingForm emit_formula(Emission& emission, const Formula& formula, const Signals& signals) {
  return FormulaEmission(emission, formula, signals).run();
}

void add_formula_source(Emission& emission, bool is_current) {
  Emitted& result = emission.result();
  if (is_current && !emission.is_referenced()) {
    result.item = emission.builder().add(model::Injection{emission.label(), emission.p(), emission.n(), {}});
    return;
  }
  // A current that others follow is an unknown of its own from the first pass on: a branch whose law leaves the voltage free.
  result.item = emission.builder().add(model::Branch{emission.label(), emission.p(), emission.n(), {}});
  result.current = quantity(Quantity::branch_current, result.item);
}

void set_source_value(Emission& emission, const MovingForm& value, bool is_current) {
  using Moved = model::NetworkMove::Item;
  Emitted& result = emission.result();
  model::Network& network = emission.builder().network();
  const auto index = static_cast<std::size_t>(result.item);
  if (is_current && !emission.is_referenced()) {
    result.current = value.form;
    result.current_moved = value.moved;
    network.injections[index].current = value.form;
    return add_moves(emission.builder(), Moved::injection_form, result.item, value.moved);
  }
  LinearForm& law = network.branches[index].voltage;
  if (!is_current) {
    law = value.form;
    if (const double r = emission.instance().series_resistance; r != 0.0) law.push_back({Quantity::branch_current, result.item, r});
    return add_moves(emission.builder(), Moved::branch_form, result.item, value.moved);
  }
  MovingForm difference(model::voltage_between(emission.p(), emission.n()));
  accumulate(difference, value, -1.0);
  difference.form.push_back({Quantity::branch_current, result.item, 1.0});
  law = difference.form;
  add_moves(emission.builder(), Moved::branch_form, result.item, difference.moved);
}

bool is_voltage_formula(const Instance& instance) { return !instance.formula_is_current; }

}  // namespace pwlsim::elements
