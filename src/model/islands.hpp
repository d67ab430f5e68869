#pragma once
/// Cutting a network into parts that share nothing but ground and nodes held by sources, and finding those that no saved signal needs.

#include <functional>
#include <string>
#include <vector>

#include "base/diagnostic.hpp"
#include "model/network.hpp"

namespace pwlsim::model {

/// One part, with its own numbering, and what ties it to the whole.
struct Island {
  struct ControlForm {
    LinearForm value;  ///< in the island's numbering
    int driven = 0;    ///< switch of the whole network
    double on_level = 0.0, off_level = 0.0;
  };
  std::string name;                ///< its first element or node, for messages
  Network network;                 ///< signals: the island's share of each saved signal
  std::vector<int> signal_number;  ///< of network.signals, in the whole network
  std::vector<int> switch_number;  ///< of network.switches, in the whole network
  std::vector<ControlForm> controls;
  bool needed = true;
  int part = 0;                      ///< islands of one number hang together in the network as drawn, by rails
  std::vector<int> copied_branches;  ///< of network.branches: sources of rails that belong to another island
};

/// Whether a switch is in one island with what its control reads, or that island tells it (Island::controls). Joined, controls stay in
/// Island::network.switches, in the island's numbering.
enum class Controls { apart, joined };

/// Islands in order of their first node. A rail (a node that a source to ground holds at a function of time) joins nothing. A switch
/// control belongs to the island whose quantities it reads: it joins islands only where it reads several of them. An island is needed
/// when a saved signal reads it, when it `must_run` for another reason, or when it drives a switch of a needed one. A part that a needed one
/// drives through controlled sources, without being read by it, is an island of its own with stand-ins for what it reads, and left out.
[[nodiscard]] std::vector<Island> split_islands(const Network& network, const std::function<bool(const Island&)>& must_run = {},
                                                Controls controls = Controls::apart);

}  // namespace pwlsim::model
