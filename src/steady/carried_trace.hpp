#pragma once
/// The recorded run of one model as a run of another one of the same circuit whose sources are more, and rest at zero: derivatives run without their inputs,
/// and look at the run with them.

#include "engine/exact/exact_model.hpp"
#include "engine/exact/selectors.hpp"
#include "steady/orbit_trace.hpp"

namespace pwlsim::steady {

/// `selectors`: of `to`; they make its modes and must outlive the trace. `stop`: of the run, s. False, and the trace of no use, where the models differ in more than
/// their sources: in islands, stores, ports, or modes.
[[nodiscard]] bool carry(Trace& trace, const engine::ExactModel& from, const engine::ExactModel& to, engine::Selectors& selectors,
                         double stop);

}  // namespace pwlsim::steady
