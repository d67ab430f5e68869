#pragma once
/// Derivatives of functions of time to their own numbers, as solutions of z' = Λ z: of SIN on sin, cos, t·sin, t·cos and 1; of PULSE and PWL straight
/// lines between the corners, where the times of jumps move, too.

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
/// z at `time` for the interval without corners that contains `inside`. `is_settled`: the function has always been periodic.
[[nodiscard]] Vector wave_state(const Wave& wave, double time, double inside, bool is_settled);
/// The shift of a jump of the function, if there is one within `near` of `time`.
[[nodiscard]] std::optional<double> edge_shift(const Wave& wave, double time, double near, bool is_settled);
/// The same for a corner without a jump.
[[nodiscard]] std::optional<double> corner_shift(const Wave& wave, double time, double near, bool is_settled);
/// For a periodic function: the relative change of its period; else 0.
[[nodiscard]] double period_share(const Wave& wave);
/// For a function that does not repeat: the derivative of its last value, which a steady state uses (steady/period.hpp).
[[nodiscard]] std::optional<double> last_value_derivative(const Wave& wave);
/// Why it has no such derivative; "" if it has one.
[[nodiscard]] std::string wave_failure(const Wave& wave);

}  // namespace pwlsim::steady
