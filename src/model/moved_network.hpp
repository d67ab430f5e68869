#pragma once
/// Networks whose numbers have changed with a parameter.

#include "model/network.hpp"
#include "model/network_move.hpp"

namespace pwlsim::model {

/// += factor·other, number by number; both are of one kind.
void add(SourceFunction& sum, const SourceFunction& other, double factor = 1.0);

/// Changes every number that depends on the parameter by `by` times its derivative.
void move(Network& network, const NetworkMoves& moves, double by);

}  // namespace pwlsim::model
