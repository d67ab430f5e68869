#include "elements/formula_emission.hpp"
#include "elements/twin.hpp"

namespace pwlsim::elements::kinds::voltage_controlled_current {
namespace {

void emit(Emission& emission) {
  if (emission.instance().formula) return add_formula_source(emission, true);
  const model::LinearForm current = voltage_control(emission.instance());
  emission.builder().add(model::Injection{emission.label(), emission.p(), emission.n(), current});
  emission.result().current = current;
}

void connect(Emission& emission) {
  if (const auto& formula = emission.instance().formula) set_source_value(emission, emit_formula(emission, *formula), true);
}

void smooth_twin(Twin& twin) { twin_of_controlled(twin, true); }

}  // namespace

Kind kind() {
  Kind kind;
  kind.name = "voltage-controlled current source";
  kind.letter = 'G';
  kind.usage =
      "G<name> n+ n- nc+ nc- gain | POLY(n) nc1+ nc1- ... p0 p1 ... pn | value={expression} | TABLE {x} = (x1,y1) (x2,y2) ... | "
      "Laplace=fraction";
  kind.text = "i = gain v(nc+,nc-), or p0 + p1 v1 + ... + pn vn, or an expression as for B.";
  kind.control = ControlSyntax::node_pair;
  kind.tail = Tail::gain;
  kind.joins_terminals = [](const Instance&) { return false; };
  kind.emit = emit;
  kind.connect = connect;
  kind.smooth_twin = smooth_twin;
  return kind;
}

}  // namespace pwlsim::elements::kinds::voltage_controlled_current
