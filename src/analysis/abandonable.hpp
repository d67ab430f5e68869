#pragma once
/// Work that a signal ends although it does not check for signals: a large dense extraction, one factorisation of a large sparse matrix.

#include <atomic>
#include <functional>

namespace pwlsim::analysis {

/// Whether work on a system of so many unknowns may take long between two checks of the interrupt flag. Below this size each step takes a tenth of a second
/// at most (dense extraction of 250 unknowns: 0.1 s), and no thread is started.
inline constexpr std::size_t quick_unknowns = 250;

/// Runs `work` in a new thread and waits for its end. False: `interrupt` became nonzero and half a second later `work` had still not returned. It
/// then continues with its data, and the process must end by `std::_Exit`, since its thread may still run. Exceptions of `work` are rethrown here.
[[nodiscard]] bool finished_in_time(std::function<void()> work, const std::atomic<int>& interrupt);

/// Whether some work was abandoned.
[[nodiscard]] bool any_abandoned();

}  // namespace pwlsim::analysis
