#pragma once

namespace pwlsim::test {

/// Of a signal's largest value.
constexpr double rounding = 1e-13;

}  // namespace pwlsim::test
