#pragma once
/// Switches whose controls read nothing but polylines of time: when they change sides is known beforehand.

#include <cstddef>
#include <vector>

#include "model/exosystem.hpp"
#include "model/network.hpp"

namespace pwlsim::engine::sparse {

/// One such switch. Its control is a constant and a sum of continuous tracks.
class Gate {
 public:
  struct Part {
    model::Track track;
    double coefficient;
    model::Track::Cursor cursor{};
  };
  Gate(std::size_t port, const model::Switch& s, double constant, std::vector<Part> parts);

  [[nodiscard]] std::size_t port() const { return port_; }
  /// Goes to t = 0 with the switch in this position; what the control asks for at once is taken.
  void begin(bool closed, double stop);
  [[nodiscard]] bool closed() const { return holds_ != inverted_; }
  /// Time of its next change of sides, infinite where there is none before the end of the run.
  [[nodiscard]] double next() const { return next_; }
  /// Takes that change.
  void pass();

 private:
  void find_next();
  [[nodiscard]] double margin(double time) const;
  [[nodiscard]] double next_corner() const;

  std::size_t port_;
  double constant_, on_level_, off_level_;
  bool inverted_, holds_ = false;
  std::vector<Part> parts_;
  double time_ = 0.0, next_ = model::forever, stop_ = model::forever;
};

/// The network with the voltages of nodes that sources to ground hold written as these sources in the controls of switches.
[[nodiscard]] model::Network with_controls_of_sources(model::Network network);

/// The gates of a network. Sources that only they read rest at their first value in it from now on.
[[nodiscard]] std::vector<Gate> take_gates(model::Network& network);

}  // namespace pwlsim::engine::sparse
