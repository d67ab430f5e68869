#pragma once
/// Reports the controls of an island within its segments to a ThresholdWatch.

#include <cstdint>
#include <vector>

#include "engine/exact/locator.hpp"
#include "engine/threshold_watch.hpp"

namespace pwlsim::engine {

class ControlProbe {
 public:
  explicit ControlProbe(ThresholdWatch& watch) : watch_(watch) {}
  /// The segment ends at `time`.
  void look(const model::System& system, const Segment& segment, double time);

 private:
  [[nodiscard]] double value(const model::System& system, std::size_t control, const std::vector<double>& y) const;
  void go_to(double tau);
  void look_for_rest(const model::System& system, std::size_t control, double length);

  ThresholdWatch& watch_;
  const Segment* segment_ = nullptr;
  std::vector<double> y_, work_;
  std::uint64_t samples_ = 0;
};

}  // namespace pwlsim::engine
