#pragma once
/// Replaces exponential characteristics by tangents.

#include <span>
#include <string>
#include <string_view>

#include "elements/kind.hpp"
#include "model/exponential_law.hpp"

namespace pwlsim::elements {

using model::Tangent;

/// v = series·i + emission·Vt·ln(i/saturation), Vt = kT/q at 27 °C.
[[nodiscard]] model::ExponentialLaw exponential_law(double saturation, double emission, double series);
/// Its tangent at i = `current`.
[[nodiscard]] model::Tangent tangent(double saturation, double emission, double series, double current);

/// Those of `names` that the model gives, "IS, N"; "" for none.
[[nodiscard]] std::string written(const Model& model, std::span<const std::string_view> names);

}  // namespace pwlsim::elements
