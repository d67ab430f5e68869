#pragma once
/// One implicit stage to solve, and what the signs of its port quantities are judged against.

#include <vector>

#include "engine/sparse/descriptor.hpp"

namespace pwlsim::engine::sparse {

/// Largest port quantities of the run so far, in volts: what signs are judged against.
struct PortScale {
  double input = 0.0, slack = 0.0;
};

/// A stage to solve. `right`: r, its closing rows without meaning.
struct Stage {
  double shift;
  const std::vector<double>& from;  ///< z0
  const std::vector<double>& right;
  const std::vector<double>& w;
  /// The problem of a change from a point at which both quantities of these ports are zero: z is that change, the others stay on their sides.
  const std::vector<char>* disputed = nullptr;

  [[nodiscard]] double free_variable(const DescriptorPort& port, bool on, const double* z) const {
    return disputed != nullptr ? port.response(on, z) : port.free_variable(on, z, w.data());
  }
  [[nodiscard]] double slack_size(const DescriptorPort& port, const double* z) const {
    return disputed == nullptr ? port.slack_size(z, w.data()) : Form::size_of(port.slack.z, z);
  }
  [[nodiscard]] bool may_change(std::size_t port, const DescriptorPort& p, const Position& on) const {
    return !p.blocks(on) && (disputed == nullptr || (*disputed)[port] != 0);
  }
};

}  // namespace pwlsim::engine::sparse
