#pragma once
/// Saved signals: first as nodes and elements of any circuit, then as forms over its network.

#include <vector>

#include "circuit/circuit.hpp"
#include "circuit/names.hpp"
#include "circuit/reporter.hpp"
#include "elements/emission.hpp"

namespace pwlsim::circuit {

/// v(p) − v(n), or the current of an element.
struct SignalSource {
  std::string column;
  model::NodeIndex p = model::ground, n = model::ground;
  int element = -1;       ///< -1: a voltage
  char quantity = ' ';    ///< x, u or y of a raw system
  std::size_t index = 0;  ///< and its number, from 0

  [[nodiscard]] bool is_same(const SignalSource& other) const {
    return p == other.p && n == other.n && element == other.element && quantity == other.quantity && index == other.index;
  }
};

/// In the order of the columns, each once. Unknown names are errors, with the nearest.
[[nodiscard]] std::vector<SignalSource> resolve_signals(const FlatCircuit& circuit, const NameIndex& names, Reporter& reporter);

/// Of `circuit.drawn`, without those among `known`.
[[nodiscard]] std::vector<SignalSource> resolve_drawn(const FlatCircuit& circuit, const NameIndex& names,
                                                      const std::vector<SignalSource>& known);

/// Signals that measurements read, in the order of FlatCircuit::probes.
[[nodiscard]] std::vector<SignalSource> resolve_probes(const FlatCircuit& circuit, const NameIndex& names, Reporter& reporter);

[[nodiscard]] model::Signal signal_of(const SignalSource& source, const std::vector<elements::Emitted>& emitted);

}  // namespace pwlsim::circuit
