#pragma once
/// An exact run beside a refined run of ngspice: how far apart, and how much of that ngspice's own study explains.

#include <string>
#include <vector>

#include "spice/study.hpp"

namespace pwlsim::spice {

/// When a diode or a switch changes sides.
struct SwitchingTimes {
  std::string name;
  std::vector<double> times;  ///< s, ascending
};

/// What the exact engine gave. `values`: one list a signal, at the study's sample times.
struct ExactRun {
  std::vector<std::vector<double>> values;
  std::vector<SwitchingTimes> switching;
};

struct ComparedSignal {
  std::string name;
  double scale = 0.0;           ///< its largest magnitude in the exact run; of ngspice's where that is zero
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
  double worst = 0.0;                  ///< s, largest distance of an exact change from its partner; 0 where there is none
  double at = 0.0;                     ///< s
};

struct Comparison {
  std::vector<ComparedSignal> signals;
  std::vector<ComparedEvents> events;
};

[[nodiscard]] Comparison compare(const Study& study, const std::vector<double>& sample_times, const ExactRun& exact);

/// When the control of a part passes its levels in ngspice's waveforms, by straight lines between its points.
[[nodiscard]] SwitchingTimes switching_times(const SwitchingPart& part, const waveform::RawFile& waveforms);

}  // namespace pwlsim::spice
