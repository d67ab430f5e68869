#pragma once
/// What `pwlsim compare` found, as text, as JSON and as a picture.

#include <string>

#include "analysis/sampling.hpp"
#include "spice/comparison.hpp"

namespace pwlsim::cli {

struct CompareReport {
  std::string deck;
  std::string engine;
  double stop = 0.0;          ///< s
  engine::Answer exact;       ///< of the run on the deck's own grid
  analysis::SampledRun grid;  ///< that run
  std::size_t samples = 0;
  spice::Study study;
  spice::Comparison comparison;  ///< empty where no level of the study reached its end
  bool events_skipped = false;   ///< there were too many
};

[[nodiscard]] std::string compare_text(const CompareReport& report);
[[nodiscard]] std::string compare_json(const CompareReport& report);
/// The waveforms of both programs over each other, one panel a signal. The first twelve signals.
[[nodiscard]] std::string compare_svg(const CompareReport& report, const std::vector<std::string>& names);

}  // namespace pwlsim::cli
