#include "elements/emission.hpp"

namespace pwlsim::elements {
namespace {

void emit(Emission& emission) {
  const model::LinearForm current = voltage_control(emission.instance());
  emission.builder().add(model::Injection{emission.label(), emission.p(), emission.n(), current});
  emission.result().current = current;
}

}  // namespace

Kind voltage_controlled_current() {
  Kind kind;
  kind.name = "voltage-controlled current source";
  kind.letter = 'G';
  kind.usage = "G<name> n+ n- nc+ nc- gain | POLY(n) nc1+ nc1- ... p0 p1 ... pn";
  kind.text = "i = gain v(nc+,nc-), or p0 + p1 v1 + ... + pn vn.";
  kind.control = Control::node_pair;
  kind.tail = Tail::gain;
  kind.joins_terminals = [](const Instance&) { return false; };
  kind.emit = emit;
  return kind;
}

}  // namespace pwlsim::elements
