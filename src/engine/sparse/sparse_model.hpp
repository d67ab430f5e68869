#pragma once
/// A network prepared for the sparse engine, and the starts of its runs.

#include <memory>
#include <vector>

#include "engine/sparse/part.hpp"
#include "engine/sparse/start.hpp"

namespace pwlsim::engine::sparse {

class SparseModel {
 public:
  std::vector<std::unique_ptr<const Part>> parts;
  std::size_t signals = 0;
  std::vector<Remark> remarks;
};

struct Starts {
  Answer answer;  ///< of the first part that cannot start
  MissingRest missing;
  std::vector<PartStart> parts;
};

/// From initial values, or the operating point.
[[nodiscard]] Starts starts_of(const SparseModel& model, bool uic);

}  // namespace pwlsim::engine::sparse
