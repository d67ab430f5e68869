#pragma once
/// Finds steps whose values influence their own arguments. Influence follows from the structure: elements and the nodes that they join influence each
/// other; a node that a branch ties to ground (or to a node tied so) at a voltage that does not read that branch itself is influenced by what the
/// voltage reads, and by nothing connected to it; a form is influenced by what it reads. Controls of switches do not count: a loop through
/// one is closed by decisions only.

#include <vector>

#include "model/builder.hpp"

namespace pwlsim::model {

/// One entry per step of `steps`: whether its value influences its argument.
[[nodiscard]] std::vector<char> steps_in_loops(const Network& network, const std::vector<Step>& steps);

}  // namespace pwlsim::model
