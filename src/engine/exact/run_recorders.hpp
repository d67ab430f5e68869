#pragma once
/// All that is kept of a run besides its rows: certificate, jumps, losses, thresholds of controls, pieces and impulses of measurements, positions of ports, and
/// what observers see. The run reports here what happens to each island, once and to all of them.

#include <vector>

#include "engine/exact/control_probe.hpp"
#include "engine/exact/island_run.hpp"
#include "engine/exact/jump_recorder.hpp"
#include "engine/exact/loss_watch.hpp"
#include "engine/exact/observer_feed.hpp"
#include "engine/exact/piece_maker.hpp"
#include "engine/exact/port_watch.hpp"
#include "engine/exact/probe_impulses.hpp"
#include "engine/exact/segment_certifier.hpp"

namespace pwlsim::engine {

class RunRecorders {
 public:
  RunRecorders(const ExactModel& model, const Request& request, Observer* observer, const std::vector<IslandRun>& islands)
      : islands_(islands),
        feed_(observer, model.islands.size()),
        jumps_(model.islands, request.jumps),
        losses_(model.islands),
        thresholds_(model.watched, request.stop),
        controls_(thresholds_),
        ports_(islands, request.watcher),
        pieces_(model.islands, request.probes, request.interrupt),
        impulses_(model.islands, request.probes) {}

  /// Each island's share of its signals before the run (RunState::signals).
  void before_start(const std::vector<std::vector<double>>& signals) { pieces_.before_start(signals); }
  /// Island i is open at the start, then its sources have been evaluated, and their breakpoints been taken.
  void started(std::size_t i) { feed_.started(i); }
  void at_start(std::size_t i) {
    jumps_.before(i, islands_[i].x);
    impulses_.before(i, islands_[i].x);
  }
  void after_start(std::size_t i) { certificate_.start(islands_[i].model(), islands_[i].x.data()); }
  void run_has_started() { ports_.begin(); }

  /// Island i is about to be opened at `time`, after a segment of this length.
  void opens(std::size_t i, double time, double length) {
    const IslandRun& island = islands_[i];
    if (!island.is_open()) certificate_.add(island.model(), island.segment(), length);
    pieces_.advance(islands_, time);
    if (is_new(island)) controls_.look(island.system(), island.segment(), time);
  }
  /// Whether a segment ends where the island is opened.
  [[nodiscard]] static bool is_new(const IslandRun& island) { return !island.is_open() && island.mode != nullptr; }
  /// It has been opened; `ends_segment`: and was not before. `from_outside`: the reason is neither its sources nor its guards. `breaks`: a source has a breakpoint.
  void opened(std::size_t i, double time, bool ends_segment, bool from_outside, bool breaks) {
    if (ends_segment) feed_.opened(i, islands_[i], time, from_outside, breaks);
    jumps_.before(i, islands_[i].x);
    impulses_.before(i, islands_[i].x);
  }
  void sources_jumped(std::size_t i) { impulses_.sources_jumped(i, islands_[i].x); }
  void selected(std::size_t i, const model::Selected& selected) {
    feed_.selected(i, islands_[i]);
    if (selected.jumps == 0) return;
    jumps_.jumped(i, selected);
    impulses_.ports_jumped(i, selected);
  }
  /// What a jump costs where these switches have opened.
  void lost(std::size_t i, double time, const model::Vector& now, const std::vector<std::string>& opened) {
    losses_.after(i, time, islands_[i].state_before(), now, opened);
  }
  void flipped(int number) { thresholds_.changed(number); }
  /// All islands have their modes. `wanted`: impulses count.
  void settled(double time, bool wanted) { impulses_.end(time, wanted); }
  /// The island's next segment is about to begin, and has begun.
  void closes(std::size_t i, double time) { jumps_.after(i, time, islands_[i].x); }
  void closed(std::size_t i) { feed_.closed(i, islands_[i]); }
  /// False: the observer ends the run.
  bool instant_ended(double time, bool has_jump, const std::vector<char>& on) { return feed_.end(time, has_jump, on); }
  void happened(const Event& event) { ports_.happened(event); }

  /// The run ends within a segment of the island, which has been opened there.
  void left(std::size_t i, double time) { feed_.ended(i, islands_[i], time); }
  /// The same where it is not opened.
  void last(std::size_t i, double time) {
    const IslandRun& island = islands_[i];
    certificate_.add(island.model(), island.segment(), std::max(0.0, time - island.segment().anchor));
  }
  void look_at_controls(std::size_t i, double time) { controls_.look(islands_[i].system(), islands_[i].segment(), time); }
  void end_pieces(double time) { pieces_.advance(islands_, time); }

  [[nodiscard]] const PieceMaker& pieces() const { return pieces_; }
  [[nodiscard]] Certificate certificate() const { return certificate_.check(); }
  /// Jumps and remarks.
  void hand_over(const std::vector<model::Clock>& clocks, const std::vector<char>& on, Answer& answer) {
    answer.jumps = jumps_.take();
    for (const model::Clock& clock : clocks) thresholds_.trace(clock, clock.driven());
    for (Remark& remark : thresholds_.remarks(on, answer.outcome == Outcome::completed)) answer.remarks.push_back(std::move(remark));
    if (auto remark = losses_.remark()) answer.remarks.push_back(std::move(*remark));
  }

 private:
  const std::vector<IslandRun>& islands_;
  ObserverFeed feed_;
  SegmentCertifier certificate_;
  JumpRecorder jumps_;
  LossWatch losses_;
  ThresholdWatch thresholds_;
  ControlProbe controls_;
  PortWatch ports_;
  PieceMaker pieces_;
  ProbeImpulses impulses_;
};

}  // namespace pwlsim::engine
