#pragma once
/// Measurements of a node that shows a power: `B1 p 0 V=V(a)*I(b)` with `.meas AVG V(p)`.

#include "circuit/definitions.hpp"

namespace pwlsim::circuit {

/// Such a source has no piecewise-linear form, but a measurement may take the product: in `.meas` of the deck V(p) becomes the expression of the source that
/// holds p against ground. The source is then one that nothing reads (unread_parts.hpp).
void measure_powers(Definitions& definitions);

}  // namespace pwlsim::circuit
