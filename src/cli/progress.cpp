#include "cli/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <string>

#include "analysis/quantity.hpp"
#include "waveform/output_file.hpp"

namespace pwlsim::cli {
namespace {

constexpr auto redraw_interval = std::chrono::milliseconds(100);
constexpr int bar_width = 30;

void to_terminal(const std::string& text) {
  std::size_t written = 0;
  (void)waveform::write_all(STDERR_FILENO, text, written);
}

}  // namespace

Progress::Progress(bool wanted, double stop)
    : shown_(wanted && ::isatty(STDERR_FILENO) == 1), stop_(stop), start_(Clock::now()), next_(start_ + redraw_interval) {}

Progress::~Progress() {
  if (drawn_) to_terminal("\r\x1b[K");
}

void Progress::reached(double time) {
  if (is_due()) draw(time, fmt::format("t = {}", analysis::quantity(time, "s", 4)));
}

void Progress::finished(double runs) {
  if (is_due()) draw(runs, fmt::format("{} of {} runs", runs, stop_));
}

void Progress::spent(double seconds) {
  if (is_due()) draw(seconds, "ngspice runs");
}

bool Progress::is_due() const { return shown_ && Clock::now() >= next_; }

void Progress::draw(double reached, const std::string& text) {
  const auto now = Clock::now();
  next_ = now + redraw_interval;
  drawn_ = true;
  const double part = std::clamp(reached / stop_, 0.0, 1.0);
  const int full = static_cast<int>(part * bar_width);
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  to_terminal(fmt::format("\r[{:#<{}}{:-<{}}] {:3.0f} %  {}, {:.0f} s to go\x1b[K", "", full, "", bar_width - full, 100.0 * part, text,
                          part > 0.0 ? elapsed * (1.0 - part) / part : 0.0));
}

}  // namespace pwlsim::cli
