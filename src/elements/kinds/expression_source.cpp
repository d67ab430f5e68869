#include "elements/formula_emission.hpp"
#include "elements/twin.hpp"

namespace pwlsim::elements::kinds::expression_source {
namespace {

constexpr Parameter parameters[] = {
    {"tc1", "1/K", 0.0, Range::any, false, "Temperature coefficient.", Use::ignored},
    {"tc2", "1/K^2", 0.0, Range::any, false, "Temperature coefficient.", Use::ignored},
    {"temp", "C", 27.0, Range::any, false, "Temperature of the element.", Use::ignored},
    {"dtemp", "K", 0.0, Range::any, false, "Temperature above the circuit's.", Use::ignored},
    {"tripdv", "V", 0.0, Range::any, true, "Hint for the time step.", Use::ignored},
    {"tripdt", "s", 0.0, Range::any, true, "Hint for the time step.", Use::ignored},
};

void emit(Emission& emission) { add_formula_source(emission, emission.instance().formula_is_current); }

void connect(Emission& emission) {
  const Instance& instance = emission.instance();
  set_source_value(emission, emit_formula(emission, *instance.formula), instance.formula_is_current);
}

}  // namespace

Kind kind() {
  Kind kind;
  kind.name = "source with an expression";
  kind.letter = 'B';
  kind.usage = "B<name> n+ n- V={expression} | I={expression} [Laplace=fraction]";
  kind.text = "v or i as a piecewise-linear expression of voltages, currents and time.";
  kind.tail = Tail::formula;
  kind.parameters = parameters;
  kind.joins_terminals = is_voltage_formula;
  kind.emit = emit;
  kind.connect = connect;
  kind.smooth_twin = [](Twin& twin) { twin_of_formula(twin, twin.instance().formula_is_current); };
  return kind;
}

}  // namespace pwlsim::elements::kinds::expression_source
