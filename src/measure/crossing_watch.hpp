#pragma once
/// Counts the passages of an expression through zero.
///
/// A passage is a change of side, also by a jump. What arrives at zero and rests there has passed; leaving to the other side is then no second passage,
/// and leaving to where it came from is one. What starts at zero has not passed it.

#include <cstdint>
#include <functional>

#include "circuit/measurement.hpp"
#include "measure/piece_view.hpp"

namespace pwlsim::measure {

class CrossingWatch {
 public:
  CrossingWatch() = default;
  CrossingWatch(circuit::Edge edge, std::uint64_t count, bool last) : edge_(edge), count_(count), last_(last) {}

  /// The side before the search begins.
  void start(double value, double noise);
  /// The expression on the next part of time. `passed(time)` is called at the passage that is asked for; of the last one, at each so far.
  /// `noise`: what is smaller counts as zero.
  void take(const Part& part, double noise, const std::function<void(double)>& passed);
  /// The value at the end: what arrives there to rounding has passed.
  void finish(double value, double noise, double time, const std::function<void(double)>& passed);
  /// Nothing more is to be found.
  [[nodiscard]] bool is_done() const { return !last_ && seen_ >= count_; }
  [[nodiscard]] std::uint64_t seen() const { return seen_; }

 private:
  enum class Side { unknown, below, above, at_from_below, at_from_above, at_start };
  void side(int sign, double time, const std::function<void(double)>& passed);
  void pass(bool rises, double time, const std::function<void(double)>& passed);

  circuit::Edge edge_ = circuit::Edge::any;
  std::uint64_t count_ = 1;
  bool last_ = false;
  std::uint64_t seen_ = 0;
  Side side_ = Side::unknown;
};

}  // namespace pwlsim::measure
