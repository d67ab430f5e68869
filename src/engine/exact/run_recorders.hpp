#pragma once
/// All that is kept of a run besides its rows. The run reports here what happens, once and to all of them; another recorder is one more line in each list below.

#include <vector>

#include "engine/exact/control_probe.hpp"
#include "engine/exact/jump_recorder.hpp"
#include "engine/exact/loss_watch.hpp"
#include "engine/exact/observer_feed.hpp"
#include "engine/exact/piece_maker.hpp"
#include "engine/exact/port_watch.hpp"
#include "engine/exact/probe_impulses.hpp"
#include "engine/exact/recorder.hpp"
#include "engine/exact/segment_certifier.hpp"

namespace pwlsim::engine {

class RunRecorders {
 public:
  RunRecorders(const ExactModel& model, const Request& request, Observer* observer, const std::vector<IslandRun>& islands)
      : feed_(observer, model.islands.size()),
        jumps_(model.islands, request.jumps),
        controls_(model.watched, request.stop),
        losses_(model.islands),
        ports_(islands, request.watcher),
        pieces_(islands, model.islands, request.probes, request.interrupt),
        impulses_(model.islands, request.probes) {}

  // The reports of Recorder.
  void run_begins(const std::vector<std::vector<double>>& signals) {
    each([&](auto& recorder) { recorder.run_begins(signals); });
  }
  void started(const IslandAt& island) {
    each([&](auto& recorder) { recorder.started(island); });
  }
  void start_is_known(const IslandAt& island) {
    each([&](auto& recorder) { recorder.start_is_known(island); });
  }
  void run_has_begun() {
    each([&](auto& recorder) { recorder.run_has_begun(); });
  }
  void opens(const IslandAt& island, double length) {
    each([&](auto& recorder) { recorder.opens(island, length); });
  }
  void opened(const IslandAt& island, const Opening& opening) {
    each([&](auto& recorder) { recorder.opened(island, opening); });
  }
  void sources_jumped(const IslandAt& island) {
    each([&](auto& recorder) { recorder.sources_jumped(island); });
  }
  void selected(const IslandAt& island, const model::Selected& selected) {
    each([&](auto& recorder) { recorder.selected(island, selected); });
  }
  void flipped(int number) {
    each([&](auto& recorder) { recorder.flipped(number); });
  }
  void settled(double time, bool impulses_count) {
    each([&](auto& recorder) { recorder.settled(time, impulses_count); });
  }
  void closes(const IslandAt& island) {
    each([&](auto& recorder) { recorder.closes(island); });
  }
  void jumped_by_switches(const IslandAt& island, const model::Vector& now, const std::vector<std::string>& switches) {
    each([&](auto& recorder) { recorder.jumped_by_switches(island, now, switches); });
  }
  void closed(const IslandAt& island) {
    each([&](auto& recorder) { recorder.closed(island); });
  }
  void happened(const Event& event) {
    each([&](auto& recorder) { recorder.happened(event); });
  }
  void ends_within(const IslandAt& island) {
    each([&](auto& recorder) { recorder.ends_within(island); });
  }
  void left(const IslandAt& island) {
    each([&](auto& recorder) { recorder.left(island); });
  }
  void reached_end(const IslandAt& island) {
    each([&](auto& recorder) { recorder.reached_end(island); });
  }
  void run_ended(double time) {
    each([&](auto& recorder) { recorder.run_ended(time); });
  }
  void hand_over(const RunEnd& end, Answer& answer) {
    each([&](auto& recorder) { recorder.hand_over(end, answer); });
  }
  bool instant_ended(double time, bool has_jump, const std::vector<char>& on) {
    bool goes_on = true;
    each([&](auto& recorder) { goes_on &= recorder.instant_ended(time, has_jump, on); });
    return goes_on;
  }

  [[nodiscard]] const PieceMaker& pieces() const { return pieces_; }
  [[nodiscard]] Certificate certificate() const { return certificate_.check(); }

 private:
  template <class Report>
  void each(Report report) {
    report(feed_);
    report(certificate_);
    report(jumps_);
    report(controls_);
    report(losses_);
    report(ports_);
    report(pieces_);
    report(impulses_);
  }

  ObserverFeed feed_;
  SegmentCertifier certificate_;
  JumpRecorder jumps_;
  ControlProbe controls_;
  LossWatch losses_;
  PortWatch ports_;
  PieceMaker pieces_;
  ProbeImpulses impulses_;
};

}  // namespace pwlsim::engine
