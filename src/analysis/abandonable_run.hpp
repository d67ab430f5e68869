#pragma once
/// Runs of an engine that end soon after a signal, also within a step that does not check for signals.

#include <atomic>

#include "analysis/transient.hpp"

namespace pwlsim::analysis {

/// The engine in its own thread. If it does not return in time after a signal (abandonable.hpp), the answer is that of an interrupted run: it contains what
/// the engine delivered before, and later data is ignored. `simulate` owns the data that it needs.
[[nodiscard]] Simulate abandonable(Simulate simulate, const std::atomic<int>& interrupt);

}  // namespace pwlsim::analysis
