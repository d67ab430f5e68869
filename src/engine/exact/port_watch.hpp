#pragma once
/// Reports the conducting ports of all islands to an EventWatcher.

#include <string>
#include <vector>

#include "engine/exact/recorder.hpp"
#include "engine/run.hpp"

namespace pwlsim::engine {

class PortWatch : public Recorder {
 public:
  /// Nothing is reported if `watcher` is null.
  PortWatch(const std::vector<IslandRun>& islands, EventWatcher* watcher) : islands_(islands), watcher_(watcher) {}

  void run_has_begun();
  void happened(const Event& event);

 private:
  void read_ports();

  const std::vector<IslandRun>& islands_;
  EventWatcher* watcher_;
  std::vector<char> on_;
};

}  // namespace pwlsim::engine
