#include "engine/threshold_watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace pwlsim::engine {
namespace {

/// Of a control's own size: what moves less is the ripple of a supply, not a signal that should switch.
constexpr double least_swing = 0.1;
/// Lines of a clock that are looked at: of a switch that changes, enough to find a level at which it rests in each period; of one that does not, the range of
/// all of them is needed.
constexpr std::size_t some_lines = 24, all_lines = 1'000'000;
/// Messages of one kind; switches behind them are named in the last.
constexpr std::size_t most_messages = 8;

/// One message a switch, and what is too many in one.
void append(std::vector<Remark>& remarks, const std::string& id, const std::vector<std::pair<std::string, std::string>>& texts) {
  for (std::size_t k = 0; k < std::min(texts.size(), most_messages); ++k) remarks.push_back({id, texts[k].second});
  if (texts.size() <= most_messages) return;
  std::string names = texts[most_messages].first;
  for (std::size_t k = most_messages + 1; k < std::min(texts.size(), 2 * most_messages); ++k) names += ", " + texts[k].first;
  const std::size_t more = texts.size() - std::min(texts.size(), 2 * most_messages);
  remarks.push_back({id, fmt::format("the same holds for {}{}", names, more > 0 ? fmt::format(" and {} more", more) : "")});
}

}  // namespace

std::vector<WatchedSwitch> watched_switches(const model::Network& network) {
  std::vector<WatchedSwitch> result;
  for (const model::Switch& s : network.switches) result.push_back({s.label.name, s.on_level, s.off_level, s.written});
  return result;
}

ThresholdWatch::ThresholdWatch(const std::vector<WatchedSwitch>& switches, double stop)
    : switches_(switches), stop_(stop), stories_(switches.size()) {
  for (const WatchedSwitch& s : switches) open_ += static_cast<std::size_t>(s.written.has_value());
}

void ThresholdWatch::see(int number, double value) {
  Story& story = of(number);
  story.least = std::min(story.least, value);
  story.most = std::max(story.most, value);
}

std::optional<double> ThresholdWatch::threshold_at(int number, double value, double noise) const {
  const WatchedSwitch& s = switches_[static_cast<std::size_t>(number)];
  for (const double threshold : {s.on_threshold(), s.off_threshold()})
    if (std::abs(value - threshold) <= noise) return threshold;
  return std::nullopt;
}

void ThresholdWatch::rests(int number, double threshold, double time) {
  of(number).rest_time = time;
  of(number).rest_threshold = threshold;
}

void ThresholdWatch::changed(int number) { of(number).changed = true; }

void ThresholdWatch::trace(const model::Clock& clock, int number) {
  if (!is_open(number)) return;
  clock.trace(stop_, of(number).changed ? some_lines : all_lines, [&](const model::Clock::Line& line) {
    see(number, line.first);
    see(number, line.last);
    if (!line.is_flat || !asks_rest(number)) return;
    const double noise = line.noise + model::threshold_noise * std::abs(line.first);
    if (const auto threshold = threshold_at(number, line.first, noise)) rests(number, *threshold, line.from);
  });
}

std::string ThresholdWatch::rest_text(std::size_t number) const {
  const WatchedSwitch& s = switches_[number];
  const Story& story = stories_[number];
  const bool is_on_threshold = story.rest_threshold == s.on_threshold();
  const char* what = s.on_threshold() == s.off_threshold() ? "the switch is off there"
                     : s.written->reach == 0.0             ? "the switch keeps its position there"
                     : is_on_threshold                     ? "the switch is on there"
                                                           : "the switch is off there";
  return fmt::format(
      "the control of {} stops at its threshold of {:.6g} {} at t = {:.6g} s: {}; try a threshold between the levels of the control",
      s.name, s.written->sense * story.rest_threshold + 0.0, s.written->unit, story.rest_time, what);
}

std::string ThresholdWatch::range_text(std::size_t number, bool is_on) const {
  const WatchedSwitch& s = switches_[number];
  const Story& story = stories_[number];
  const double one = s.written->sense * story.least, other = s.written->sense * story.most;
  return fmt::format(
      "{} is {} for the whole run: its control moves between about {:.3g} and {:.3g} {} and never crosses the threshold of {:.6g} {}",
      s.name, is_on ? "on" : "off", std::min(one, other) + 0.0, std::max(one, other) + 0.0, s.written->unit,
      s.written->sense * (is_on ? s.off_threshold() : s.on_threshold()) + 0.0, s.written->unit);
}

bool ThresholdWatch::moves_in_vain(std::size_t number) const {
  const Story& story = stories_[number];
  return !story.changed && story.most - story.least > least_swing * std::max(std::abs(story.most), std::abs(story.least));
}

std::vector<Remark> ThresholdWatch::remarks(const std::vector<char>& is_on, bool completed) const {
  std::vector<std::pair<std::string, std::string>> at_rest, in_vain;
  for (std::size_t k = 0; k < switches_.size(); ++k) {
    if (!switches_[k].written) continue;
    if (!std::isnan(stories_[k].rest_time)) at_rest.emplace_back(switches_[k].name, rest_text(k));
    if (completed && moves_in_vain(k)) in_vain.emplace_back(switches_[k].name, range_text(k, is_on[k] != 0));
  }
  std::vector<Remark> remarks;
  append(remarks, "W-switch-at-threshold", at_rest);
  append(remarks, "N-never-switches", in_vain);
  return remarks;
}

}  // namespace pwlsim::engine
