#include "elements/emission.hpp"

namespace pwlsim::elements {
namespace {

void emit(Emission& emission) {
  const int index =
      emission.builder().add(model::Branch{emission.label(), emission.p(), emission.n(), voltage_control(emission.instance())});
  emission.result().current = quantity(Quantity::branch_current, index);
}

}  // namespace

Kind voltage_controlled_voltage() {
  Kind kind;
  kind.name = "voltage-controlled voltage source";
  kind.letter = 'E';
  kind.usage = "E<name> n+ n- nc+ nc- gain | POLY(n) nc1+ nc1- ... p0 p1 ... pn";
  kind.text = "v = gain v(nc+,nc-), or p0 + p1 v1 + ... + pn vn.";
  kind.control = Control::node_pair;
  kind.tail = Tail::gain;
  kind.saved_by_default = true;
  kind.emit = emit;
  return kind;
}

}  // namespace pwlsim::elements
