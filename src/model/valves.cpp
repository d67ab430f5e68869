#include "model/valves.hpp"

#include <algorithm>

namespace pwlsim::model {

namespace {

bool is_closed(const System& system, int port, const IndexSet& set) {
  return set.contains(port) == system.port[static_cast<std::size_t>(port)].input_is_current;
}

bool blocks(const System& system, const Valve& valve, const IndexSet& set) {
  return std::none_of(valve.switches.begin(), valve.switches.end(), [&](int port) { return is_closed(system, port, set); });
}

}  // namespace

std::vector<int> blocked_ports(const System& system, const IndexSet& set) {
  std::vector<int> ports;
  for (const Valve& valve : system.valves)
    if (blocks(system, valve, set)) ports.push_back(valve.port);
  return ports;
}

void hold_blocked(const System& system, IndexSet& set) {
  for (const Valve& valve : system.valves)
    if (blocks(system, valve, set)) set.set(valve.port, !system.port[static_cast<std::size_t>(valve.port)].input_is_current);
}

}  // namespace pwlsim::model
