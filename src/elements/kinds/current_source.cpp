#include "elements/emission.hpp"
#include "elements/twin.hpp"

namespace pwlsim::elements {
namespace {

void emit(Emission& emission) {
  const model::LinearForm current = add_source(emission);
  emission.builder().add(model::Injection{emission.label(), emission.p(), emission.n(), current});
  emission.result().current = current;
}

void smooth_twin(Twin& twin) { twin.source({}, twin.ends(), true, twin.instance().waveform.value_or(model::Dc{})); }

}  // namespace

Kind current_source() {
  Kind kind;
  kind.name = "current source";
  kind.letter = 'I';
  kind.usage = "I<name> n+ n- [DC] value | SIN(...) | PULSE(...) | PWL(...) | EXP(...)";
  kind.text = "Independent current source; its current enters n+ and leaves n-.";
  kind.tail = Tail::waveform;
  kind.joins_terminals = [](const Instance&) { return false; };
  kind.emit = emit;
  kind.smooth_twin = smooth_twin;
  return kind;
}

}  // namespace pwlsim::elements
