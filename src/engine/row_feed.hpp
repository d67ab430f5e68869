#pragma once
/// Rows of a run: those of the grid, pairs of rows around events, and blocks of them for the sink.

#include <chrono>
#include <cstdint>
#include <limits>
#include <vector>

#include "engine/run.hpp"

namespace pwlsim::engine {

/// Signals of the whole network at a time.
class RowSource {
 public:
  virtual ~RowSource() = default;
  /// Writes the time and all signals to `row`.
  virtual void row(double time, double* row) = 0;
};

class RowFeed {
 public:
  /// `signals`: number of signals of a row, including unsaved ones, which are removed. Instants closer than `tolerance`, s, are one.
  RowFeed(const Request& request, RowSink& sink, std::size_t signals, std::size_t rows_per_block, double tolerance);

  /// Whether the block of a row waits for more, went to the sink with it, or went there and was refused.
  enum class Pushed { kept, handed_over, refused };

  /// The next row of the grid; infinite after the last.
  [[nodiscard]] double next_time() const { return next_row_ < request_.grid.rows ? next_time_ : std::numeric_limits<double>::infinity(); }
  /// Whether the next row of the grid is due before `time`: one within rounding of it holds the values after it. At the end of a run (`inclusive`) the
  /// row at `time` is due, too.
  [[nodiscard]] bool is_due(double time, bool inclusive) const;
  /// Writes the next row of the grid, unless an event has written it.
  Pushed push_next(RowSource& source);

  /// Whether an event at `time` has rows.
  [[nodiscard]] bool has_event_rows(double time) const { return request_.events && time >= first_time_ - tolerance_; }
  /// The time that both rows of an event at `time` hold: that of the row of the grid, where there is one.
  double begin_event(double time);
  [[nodiscard]] double event_time() const { return event_time_; }

  /// Room for the next row; `push` takes what is in it.
  [[nodiscard]] double* room() { return &rows_[buffered_ * width_]; }
  [[nodiscard]] std::size_t width() const { return width_; }
  Pushed push();
  /// Passes on the waiting rows. False: the sink refuses them.
  bool flush();
  /// The same if rows have waited for 0.1 s, so that the rows of a large circuit are delivered before the run is ended from outside.
  bool flush_in_time();

  [[nodiscard]] std::uint64_t count() const { return count_; }
  /// Time spent in the sink.
  [[nodiscard]] double seconds() const { return seconds_; }

 private:
  using Clock = std::chrono::steady_clock;

  const Request& request_;
  RowSink& sink_;
  std::size_t width_, rows_per_block_;
  double tolerance_;
  std::vector<double> rows_;
  std::size_t buffered_ = 0;
  std::uint64_t next_row_ = 0, count_ = 0;
  double next_time_ = 0.0, first_time_ = 0.0;
  double event_time_ = -std::numeric_limits<double>::infinity();  ///< of the last rows of an event
  double seconds_ = 0.0;
  Clock::time_point last_flush_ = Clock::now();
};

}  // namespace pwlsim::engine
