#pragma once
/// Switches that drive each other.

#include <cstddef>
#include <set>
#include <vector>

namespace pwlsim::engine {

/// At an operating point: they change together until their positions repeat, then one by one.
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

/// At one instant of a run: rounds until none changes any more, and which do not stop where there is no end.
class InstantRounds {
 public:
  /// False: there were too many.
  bool next() { return ++round_ <= most_rounds; }
  /// In the second half of them only those change that keep toggling.
  [[nodiscard]] bool is_late() const { return 2 * round_ > most_rounds; }
  void note_late(std::size_t number) { restless_.insert(number); }
  [[nodiscard]] const std::set<std::size_t>& restless() const { return restless_; }

 private:
  static constexpr int most_rounds = 200;  ///< logic has long chains
  int round_ = 0;
  std::set<std::size_t> restless_;
};

}  // namespace pwlsim::engine
