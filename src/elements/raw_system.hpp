#pragma once
/// A raw linear complementarity system beside the circuit (van der Schaft & Schumacher 1996, eq. (2.8), with inputs):
///
///     x' = A x + B u + E w,   y = C x + D u + F w,   0 ≤ u ⊥ y ≥ 0,   x(0) = x0.
///
/// States are voltages of 1 F at inner nodes, rows are injections and complementarities; the engine needs no special case.

#include <vector>

#include "elements/kind.hpp"

namespace pwlsim::elements {

/// Rows of numbers.
using Rows = std::vector<std::vector<double>>;

struct RawSystem {
  int states = 0, ports = 0;
  Rows a, b, c, d, e, f;  ///< of full size, or empty: zero
  std::vector<double> start;
  std::vector<model::SourceFunction> inputs;
};

/// The kind of its instance; no card has its letter.
[[nodiscard]] const Kind& raw_system_kind();

}  // namespace pwlsim::elements
