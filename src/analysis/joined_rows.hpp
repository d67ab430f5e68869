#pragma once
/// Rows of several runs on one axis of times.

#include <vector>

#include "waveform/thinned_rows.hpp"

namespace pwlsim::analysis {

struct JoinedRows {
  std::vector<double> times;  ///< of all runs, ascending; twice where a run has a time twice
  std::vector<std::vector<std::vector<double>>>
      columns{};  ///< [run][signal][time]: on straight lines between the run's rows; NaN outside of it
};

[[nodiscard]] JoinedRows join_rows(const std::vector<waveform::ThinnedRows::Rows>& runs);

}  // namespace pwlsim::analysis
