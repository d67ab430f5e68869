#pragma once
/// What `pwlsim compare` found, as text, as JSON and as a picture.

#include <string>

#include "analysis/sampling.hpp"
#include "spice/comparison.hpp"

namespace pwlsim::cli {

struct CompareReport {
  std::string deck;
  std::string engine;
  double stop = 0.0;            ///< s, of the deck
  double until = 0.0;           ///< s, of the comparison
  bool is_cut = false;          ///< until < stop, because ngspice takes too long
  double seconds_window = 0.0;  ///< time of the exact run for it
  engine::Answer exact;         ///< of the run on the deck's own grid
  analysis::SampledRun grid;    ///< that run
  std::size_t samples = 0;
  spice::Study study;
  spice::Comparison comparison;  ///< empty if no level of the study reached its end
  bool events_skipped = false;   ///< there were too many
};

/// One line: how far apart the two are, or why this is not known, and both times.
[[nodiscard]] std::string compare_verdict(const CompareReport& report);
/// The verdict and, if `verbose`, its details.
[[nodiscard]] std::string compare_text(const CompareReport& report, bool verbose);
[[nodiscard]] std::string compare_json(const CompareReport& report);
/// The waveforms of both programs overlaid, one panel per signal. The first twelve signals.
[[nodiscard]] std::string compare_svg(const CompareReport& report, const std::vector<std::string>& names);

}  // namespace pwlsim::cli
