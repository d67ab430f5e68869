#pragma once

#include <algorithm>

namespace pwlsim::engine::sparse {

/// What is tried less and less often where it fails: at each failure in a row 1, 3, 7, … turns pass, 63 at most.
class Attempts {
 public:
  /// False: a turn passes.
  bool is_due() {
    if (wait_ == 0) return true;
    --wait_;
    return false;
  }
  /// What came of it, which is returned.
  bool note(bool success) {
    pause_ = success ? 0 : std::min(2 * pause_ + 1, longest_pause);
    wait_ = pause_;
    return success;
  }

 private:
  static constexpr int longest_pause = 63;
  int pause_ = 0, wait_ = 0;  ///< after the last failure, and what is left of it
};

}  // namespace pwlsim::engine::sparse
