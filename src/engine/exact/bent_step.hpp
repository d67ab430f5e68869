#pragma once
/// Chebyshev's step to a root of g: Newton's, −g/g', with a correction for curvature (Traub, Iterative Methods (1964), §5.1).

#include <cmath>

namespace pwlsim::engine {

/// After this many steps the bracket is only halved: fewer steps find any root that is not near a change of curvature.
inline constexpr int most_bent_steps = 12;

/// Newton's step times this is Chebyshev's, `bend` = −g g''/(2 g'²). A bend of 1, far from a root, would give no step at all, and such a place may attract: if
/// the curvature changes the step by half or more, Newton's step is taken.
[[nodiscard]] inline double bend_factor(double bend) { return std::abs(bend) < 0.5 ? 1.0 - bend : 1.0; }

}  // namespace pwlsim::engine
