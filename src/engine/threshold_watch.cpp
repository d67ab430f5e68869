#include "engine/threshold_watch.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <utility>

namespace pwlsim::engine {
namespace {

/// Of a control's own size: what moves less is the ripple of a supply, not a signal that should switch.
constexpr double least_swing = 0.1;
/// Of its distance from the threshold: what moves less is rounding of a control that rests.
constexpr double least_approach = 1e-9;
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

/// The node whose voltage closes the channel of a transistor when it rises (N) or falls (P); none of another switch.
std::optional<model::NodeIndex> gate_of(const model::Switch& channel) {
  if (!channel.written) return std::nullopt;
  for (const model::Term& term : channel.control)
    if (term.kind == model::Term::Kind::node_voltage && term.coefficient == channel.written->sense) return term.index;
  return std::nullopt;
}

void find_partners(const model::Network& network, std::vector<WatchedSwitch>& switches) {
  std::map<model::NodeIndex, std::vector<std::size_t>> n_channels;
  const auto visit = [&](double sense, const auto& take) {
    for (std::size_t k = 0; k < switches.size(); ++k) {
      const model::Switch& channel = network.switches[k];
      if (!channel.written || channel.written->sense != sense) continue;
      if (const auto gate = gate_of(channel)) take(k, *gate);
    }
  };
  const auto touch = [&](std::size_t a, std::size_t b) {
    const model::Switch &one = network.switches[a], &other = network.switches[b];
    return one.p == other.p || one.p == other.n || one.n == other.p || one.n == other.n;
  };
  visit(1.0, [&](std::size_t k, model::NodeIndex gate) { n_channels[gate].push_back(k); });
  visit(-1.0, [&](std::size_t k, model::NodeIndex gate) {
    for (const std::size_t other : n_channels[gate])
      if (touch(k, other)) switches[k].partner = static_cast<int>(other);
  });
}

}  // namespace

std::vector<WatchedSwitch> watched_switches(const model::Network& network) {
  std::vector<WatchedSwitch> result;
  for (const model::Switch& s : network.switches) result.push_back({s.label.name, s.on_level, s.off_level, s.written});
  find_partners(network, result);
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
  const WatchedSwitch& s = switches_[number];
  const double swing = story.most - story.least;
  const double distance = std::min(std::abs(s.on_threshold() - story.most), std::abs(story.least - s.off_threshold()));
  return !story.changed && swing > least_swing * std::max(std::abs(story.most), std::abs(story.least)) && swing > least_approach * distance;
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
  if (completed)
    for (Remark& remark : inverters_at_rest(is_on)) remarks.push_back(std::move(remark));
  return remarks;
}

std::vector<Remark> ThresholdWatch::inverters_at_rest(const std::vector<char>& is_on) const {
  std::vector<std::string> pairs;
  for (std::size_t k = 0; k < switches_.size(); ++k) {
    const int partner = switches_[k].partner;
    if (partner >= 0 && is_on[k] != 0 && is_on[static_cast<std::size_t>(partner)] != 0)
      pairs.push_back(fmt::format("{} and {}", switches_[static_cast<std::size_t>(partner)].name, switches_[k].name));
  }
  if (pairs.empty()) return {};
  const std::size_t more = pairs.size() - std::min(pairs.size(), most_messages);
  pairs.resize(pairs.size() - more);
  return {
      {"W-inverter-at-rest",
       fmt::format(
           "at the end of the run both transistors of an inverter are on, their gate between the thresholds: {}{}. Switches have no gain "
           "there, so a ring of inverters, or an amplifier made of them, rests where transistors would oscillate or amplify; try gates "
           "of LTspice's A devices or XSPICE's logic",
           fmt::join(pairs, ", "), more > 0 ? fmt::format(" and {} more", more) : "")}};
}

}  // namespace pwlsim::engine
