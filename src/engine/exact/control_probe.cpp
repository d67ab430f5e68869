#include "engine/exact/control_probe.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/exact/guard_watch.hpp"
#include "engine/exact/tolerances.hpp"
#include "model/mode.hpp"

namespace pwlsim::engine {
namespace {

/// Samples of a segment, so many a unit of rate·length: the range of what rings is right to a few percent, that of sinusoids from sources alone to 2·10⁻⁴. They
/// cost as much as a row each, so a run has only so many.
constexpr double samples_per_unit = 2.0, most_samples = 48.0, most_samples_of_sources = 256.0;
constexpr std::uint64_t most_samples_of_run = 2048;
/// Places that never fall into step with a period: multiples of the golden section.
constexpr double golden = 0.6180339887498949;

}  // namespace

double ControlProbe::value(const model::System& system, std::size_t control, const std::vector<double>& y) const {
  const int row = system.diodes + 2 * static_cast<int>(control);
  return linalg::row_times(segment_->mode->guards, row, y.data()) + system.controls[control].off_level;
}

void ControlProbe::go_to(double tau) {
  const auto ny = static_cast<std::size_t>(segment_->mode->ny);
  std::copy_n(segment_->y0.begin(), ny, y_.begin());
  segment_->mode->flow.apply_once(tau, y_.data(), work_.data());
}

void ControlProbe::hand_over(const RunEnd& end, Answer& answer) {
  for (const model::Clock& clock : end.clocks) watch_.trace(clock, clock.driven());
  for (Remark& remark : watch_.remarks(end.on, answer.outcome == Outcome::completed)) answer.remarks.push_back(std::move(remark));
}

/// The segment at hand ends.
void ControlProbe::look(const IslandAt& island) {
  const model::System& system = island.run.system();
  const Segment& segment = island.run.segment();
  const double length = (island.time - segment.anchor) - segment.late;
  if (system.controls.empty() || segment.mode == nullptr || segment.mode->ny == 0 || !(length > 0.0)) return;
  segment_ = &segment;
  const auto wants = [&](const model::Control& control) { return watch_.asks_range(control.driven) || watch_.asks_rest(control.driven); };
  if (std::none_of(system.controls.begin(), system.controls.end(), wants)) return;
  y_.resize(static_cast<std::size_t>(segment.mode->ny));
  work_.resize(2 * y_.size());
  bool asks_range = false;
  for (std::size_t i = 0; i < system.controls.size(); ++i) {
    const int number = system.controls[i].driven;
    if (watch_.asks_rest(number)) look_for_rest(system, i, length);
    asks_range |= watch_.asks_range(number);
  }
  if (!asks_range) return;
  const double most = system.n == 0 ? most_samples_of_sources : most_samples;
  const double inside =
      samples_ < most_samples_of_run ? std::min(most, std::floor(samples_per_unit * segment.mode->flow.rate() * length)) : 0.0;
  for (double k = 0.0; k <= inside + 1.0; ++k) {  // the begin, points inside, the end
    go_to(k == inside + 1.0 ? length : length * (k * golden - std::floor(k * golden)));
    ++samples_;
    for (std::size_t i = 0; i < system.controls.size(); ++i)
      if (watch_.asks_range(system.controls[i].driven)) watch_.see(system.controls[i].driven, value(system, i, y_));
  }
}

/// At a threshold at the begin, inside and at the end.
void ControlProbe::look_for_rest(const model::System& system, std::size_t control, double length) {
  const model::Mode& mode = *segment_->mode;
  if (!(length > tolerance::brief_rest * watch_.stop())) return;
  const int row = system.diodes + 2 * static_cast<int>(control), number = system.controls[control].driven;
  const auto noise = [&](const std::vector<double>& y) {
    return rounding_levels * mode.guard_noise[row] * mode.guard_norm[row] * linalg::norm(y.data(), mode.ny);
  };
  const auto threshold = watch_.threshold_at(number, value(system, control, segment_->y0), noise(segment_->y0));
  if (!threshold) return;
  for (const double share : {golden, 1.0 - golden * golden * golden, 1.0}) {
    go_to(share * length);
    if (std::abs(value(system, control, y_) - *threshold) > noise(y_)) return;
  }
  watch_.rests(number, *threshold, segment_->anchor);
}

}  // namespace pwlsim::engine
