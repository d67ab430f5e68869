#pragma once
/// Settles switches that drive each other at an operating point: together until their positions repeat, then one by one.

#include <set>
#include <vector>

namespace pwlsim::engine {

class SwitchRounds {
 public:
  explicit SwitchRounds(std::size_t switches) : most_alone_(64 + 2 * switches) {}

  /// Else only the first of them changes sides, for a latch that would toggle forever.
  [[nodiscard]] bool together() const { return together_; }
  [[nodiscard]] bool exhausted() const { return alone_ > most_alone_; }
  /// After a round that led to these positions. True: from now on one by one.
  bool turns_to_one_by_one(const std::vector<char>& on) {
    constexpr std::size_t most_together = 1000;
    const bool was_together = together_;
    if (together_) together_ = seen_.insert(on).second && seen_.size() <= most_together;
    if (!together_) ++alone_;
    return was_together && !together_;
  }
  /// Their inputs have changed.
  void start_anew() { seen_.clear(); }

 private:
  std::size_t most_alone_, alone_ = 0;
  std::set<std::vector<char>> seen_;
  bool together_ = true;
};

}  // namespace pwlsim::engine
