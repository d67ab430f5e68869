#include "elements/emission.hpp"
#include "elements/twin.hpp"

namespace pwlsim::elements::kinds::current_source {
namespace {

/// LTspice's load delivers nothing: a diode leads to it, and one across it takes its current while that diode blocks.
void emit_load(Emission& emission) {
  constexpr double knee = 1e-3;  // ohm: without it what rests at zero volts is not determined
  const model::LinearForm current = add_source(emission);
  const model::NodeIndex inner = emission.inner_node("load");
  model::NetworkBuilder& builder = emission.builder();
  builder.add(model::Injection{emission.label("load"), inner, emission.n(), current});
  builder.add(model::Diode{emission.label("load"), emission.n(), inner, 0.0, 0.0});
  const int index = builder.add(model::Diode{emission.label(), emission.p(), inner, knee, 0.0});
  emission.result().current = quantity(Quantity::diode_current, index);
}

void emit(Emission& emission) {
  if (emission.instance().is_load) return emit_load(emission);
  const model::LinearForm current = add_source(emission);
  emission.builder().add(model::Injection{emission.label(), emission.p(), emission.n(), current});
  emission.result().current = current;
}

void smooth_twin(Twin& twin) {
  TwinEnds ends = twin.ends();
  if (twin.instance().is_load) {
    const std::string inner = twin.inner("load");
    twin.diode({}, {ends.p, inner}, {});
    twin.diode("load", {ends.n, inner}, {});
    ends.p = inner;
  }
  twin.source({}, ends, true, twin.instance().waveform.value_or(model::Dc{}));
}

}  // namespace

Kind kind() {
  Kind kind;
  kind.name = "current source";
  kind.letter = 'I';
  kind.usage = "I<name> n+ n- [DC] value | SIN(...) | PULSE(...) | PWL(...) | EXP(...) [load]";
  kind.text = "Independent current source; its current enters n+ and leaves n-. A load carries none against a negative voltage.";
  kind.tail = Tail::waveform;
  kind.joins_terminals = [](const Instance&) { return false; };
  kind.emit = emit;
  kind.smooth_twin = smooth_twin;
  return kind;
}

}  // namespace pwlsim::elements::kinds::current_source
