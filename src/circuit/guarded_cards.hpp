#pragma once
/// Parameters and models in sections of `.if` within subcircuits, which each call decides (netlist::Card::guards).

#include <string_view>
#include <vector>

#include "netlist/ast.hpp"

namespace pwlsim::circuit {

/// How the name ends that stands for the value of a parameter which no section gives.
inline constexpr std::string_view undecided_end = " of no section of .if that holds";

/// Whether the text of a parameter may have no value: it stands in sections only.
[[nodiscard]] bool may_be_undecided(const netlist::Item& value);

/// `.param p=…` in a section becomes p = condition ? … : what the definition before it gives. A `.model` in a section gets a name of its own, and each element of
/// the same subcircuit that names it becomes one element for each such model, with its condition, and one for where none of them holds.
[[nodiscard]] std::vector<netlist::Card> with_decided_definitions(std::vector<netlist::Card> cards);

}  // namespace pwlsim::circuit
