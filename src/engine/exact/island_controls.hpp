#pragma once
/// The controls of an island: whose switches must change. `on`: the positions of all switches.

#include <vector>

#include "model/selection.hpp"
#include "model/source_departure.hpp"

namespace pwlsim::engine {

class IslandControls {
 public:
  IslandControls(const model::System& system, model::Selector& selector);

  /// Crossings of thresholds closer than `tolerance` are one.
  void set_tolerance(double tolerance);
  void begin_instant();
  /// Whether some controls read more than sources.
  [[nodiscard]] bool sense_state() const;
  /// Guard row of control i.
  [[nodiscard]] int row(std::size_t i, const std::vector<char>& on) const;

  /// Numbers of controls that read the state or a port and whose switch must change, in the mode at y.
  const std::vector<int>& violated(const model::Mode& mode, const double* y, const std::vector<char>& on);
  /// Of the controls that were examined last: those whose switch changes because the control stays at the threshold from now on.
  const std::vector<int>& at_rest(const std::vector<char>& on);
  /// The same for controls that do not depend on the mode: those that read sources only, by the sources' own derivatives; with `by_state` also those that
  /// read the state directly, by value. x: the full state.
  const std::vector<int>& violated_without_mode(const model::Exosystem::Phase& phase, double time, const std::vector<double>& x,
                                                const std::vector<char>& on, bool by_state);
  /// A control that passes its threshold within the tolerance, before or after, is on it, and its slope decides.
  void take_slope_at_threshold(const model::Mode& mode, int row, const double* y, model::Departure& departure);

 private:
  enum class Reads { sources, state, ports };
  /// A control that reads the same as this one, or as its negative with levels to match: then it is on where the other is off.
  struct Alike {
    std::size_t control = 0;
    bool is_mirrored = false;
  };
  [[nodiscard]] Alike first_alike(std::size_t control) const;
  double source_departure_of(std::size_t i, bool is_on);
  bool find_departures(const model::Mode& mode, const double* y, const std::vector<char>& on);

  const model::System& system_;
  model::Selector& selector_;
  model::SourceDeparture source_departure_;
  double tolerance_ = 0.0;
  std::vector<Reads> reads_;
  std::vector<Alike> alike_;
  std::vector<double> source_departures_;  ///< of controls that read sources, off and on; NaN: not known
  std::vector<char> passed_;               ///< controls that have changed their switch at the present instant
  std::vector<int> rows_, numbers_, violated_;
  std::vector<model::Departure> departures_;
  std::vector<double> ahead_, work_;
};

}  // namespace pwlsim::engine
