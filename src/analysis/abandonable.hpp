#pragma once
/// Work that a signal ends though it does not look for signals: a large dense extraction, one factorisation of a large sparse matrix.

#include <atomic>
#include <functional>

namespace pwlsim::analysis {

/// Whether work on a system of so many unknowns may take long between two looks at the flag of the interrupt. Up to here each step of it takes a tenth of a second
/// at most (dense extraction of 250 unknowns: 0.1 s), and no thread is begun.
inline constexpr std::size_t quick_unknowns = 250;

/// Runs `work` in a thread of its own and waits for its end. False: `interrupt` became nonzero and half a second later `work` had still not returned. It
/// then goes on with what it holds, and the process must end by `std::_Exit`, since its thread may still run. Exceptions of `work` are thrown here.
[[nodiscard]] bool finished_in_time(std::function<void()> work, const std::atomic<int>& interrupt);

/// Whether some work was left to itself.
[[nodiscard]] bool any_abandoned();

}  // namespace pwlsim::analysis
