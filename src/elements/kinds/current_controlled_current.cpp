#include "elements/formula_emission.hpp"
#include "elements/twin.hpp"

namespace pwlsim::elements::kinds::current_controlled_current {
namespace {

void emit(Emission& emission) {
  if (emission.instance().formula) return add_formula_source(emission, true);
  emission.result().item = emission.builder().add(model::Injection{emission.label(), emission.p(), emission.n(), {}});
}

void connect(Emission& emission) {
  if (const auto& formula = emission.instance().formula) return set_source_value(emission, emit_formula(emission, *formula), true);
  const model::LinearForm current = current_control(emission);
  emission.builder().network().injections[static_cast<std::size_t>(emission.result().item)].current = current;
  emission.result().current = current;
}

void smooth_twin(Twin& twin) { twin_of_controlled(twin, true); }

}  // namespace

Kind kind() {
  Kind kind;
  kind.name = "current-controlled current source";
  kind.letter = 'F';
  kind.usage =
      "F<name> n+ n- element gain | POLY(n) element1 ... p0 p1 ... pn | value={expression} | TABLE {x} = (x1,y1) (x2,y2) ... | "
      "Laplace=fraction";
  kind.text = "i = gain i(element), or p0 + p1 i1 + ... + pn in, or an expression as for B.";
  kind.control = ControlSyntax::element;
  kind.tail = Tail::gain;
  kind.controls_others = false;
  kind.joins_terminals = [](const Instance&) { return false; };
  kind.emit = emit;
  kind.connect = connect;
  kind.smooth_twin = smooth_twin;
  return kind;
}

}  // namespace pwlsim::elements::kinds::current_controlled_current
