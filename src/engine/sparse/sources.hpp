#pragma once
/// Values of the sources over time, between breakpoints and across them.

#include <vector>

#include "model/exosystem.hpp"
#include "model/network.hpp"

namespace pwlsim::engine::sparse {

class Sources {
 public:
  explicit Sources(const model::Network& network);

  /// Values at `time`, on the segments where the sources stand.
  void evaluate(double time, std::vector<double>& w) const;
  [[nodiscard]] double next_break() const { return phase_.next; }
  /// Takes every breakpoint up to time + tolerance; true if some source jumped.
  bool advance(double time, double tolerance) { return exosystem_.advance(phase_, time, tolerance); }
  [[nodiscard]] std::size_t size() const { return count_; }
  /// The sources as a system of their own, the constant 1 among its states; and these states at `time`.
  [[nodiscard]] const model::Exosystem& exosystem() const { return exosystem_; }
  void states(double time, std::vector<double>& zeta) const;
  /// The shortest period of a sinusoid that never ends; infinite where there is none.
  [[nodiscard]] double shortest_period() const;

 private:
  model::Exosystem exosystem_;
  model::Exosystem::Phase phase_;
  std::size_t count_ = 0;
  mutable std::vector<double> zeta_;
};

/// The largest magnitude a function takes from 0 to `stop` (s), or a bound of it: `time` itself rises beyond any run.
[[nodiscard]] double largest_value(const model::SourceFunction& function, double stop);

/// The largest voltage that a branch of sources holds until then, in V.
[[nodiscard]] double largest_held_voltage(const model::Network& network, double stop);
/// The same of currents that sources drive between nodes, A.
[[nodiscard]] double largest_injected_current(const model::Network& network, double stop);

}  // namespace pwlsim::engine::sparse
