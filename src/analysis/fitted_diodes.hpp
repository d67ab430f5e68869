#pragma once
/// Exponential diodes are tangents, and a MOSFET's channel has the resistance of one gate voltage; if a deck does not give the current (`.options i0=`)
/// and the gate voltage (`vdrive=`), preliminary runs find them.

#include "analysis/prepared_engine.hpp"

namespace pwlsim::analysis {

/// Runs the transient analysis that `compiled` asks for, with tangents at 1 A, and then again with each exponential diode's tangent at the current found: its mean weighted by charge,
/// ∫i² dt / ∫i dt, to two digits, over sixteen equal windows of the run (measure/diode_currents.hpp); if its current varies so much that one tangent is not enough, with two or three (analysis/tangent_points.hpp), of which each but the first is added to the network as a
/// diode in parallel. For a diode without current the tangent is taken at the current that it would carry at its highest voltage. A channel that is a switch gets the resistance
/// at the v(gate,source) at which it is closed most; one that follows its gate gets one to three lines at the overdrives found. The runs end when nothing changes (six at most, three if they are long). Returns
/// notes with the results; none if there is nothing to fit, or if a run does not reach its end: the network is then unchanged.
/// With `.op` alone the tangents are those at the operating point, found by Newton's method.
[[nodiscard]] Diagnostics fit_diodes(circuit::Compiled& compiled, EngineChoice choice, double reltol, const std::atomic<int>* interrupt);

}  // namespace pwlsim::analysis
