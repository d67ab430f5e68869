#pragma once
/// What to write for a text that is meant as a number and is none.

#include <string>
#include <string_view>

#include "circuit/scope.hpp"

namespace pwlsim::circuit {

/// "; try {1/fs}" for an expression of numbers and parameters, "; try -5" for a minus of word processors, "" for anything else.
[[nodiscard]] std::string number_cure(std::string_view text, Scope& scope);

/// For a word behind the value of a card that takes one: "a comma ends a value: try 4.7u" for 4,7u, "a blank …: try 100u" for 100 u, else the usage.
[[nodiscard]] std::string surplus_cure(const netlist::Item& value, const netlist::Item& surplus, Reporter& reporter,
                                       std::string_view usage);

}  // namespace pwlsim::circuit
