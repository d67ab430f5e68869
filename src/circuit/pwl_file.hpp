#pragma once
/// `PWL file=name`: points of a waveform from a text file, one pair of time and value a line.

#include "circuit/reporter.hpp"
#include "circuit/scope.hpp"
#include "elements/waveform.hpp"

namespace pwlsim::circuit {

[[nodiscard]] bool is_pwl_file(const netlist::Item& item);

/// Adds the points as a part of the card. The name is looked for beside the file that names it, then in the current directory. Numbers are those of decks; lines that
/// begin with `*`, `;` or `#` are comments, and a time with `+` counts from the one before.
[[nodiscard]] bool read_pwl_file(const netlist::Item& item, elements::PwlCard& card, Scope& scope, Reporter& reporter);

}  // namespace pwlsim::circuit
