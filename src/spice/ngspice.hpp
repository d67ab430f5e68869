#pragma once
/// One run of ngspice in batch mode.

#include <optional>
#include <string>
#include <vector>

#include "base/process.hpp"
#include "waveform/raw_file.hpp"

namespace pwlsim::spice {

/// The path of the program, by PATH; empty if it is not installed.
[[nodiscard]] std::optional<std::string> find_ngspice();

struct NgspiceRun {
  std::optional<waveform::RawFile> raw;  ///< the written data, also of a failed run
  std::string words;                     ///< ngspice's own message for a failure; "" without one
  bool ended = false;                    ///< ended by itself, with status 0
  double seconds = 0.0;                  ///< CPU time of the process
  double seconds_analysis = 0.0;         ///< "Total analysis time", in steps of a millisecond
};

/// Writes `deck` into a new temporary folder, which is removed afterwards. Ignores the user's .spiceinit.
[[nodiscard]] NgspiceRun run_ngspice(const std::string& program, const std::string& deck, const ProcessLimits& limits = {});

}  // namespace pwlsim::spice
