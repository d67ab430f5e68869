#pragma once
/// LTspice's state machines: `.machine`, `.state name value`, `.rule from to condition`, `.output (node) expression`, `.endmachine` (LTspice's help,
/// ".MACHINE"). Each becomes ideal switches and sources in its definition: a bit for each state, one of them high at a time; a bit for each rule, high
/// while its state is, its condition holds and no rule before it fires.
///
/// The first state is the initial one. Rules from `*` go before the others, else they are tried in their order; one that fires leads on at once, and the
/// rules of the new state are then tried at the same instant, where LTspice goes on by a time step. A condition holds from 0.5 on. An output is a current of
/// 1 mA times its expression into the node (what it holds across 1 kohm is the expression's value in volts: public libraries of sample-and-holds and
/// counters made of such machines count on this; LTspice's help does not say it).

#include "circuit/definitions.hpp"
#include "circuit/reporter.hpp"

namespace pwlsim::circuit {

/// Adds their cards to the elements of the definitions. Unknown states and missing values are errors.
void make_state_machines(Definitions& definitions, Reporter& reporter);

}  // namespace pwlsim::circuit
