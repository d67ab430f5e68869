#pragma once
/// Random passive networks of R, L, C, ideal diodes, ideal switches on clocks, and sources; as data, so that one can be renumbered,
/// made smaller and printed as a deck.
///
/// Passive networks have one trajectory of capacitor voltages and inductor currents for any start (theorem of van der Schaft and
/// Schumacher's class of passive systems: two solutions never part), as long as Kirchhoff's laws can be met at all. So that they can:
/// a voltage source closes no loop with diodes, switches and other such sources alone, and the current of a current source has a way
/// round that is open to both directions. What is left are networks whose linear equations are singular; the program must refuse those.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "model/network.hpp"
#include "support/random.hpp"

namespace pwlsim::test {

constexpr double clock_threshold = 0.5;

struct NetworkPart {
  enum class Kind { resistor, capacitor, inductor, diode, switch_, voltage, current };
  Kind kind = Kind::resistor;
  std::string name;
  int p = 0, n = 0;      ///< nodes; 0 is ground
  double value = 0.0;    ///< Ω, F, H; of a voltage source its series resistance, of a diode its Ron, of a switch nothing
  double leak = 0.0;     ///< Ω, of a diode: its Roff; 0: none
  double initial = 0.0;  ///< V of a capacitor, A of an inductor, with uic
  std::string waveform;  ///< of a source, or of the clock of a switch (see clock_threshold), as the deck writes it
  model::SourceFunction function;

  [[nodiscard]] bool is_state() const { return kind == Kind::capacitor || kind == Kind::inductor; }
};

struct RandomNetwork {
  int nodes = 0;  ///< without ground
  std::vector<NetworkPart> parts;
  double stop = 0.0;  ///< s

  [[nodiscard]] bool has_sources() const;
};

/// What a family of networks is made of: relative frequencies of parts beyond the tree that connects the nodes.
struct Recipe {
  double resistor = 3, capacitor = 3, inductor = 2, diode = 3, switch_ = 1, voltage = 1, current = 0.5;
  double stiff_source = 0.4;  ///< of sources without resistance, where Kirchhoff's laws allow it
  double floating = 0.1;      ///< of networks that nothing but diodes and switches may tie to ground
  int most_nodes = 8, most_diodes = 6, most_switches = 2;
  double spread = 3.0;       ///< values lie within ± so many decades
  double real_diodes = 0.0;  ///< of diodes with Ron between 1 mΩ and 1 Ω and Roff between 100 kΩ and 1 GΩ
};

[[nodiscard]] RandomNetwork make_random_network(std::uint64_t seed, const Recipe& recipe);

/// Whether the sources leave Kirchhoff's laws a solution in every position of diodes and switches (see above).
[[nodiscard]] bool sources_can_be_met(const RandomNetwork& network);

/// The network with every part removed that `fails` does not need; what is left can be met by its sources.
[[nodiscard]] RandomNetwork smallest(RandomNetwork network, const std::function<bool(const RandomNetwork&)>& fails);

/// The network of the model; its signals are the voltages of capacitors and currents of inductors, in the order of `parts`. `part_order`
/// and `node_order` (a permutation of 0 … nodes−1) number elements and nodes otherwise, without any effect on what is computed.
[[nodiscard]] model::Network to_model(const RandomNetwork& network, const std::vector<int>& part_order, const std::vector<int>& node_order);
[[nodiscard]] model::Network to_model(const RandomNetwork& network);

[[nodiscard]] std::string to_deck(const RandomNetwork& network);

}  // namespace pwlsim::test
