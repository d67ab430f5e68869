#pragma once
/// Conditions that drive switches.

#include <vector>

#include "engine/sparse/descriptor.hpp"

namespace pwlsim::engine::sparse {

struct Control {
  std::size_t port = 0;  ///< of the switch
  Form value;            ///< SI units
  double on_level = 0.0, off_level = 0.0;
  bool inverted = false;
  double largest = 0.0;  ///< magnitude of the value over the run

  /// Whether the condition holds in a position of the ports: the switch is closed, or open where inverted.
  [[nodiscard]] bool holds(const Position& on) const { return (on[port] != 0) != inverted; }
  /// Positive as long as nothing changes; `value` is that of the condition's form.
  [[nodiscard]] double margin(const Position& on, double form_value) const {
    return holds(on) ? form_value - off_level : on_level - form_value;
  }
  [[nodiscard]] bool by_sources() const { return value.z.empty(); }
  /// Size of what margins are differences of.
  [[nodiscard]] double level_size() const;
};

[[nodiscard]] std::vector<Control> controls_of(const model::Network& network, const Descriptor& descriptor);

/// The start position of all ports: diodes off, switches as their elements say.
[[nodiscard]] Position first_position(const model::Network& network, const Descriptor& descriptor);

}  // namespace pwlsim::engine::sparse
