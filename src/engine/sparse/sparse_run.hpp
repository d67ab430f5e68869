#pragma once
/// The run: all parts, the one with the least time first, rows in between.

#include <memory>
#include <vector>

#include "engine/remarks.hpp"
#include "engine/row_feed.hpp"
#include "engine/sparse/part.hpp"
#include "engine/sparse/part_run.hpp"

namespace pwlsim::engine::sparse {

class SparseRun : private RowSource {
 public:
  /// `signals`: of the whole network. Parts and request must outlive it.
  SparseRun(const std::vector<std::unique_ptr<const Part>>& parts, std::size_t signals, const Request& request, double reltol,
            PartRun::Method method, RowSink& sink);
  /// Before `run`, of segments: it stops before what happens at its end, and each part records its segments, where `records` is not null. It fails where a part tries more
  /// positions than that; 0: any number.
  void begin_lap(std::vector<std::vector<SegmentRecord>>* records, std::uint64_t most_openings);
  /// Before `run`, of segments: as ExactSegment::scale_shifts.
  void scale_shifts(double factor) {
    for (const auto& track : tracks_) track->run.scale_shifts(factor);
  }
  /// The most positions that a part has tried.
  [[nodiscard]] std::uint64_t openings() const;
  /// One start per part.
  Answer run(const std::vector<PartStart>& starts);
  /// After `run`, the start of another that goes on from there.
  [[nodiscard]] std::vector<PartStart> ends();

 private:
  struct Track {
    Track(const Part& p, const Request& request, double reltol, PartRun::Method method)
        : part(p), run(p, request, reltol, method), values(p.island.signal_number.size()) {}
    const Part& part;
    PartRun run;
    std::vector<double> values;         ///< of its shares of signals
    std::vector<int> shares, probes{};  ///< signals of the part that are parts of probes, and of which
    bool is_start_given = false;        ///< by the deck; not by a run that this one goes on from
  };
  /// Order of the heap.
  [[nodiscard]] auto is_later() const {
    return [this](std::size_t a, std::size_t b) { return tracks_[a]->run.time() > tracks_[b]->run.time(); };
  }
  bool begin(const std::vector<PartStart>& starts);
  bool advance_least();
  void row(double time, double* values) override;
  bool fail(const Answer& failure);
  [[nodiscard]] std::string mode_text() const;
  bool rows_before(double time, bool inclusive);
  void find_shares(Track& track) const;
  void pieces_before(double time);
  void note_noise();
  void hand_over_start();
  void hand_over_impulses(const Track& track, double time);
  void note_before_start(const Track& track, const PartStart& start);
  bool open_event(Track& track);
  bool close_event();
  void watch_start();
  void watch(const Track& track);
  void tell_event();
  bool accepted(RowFeed::Pushed pushed);
  bool take(bool accepted);
  bool is_interrupted();
  void end(Ending ending);
  void finish();

  const Request& request_;
  double reltol_;
  PartRun::Method method_;
  std::vector<std::unique_ptr<Track>> tracks_;
  std::vector<std::size_t> order_;  ///< of tracks_: a heap by time, the least first
  Answer answer_;
  double tolerance_ = 0.0;
  RowFeed rows_;
  double last_instant_ = -1.0;         ///< of any part
  bool event_open_ = false;            ///< its row after it is due
  std::uint64_t shared_instants_ = 0;  ///< at which several parts came upon something
  std::vector<char> on_;               ///< of all ports
  std::optional<Event> event_;         ///< at hand, of all parts that came upon it
  double piece_time_ = 0.0;            ///< up to which pieces have been handed over
  std::vector<double> piece_values_;
  std::vector<double> probe_noise_;  ///< as Piece::noise, the largest so far
};

}  // namespace pwlsim::engine::sparse
