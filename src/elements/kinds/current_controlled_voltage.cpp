#include "elements/formula_emission.hpp"
#include "elements/twin.hpp"

namespace pwlsim::elements::kinds::current_controlled_voltage {
namespace {

void emit(Emission& emission) {
  if (emission.instance().formula) return add_formula_source(emission, false);
  const int index = emission.builder().add(model::Branch{emission.label(), emission.p(), emission.n(), {}});
  emission.result().item = index;
  emission.result().current = quantity(Quantity::branch_current, index);
}

void connect(Emission& emission) {
  if (const auto& formula = emission.instance().formula) return set_source_value(emission, emit_formula(emission, *formula), false);
  emission.builder().network().branches[static_cast<std::size_t>(emission.result().item)].voltage = current_control(emission);
}

void smooth_twin(Twin& twin) { twin_of_controlled(twin, false); }

}  // namespace

Kind kind() {
  Kind kind;
  kind.name = "current-controlled voltage source";
  kind.letter = 'H';
  kind.usage =
      "H<name> n+ n- element gain | POLY(n) element1 ... p0 p1 ... pn | value={expression} | TABLE {x} = (x1,y1) (x2,y2) ... | "
      "Laplace=fraction";
  kind.text = "v = gain i(element), or p0 + p1 i1 + ... + pn in, or an expression as for B.";
  kind.control = ControlSyntax::element;
  kind.tail = Tail::gain;
  kind.saved_by_default = true;
  kind.emit = emit;
  kind.connect = connect;
  kind.smooth_twin = smooth_twin;
  return kind;
}

}  // namespace pwlsim::elements::kinds::current_controlled_voltage
