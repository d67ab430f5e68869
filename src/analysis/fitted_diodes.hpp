#pragma once
/// Exponential diodes are tangents, and a MOSFET's channel has the resistance of one gate voltage; where a deck does not say at which current (`.options i0=`)
/// and at which gate voltage (`vdrive=`), runs find them.

#include "analysis/prepared_engine.hpp"

namespace pwlsim::analysis {

/// Runs the transient analysis that `compiled` asks for, with tangents at 1 A, and then again with each exponential diode's tangent at the current found: its mean weighted by charge,
/// ∫i² dt / ∫i dt, to two digits, over sixteen equal windows of the run (measure/diode_currents.hpp); where its current spans so much that one tangent is off, with two or three (analysis/tangent_points.hpp), of which the network gets each but the first as a
/// diode in parallel. A diode that carries nothing is taken at the current that it would carry at its highest voltage. A channel that is a switch gets the resistance
/// at the v(gate,source) at which it is closed most; one that follows its gate gets one to three lines at what its gate exceeds the threshold by. The runs end when nothing moves (six at most, three of long ones). Returns
/// notes on what was found; none where there is nothing to fit, or a run does not come to its end: the network is then as it was.
/// With `.op` alone the tangents are those at the operating point, found by Newton's method.
[[nodiscard]] Diagnostics fit_diodes(circuit::Compiled& compiled, EngineChoice choice, double reltol, const std::atomic<int>* interrupt);

}  // namespace pwlsim::analysis
