#include "engine/exact/port_watch.hpp"

namespace pwlsim::engine {

/// A port whose input is a current conducts where that is free; one whose input is the voltage that it blocks, where it is zero.
void PortWatch::read_ports() {
  on_.clear();
  for (const IslandRun& island : islands_) {
    const auto& ports = island.system().port;
    for (std::size_t i = 0; i < ports.size(); ++i)
      if (!ports[i].is_of_leak)
        on_.push_back(static_cast<char>(island.mode->active.contains(static_cast<int>(i)) == ports[i].input_is_current));
  }
}

void PortWatch::run_has_begun() {
  if (watcher_ == nullptr) return;
  std::vector<std::string> elements;
  for (const IslandRun& island : islands_)
    for (const model::Port& port : island.system().port)
      if (!port.is_of_leak) elements.push_back(port.name);
  read_ports();
  watcher_->begin(elements, on_);
}

void PortWatch::happened(const Event& event) {
  if (watcher_ == nullptr) return;
  read_ports();
  watcher_->happened(event, on_);
}

}  // namespace pwlsim::engine
