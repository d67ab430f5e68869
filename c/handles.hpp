#pragma once
/// What stands behind the handles of pwlsim.h, and how exceptions become statuses.

#include <pwlsim.h>

#include <exception>
#include <new>
#include <string>
#include <vector>

#include <pwlsim/pwlsim.hpp>

struct pwlsim_circuit {
  pwlsim::Circuit circuit;
};

struct pwlsim_result {
  /// Names of an event as C has them.
  struct Names {
    std::vector<const char*> on, off;
  };
  explicit pwlsim_result(pwlsim::Result of);

  pwlsim::Result result;
  std::vector<Names> names;  ///< one an event
};

namespace pwlsim::c {

/// Remembers the failure for pwlsim_last_error of this thread, and returns `status`.
int fail(int status, const char* text) noexcept;
int fail(int status, const Error& error) noexcept;
/// PWLSIM_ARGUMENT.
inline int bad_argument(const char* text) noexcept { return fail(PWLSIM_ARGUMENT, text); }

/// PWLSIM_OK, or the status of what `call` throws. What it returns is a status.
template <class Call>
int guarded(const Call& call) noexcept {
  try {
    return call();
  } catch (const Error& error) {
    return fail(PWLSIM_INVALID, error);
  } catch (const std::bad_alloc&) {
    return fail(PWLSIM_INTERNAL, "no memory is left");
  } catch (const std::exception& exception) {
    return fail(PWLSIM_INTERNAL, exception.what());
  } catch (...) {
    return fail(PWLSIM_INTERNAL, "internal error");
  }
}

[[nodiscard]] pwlsim_message message_of(const Message& message) noexcept;

}  // namespace pwlsim::c
