#pragma once
/// The controls of islands within their segments, for messages about those that stop at a threshold or never cross one.

#include <cstdint>
#include <vector>

#include "engine/exact/locator.hpp"
#include "engine/exact/recorder.hpp"
#include "engine/threshold_watch.hpp"

namespace pwlsim::engine {

class ControlProbe : public Recorder {
 public:
  ControlProbe(const std::vector<WatchedSwitch>& switches, double stop) : watch_(switches, stop) {}

  void opens(const IslandAt& island, double /*length*/) {
    if (!island.run.is_open() && island.run.mode != nullptr) look(island);
  }
  void reached_end(const IslandAt& island) { look(island); }
  void flipped(int number) { watch_.changed(number); }
  void hand_over(const RunEnd& end, Answer& answer);

 private:
  void look(const IslandAt& island);
  [[nodiscard]] double value(const model::System& system, std::size_t control, const std::vector<double>& y) const;
  void go_to(double tau);
  void look_for_rest(const model::System& system, std::size_t control, double length);

  ThresholdWatch watch_;
  const Segment* segment_ = nullptr;
  std::vector<double> y_, work_;
  std::uint64_t samples_ = 0;
};

}  // namespace pwlsim::engine
