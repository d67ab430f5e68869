#pragma once
/// The run: all islands, instants in order, rows in between.

#include <vector>

#include "engine/exact/run_recorders.hpp"
#include "engine/exact/run_state.hpp"
#include "engine/exact/selectors.hpp"
#include "engine/remarks.hpp"
#include "engine/row_feed.hpp"
#include "engine/sampler.hpp"
#include "model/clock.hpp"

namespace pwlsim::engine {

class ExactRun : private RowSource {
 public:
  /// For partial runs: the observer, whether the instant at `stop` is left to the next run (then only guards have a certificate),
  /// and the distance below which instants are one, s.
  struct Watching {
    Observer* observer = nullptr;
    bool leaves_end_open = false;
    double merge = 0.0;  ///< 0: a fraction of `stop`
  };
  ExactRun(const ExactModel& model, const Request& request, RowSink& sink, Selectors& selectors, const Watching& watching);
  Answer run(const RunState& start);
  /// The state at the end of the run: just before `stop`, or after the instant at which the observer ended it.
  [[nodiscard]] RunState state() const;

 private:
  /// The changes at one instant.
  struct Instant {
    double time = 0.0;
    double late = 0.0;  ///< rounding error of the time
    bool source_edge = false;
    bool mode_change = false;
    bool flips = false;
    bool crossing = false;  ///< a guard of some island crosses zero
    int jumps = 0;
  };

  /// Running islands that drive each other, those without states first, and the groups that drive them.
  struct Group {
    std::vector<IslandRun*> islands;
    std::vector<const model::Clock*> clocks;
    std::vector<std::size_t> steered_by;  ///< groups, all before this one
    double horizon = 0.0;                 ///< the next instant there, or in what steers it
  };

  [[nodiscard]] std::size_t number_of(const IslandRun& island) const { return static_cast<std::size_t>(&island - islands_.data()); }
  [[nodiscard]] IslandAt at(const IslandRun& island, double time) const { return {number_of(island), island, time}; }
  void make_clocks();
  void make_groups();
  bool begin(const RunState& start);
  void march();
  bool leave(IslandRun& island);
  void stop_short();
  void close_others();
  double next_instant();
  [[nodiscard]] bool is_due(double time, Instant& instant) const;
  bool push_event_rows(double time);
  bool handle(double time);
  bool ask_sampler(double time);
  bool settle(Instant& instant, bool at_start);
  bool select_open(const std::vector<IslandRun*>& islands, Instant& instant);
  void take_clocks(Instant& instant);
  template <class Controls>
  void add_flips(const std::vector<IslandRun*>& islands, const Controls& controls);
  bool flip_without_mode(Instant& instant, bool at_start);
  bool flip_passing(Instant& instant);
  bool select_logic(Instant& instant);
  bool selects(IslandRun& island, Instant& instant);
  bool flip_logic(Instant& instant);
  bool flip_violated(Instant& instant);
  bool flip_at_rest(Instant& instant);
  bool flip(Instant& instant);
  void open_event_islands(double time, Instant& instant);
  void note_mode_changes(Instant& instant);
  bool holds(const IslandRun& island);
  void note_loss(const IslandRun& island, const Instant& instant);
  bool rows_before(double time, bool inclusive);
  [[nodiscard]] bool is_interrupted() const;
  bool accepted(RowFeed::Pushed pushed);
  bool take(bool accepted);
  bool watch_crowd(const Instant& instant);
  bool watch_idle_crowd(const Instant& instant);
  bool fail_crowd(const Instant& instant, const Crowd& crowd);
  [[nodiscard]] std::vector<std::string> what_happens(const Instant& instant) const;
  [[nodiscard]] std::string passed_name(const IslandRun& island) const;
  void watch_accumulation(const Instant& instant);
  bool may_cross(const IslandRun& island, const AccumulationWatch::Limit& limit, double time);
  void cross(IslandRun& island, const AccumulationWatch::Limit& limit);
  void fail(Outcome outcome, std::string id, std::string text, std::vector<std::string> elements);
  void fail(Ending ending);
  [[nodiscard]] std::string mode_text(Outcome outcome) const;
  void fail_selection(const IslandRun& island, const model::Selected& selected, double time);
  void note_several(const IslandRun& island, const model::Selected& selected, double time);
  void note_open_signals();
  void open_island(IslandRun& island, Instant& instant);
  void row(double time, double* row) override;
  void count();
  void note_doubtful_events();
  void note_choices();
  void certify();
  void finish();

  const ExactModel& model_;
  const Request& request_;
  Watching watching_;
  bool is_ended_by_observer_ = false;
  bool is_start_given_ = false;  ///< by initial values: nothing lies left of it
  Answer answer_;
  std::vector<IslandRun> islands_;
  std::vector<IslandRun*> running_;               ///< those that are not clocks
  std::vector<model::Clock> clocks_;              ///< switches that only piecewise linear sources drive
  std::vector<IslandRun*> following_, steering_;  ///< the running ones that drive no switch, and that drive some
  std::vector<IslandRun*> sensing_;               ///< of these the ones whose controls read more than sources
  std::vector<IslandRun*> logic_;                 ///< and of these the ones without states
  std::vector<char> is_ready_;                    ///< islands of those whose mode of the round at hand is known
  std::vector<Group> groups_;
  std::vector<char> on_;         ///< switches
  std::vector<int> flips_;       ///< switches that are to change
  std::vector<int> last_flips_;  ///< and those that did last
  std::vector<char> rested_;     ///< switches that have changed at this instant because their control stays at a threshold
  bool is_slow_ = false;         ///< an island is large
  std::vector<const model::Mode*> modes_before_;
  enum class Opened : char { no, by_own_event, from_outside };
  bool all_passive_ = false;
  std::vector<Opened> opened_;  ///< at the instant at hand
  RunRecorders recorders_;
  std::uint64_t several_ = 0;  ///< selections that had a choice, and the first of them in words
  std::string several_text_;
  double tolerance_ = 0.0;  ///< instants closer than this are one
  double begin_ = 0.0, now_ = 0.0;
  RowFeed rows_;
  std::vector<double> row_before_, sampled_;
  std::vector<Sampler::Setting> settings_;
  Crowd crowd_, idle_crowd_;
  std::uint64_t instants_ = 0;
};

}  // namespace pwlsim::engine
