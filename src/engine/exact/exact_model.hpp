#pragma once
/// The result of `prepare`: the extracted islands of a network.

#include <string>
#include <vector>

#include "engine/run.hpp"
#include "engine/threshold_watch.hpp"
#include "model/extraction.hpp"
#include "model/islands.hpp"

namespace pwlsim::engine {

struct IslandModel {
  model::Island island;
  model::Extraction extraction;
};

struct SwitchInfo {
  std::string name;
  bool initially_on = false;
  double on_level = 0.0, off_level = 0.0;
  int island = -1;  ///< the island of its port; −1: left out
  int port = -1;
};

class ExactModel {
 public:
  std::vector<IslandModel> islands;  ///< needed ones only
  std::vector<IslandModel> left_out;
  std::vector<SwitchInfo> switches;    ///< of the whole network
  std::vector<WatchedSwitch> watched;  ///< the same for messages about their controls
  std::vector<std::string> signal_names;
  std::vector<Remark> remarks;
  double seconds = 0.0;
};

}  // namespace pwlsim::engine
