#pragma once
/// Conditions that drive switches.

#include <limits>
#include <vector>

#include "engine/sparse/descriptor.hpp"

namespace pwlsim::engine::sparse {

struct WatchedControl {
  std::size_t port = 0;  ///< of the switch
  Form value;            ///< SI units
  double on_level = 0.0, off_level = 0.0;
  bool inverted = false;
  int turn = 0;               ///< at an instant: only the violated ones of the first turn change together
  bool reads_states = false;  ///< alone, and sources: what ports do at an instant does not reach it before states jump
  double largest = 0.0;       ///< magnitude of the value over the run
  double at_threshold_since = std::numeric_limits<double>::quiet_NaN();  ///< s: the value has been at one threshold from there on
  bool has_rested = false;  ///< its switch was opened at the present instant because the value stays at the threshold

  /// Whether the condition holds in a position of the ports: the switch is closed, or open where inverted.
  [[nodiscard]] bool holds(const Position& on) const { return (on[port] != 0) != inverted; }
  /// Positive until the switch changes; `value` is that of the condition's form.
  [[nodiscard]] double margin(const Position& on, double form_value) const {
    return holds(on) ? form_value - off_level : on_level - form_value;
  }
  /// Whether its margin is that of another one, as of the two switches of a comparison: they pass at one instant.
  [[nodiscard]] bool passes_with(const WatchedControl& other, const Position& on) const;
  /// Whether the switch changes sides because the value stays at the threshold: without hysteresis it is off there.
  [[nodiscard]] bool passes_at_rest(const Position& on) const { return on_level == off_level && holds(on); }
  [[nodiscard]] bool by_sources() const { return value.z.empty(); }
  /// Size of the terms of which margins are differences.
  [[nodiscard]] double level_size() const;
  /// The error of the value from rounding of the unknowns: a zero current is as small as the solution's error.
  [[nodiscard]] double rounding(double largest_unknown) const;
  /// Up to there a margin is nothing but rounding.
  [[nodiscard]] double noise(double form_value, double largest_unknown) const;
};

[[nodiscard]] std::vector<WatchedControl> controls_of(const model::Network& network, const Descriptor& descriptor);
/// The same with their turns: gates of logic, which has no states, come first, then its latches, then what it drives elsewhere, at last all that reads parts with states, so that these see
/// as one change what logic does in several rounds, and answer it once its outputs stand, be they loaded by a capacitor.
[[nodiscard]] std::vector<WatchedControl> controls_in_turn(const model::Network& network, const Descriptor& descriptor);

/// Of controls that have passed at an instant those of the first turn.
void keep_first_turn(std::vector<const WatchedControl*>& passed);

/// The start position of all ports: diodes off, switches as their elements say.
[[nodiscard]] Position first_position(const model::Network& network, const Descriptor& descriptor);

}  // namespace pwlsim::engine::sparse
