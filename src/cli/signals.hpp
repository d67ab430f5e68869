#pragma once
/// SIGINT and SIGTERM as a flag that a run reads; SIGPIPE and SIGXFSZ as failed writes.

#include <atomic>

namespace pwlsim::cli {

/// From now on the first SIGINT or SIGTERM sets the flag; the second ends the process as usual. This holds where they were ignored too: a
/// plain shell starts its background jobs so, and `kill -INT` must reach them.
void catch_signals();

/// 0, or the number of the signal that came.
[[nodiscard]] const std::atomic<int>& caught_signal();

}  // namespace pwlsim::cli
