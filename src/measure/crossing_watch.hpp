#pragma once
/// Counts the zero crossings of an expression.
///
/// A crossing is a change of side, also by a jump. A value that reaches zero and stays there has crossed; leaving to the other side is then not a second crossing,
/// but leaving to the side that it came from is one. A value that starts at zero has not crossed.

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
  /// The expression on the next interval. Calls `passed(time)` at the requested crossing; for the last one, at each so far.
  /// `noise`: smaller values count as zero.
  void take(const PolynomialPart& part, double noise, const std::function<void(double)>& passed);
  /// The value at the end: a value that reaches zero there to rounding has crossed.
  void finish(double value, double noise, double time, const std::function<void(double)>& passed);
  /// Whether all requested crossings are found.
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
