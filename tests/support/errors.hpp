#pragma once
/// Exceptions of the library, by their ids.

#include <pwlsim/pwlsim.hpp>

#include <catch2/catch.hpp>
#include <functional>
#include <string>

namespace pwlsim::test {

/// Of the Error that `call` throws, whose text shows it; "none" where it throws none.
inline std::string id_of_error(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    INFO(error.what());
    CHECK_THAT(error.what(), Catch::Matchers::Contains("error[" + error.id() + "]"));
    return error.id();
  }
  return "none";
}

}  // namespace pwlsim::test
