#include "elements/twin.hpp"
#include "elements/two_terminal.hpp"

namespace pwlsim::elements::kinds::resistor {
namespace {

constexpr Parameter parameters[] = {
    {"R", "ohm", 0.0, Range::any, false, "Resistance; zero and negative values are allowed if the circuit remains solvable."},
    multiplicity,
    series_resistance,
    series_inductance,
    parallel_resistance,
    parallel_capacitance,
    temperature_both,
    temperature_linear,
    temperature_square,
    temperature,
    temperature_difference,
    {"ac", "ohm", 0.0, Range::any, false, "Resistance in small-signal analyses.", Use::ignored},
    {"noisy", "", 1.0, Range::any, false, "Whether it makes noise.", Use::ignored},
    {"tol", "%", 0.0, Range::any, false, "Tolerance of the part.", Use::ignored},
    {"pwr", "W", 0.0, Range::any, false, "Rated power.", Use::ignored},
    maker,
    part_number,
    part_type,
};

constexpr Parameter model_parameters[] = {
    {"R", "", 1.0, Range::any, false, "Factor of the value on the card; the value itself if the card has none."},
    temperature_linear,
    temperature_square,
    {"dev", "", 0.0, Range::any, false, "Tolerance.", Use::ignored},
    {"lot", "", 0.0, Range::any, false, "Tolerance.", Use::ignored},
    {"tnom", "C", 27.0, Range::any, false, "Temperature of the parameters.", Use::ignored},
};
constexpr ModelKind short_model{"R", "resistor", model_parameters, nullptr, nullptr, true};
constexpr ModelKind long_model{"RES", "resistor", model_parameters, nullptr, nullptr, true};
constexpr const ModelKind* models[] = {&short_model, &long_model};

void emit(Emission& emission) {
  const NodePair core = add_series_parts(emission);
  const double resistance = emission.value("R") / emission.value("m");
  const int index = emission.builder().add(model::Resistor{emission.label(), core.p, core.n, resistance});
  emission.result().current = quantity(Quantity::resistor_current, index);
  add_parallel_parts(emission);
}

void smooth_twin(Twin& twin) {
  twin.resistor({}, twin_of_series_parts(twin), twin.value("R") / twin.value("m"));
  twin_of_parallel_parts(twin);
}

}  // namespace

Kind kind() {
  Kind kind;
  kind.name = "resistor";
  kind.letter = 'R';
  kind.usage = "R<name> n+ n- value [m= Rser= Lser= Rpar= Cpar=]";
  kind.text = "Linear resistor, v = R i.";
  kind.parameters = parameters;
  kind.models = models;
  kind.emit = emit;
  kind.smooth_twin = smooth_twin;
  return kind;
}

}  // namespace pwlsim::elements::kinds::resistor
