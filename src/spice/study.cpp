#include "spice/study.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace pwlsim::spice {
namespace {

using Clock = std::chrono::steady_clock;
using Samples = std::vector<std::vector<double>>;  // one row a signal

constexpr int most_levels = 6;
constexpr std::size_t least_levels = 3;
constexpr int most_failures = 2;  // one after the other
constexpr double first_reltol = 1e-3, first_steps = 1000.0;
constexpr double step_ratio = 2.0, tolerance_ratio = 4.0, sharpness_ratio = 4.0;
constexpr double share_of_attempt = 0.35;  // of the time that is left to a level: the rest is for those after it
constexpr double growth_of_time = 2.5;     // from one level to the next
constexpr double end_slack = 1e-9;         // of the run's length

double largest_magnitude(const std::vector<double>& values) {
  double result = 0.0;
  for (double value : values) result = std::max(result, std::abs(value));
  return result;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double result = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) result = std::max(result, std::abs(a[k] - b[k]));
  return result;
}

class Refinement {
 public:
  Refinement(const circuit::FlatCircuit& circuit, const std::string& program, const StudySettings& settings, Diagnostics& diagnostics)
      : circuit_(circuit), program_(program), settings_(settings), diagnostics_(diagnostics), start_(Clock::now()) {}

  Study run() {
    climb(false, 0.5 * settings_.seconds);
    steps_ = std::move(ladder_);
    ladder_.clear();
    if (!steps_.empty()) {
      ladder_.push_back(steps_.back());
      last_seconds_ = steps_seconds_;
      climb(true, settings_.seconds);
      if (ladder_.size() < least_levels) add_coarser();
      judge();
    }
    return std::move(study_);
  }

 private:
  double elapsed() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
  bool interrupted() const { return settings_.interrupt != nullptr && *settings_.interrupt != 0; }

  DeckSettings level_settings(bool smoothing, int k) const {
    DeckSettings deck = base_;
    if (smoothing) {
      deck.sharpness = std::clamp(settings_.sharpness / std::pow(sharpness_ratio, k), least_sharpness, largest_sharpness);
    } else {
      const circuit::TransientAnalysis& transient = *circuit_.analyses.transient;
      deck.sharpness = settings_.sharpness;
      deck.largest_step = (transient.stop.seconds - transient.start.seconds) / (first_steps * std::pow(step_ratio, k));
      deck.reltol = first_reltol / std::pow(tolerance_ratio, k);
    }
    deck.switching = true;
    deck.sample_times = settings_.sample_times;
    return deck;
  }

  void climb(bool smoothing, double budget) {
    int failures = 0;
    for (int k = smoothing ? 1 : 0; k < most_levels; ++k) {
      const double left = budget - elapsed();
      if (interrupted() || left < growth_of_time * last_seconds_ || left <= 0.0) return;
      const bool reached = attempt(smoothing, k, left);
      if (diagnostics_.has_errors()) return;
      failures = reached ? 0 : failures + 1;
      if (failures > 0 && (ladder_.size() > 1 || (smoothing && failures == most_failures))) return;
      if (reached && ladder_.size() >= least_levels && study_.levels.back().change <= settings_.target) return;
    }
  }

  /// Where smaller X fail, larger ones tell how the answer depends on it.
  void add_coarser() {
    for (int k = 1; ladder_.size() < least_levels && !interrupted() && elapsed() < settings_.seconds; ++k) {
      SmoothDeck deck = std::move(study_.finest);
      waveform::RawFile waveforms = std::move(study_.waveforms);
      const std::size_t level = study_.finest_level;
      const DeckSettings base = base_;
      std::vector<Samples> finer = std::move(ladder_);
      ladder_.clear();
      const bool reached = run_level(true, level_settings(true, -k), settings_.seconds - elapsed());
      study_.finest = std::move(deck);
      study_.waveforms = std::move(waveforms);
      study_.finest_level = level;
      base_ = base;
      if (reached && !finer.empty()) study_.levels.back().change = worst_change(ladder_.back(), finer.front());
      ladder_.insert(ladder_.end(), std::make_move_iterator(finer.begin()), std::make_move_iterator(finer.end()));
      if (!reached) return;
    }
  }

  /// All attempts share the time.
  bool attempt(bool smoothing, int k, double seconds) {
    const auto begin = Clock::now();
    const std::vector<DeckSettings> list = attempts_from(smoothing, level_settings(smoothing, k));
    for (const DeckSettings& deck : list) {
      const double left = seconds - std::chrono::duration<double>(Clock::now() - begin).count();
      if (left <= 0.0) return false;
      const bool is_proven = !ladder_.empty() && &deck == &list.front();  // it ran on the level before
      if (run_level(smoothing, deck, is_proven ? left : share_of_attempt * left)) return true;
      if (diagnostics_.has_errors() || interrupted()) return false;
    }
    return false;
  }

  /// What a level is tried with until one reaches its end: what the level before ran with, then Gear's method; where there is
  /// no answer yet also with a small R–C across the contacts.
  std::vector<DeckSettings> attempts_from(bool smoothing, const DeckSettings& first) const {
    std::vector<DeckSettings> list{first};
    const auto add = [&](bool gear, const Snubber& snubber) {
      list.push_back(first);
      list.back().gear = gear;
      list.back().snubber = snubber;
    };
    if (first.snubber.impedance > 0.0) return list;  // by another method what rings would have another answer
    if (!first.gear) add(true, first.snubber);
    const bool has_answer = smoothing || ladder_.size() > 1;
    if (has_answer || settings_.snubber.impedance <= 0.0) return list;
    add(false, settings_.snubber);
    add(true, settings_.snubber);
    return list;
  }

  bool run_level(bool smoothing, const DeckSettings& settings, double seconds) {
    auto deck = smooth_deck(circuit_, settings, diagnostics_);
    if (!deck) return false;
    Level level;
    level.smoothing = smoothing;
    level.deck = settings;
    const auto begin = Clock::now();
    if (settings_.watcher) settings_.watcher(elapsed());
    NgspiceRun run = run_ngspice(program_, deck->text, {seconds, settings_.interrupt});
    const double took = std::chrono::duration<double>(Clock::now() - begin).count();
    level.seconds = run.seconds;
    level.points = run.raw ? run.raw->rows() : 0;
    Samples samples;
    level.failure = failure_of(run, *deck, samples);
    const bool good = level.failure.empty();
    if (good && !ladder_.empty() && settings.snubber.impedance == base_.snubber.impedance)
      level.change = worst_change(ladder_.back(), samples);
    study_.levels.push_back(std::move(level));
    if (!good) return false;
    study_.finest_level = study_.levels.size() - 1;
    last_seconds_ = took;
    if (!smoothing) steps_seconds_ = took;
    if (settings.snubber.impedance != base_.snubber.impedance) ladder_.clear();  // it is another circuit
    base_ = settings;
    ladder_.push_back(std::move(samples));
    study_.finest = std::move(*deck);
    study_.waveforms = std::move(*run.raw);
    return true;
  }

  /// "" where the run reached its end; then `samples` are filled.
  std::string failure_of(const NgspiceRun& run, const SmoothDeck& deck, Samples& samples) const {
    const std::string words = run.words.empty() ? "" : ": " + run.words;
    if (!run.raw || run.raw->rows() == 0) return "no waveforms" + words;
    const double stop = circuit_.analyses.transient->stop.seconds;
    const double reached = run.raw->at(run.raw->rows() - 1, 0);
    if (!(reached >= stop * (1.0 - end_slack))) return fmt::format("ended at t = {:.6g} s{}", reached, words);
    if (!run.ended) return "did not end well" + words;
    for (const SignalVectors& signal : deck.signals) {
      const SignalReader reader(*run.raw, signal);
      if (!reader.known()) return fmt::format("{} is not in its file{}", signal.name, words);
      std::vector<double>& row = samples.emplace_back();
      for (double time : settings_.sample_times) row.push_back(reader.at(time));
      if (!std::isfinite(largest_magnitude(row))) return fmt::format("{} is not finite{}", signal.name, words);
    }
    return "";
  }

  static double worst_change(const Samples& before, const Samples& after) {
    double worst = 0.0;
    for (std::size_t k = 0; k < after.size(); ++k) {
      const double scale = largest_magnitude(after[k]);
      if (scale > 0.0) worst = std::max(worst, largest_difference(before[k], after[k]) / scale);
    }
    return worst;
  }

  static Remainder remainder_of(const std::vector<Samples>& ladder, std::size_t signal) {
    std::vector<double> changes;
    for (std::size_t k = 1; k < ladder.size(); ++k) changes.push_back(largest_difference(ladder[k - 1][signal], ladder[k][signal]));
    return remainder_after(changes);
  }

  void judge() {
    for (std::size_t k = 0; k < study_.finest.signals.size(); ++k) {
      SignalStudy signal;
      signal.name = study_.finest.signals[k].name;
      signal.values = ladder_.back()[k];
      signal.scale = largest_magnitude(signal.values);
      const Remainder discretisation = remainder_of(steps_, k), smoothing = remainder_of(ladder_, k);
      signal.discretisation = discretisation.size;
      signal.smoothing = smoothing.size;
      const auto settled = [&](const Remainder& r) { return r.geometric || r.size <= settings_.target * signal.scale; };
      signal.settled = settled(discretisation) && settled(smoothing);
      study_.signals.push_back(std::move(signal));
    }
  }

  const circuit::FlatCircuit& circuit_;
  const std::string& program_;
  const StudySettings& settings_;
  Diagnostics& diagnostics_;
  Clock::time_point start_;
  DeckSettings base_;
  std::vector<Samples> ladder_, steps_;
  double last_seconds_ = 0.0, steps_seconds_ = 0.0;
  Study study_;
};

}  // namespace

Study refine(const circuit::FlatCircuit& circuit, const std::string& program, const StudySettings& settings, Diagnostics& diagnostics) {
  return Refinement(circuit, program, settings, diagnostics).run();
}

SignalReader::SignalReader(const waveform::RawFile& file, const SignalVectors& signal) : file_(file) {
  for (const auto& [name, sign] : signal.terms) {
    const auto vector = file.find(name);
    known_ = known_ && vector.has_value();
    if (vector) terms_.emplace_back(*vector, sign);
  }
}

double SignalReader::at_row(std::size_t row) const {
  double value = 0.0;
  for (const auto& [vector, sign] : terms_) value += sign * file_.at(row, vector);
  return value;
}

double SignalReader::at(double time) const {
  std::size_t low = 0, high = file_.rows() - 1;
  while (high - low > 1) {
    const std::size_t middle = low + (high - low) / 2;
    (file_.at(middle, 0) <= time ? low : high) = middle;
  }
  const double from = file_.at(low, 0), to = file_.at(high, 0);
  if (to <= from) return at_row(high);
  const double part = std::clamp((time - from) / (to - from), 0.0, 1.0);
  return (1.0 - part) * at_row(low) + part * at_row(high);
}

}  // namespace pwlsim::spice
