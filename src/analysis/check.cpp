#include "analysis/check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "analysis/prepared_engine.hpp"
#include "analysis/quantity.hpp"
#include "analysis/sampling.hpp"
#include "base/remainder.hpp"

namespace pwlsim::analysis {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double first_tolerance = 1e-4, last_tolerance = 1e-9, refinement = 0.1;
/// Of a row step: how far from a row its neighbours are looked at, the near ones first. Between a decay that one engine follows and the other takes for a jump and the far ones a signal moves on.
constexpr std::array beside_event{1e-6, 1e-3};
constexpr double safety = 2.0;          ///< of estimated errors
constexpr double rounding = 1e-9;       ///< of a signal's, or its unit's, largest value
constexpr double target = 1e-5;         ///< an agreement within such an error is not refined further
constexpr double loosest = 1e-3;        ///< an agreement within a larger error tells nothing
constexpr double converged_by = 10.0;   ///< a difference is one where the error is smaller by that
constexpr double tolerances_off = 100;  ///< that a sparse run may be off

/// The times of the other engine's events.
class EventTimes : public engine::EventWatcher {
 public:
  void begin(std::span<const std::string>, std::span<const char>) override {}
  void happened(const engine::Event& event, std::span<const char>) override {
    if (times_.empty() || event.time > times_.back()) times_.push_back(event.time);
  }
  /// The start counts: states may jump there.
  [[nodiscard]] bool any_within(double from, double to) const {
    const auto next = std::lower_bound(times_.begin(), times_.end(), from);
    return from <= 0.0 || (next != times_.end() && *next <= to);
  }

 private:
  std::vector<double> times_;
};

/// A run of the other engine: each signal at each row and on both sides of it.
struct Level {
  SampledRun run;
  EventTimes events;
};

struct Distance {
  double size = 0.0, time = 0.0;
};

class Checker {
 public:
  Checker(const circuit::Compiled& compiled, const KeptRows& rows, const CheckSettings& settings)
      : compiled_(compiled), rows_(rows), settings_(settings) {
    place_samples();
    measure_scales();
  }

  Check run() {
    check_.rows = rows_.rows();
    if (rows_.rows() == 0 || rows_.signals() == 0) {
      check_.reason = "the run has no values to compare";
      return std::move(check_);
    }
    if (settings_.engine == "sparse")
      check_sparse();
    else
      check_exact();
    conclude();
    return std::move(check_);
  }

 private:
  void place_samples();
  void measure_scales();
  [[nodiscard]] double elapsed() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
  bool simulate(EngineChoice choice, double reltol);
  void take(Level level);
  [[nodiscard]] bool is_beside_event(const Level& level, std::size_t row) const;
  template <class Value>
  [[nodiscard]] Distance largest_distance(const Level& level, std::size_t signal, const Value& value) const;
  void check_exact();
  void check_sparse();
  void judge_by_errors();
  void judge_by_tolerance();
  void conclude();
  [[nodiscard]] std::string no_verdict() const;

  const circuit::Compiled& compiled_;
  const KeptRows& rows_;
  const CheckSettings& settings_;
  const Clock::time_point start_ = Clock::now();
  std::vector<double> times_;                   ///< of the samples
  std::vector<std::size_t> at_;                 ///< of a row: its sample
  std::vector<std::vector<std::size_t>> near_;  ///< of a row: samples beside it
  double window_ = 0.0;                         ///< s
  std::vector<double> scale_, noise_;           ///< of each signal; noise relative to its scale
  std::optional<Level> level_;                  ///< the finest
  std::vector<std::vector<double>> changes_;    ///< of each signal, from level to level, relative
  std::vector<bool> apart_;                     ///< at the finest level
  Check check_;
};

void Checker::place_samples() {
  const std::size_t count = rows_.rows();
  const double stop = compiled_.analyses.transient->stop.seconds;
  double step = stop;
  for (std::size_t row = 1; row < count; ++row) step = std::min(step, rows_.time(row) - rows_.time(row - 1));
  window_ = beside_event.back() * step;
  const auto add = [&](double time) {
    if (times_.empty() || time > times_.back()) times_.push_back(time);
    return times_.size() - 1;
  };
  for (std::size_t row = 0; row < count; ++row) {
    const double time = rows_.time(row);
    std::vector<std::size_t> near;
    for (auto share = beside_event.rbegin(); share != beside_event.rend(); ++share)
      near.push_back(add(std::max(0.0, time - *share * step)));
    at_.push_back(add(time));
    for (const double share : beside_event) near.push_back(add(std::min(stop, time + share * step)));
    near_.push_back(std::move(near));
  }
}

void Checker::measure_scales() {
  std::map<std::string_view, double> largest_of_unit;
  for (std::size_t signal = 0; signal < rows_.signals(); ++signal) {
    double largest = 0.0;
    for (std::size_t row = 0; row < rows_.rows(); ++row) largest = std::max(largest, std::abs(rows_.value(row, signal)));
    double& of_unit = largest_of_unit[unit_of_signal(compiled_.network.signals[signal].name)];
    of_unit = std::max(of_unit, largest);
    scale_.push_back(largest);
  }
  for (std::size_t signal = 0; signal < rows_.signals(); ++signal) {
    const double of_unit = largest_of_unit[unit_of_signal(compiled_.network.signals[signal].name)];
    if (scale_[signal] <= rounding * of_unit) scale_[signal] = of_unit;  // nothing but rounding, or zero
    if (scale_[signal] == 0.0) scale_[signal] = 1.0;
    noise_.push_back(rounding * std::max(1.0, of_unit / scale_[signal]));
  }
  changes_.resize(rows_.signals());
}

/// False where it did not reach the end.
bool Checker::simulate(EngineChoice choice, double reltol) {
  const auto start = Clock::now();
  Level level;
  check_.levels.push_back({choice == EngineChoice::exact ? "exact" : "sparse", choice == EngineChoice::exact ? 0.0 : reltol, 0.0, ""});
  CheckLevel& told = check_.levels.back();
  std::atomic<int> stop = 0;
  const auto is_late = [&] {
    return elapsed() > settings_.seconds || (settings_.interrupt != nullptr && settings_.interrupt->load() != 0);
  };
  RunControl control;
  control.progress = [&](double) { stop = is_late() ? 1 : 0; };
  control.interrupt = &stop;
  control.watcher = &level.events;
  Diagnostics diagnostics;
  const PreparedEngine engine = prepare_engine(compiled_.network, choice, reltol, diagnostics);
  if (engine.simulate) {
    level.run = sample(compiled_.analyses, compiled_.network.signals.size(), engine.simulate, times_, control);
    const engine::Answer& answer = level.run.answer;
    if (answer.outcome == engine::Outcome::interrupted)
      told.failure = fmt::format("the time for the check, {} s, was used up", settings_.seconds);
    else if (answer.outcome != engine::Outcome::completed)
      told.failure = fmt::format("{}: {}", answer.id, answer.message);
  } else {
    told.failure =
        diagnostics.all().empty() ? "no model" : fmt::format("{}: {}", diagnostics.all().front().id, diagnostics.all().front().text);
  }
  told.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  if (!told.failure.empty()) return false;
  take(std::move(level));
  return true;
}

void Checker::take(Level level) {
  for (std::size_t signal = 0; signal < rows_.signals() && level_; ++signal) {
    const std::vector<double>& values = level.run.columns[signal];
    changes_[signal].push_back(largest_distance(*level_, signal, [&](std::size_t row) { return values[at_[row]]; }).size);
  }
  level_ = std::move(level);
}

bool Checker::is_beside_event(const Level& level, std::size_t row) const {
  return level.events.any_within(rows_.time(row) - 2.0 * window_, rows_.time(row) + 2.0 * window_);
}

/// Of `value(row)` from the level's, relative to the signal's scale.
template <class Value>
Distance Checker::largest_distance(const Level& level, std::size_t signal, const Value& value) const {
  Distance largest;
  const std::vector<double>& values = level.run.columns[signal];
  for (std::size_t row = 0; row < rows_.rows(); ++row) {
    const double here = value(row);
    double low = values[at_[row]], high = low;
    if (here != low && is_beside_event(level, row))
      for (const std::size_t sample : near_[row]) {
        low = std::min(low, values[sample]);
        high = std::max(high, values[sample]);
      }
    const double distance = std::max(low - here, here - high) / scale_[signal];
    if (distance > largest.size) largest = {distance, rows_.time(row)};
  }
  return largest;
}

void Checker::check_exact() {
  for (double reltol = first_tolerance; reltol > 0.5 * last_tolerance; reltol *= refinement) {
    if (!simulate(EngineChoice::sparse, reltol)) break;
    judge_by_errors();
    const bool done = std::all_of(check_.signals.begin(), check_.signals.end(), [](const CheckedSignal& signal) {
      return signal.agreement == Agreement::differs || (signal.agreement == Agreement::agrees && signal.error <= target);
    });
    if (done) break;
  }
}

/// The signals as the finest level has them. One small change among large ones is chance: what differs must do so at two levels one after the other.
void Checker::judge_by_errors() {
  const double reltol = check_.levels.back().reltol;
  std::vector<bool> differed = std::exchange(apart_, std::vector<bool>(rows_.signals(), false));
  differed.resize(rows_.signals());
  check_.signals.clear();
  for (std::size_t k = 0; k < rows_.signals(); ++k) {
    const Distance difference = largest_distance(*level_, k, [&](std::size_t row) { return rows_.value(row, k); });
    CheckedSignal signal{compiled_.network.signals[k].name,
                         scale_[k],
                         difference.size,
                         difference.time,
                         std::max(reltol, remainder_after(changes_[k]).size),
                         Agreement::undecided};
    const bool is_within = signal.difference <= safety * signal.error + noise_[k];
    apart_[k] = !is_within && signal.error <= signal.difference / converged_by;
    if (is_within && signal.error <= loosest) signal.agreement = Agreement::agrees;
    if (apart_[k] && differed[k]) signal.agreement = Agreement::differs;
    check_.signals.push_back(std::move(signal));
  }
}

void Checker::check_sparse() {
  Diagnostics unused;
  const bool is_small = prepare_engine(compiled_.network, EngineChoice::automatic, first_tolerance, unused).name == "exact";
  if (is_small) {
    if (simulate(EngineChoice::exact, 0.0)) judge_by_tolerance();
    return;
  }
  for (double reltol = settings_.reltol * refinement; reltol > 0.5 * refinement * refinement * settings_.reltol; reltol *= refinement) {
    if (!simulate(EngineChoice::sparse, reltol)) return;
    judge_by_tolerance();
  }
}

void Checker::judge_by_tolerance() {
  check_.signals.clear();
  for (std::size_t k = 0; k < rows_.signals(); ++k) {
    const Distance difference = largest_distance(*level_, k, [&](std::size_t row) { return rows_.value(row, k); });
    const bool agrees = difference.size <= tolerances_off * settings_.reltol + noise_[k];
    check_.signals.push_back({compiled_.network.signals[k].name, scale_[k], difference.size, difference.time,
                              changes_[k].empty() ? 0.0 : remainder_after(changes_[k]).size,
                              agrees ? Agreement::agrees : Agreement::differs});
  }
}

std::string relative_size(double size) {
  if (!std::isfinite(size)) return "an unknown amount";
  return size < 1e-3 ? fmt::format("{:.1e}", size) : fmt::format("{:.3g} %", 100.0 * size);
}

std::string Checker::no_verdict() const {
  const CheckLevel& last = check_.levels.back();
  if (check_.signals.empty()) return fmt::format("the {} engine did not reach the end: {}", last.engine, last.failure);
  const CheckedSignal* worst = nullptr;
  for (const CheckedSignal& signal : check_.signals)
    if (signal.agreement == Agreement::undecided && (worst == nullptr || signal.difference > worst->difference)) worst = &signal;
  return fmt::format(
      "{} differs by {} of its maximum at t = {}, and the sparse engine has not converged (its own error is estimated to be {}){}",
      worst->name, relative_size(worst->difference), quantity(worst->time, "s"), relative_size(worst->error),
      last.failure.empty() ? "" : "; " + last.failure);
}

void Checker::conclude() {
  const auto has = [&](Agreement agreement) {
    return std::any_of(check_.signals.begin(), check_.signals.end(), [=](const CheckedSignal& s) { return s.agreement == agreement; });
  };
  if (check_.signals.empty() || (has(Agreement::undecided) && !has(Agreement::differs))) {
    check_.reason = no_verdict();
    return;
  }
  check_.agreement = has(Agreement::differs) ? Agreement::differs : Agreement::agrees;
  const auto worst = std::max_element(check_.signals.begin(), check_.signals.end(), [&](const CheckedSignal& a, const CheckedSignal& b) {
    return std::pair(a.agreement == check_.agreement, a.difference) < std::pair(b.agreement == check_.agreement, b.difference);
  });
  const auto level = std::find_if(check_.levels.rbegin(), check_.levels.rend(), [](const CheckLevel& l) { return l.failure.empty(); });
  const std::string by = level->reltol == 0.0 ? "the exact engine" : fmt::format("the sparse engine at reltol {:.0e}", level->reltol);
  const bool differs = check_.agreement == Agreement::differs;
  const std::string bound = settings_.engine == "sparse" ? fmt::format("{} a hundred times the tolerance of this run ({:.0e})",
                                                                       differs ? "more than" : "within", settings_.reltol)
                            : differs                    ? fmt::format("which has converged to {}", relative_size(worst->error))
                                      : fmt::format("within its own error, estimated to be {}", relative_size(worst->error));
  check_.reason = fmt::format("{} {} by {} of its maximum at t = {} from {}, {}", worst->name, differs ? "differs" : "differs at most",
                              relative_size(worst->difference), quantity(worst->time, "s"), by, bound);
}

}  // namespace

Check check_run(const circuit::Compiled& compiled, const KeptRows& rows, const CheckSettings& settings) {
  return Checker(compiled, rows, settings).run();
}

}  // namespace pwlsim::analysis
