#pragma once
/// Exponential characteristics by their tangents.

#include <span>
#include <string>
#include <string_view>

#include "elements/kind.hpp"

namespace pwlsim::elements {

struct Tangent {
  double resistance = 0.0;  ///< ohm
  double drop = 0.0;        ///< V
};

/// Of v = series·i + emission·Vt·ln(i/saturation) at i = `current`, Vt = kT/q at 27 °C.
[[nodiscard]] Tangent tangent(double saturation, double emission, double series, double current);

/// Those of `names` that the model was given, "IS, N"; "" for none.
[[nodiscard]] std::string written(const Model& model, std::span<const std::string_view> names);

}  // namespace pwlsim::elements
