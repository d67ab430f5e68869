/// Expressions for ngspice: each kink, step and hysteresis of a formula stands at an inner node of its own.
#include <fmt/format.h>

#include "elements/dynamics.hpp"
#include "elements/twin.hpp"

namespace pwlsim::elements {
namespace {

using PartKind = FormulaPart::Kind;

class FormulaTwin {
 public:
  FormulaTwin(Twin& twin, const Formula& formula, const std::vector<std::string>& voltages, const std::vector<std::string>& currents)
      : twin_(twin), formula_(formula), voltages_(voltages), currents_(currents) {}

  std::string run() {
    for (const FormulaPart& part : formula_.parts) texts_.push_back(text_of(part));
    return sum(formula_.value);
  }

 private:
  std::string sum(const AffineSum& sum) const {
    std::string text = sum.constant.value == 0.0 && !sum.is_constant() ? "" : fmt::format("{}", sum.constant.value);
    for (const auto& [part, coefficient] : sum.terms)
      if (coefficient.value != 0.0) text += term_text(coefficient.value, texts_[static_cast<std::size_t>(part)]);
    return text[0] == '+' ? text.substr(1) : text;
  }

  std::string name() const { return fmt::format("part{}", texts_.size() + 1); }

  std::string text_of(const FormulaPart& part) {
    switch (part.kind) {
      case PartKind::voltage:
        return voltages_[static_cast<std::size_t>(part.index)];
      case PartKind::current:
        return currents_[static_cast<std::size_t>(part.index)];
      case PartKind::time:
        twin_.source(name(), {twin_.inner(name()), "0"}, false, part.function);
        return fmt::format("v({})", twin_.inner(name()));
      case PartKind::positive:
        return twin_.positive(name(), sum(part.argument));
      case PartKind::step:
        return twin_.step(name(), sum(part.argument));
      case PartKind::choice:
        return choice(part);
      case PartKind::product:  // they are gone by now
      case PartKind::quotient:
      case PartKind::call:
        return "0";
      case PartKind::integral:
        return text_of_integral(part);
      case PartKind::derivative:
        return twin_derivative(twin_, name(), sum(part.argument));
      case PartKind::transfer:
        return fmt::format("({})", twin_transfer(twin_, name(), part.fraction, 1.0, sum(part.argument)));
    }
    return "0";
  }

  std::string text_of_integral(const FormulaPart& part) {
    if (part.is_held) return held(part);
    if (part.from == part.to) return twin_integral(twin_, name(), sum(part.argument), {part.start});
    return wrapped(part);
  }

  /// A free integral, less whole widths.
  std::string wrapped(const FormulaPart& part) {
    const std::string free = twin_integral(twin_, name(), sum(part.argument), {part.start});
    const double width = part.to - part.from;
    return fmt::format("({0}-{1}*floor(({0}-({2}))/{1}))", free, width, part.from);
  }

  /// A switch to its start across the state.
  std::string held(const FormulaPart& part) {
    const double gain = 1.0 / twin_.sharpness();
    const std::string control = name() + ".control", start = name() + ".start";
    std::string state = twin_integral(twin_, name(), sum(part.argument), {part.start});
    twin_.behaviour(control, {twin_.inner(control), "0"}, false, fmt::format("{}*({})", gain, sum(part.above)));
    twin_.source(start, {twin_.inner(start), "0"}, false, model::Dc{part.start.value});
    twin_.contact(name() + ".hold", {twin_.inner(name() + "state"), twin_.inner(start)}, {twin_.inner(control), "0"},
                  {twin_.sharpness(), infinite, gain * part.on_level.value, gain * part.on_level.value, false});
    return state;
  }

  /// below + h·(above − below), h the voltage behind a switch with hysteresis that 1 V feeds.
  std::string choice(const FormulaPart& part) {
    const double gain = 1.0 / twin_.sharpness();
    const std::string control = name() + ".control", supply = name() + ".supply", chosen = name();
    twin_.behaviour(control, {twin_.inner(control), "0"}, false, fmt::format("{}*({})", gain, sum(part.argument)));
    twin_.source(supply, {twin_.inner(supply), "0"}, false, model::Dc{1.0});
    twin_.contact(chosen, {twin_.inner(supply), twin_.inner(chosen)}, {twin_.inner(control), "0"},
                  {twin_.sharpness(), infinite, gain * part.on_level.value, gain * part.off_level.value, false});
    twin_.resistor(chosen, {twin_.inner(chosen), "0"}, 1.0);
    return fmt::format("(({1})+v({0})*(({2})-({1})))", twin_.inner(chosen), sum(part.below), sum(part.above));
  }

  Twin& twin_;
  const Formula& formula_;
  const std::vector<std::string>& voltages_;
  const std::vector<std::string>& currents_;
  std::vector<std::string> texts_;
};

std::vector<std::string> control_voltages(const Twin& twin) {
  std::vector<std::string> texts;
  for (const NodePair& pair : twin.instance().control_nodes) texts.push_back(voltage_text({twin.node(pair.p), twin.node(pair.n)}));
  return texts;
}

std::vector<std::string> reference_currents(const Twin& twin) {
  std::vector<std::string> texts;
  for (const Reference& reference : twin.instance().references) texts.push_back(current_text(twin.meter_of(reference)));
  return texts;
}

}  // namespace

std::string formula_text(Twin& twin, const Formula& formula, const std::vector<std::string>& voltages,
                         const std::vector<std::string>& currents) {
  return FormulaTwin(twin, formula, voltages, currents).run();
}

void twin_of_formula(Twin& twin, bool is_current) {
  const std::string text = formula_text(twin, *twin.instance().formula, control_voltages(twin), reference_currents(twin));
  twin.behaviour({}, twin.ends(), is_current, text);
}

void twin_of_controlled(Twin& twin, bool is_current) {
  const Instance& instance = twin.instance();
  if (instance.formula) return twin_of_formula(twin, is_current);
  const bool by_current = instance.kind->control == ControlSyntax::element;
  const std::vector<double>& gains = instance.coefficients;
  const TwinEnds ends = twin.ends();
  if (gains.size() == 2 && gains[0] == 0.0) {
    const std::string control = by_current ? twin.meter_of(instance.references[0])
                                           : twin.node(instance.control_nodes[0].p) + ' ' + twin.node(instance.control_nodes[0].n);
    return twin.line(fmt::format("{} {} {} {} {}", twin.device(instance.kind->letter), ends.p, ends.n, control, gains[1]));
  }
  const std::vector<std::string> inputs = by_current ? reference_currents(twin) : control_voltages(twin);
  std::string text = fmt::format("{}", gains[0]);
  for (std::size_t k = 0; k < inputs.size(); ++k) text += term_text(gains[k + 1], inputs[k]);
  twin.behaviour({}, ends, is_current, text);
}

}  // namespace pwlsim::elements
