#pragma once
/// Parts of a circuit without a path to ground.

#include <vector>

#include "circuit/circuit.hpp"
#include "circuit/reporter.hpp"

namespace pwlsim::circuit {

/// An error for each group of nodes that no chain of elements that tie their terminals (R C L V E H D S W) connects to ground, and whose
/// potential no controlled current fixes either. Parts inside an element count as tied. In a deck that LTspice wrote, whose smallest conductances hold
/// such a group near ground, a group that no source feeds a current is a warning; the answer is a node of each of those, to be tied to ground.
[[nodiscard]] std::vector<model::NodeIndex> report_floating(const FlatCircuit& circuit, Reporter& reporter);

}  // namespace pwlsim::circuit
