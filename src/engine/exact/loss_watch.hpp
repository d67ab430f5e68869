#pragma once
/// Detects switches that break the current of an inductor: it has no other path, so its stored energy is lost in zero time. The jump is what the ideal
/// elements require, but seldom what the user intended. (Charge sharing through closed contacts without resistance loses energy, too, but breaks no current.)

#include <map>
#include <string>
#include <vector>

#include "engine/exact/exact_model.hpp"
#include "engine/exact/recorder.hpp"
#include "engine/run.hpp"
#include "model/store_values.hpp"

namespace pwlsim::engine {

class LossWatch : public Recorder {
 public:
  explicit LossWatch(const std::vector<IslandModel>& islands) : islands_(islands) {}

  void jumped_by_switches(const IslandAt& island, const model::Vector& now, const std::vector<std::string>& switches);
  /// W-jump-loses-energy.
  void hand_over(const RunEnd& end, Answer& answer) const;

 private:
  [[nodiscard]] std::string broken_currents(const model::StoreValues& stores, const model::Vector& before, const model::Vector& now) const;

  const std::vector<IslandModel>& islands_;
  std::map<std::size_t, model::StoreValues> stores_;
  std::string first_;  ///< in words
  std::size_t count_ = 0;
};

}  // namespace pwlsim::engine
