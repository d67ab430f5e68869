#pragma once
/// Steps of what a source alone decides. In no loop, a step is no complementarity but a function of time, with one value where the source
/// rests on the threshold.

#include <optional>

#include "elements/emission.hpp"

namespace pwlsim::elements {

/// 1 where x > 0, 0 where x < 0, `at_zero` where x rests at 0: as a constant or another source, if x is an affine function of one DC, PULSE or
/// PWL source, read directly or from a node that it holds against ground. Second pass only.
[[nodiscard]] std::optional<model::LinearForm> step_of_source(Emission& emission, const model::LinearForm& x, double at_zero);

}  // namespace pwlsim::elements
