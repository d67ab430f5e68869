#pragma once
/// SIGINT and SIGTERM as a flag that a run reads; SIGPIPE and SIGXFSZ as failed writes.

#include <atomic>

namespace pwlsim::cli {

/// From now on the first SIGINT or SIGTERM sets the flag; the second ends the process as usual. This also applies if they were ignored: a
/// plain shell starts background jobs that way, and `kill -INT` must reach them.
void catch_signals();

/// 0, or the number of the received signal.
[[nodiscard]] const std::atomic<int>& caught_signal();

}  // namespace pwlsim::cli
