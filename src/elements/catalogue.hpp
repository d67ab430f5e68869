#pragma once
/// All elements, as data. The list of calls behind `catalogue` is generated from the files in elements/kinds.

#include <vector>

#include "elements/kind.hpp"

namespace pwlsim::elements {

[[nodiscard]] const std::vector<Kind>& catalogue();

/// The kind of a card whose name begins with `letter`, any case; null if there is none.
[[nodiscard]] const Kind* find_kind(char letter);

/// The `.model` type of that name, any case; null if no element takes it.
[[nodiscard]] const ModelKind* find_model_kind(std::string_view type);

}  // namespace pwlsim::elements
