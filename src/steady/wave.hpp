#pragma once
/// Derivatives of functions of time to their own numbers, as solutions of z' = Λ z: of SIN on sin, cos, t·sin, t·cos and 1; of PULSE and PWL straight
/// lines between the corners, and where they jump the time of the jump moves.

#include <optional>
#include <string>

#include "linalg/dense.hpp"
#include "steady/parameter_inputs.hpp"

namespace pwlsim::steady {

using linalg::Matrix;
using linalg::Vector;

/// Number of z.
[[nodiscard]] int wave_size(const Wave& wave);
/// Λ.
[[nodiscard]] Matrix wave_generator(const Wave& wave);
/// w = row·z.
[[nodiscard]] Eigen::RowVectorXd wave_row(const Wave& wave);
/// z at `time` for a stretch without a corner that `inside` lies in. `is_settled`: the function has always been periodic.
[[nodiscard]] Vector wave_state(const Wave& wave, double time, double inside, bool is_settled);
/// How a jump of the function at `time` moves, where it has one within `near` of it.
[[nodiscard]] std::optional<double> edge_shift(const Wave& wave, double time, double near, bool is_settled);
/// Likewise a corner, where the function does not jump.
[[nodiscard]] std::optional<double> corner_shift(const Wave& wave, double time, double near, bool is_settled);
/// Of a periodic function: how its period moves, as a share of it; 0 where it has none.
[[nodiscard]] double period_share(const Wave& wave);
/// Of a function that does not repeat: the derivative of its last value, which is what a steady state takes it for (steady/period.hpp).
[[nodiscard]] std::optional<double> last_value_derivative(const Wave& wave);
/// Why it has no such derivative; "" where it has.
[[nodiscard]] std::string wave_failure(const Wave& wave);

}  // namespace pwlsim::steady
