#pragma once
/// The controls of switches and their thresholds over a run: messages for controls that stop at a threshold, and for those that never cross one although
/// they vary.

#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "engine/run.hpp"
#include "model/clock.hpp"
#include "model/network.hpp"

namespace pwlsim::engine {

/// A switch as its messages name it. Levels are those of its control as it runs; `written` is what the deck gives instead.
struct WatchedSwitch {
  std::string name;
  double on_level = 0.0, off_level = 0.0;
  std::optional<model::WrittenControl> written;
  int partner = -1;  ///< of a P channel: an N channel with the same gate and a common node, an inverter; -1: none

  [[nodiscard]] double on_threshold() const { return on_level + written->reach; }
  [[nodiscard]] double off_threshold() const { return off_level - written->reach; }
};
[[nodiscard]] std::vector<WatchedSwitch> watched_switches(const model::Network& network);

class ThresholdWatch {
 public:
  /// The switches of a run to `stop`; they must outlive this.
  ThresholdWatch(const std::vector<WatchedSwitch>& switches, double stop);

  [[nodiscard]] bool asks_anything() const { return open_ > 0; }
  /// Whether values of this control are still needed: it has not changed its switch.
  [[nodiscard]] bool asks_range(int number) const { return is_open(number) && !of(number).changed; }
  [[nodiscard]] bool asks_rest(int number) const { return is_open(number) && std::isnan(of(number).rest_time); }
  /// The control has this value.
  void see(int number, double value);
  /// The threshold that the control's value is at, within `noise`; none where it is at neither.
  [[nodiscard]] std::optional<double> threshold_at(int number, double value, double noise) const;
  /// The control stays at a threshold from `time` on.
  void rests(int number, double threshold, double time);
  /// s
  [[nodiscard]] double stop() const { return stop_; }
  /// The switch has changed sides after t = 0.
  void changed(int number);
  /// The whole control of a clock.
  void trace(const model::Clock& clock, int number);
  /// At the end; `is_on` as the control has it. A run that did not complete reports nothing about switches that have not changed yet.
  [[nodiscard]] std::vector<Remark> remarks(const std::vector<char>& is_on, bool completed) const;

 private:
  struct Story {
    double least = std::numeric_limits<double>::infinity(), most = -std::numeric_limits<double>::infinity();
    double rest_time = std::numeric_limits<double>::quiet_NaN(), rest_threshold = 0.0;
    bool changed = false;
  };
  [[nodiscard]] Story& of(int number) { return stories_[static_cast<std::size_t>(number)]; }
  [[nodiscard]] const Story& of(int number) const { return stories_[static_cast<std::size_t>(number)]; }
  [[nodiscard]] bool is_open(int number) const { return switches_[static_cast<std::size_t>(number)].written.has_value(); }
  [[nodiscard]] std::string rest_text(std::size_t number) const;
  [[nodiscard]] std::string range_text(std::size_t number, bool is_on) const;
  [[nodiscard]] std::vector<Remark> inverters_at_rest(const std::vector<char>& is_on) const;
  [[nodiscard]] bool moves_in_vain(std::size_t number) const;

  const std::vector<WatchedSwitch>& switches_;
  double stop_ = 0.0;
  std::vector<Story> stories_;
  std::size_t open_ = 0;  ///< switches that have a written control
};

}  // namespace pwlsim::engine
