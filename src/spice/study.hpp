#pragma once
/// How far ngspice's answer to a smoothed deck is from its own limit: refinement of its step and of the smoothing until the answer no longer changes.
///
/// Both ladders divide the cause of the error by a constant: level k of the first has the largest step h/2^k and reltol/4^k at a fixed sharpness X,
/// level k of the second X/4^k at the finest of these steps: both divide the error by 4 (the trapezoidal rule is of second order in h, smoothing of first in X). The error that remains at
/// the last level is estimated from the largest changes at the sample times (base/remainder.hpp). If they are not a geometric sequence, the signal counts as not settled unless the
/// estimate is below the target.

#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "base/remainder.hpp"
#include "circuit/circuit.hpp"
#include "spice/deck.hpp"
#include "spice/ngspice.hpp"

namespace pwlsim::spice {

struct StudySettings {
  double sharpness = default_sharpness;  ///< of the first ladder
  double target = 1e-4;                  ///< change between levels, relative to a signal's maximum, below which a signal has converged
  double seconds = 30.0;                 ///< of wall time, in all
  std::vector<double> sample_times;      ///< s, ascending, within (0, Tstop]
  Snubber snubber;                       ///< added to a deck that ngspice does not run without it; impedance 0: none
  std::function<void(double)> watcher;   ///< called while ngspice runs, with the seconds since the start; may be empty
  const std::atomic<int>* interrupt = nullptr;
};

struct Level {
  bool smoothing = false;  ///< of the second ladder
  DeckSettings deck;
  double seconds = 0.0;    ///< CPU time of the process
  std::size_t points = 0;  ///< computed by ngspice
  double change = -1.0;    ///< largest relative change of a signal from the level before; negative without one
  std::string failure;     ///< the failure, if possible in ngspice's words; "" if the run reached its end
};

struct SignalStudy {
  std::string name;
  std::vector<double> values;   ///< at the sample times, of the finest level
  double scale = 0.0;           ///< largest of them
  double discretisation = 0.0;  ///< the remaining error in `values`, absolute
  double smoothing = 0.0;
  bool settled = false;  ///< both ladders are geometric, or no longer change
};

struct Study {
  std::vector<Level> levels;         ///< in the order they ran
  std::vector<SignalStudy> signals;  ///< none if no level reached the end
  std::size_t finest_level = 0;      ///< within `levels`
  SmoothDeck finest;                 ///< its deck
  waveform::RawFile waveforms;       ///< and its waveforms
};

/// `circuit` must have passed circuit::assemble and have a `.tran`. Elements without a twin are reported in `diagnostics`.
[[nodiscard]] Study refine(const circuit::FlatCircuit& circuit, const std::string& program, const StudySettings& settings,
                           Diagnostics& diagnostics);

/// Σ sign·vector at `time`, by straight lines between ngspice's points.
class SignalReader {
 public:
  SignalReader(const waveform::RawFile& file, const SignalVectors& signal);
  [[nodiscard]] bool known() const { return known_; }
  [[nodiscard]] double at_row(std::size_t row) const;
  [[nodiscard]] double at(double time) const;

 private:
  const waveform::RawFile& file_;
  std::vector<std::pair<std::size_t, double>> terms_;
  bool known_ = true;
};

}  // namespace pwlsim::spice
