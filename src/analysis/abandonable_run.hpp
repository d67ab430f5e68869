#pragma once
/// Runs of an engine that end soon after a signal, also within a step that does not look for signals.

#include <atomic>

#include "analysis/transient.hpp"

namespace pwlsim::analysis {

/// The engine in a thread of its own. Where it does not return in time after a signal (abandonable.hpp), the answer is that of an interrupted run: what
/// it handed over before is all that there is, and whatever it hands over later is dropped. `simulate` keeps what it needs itself.
[[nodiscard]] Simulate abandonable(Simulate simulate, const std::atomic<int>& interrupt);

}  // namespace pwlsim::analysis
