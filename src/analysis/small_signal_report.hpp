#pragma once
/// The results of `.ac` as rows, as one line, and as JSON.

#include <string>

#include "analysis/json.hpp"
#include "analysis/small_signal.hpp"

namespace pwlsim::analysis {

/// The rows: frequency, magnitude and phase in degrees of every signal; each after `prefix`.
[[nodiscard]] std::string small_signal_rows(const SmallSignalResult& result, const std::string& prefix = "");
/// The same with a head.
[[nodiscard]] std::string small_signal_csv(const SmallSignalResult& result);
/// "ac response of buck.ac.csv: 61 frequencies, …; loop V1: crosses over at …".
[[nodiscard]] std::string small_signal_summary(const SmallSignalResult& result, const std::string& file);
/// The member `ac`.
void write_small_signals(JsonWriter& json, const SmallSignalResult* result);

}  // namespace pwlsim::analysis
