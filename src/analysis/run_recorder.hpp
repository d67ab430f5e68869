#pragma once
/// Records the data for pictures of a run in bounded memory while it runs: its solution between events, its events, the conducting ports.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "engine/run.hpp"
#include "measure/solution_record.hpp"
#include "waveform/svg_plot.hpp"

namespace pwlsim::analysis {

/// An event with its changes.
struct ToldEvent {
  engine::Event event;
  std::vector<std::string> changes;  ///< "D1 on", "S1 off"; at most a dozen
  std::size_t more_changes = 0;
};

/// Distinct names of ports from those of their elements, which may have several ports (a diode that also breaks down, a block): "D1", "D1 (2)".
[[nodiscard]] std::vector<std::string> port_names(std::span<const std::string> elements);

class RunRecorder : public engine::EventWatcher {
 public:
  /// Keeps the solution and events from `from` to `to`, for the first `most_signals` signals.
  /// `sharers`: how many recorders share the memory that one may take.
  RunRecorder(double from, double to, std::size_t signals, std::size_t sharers = 1);
  static constexpr std::size_t most_signals = 200, most_lanes = 64, most_told = 1000;

  /// A piece of the first signals; the part before `from` is ignored.
  void take_piece(engine::Piece piece);
  void begin(std::span<const std::string> elements, std::span<const char> on) override;
  void happened(const engine::Event& event, std::span<const char> on) override;
  /// The run ended at this time.
  void end(double time);

  [[nodiscard]] double from() const { return from_; }
  [[nodiscard]] double to() const { return end_; }
  [[nodiscard]] const measure::SolutionRecord& solution() const { return solution_; }
  /// One per port, for the first `most_lanes`. If there were too many changes to keep, its share in each of many intervals.
  [[nodiscard]] std::vector<waveform::Lane> lanes() const;
  [[nodiscard]] std::size_t ports() const { return last_.size(); }
  /// Every event or, if there were too many, the first in each of many intervals, with the kinds of all events in the interval.
  [[nodiscard]] const std::vector<engine::Event>& events() const { return events_; }
  [[nodiscard]] std::uint64_t event_count() const { return event_count_; }
  /// The first `most_told`.
  [[nodiscard]] const std::vector<ToldEvent>& told() const { return told_; }

 private:
  struct Track {
    std::string name;
    bool on = false;              ///< now
    bool on_first = false;        ///< at from_
    double since = 0.0;           ///< time of the last change, or from_
    std::vector<double> changes;  ///< times, until there are too many
    std::vector<double> on_time;  ///< in each interval, from then on
  };
  [[nodiscard]] double piece_length() const;
  [[nodiscard]] std::size_t piece_of(double time) const;
  void tell(const engine::Event& event, std::span<const char> on);
  void keep(const engine::Event& event);
  void change(Track& track, bool on, double time);
  void fold_changes();
  void add_on_time(Track& track, double from, double to) const;
  [[nodiscard]] waveform::Lane lane(const Track& track) const;

  double from_, to_, end_;
  measure::SolutionRecord solution_;
  std::vector<std::string> elements_;
  std::vector<char> last_;  ///< position of all ports
  std::vector<Track> tracks_;
  std::size_t change_count_ = 0, most_events_;
  bool changes_folded_ = false, events_folded_ = false;
  std::vector<engine::Event> events_;
  std::uint64_t event_count_ = 0;
  std::vector<ToldEvent> told_;
};

}  // namespace pwlsim::analysis
