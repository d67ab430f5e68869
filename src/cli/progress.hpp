#pragma once
/// A progress bar on standard error.

#include <chrono>
#include <string>

namespace pwlsim::cli {

class Progress {
 public:
  /// Shows nothing unless `wanted` and standard error is a terminal. `stop`: the time at which the bar is full, seconds.
  Progress(bool wanted, double stop);
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  /// Clears the bar.
  ~Progress();

  [[nodiscard]] bool shown() const { return shown_; }
  /// Cheap; redraws at most ten times a second, and not in the first tenth.
  void reached(double time);
  /// The same for a bar that counts runs.
  void finished(double runs);
  /// The same for a bar that shows the used part of a budget of seconds.
  void spent(double seconds);

 private:
  [[nodiscard]] bool is_due() const;
  void draw(double reached, const std::string& text);
  using Clock = std::chrono::steady_clock;
  bool shown_;
  bool drawn_ = false;
  double stop_;
  Clock::time_point start_, next_;
};

}  // namespace pwlsim::cli
