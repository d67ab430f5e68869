#include "api/controllers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "analysis/quantity.hpp"
#include "api/messages.hpp"
#include "base/names.hpp"

namespace pwlsim::api {
namespace {

constexpr double same_rounding = 1e-15;  ///< of the time: the rounding of k·every + delay
constexpr double same_time = 1e-12;      ///< of the shortest sampling interval: two instants this close are one

std::size_t number_of(const model::Network& network, const std::string& name) {
  const auto found = std::find_if(network.signals.begin(), network.signals.end(),
                                  [&](const model::Signal& signal) { return same_name(signal.name, name); });
  if (found == network.signals.end())
    throw error("E-unknown-signal", fmt::format("'{}', the input of a controller, is not a signal", name));
  return static_cast<std::size_t>(found - network.signals.begin());
}

}  // namespace

Controllers::Controllers(const std::vector<Controller>& list, const model::Network& network)
    : kept_(std::make_shared<std::vector<double>>()) {
  int channel = 0;
  for (const Controller& controller : list) {
    Loop& loop = loops_.emplace_back();
    loop.controller = controller;
    for (const std::string& input : controller.inputs) loop.inputs.push_back(number_of(network, input));
    loop.seen.resize(loop.inputs.size());
    loop.first_channel = channel;
    channel += static_cast<int>(controller.outputs.size());
    loop.initial.resize(controller.outputs.size());
    for (const model::Source& source : network.sources) {
      const auto* const held = std::get_if<model::Held>(&source.function);
      if (held != nullptr && held->channel >= loop.first_channel && held->channel < channel)
        loop.initial[static_cast<std::size_t>(held->channel - loop.first_channel)] = held->value;
    }
  }
}

Controllers Controllers::repeating(const Controllers& first) {
  Controllers again = first;
  again.repeats_ = true;
  return again;
}

void Controllers::begin() {
  repeats_ |= std::exchange(began_, true);
  repeated_ = 0;
  pending_.clear();
  for (Loop& loop : loops_) {
    loop.calls = 0;
    loop.set = loop.initial;
  }
}

double Controllers::next() const {
  double time = pending_.empty() ? model::forever : pending_.front().time;
  for (const Loop& loop : loops_) time = std::min(time, loop.next());
  return time;
}

bool Controllers::sample(double time, std::span<const double> signals, std::vector<Setting>& settings) {
  const double now = std::max(time, next());
  double shortest = model::forever;
  for (const Loop& loop : loops_) shortest = std::min(shortest, loop.controller.every);
  const double due = now + same_time * shortest + same_rounding * now;
  for (; !pending_.empty() && pending_.front().time <= due; pending_.pop_front()) settings.push_back(pending_.front().setting);
  for (Loop& loop : loops_) {
    if (loop.next() > due) continue;
    if (!call(loop, signals)) return false;
    set(loop, loop.next(), settings);
    ++loop.calls;
  }
  return true;
}

void Controllers::check_finite(const Loop& loop) {
  for (std::size_t k = 0; k < loop.set.size(); ++k)
    if (!std::isfinite(loop.set[k])) throw std::domain_error(fmt::format("{} was set to {}", loop.controller.outputs[k], loop.set[k]));
}

/// False: it threw, or a run that is done again goes farther than the first one came.
bool Controllers::call(Loop& loop, std::span<const double> signals) {
  if (repeats_) {
    if (repeated_ == kept_->size()) return false;
    for (double& value : loop.set) value = (*kept_)[repeated_++];
    return true;
  }
  for (std::size_t k = 0; k < loop.inputs.size(); ++k) loop.seen[k] = signals[loop.inputs[k]];
  try {
    loop.controller.function(loop.next(), loop.seen, loop.set);
    loop.set.resize(loop.controller.outputs.size(), 0.0);
    check_finite(loop);
  } catch (...) {
    thrown_ = std::current_exception();
    return false;
  }
  kept_->insert(kept_->end(), loop.set.begin(), loop.set.end());
  return true;
}

void Controllers::set(const Loop& loop, double time, std::vector<Setting>& settings) {
  for (std::size_t k = 0; k < loop.set.size(); ++k) {
    const Setting setting{loop.first_channel + static_cast<int>(k), loop.set[k]};
    if (loop.controller.delay == 0.0) {
      settings.push_back(setting);
      continue;
    }
    const Pending later{time + loop.controller.delay, setting};
    const auto place =
        std::upper_bound(pending_.begin(), pending_.end(), later, [](const Pending& a, const Pending& b) { return a.time < b.time; });
    pending_.insert(place, later);
  }
}

std::string sentence_of(const std::exception_ptr& thrown, double time) {
  std::string what;
  try {
    std::rethrow_exception(thrown);
  } catch (const std::exception& exception) {
    const std::string_view text = exception.what();  // of Python with where it was thrown, line by line
    what = fmt::format(": {}", text.substr(0, text.find('\n')));
  } catch (...) {
  }
  return fmt::format("the function of a controller ended the run at t = {} by an exception{}", analysis::quantity(time, "s"), what);
}

}  // namespace pwlsim::api
