#pragma once
/// What the files of Sensitivity share.

#include <vector>

#include "linalg/dense.hpp"
#include "model/system.hpp"

namespace pwlsim::steady {

inline linalg::Vector vector_of(const std::vector<double>& y) {
  return Eigen::Map<const linalg::Vector>(y.data(), static_cast<Eigen::Index>(y.size()));
}

/// Nothing but sources: runs evaluate them when they are read.
inline bool is_static(const model::System& system) { return system.n == 0 && system.ports == 0; }

}  // namespace pwlsim::steady
