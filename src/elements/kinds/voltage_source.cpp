#include "elements/twin.hpp"
#include "elements/two_terminal.hpp"

namespace pwlsim::elements::kinds::voltage_source {
namespace {

constexpr Parameter parameters[] = {
    series_resistance,
    {"Cpar", "F", 0.0, Range::any, false, "Capacitance across the source."},
};

void emit(Emission& emission) {
  const auto index = static_cast<int>(emission.builder().network().branches.size());
  model::LinearForm voltage = add_source(emission);
  if (const double r = emission.value("Rser"); r != 0.0) voltage.push_back({Quantity::branch_current, index, r});
  emission.builder().add(model::Branch{emission.label(), emission.p(), emission.n(), std::move(voltage)});
  emission.result().current = quantity(Quantity::branch_current, index);
  if (const double c = emission.value("Cpar"); c != 0.0) {
    const int parallel = emission.builder().add(model::Capacitor{emission.label("Cpar"), emission.p(), emission.n(), c, false, 0.0});
    emission.result().current.push_back({Quantity::capacitor_current, parallel, 1.0});
  }
}

void smooth_twin(Twin& twin) {
  const TwinEnds whole = twin.ends();
  TwinEnds core = whole;
  if (const double r = twin.value("Rser"); r != 0.0) {
    core.n = twin.inner("Rser");
    twin.resistor("Rser", {core.n, whole.n}, r);
  }
  twin.source({}, core, false, twin.instance().waveform.value_or(model::Dc{}));
  if (const double c = twin.value("Cpar"); c != 0.0) twin.capacitor("Cpar", whole, c);
}

}  // namespace

Kind kind() {
  Kind kind;
  kind.name = "voltage source";
  kind.letter = 'V';
  kind.usage = "V<name> n+ n- [DC] value | SIN(...) | PULSE(...) | PWL(...) | EXP(...) [Rser=]";
  kind.text = "Independent voltage source, v = value(t) + Rser i.";
  kind.tail = Tail::waveform;
  kind.parameters = parameters;
  kind.saved_by_default = true;
  kind.emit = emit;
  kind.smooth_twin = smooth_twin;
  return kind;
}

}  // namespace pwlsim::elements::kinds::voltage_source
