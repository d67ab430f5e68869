#include "elements/emission.hpp"

namespace pwlsim::elements {
namespace {

void emit(Emission& emission) {
  emission.result().item = emission.builder().add(model::Injection{emission.label(), emission.p(), emission.n(), {}});
}

void connect(Emission& emission) {
  const model::LinearForm current = current_control(emission);
  emission.builder().network().injections[static_cast<std::size_t>(emission.result().item)].current = current;
  emission.result().current = current;
}

}  // namespace

Kind current_controlled_current() {
  Kind kind;
  kind.name = "current-controlled current source";
  kind.letter = 'F';
  kind.usage = "F<name> n+ n- element gain | POLY(n) element1 ... p0 p1 ... pn";
  kind.text = "i = gain i(element), or p0 + p1 i1 + ... + pn in.";
  kind.control = Control::element;
  kind.tail = Tail::gain;
  kind.controls_others = false;
  kind.joins_terminals = [](const Instance&) { return false; };
  kind.emit = emit;
  kind.connect = connect;
  return kind;
}

}  // namespace pwlsim::elements
