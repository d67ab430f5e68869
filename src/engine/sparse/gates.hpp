#pragma once
/// Switches whose controls read only polylines of time: the times at which they change sides are known beforehand.

#include <cstddef>
#include <utility>
#include <vector>

#include "model/clock.hpp"
#include "model/network.hpp"

namespace pwlsim::engine::sparse {

/// One such switch. Its control is a constant and a sum of continuous tracks.
class Gate {
 public:
  Gate(std::size_t port, bool inverted, model::Clock clock) : port_(port), inverted_(inverted), clock_(std::move(clock)) {}

  [[nodiscard]] std::size_t port() const { return port_; }
  /// Goes to t = 0 with the switch in this position; a change that the control requires at once is taken.
  void begin(bool closed, double stop);
  [[nodiscard]] bool closed() const { return clock_.is_on() != inverted_; }
  [[nodiscard]] const model::Clock& clock() const { return clock_; }
  /// Time of its next change of sides, infinite if there is none before the end of the run.
  [[nodiscard]] double next() const { return clock_.next().time < stop_ ? clock_.next().time : model::forever; }
  /// Takes that change.
  void pass();

 private:
  void skip_empty();

  std::size_t port_;
  bool inverted_;
  model::Clock clock_;
  double stop_ = model::forever;
};

/// The network with the voltages of nodes that sources hold, by themselves or one on the other, written as these sources in the controls of switches.
[[nodiscard]] model::Network with_controls_of_sources(model::Network network);

/// The gates of a network. Sources that only they read rest at their first value in it from now on.
[[nodiscard]] std::vector<Gate> take_gates(model::Network& network);

}  // namespace pwlsim::engine::sparse
