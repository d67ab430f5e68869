#pragma once
/// The text of a PWL waveform, with its relative times and repetitions.

#include <optional>

#include "circuit/card_cursor.hpp"
#include "circuit/scope.hpp"
#include "elements/waveform.hpp"

namespace pwlsim::circuit {

[[nodiscard]] bool word_is(const netlist::Item* item, std::string_view text);
/// Whether the next item is a number of a waveform: not name=value, and not AC or DC, which end a waveform without parentheses.
[[nodiscard]] bool at_waveform_value(const CardCursor& cursor);

/// The items after PWL. With `closed` the cursor runs over the inside of its parentheses, all of which must be understood.
/// Empty after an error.
[[nodiscard]] std::optional<elements::PwlCard> bind_pwl(CardCursor& cursor, bool closed, Scope& scope, Reporter& reporter, SourceSpan span);

/// `r=` and `td=`, which may also follow the parentheses.
[[nodiscard]] bool is_pwl_option(const netlist::Item& item);
bool read_pwl_option(const netlist::Item& item, elements::PwlCard& card, Scope& scope, Reporter& reporter);

}  // namespace pwlsim::circuit
