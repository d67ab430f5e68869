#include "elements/twin.hpp"
#include "elements/two_terminal.hpp"

namespace pwlsim::elements::kinds::inductor {
namespace {

constexpr Parameter parameters[] = {
    {"L", "H", 0.0, Range::any, false, "Inductance; negative values are allowed if the circuit remains solvable; zero is a short circuit."},
    {"ic", "A", 0.0, Range::any, false, "Current at the start; used only with uic."},
    multiplicity,
    series_resistance,
    series_inductance,
    parallel_resistance,
    parallel_capacitance,
    {"Flux", "Wb", 0.0, Range::any, false, "Flux as a function of current.", Use::refused},
    {"Hc", "A/m", 0.0, Range::any, false, "Coercive force of LTspice's core with hysteresis.", Use::refused},
    temperature_both,
    temperature_linear,
    temperature_square,
    temperature,
    temperature_difference,
    {"Ipk", "A", 0.0, Range::any, false, "Rated peak current.", Use::ignored},
    {"Irms", "A", 0.0, Range::any, false, "Rated current.", Use::ignored},
    maker,
    part_number,
    part_type,
};

void emit_short(Emission& emission, const NodePair& core) {
  emission.diagnostics().note("N-zero-inductance", emission.span_of("L"),
                              emission.instance().name + " has no inductance: it is a short circuit");
  const int index = emission.builder().add(model::Branch{emission.label(), core.p, core.n, {}});
  emission.result().current = quantity(Quantity::branch_current, index);
}

void emit_inductor(Emission& emission, const NodePair& core, double inductance) {
  const int index =
      emission.builder().add(model::Inductor{emission.label(), core.p, core.n, inductance, emission.has("ic"), emission.value("ic")});
  emission.result().current = quantity(Quantity::inductor_current, index);
  emission.result().inductor = index;
}

constexpr Parameter model_parameters[] = {
    {"L", "", 1.0, Range::any, false, "Factor of the value on the card; the value itself if the card has none."},
    temperature_linear,
    temperature_square,
    {"dev", "", 0.0, Range::any, false, "Tolerance.", Use::ignored},
    {"lot", "", 0.0, Range::any, false, "Tolerance.", Use::ignored},
    {"tnom", "C", 27.0, Range::any, false, "Temperature of the parameters.", Use::ignored},
};
constexpr ModelKind short_model{"L", "inductor", model_parameters, nullptr, nullptr, true};
constexpr ModelKind long_model{"IND", "inductor", model_parameters, nullptr, nullptr, true};
constexpr const ModelKind* models[] = {&short_model, &long_model};

void emit(Emission& emission) {
  const NodePair core = add_series_parts(emission);
  const double inductance = emission.value("L") / emission.value("m");
  if (inductance == 0.0) {
    emit_short(emission, core);
  } else {
    emit_inductor(emission, core, inductance);
  }
  add_parallel_parts(emission);
}

void smooth_twin(Twin& twin) {
  const double initial = twin.initial_current().value_or(twin.value("ic")), inductance = twin.value("L") / twin.value("m");
  const TwinEnds core = twin_of_series_parts(twin);
  if (inductance == 0.0) {
    twin.short_circuit("short", core);
  } else {
    twin.inductor({}, core, inductance, twin.has("ic") || twin.initial_current() ? &initial : nullptr);
  }
  twin_of_parallel_parts(twin);
}

}  // namespace

Kind kind() {
  Kind kind;
  kind.name = "inductor";
  kind.letter = 'L';
  kind.usage = "L<name> n+ n- value [ic= m= Rser= Lser= Rpar= Cpar=]";
  kind.text = "Linear inductor, v = L di/dt.";
  kind.parameters = parameters;
  kind.models = models;
  kind.saved_by_default = true;
  kind.emit = emit;
  kind.smooth_twin = smooth_twin;
  return kind;
}

}  // namespace pwlsim::elements::kinds::inductor
