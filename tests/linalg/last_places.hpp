#pragma once

#include "linalg/dense.hpp"

namespace pwlsim::test {

/// A few units of the last place of one.
constexpr linalg::Wide last_places = 4e-19L;

}  // namespace pwlsim::test
