#include <cmath>

#include "elements/twin.hpp"
#include "elements/two_terminal.hpp"

namespace pwlsim::elements::kinds::capacitor {
namespace {

constexpr Parameter parameters[] = {
    {"C", "F", 0.0, Range::any, false,
     "Capacitance; negative values are allowed if the circuit remains solvable; zero is an open circuit."},
    {"ic", "V", 0.0, Range::any, false, "Voltage at the start; used only with uic."},
    multiplicity,
    series_resistance,
    series_inductance,
    parallel_resistance,
    parallel_capacitance,
    {"RLshunt", "ohm", infinite, Range::any, true, "Resistance across Lser.", Use::refused},
    {"Q", "C", 0.0, Range::any, false, "Charge as a function of voltage.", Use::refused},
    temperature_both,
    temperature_linear,
    temperature_square,
    temperature,
    temperature_difference,
    {"V", "V", 0.0, Range::any, false, "Rated voltage.", Use::ignored},
    {"Irms", "A", 0.0, Range::any, false, "Rated current.", Use::ignored},
    {"MTBF", "h", 0.0, Range::any, true, "Life of the part.", Use::ignored},
    {"ppPkg", "", 0.0, Range::any, true, "Parts in a package.", Use::ignored},
    maker,
    part_number,
    part_type,
};

constexpr Parameter model_parameters[] = {
    {"C", "", 1.0, Range::any, false, "Factor of the value on the card; the value itself if the card has none."},
    temperature_linear,
    temperature_square,
    {"dev", "", 0.0, Range::any, false, "Tolerance.", Use::ignored},
    {"lot", "", 0.0, Range::any, false, "Tolerance.", Use::ignored},
    {"tnom", "C", 27.0, Range::any, false, "Temperature of the parameters.", Use::ignored},
};
constexpr ModelKind short_model{"C", "capacitor", model_parameters, nullptr, nullptr, true};
constexpr ModelKind long_model{"CAP", "capacitor", model_parameters, nullptr, nullptr, true};
constexpr const ModelKind* models[] = {&short_model, &long_model};

void emit(Emission& emission) {
  const double capacitance = emission.value("C") * emission.value("m");
  if (capacitance == 0.0) {
    emission.diagnostics().note("N-zero-capacitance", emission.span_of("C"),
                                emission.instance().name + " has no capacitance: it is an open circuit");
  } else {
    const NodePair core = add_series_parts(emission);
    const int index =
        emission.builder().add(model::Capacitor{emission.label(), core.p, core.n, capacitance, emission.has("ic"), emission.value("ic")});
    emission.result().current = quantity(Quantity::capacitor_current, index);
  }
  add_parallel_parts(emission);
}

bool joins_terminals(const Instance& instance) {
  const Values& v = instance.values;
  return v.get("C") != 0.0 || v.get("Cpar") != 0.0 || !std::isinf(v.get("Rpar"));
}

void smooth_twin(Twin& twin) {
  const double initial = twin.value("ic"), capacitance = twin.value("C") * twin.value("m");
  if (capacitance != 0.0) twin.capacitor({}, twin_of_series_parts(twin), capacitance, twin.has("ic") ? &initial : nullptr);
  twin_of_parallel_parts(twin);
}

}  // namespace

Kind kind() {
  Kind kind;
  kind.name = "capacitor";
  kind.letter = 'C';
  kind.usage = "C<name> n+ n- value [ic= m= Rser= Lser= Rpar= Cpar=]";
  kind.text = "Linear capacitor, i = C dv/dt.";
  kind.parameters = parameters;
  kind.models = models;
  kind.joins_terminals = joins_terminals;
  kind.emit = emit;
  kind.smooth_twin = smooth_twin;
  return kind;
}

}  // namespace pwlsim::elements::kinds::capacitor
