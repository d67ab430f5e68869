#pragma once
/// Compares an exact run with a refined run of ngspice: their difference, and how much of it ngspice's refinement study explains.

#include <string>
#include <vector>

#include "spice/study.hpp"

namespace pwlsim::spice {

/// The times at which a diode or a switch changes.
struct SwitchingTimes {
  std::string name;
  std::vector<double> times;  ///< s, ascending
};

/// Results of the exact engine. `values`: one list per signal, at the study's sample times.
struct ExactResults {
  std::vector<std::vector<double>> values;
  std::vector<SwitchingTimes> switching;
};

struct ComparedSignal {
  std::string name;
  double scale = 0.0;           ///< its largest magnitude in the exact run, or in ngspice's if that is zero
  double difference = 0.0;      ///< largest at the sample times; this and what follows relative to `scale`
  double mean = 0.0;            ///< of the magnitudes at the sample times
  double time = 0.0;            ///< s, of the largest
  double discretisation = 0.0;  ///< ngspice's own, as estimated (spice/study.hpp)
  double smoothing = 0.0;
  bool settled = false;
  bool explained = false;  ///< settled, and the difference is at most `safety` times ngspice's own error
};

inline constexpr double safety = 2.0;

struct ComparedEvents {
  std::string name;
  std::size_t exact = 0, ngspice = 0;  ///< numbers of changes
  double worst = 0.0;                  ///< s, largest distance of an exact change from its partner; 0 if there is none
  double at = 0.0;                     ///< s
};

struct Comparison {
  std::vector<ComparedSignal> signals;
  std::vector<ComparedEvents> events;
};

[[nodiscard]] Comparison compare(const Study& study, const std::vector<double>& sample_times, const ExactResults& exact);

/// The times at which the control of a part crosses its levels in ngspice's waveforms, with straight lines between points.
[[nodiscard]] SwitchingTimes switching_times(const SwitchingPart& part, const waveform::RawFile& waveforms);

}  // namespace pwlsim::spice
