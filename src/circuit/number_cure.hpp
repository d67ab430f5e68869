#pragma once
/// Suggestions for a text that is meant as a number but is not one.

#include <string>
#include <string_view>

#include "circuit/scope.hpp"

namespace pwlsim::circuit {

/// "; try {1/fs}" for an expression of numbers and parameters, "; try -5" for a typographic minus, else "".
[[nodiscard]] std::string number_cure(std::string_view text, Scope& scope);

/// For a word after the value of a card that takes one value: "a comma ends a value: try 4.7u" for 4,7u, "a blank …: try 100u" for 100 u, else the usage.
[[nodiscard]] std::string surplus_cure(const netlist::Item& value, const netlist::Item& surplus, Reporter& reporter,
                                       std::string_view usage);

}  // namespace pwlsim::circuit
