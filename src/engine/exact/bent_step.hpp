#pragma once
/// Chebyshev's step to a root of g: Newton's, −g/g', and what the curvature adds to it (Traub, Iterative Methods (1964), §5.1).

#include <cmath>

namespace pwlsim::engine {

/// Steps after which only the bracket is halved: fewer find any root that is not far from a change of curvature.
inline constexpr int most_bent_steps = 12;

/// Newton's step times this is Chebyshev's, `bend` = −g g''/(2 g'²). A bend of 1 would make no step at all, far from a root, and such a place may attract: where
/// the curvature makes half of a step or more, Newton's is taken as it is.
[[nodiscard]] inline double bend_factor(double bend) { return std::abs(bend) < 0.5 ? 1.0 - bend : 1.0; }

}  // namespace pwlsim::engine
