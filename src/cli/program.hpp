#pragma once
/// The program behind main().

#include <string>

namespace pwlsim::cli {

/// Returns the exit status; throws nothing. Unexpected exceptions are reported as E-internal or E-out-of-memory, with status 1.
[[nodiscard]] int run_program(int argument_count, char** arguments, const char* version) noexcept;

}  // namespace pwlsim::cli
