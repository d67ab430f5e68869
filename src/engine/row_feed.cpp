#include "engine/row_feed.hpp"

#include <algorithm>
#include <cmath>

namespace pwlsim::engine {

namespace {

constexpr double longest_wait = 0.1;  ///< s, of rows for their block to be full

double seconds_between(std::chrono::steady_clock::time_point from, std::chrono::steady_clock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

/// Rows of `width` values become rows of the first `kept` of them, in place.
void keep_columns(double* rows, std::size_t count, std::size_t width, std::size_t kept) {
  for (std::size_t row = 1; row < count && kept != width; ++row) std::copy_n(rows + row * width, kept, rows + row * kept);
}

}  // namespace

RowFeed::RowFeed(const Request& request, RowSink& sink, std::size_t signals, std::size_t rows_per_block, double tolerance)
    : request_(request), sink_(sink), width_(1 + signals), rows_per_block_(rows_per_block), tolerance_(tolerance) {
  if (request.grid.rows > 0 || request.events) rows_.resize(rows_per_block * width_);
  if (request.grid.rows > 0) next_time_ = first_time_ = request.grid.time(0);
}

bool RowFeed::is_due(double time, bool inclusive) const {
  if (next_row_ >= request_.grid.rows) return false;
  return inclusive ? next_time_ <= time : next_time_ < time - tolerance_;
}

RowFeed::Pushed RowFeed::push_next(RowSource& source) {
  Pushed pushed = Pushed::kept;
  if (std::abs(event_time_ - next_time_) > tolerance_) {
    source.row(next_time_, room());
    pushed = push();
    if (pushed == Pushed::refused) return pushed;
  }
  if (++next_row_ < request_.grid.rows) next_time_ = request_.grid.time(next_row_);
  return pushed;
}

double RowFeed::begin_event(double time) {
  const bool is_on_grid = next_row_ < request_.grid.rows && std::abs(next_time_ - time) <= tolerance_;
  event_time_ = is_on_grid ? next_time_ : time;
  return event_time_;
}

RowFeed::Pushed RowFeed::push() {
  ++count_;
  if (++buffered_ < rows_per_block_) return Pushed::kept;
  return flush() ? Pushed::handed_over : Pushed::refused;
}

bool RowFeed::flush() {
  if (buffered_ == 0) return true;
  const auto start = Clock::now();
  const std::size_t columns = width_ - request_.unsaved_signals;
  keep_columns(rows_.data(), buffered_, width_, columns);
  const bool accepted = sink_.write({rows_.data(), buffered_ * columns}, buffered_);
  last_flush_ = Clock::now();
  seconds_ += seconds_between(start, last_flush_);
  buffered_ = 0;
  return accepted;
}

bool RowFeed::flush_in_time() { return buffered_ == 0 || seconds_between(last_flush_, Clock::now()) < longest_wait || flush(); }

}  // namespace pwlsim::engine
