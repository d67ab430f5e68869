#pragma once
/// Steps decided by a source alone. Outside of loops such a step is not a complementarity but a function of time, with one value while the source
/// stays at the threshold.

#include <optional>

#include "elements/emission.hpp"

namespace pwlsim::elements {

/// 1 for x > 0, 0 for x < 0, `at_zero` while x stays at 0: as a constant or another source, if x is an affine function of one DC, PULSE or
/// PWL source, read directly or from a node that it holds against ground. A constant only where comparisons are kept (Emission::keep_comparisons). Second pass only.
[[nodiscard]] std::optional<model::LinearForm> step_of_source(Emission& emission, const model::LinearForm& x, double at_zero);

}  // namespace pwlsim::elements
