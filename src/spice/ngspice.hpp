#pragma once
/// One run of ngspice in batch mode.

#include <optional>
#include <string>
#include <vector>

#include "base/process.hpp"
#include "waveform/raw_file.hpp"

namespace pwlsim::spice {

/// Where the program is, by PATH; empty where it is not installed.
[[nodiscard]] std::optional<std::string> find_ngspice();

struct NgspiceRun {
  std::optional<waveform::RawFile> raw;  ///< what was written, also by a run that failed
  std::string words;                     ///< ngspice's own, of what went wrong; "" where it says nothing
  bool ended = false;                    ///< by itself, with status 0
  double seconds = 0.0;                  ///< CPU time of the process
  double seconds_analysis = 0.0;         ///< "Total analysis time", in steps of a millisecond
};

/// Writes `deck` into a folder of its own under the system's temporary one, which is removed afterwards. Reads no user's .spiceinit.
[[nodiscard]] NgspiceRun run_ngspice(const std::string& program, const std::string& deck, const ProcessLimits& limits = {});

}  // namespace pwlsim::spice
