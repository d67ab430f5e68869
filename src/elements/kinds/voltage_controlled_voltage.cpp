#include "elements/formula_emission.hpp"
#include "elements/twin.hpp"

namespace pwlsim::elements::kinds::voltage_controlled_voltage {
namespace {

void emit(Emission& emission) {
  if (emission.instance().formula) return add_formula_source(emission, false);
  const int index =
      emission.builder().add(model::Branch{emission.label(), emission.p(), emission.n(), voltage_control(emission.instance())});
  emission.result().current = quantity(Quantity::branch_current, index);
}

void connect(Emission& emission) {
  if (const auto& formula = emission.instance().formula) set_source_value(emission, emit_formula(emission, *formula), false);
}

void smooth_twin(Twin& twin) { twin_of_controlled(twin, false); }

}  // namespace

Kind kind() {
  Kind kind;
  kind.name = "voltage-controlled voltage source";
  kind.letter = 'E';
  kind.usage =
      "E<name> n+ n- nc+ nc- gain | POLY(n) nc1+ nc1- ... p0 p1 ... pn | value={expression} | TABLE {x} = (x1,y1) (x2,y2) ... | "
      "Laplace=fraction";
  kind.text = "v = gain v(nc+,nc-), or p0 + p1 v1 + ... + pn vn, or an expression as for B.";
  kind.control = ControlSyntax::node_pair;
  kind.tail = Tail::gain;
  kind.saved_by_default = true;
  kind.emit = emit;
  kind.connect = connect;
  kind.smooth_twin = smooth_twin;
  return kind;
}

}  // namespace pwlsim::elements::kinds::voltage_controlled_voltage
