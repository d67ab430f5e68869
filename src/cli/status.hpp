#pragma once
/// Exit status of the process (docs/reference/command-line.md).

namespace pwlsim::cli {

enum class Status { done = 0, run_failed = 1, wrong_input = 2, file_error = 3, closed_pipe = 141 };

/// 130 for SIGINT, 143 for SIGTERM.
[[nodiscard]] constexpr int status_of_signal(int signal_number) { return 128 + signal_number; }

}  // namespace pwlsim::cli
