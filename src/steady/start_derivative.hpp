#pragma once
/// The derivative of a run's start to a parameter: of given initial values, and of the DC operating point
///
///     0 = A ξ + B_J u_J + E ζ,   0 = C_J ξ + D_JJ u_J + F_J ζ     differentiated, J the ports that conduct or are closed.

#include <string>

#include "engine/exact/start.hpp"
#include "steady/sensitivity.hpp"

namespace pwlsim::steady {

struct StartDerivative {
  Vector xi;            ///< stacked
  std::string failure;  ///< why there is none; "" where there is one
};

/// For a run with uic.
[[nodiscard]] StartDerivative of_initial_values(const engine::ExactModel& model, const Stacking& stacking,
                                                const ParameterInputs& parameter);
/// For an operating point that was found.
[[nodiscard]] StartDerivative of_operating_point(const engine::ExactModel& model, const LinearisedOrbit& orbit,
                                                 const engine::RunStart& start, const ParameterInputs& parameter);

}  // namespace pwlsim::steady
