#pragma once
/// Runs one island: mode, segment, sources, rows.

#include <vector>

#include "engine/exact/accumulation.hpp"
#include "engine/exact/continuity_watch.hpp"
#include "engine/exact/exact_model.hpp"
#include "engine/exact/guard_watch.hpp"
#include "engine/exact/island_controls.hpp"
#include "engine/exact/locator.hpp"
#include "engine/exact/row_state.hpp"
#include "engine/run.hpp"
#include "model/selection.hpp"

namespace pwlsim::engine {

class IslandRun {
 public:
  /// `selector`: of the model's system; it keeps its modes from run to run.
  IslandRun(const IslandModel& model, model::Selector& selector);

  [[nodiscard]] const model::System& system() const { return system_; }
  [[nodiscard]] model::Selector& selector() { return selector_; }
  [[nodiscard]] const model::Selector& selector() const { return selector_; }
  [[nodiscard]] const Locator& locator() const { return locator_; }
  /// Instants at which a mode was accepted only at the coarsest rounding level, and the time of the first, s.
  [[nodiscard]] std::uint64_t coarse_selections() const { return coarse_selections_; }
  [[nodiscard]] double first_coarse() const { return first_coarse_; }
  [[nodiscard]] const GuardWatch& guards() const { return guard_watch_; }
  [[nodiscard]] const ContinuityWatch& continuity() const { return continuity_watch_; }
  /// The run ends at `time`, within the segment.
  void look_at_end(double time);
  /// For tests: deliberate faults.
  void inject(const Request::Faults& faults) { faults_ = faults; }
  [[nodiscard]] const Segment& segment() const { return segment_; }
  /// Counts segments.
  [[nodiscard]] std::uint64_t segment_number() const { return segment_number_; }
  [[nodiscard]] bool is_static() const { return system_.is_static(); }

  /// Time of the next source breakpoint that is an instant of the run.
  [[nodiscard]] double next_break() const { return phase_.next; }
  /// Certifies the segment up to absolute time `end`, or finds the first event before it; returns its time, else `end`.
  double certify(double end);
  [[nodiscard]] double event_time() const { return event_time_; }
  /// The rounding error of the event's time. Over many events it would add up to a drift of the sources.
  [[nodiscard]] double event_late() const { return event_late_; }
  /// Whether the next event belongs to the instant `time`: it is before it, or within the tolerance after it.
  [[nodiscard]] bool has_event_at(double time) const { return event_.found && event_time_ <= (at_limit_ ? time : time + tolerance_); }

  /// Of its segment, until it is opened at the instant `time` + `late`: rounding of times may be longer than what is fast.
  [[nodiscard]] double length_until(double time, double late) const {
    return has_event_at(time) ? event_.tau : (time - segment_.anchor) + (late - segment_.late);
  }
  /// Opens the instant `time` + `late`, or that of the island's own event within the tolerance: sets x to the state just before it, with sources still at
  /// their left limit.
  void open(double time, double late);
  [[nodiscard]] bool is_open() const { return open_; }
  /// Sets the next event to the limit of those before it (accumulation.hpp), with states ξ at that time.
  void go_to_limit(const AccumulationWatch::Limit& limit);
  /// Whether the next event is such a limit.
  [[nodiscard]] bool is_at_limit(double time) const { return at_limit_ && event_time_ == time; }
  [[nodiscard]] AccumulationWatch& accumulation() { return accumulation_; }

  /// The run begins at `time`, before its breakpoints.
  void start_sources(double time) { phase_ = system_.exosystem->start(time); }
  /// Breakpoints closer than `tolerance` are one, and so are crossings of controls.
  void set_tolerance(double tolerance);
  /// Takes the breakpoints at `time`; true if a source value jumped.
  bool take_breakpoints(double time);
  /// Held sources of this channel change at `time`.
  void hold(int channel, double value, double time) { system_.exosystem->hold(phase_, channel, value, time); }
  /// ζ at `time` from the sources themselves.
  void evaluate_sources(double time) { system_.exosystem->evaluate(phase_, time, x.data() + system_.n); }
  /// Selects the mode that follows at x; `set` is the wanted active set.
  const model::Selected& select();
  [[nodiscard]] const model::Selected& selected() const { return selector_.selected(); }
  void set_switch(int port, bool closed);
  /// Whether some of its controls read more than sources.
  [[nodiscard]] bool senses_state() const { return controls_.sense_state(); }
  /// Numbers of controls whose switch must change at x in the new mode; `on` is the state of all switches.
  const std::vector<int>& violated_controls(const std::vector<char>& on);
  /// Of the controls that violated_controls examined last: those whose switch changes because the control stays at the threshold from now on.
  const std::vector<int>& controls_at_rest(const std::vector<char>& on) { return controls_.at_rest(on); }
  /// The same for controls that do not depend on the mode, before one is selected: those that read sources only, by the sources' own
  /// derivatives; at the start also those that read the state directly, by value.
  const std::vector<int>& violated_without_mode(double time, const std::vector<char>& on, bool at_start) {
    return controls_.violated_without_mode(phase_, time, x, on, at_start);
  }
  /// Numbers of controls that read the state and cross at this instant in the previous mode: called once, if a switch of this island has
  /// been set before a mode is selected.
  const std::vector<int>& passing_controls(const std::vector<char>& on);
  /// Begins the new segment at `time`, with the rounding error with which it was opened.
  void close(double time, const std::vector<char>& on);

  /// Values of this island's signals at absolute `time` ≥ the anchor, added to out[signal].
  void add_signals(double time, double* out);
  /// Caches propagators for rows with the distance `step`.
  void set_row_step(double step) { row_state_.set_step(step); }

  std::vector<double> x;  ///< full state (ξ, ζ) while open
  const model::Mode* mode = nullptr;
  model::IndexSet wanted;  ///< active set with the present positions of the switches
  int trigger = -1;        ///< diode port whose guard reached zero
  int passed_row = -1;     ///< guard of the event at which the island was opened last; −1: none
  /// Whether the mode continues differently than `before` would have: a port determined in both modes, and not identically zero, lies on
  /// another side; or, if only undetermined ports changed, the state or a port's power departs differently.
  bool changes_visibly(const model::Mode& before);
  /// At the present instant: why it was opened, and the length of the segment before it, s.
  [[nodiscard]] double length_before() const { return length_before_; }
  [[nodiscard]] bool is_settled() const { return is_settled_; }
  [[nodiscard]] bool is_undecided() const { return undecided_; }
  [[nodiscard]] bool is_open_at_limit() const { return opened_at_limit_; }
  /// The full state just before the present instant.
  [[nodiscard]] model::Vector state_before() const;
  /// t = 0: x and `wanted` are set by the caller, no segment precedes.
  void open_at_start() {
    open_ = true;
    continuity_watch_.begin(x.data());
  }
  [[nodiscard]] const IslandModel& model() const { return model_; }

 private:
  void take_limit(double time, double* out) const;
  void take_event(double end);
  void begin_segment(double time, double late);
  [[nodiscard]] double time_to_settle();
  void settle();
  void locate(double length);
  void choose_guards(const std::vector<char>& on);
  void take_diode_guards();
  void take_guard_rows();
  void go_to_event(double time);
  void go_to_time();
  void note_coarse(double time);
  void outputs_from(const model::Mode& m, const double* y, double* out);

  const IslandModel& model_;
  const model::System& system_;
  model::Selector& selector_;
  IslandControls controls_;
  Locator locator_;
  GuardWatch guard_watch_;
  ContinuityWatch continuity_watch_;
  RowState row_state_;
  Request::Faults faults_;
  std::uint64_t port_events_ = 0;
  model::Exosystem::Phase phase_;
  double tolerance_ = 0.0;
  double time_to_settle_ = model::forever;  ///< s from the anchor, after which the slow motion replaces the mode
  std::vector<double> settled_y_;           ///< state there
  bool is_settled_ = false;                 ///< the present instant is that time
  Segment segment_;
  std::uint64_t segment_number_ = 0;
  Located event_;
  double event_time_ = 0.0, event_late_ = 0.0;
  AccumulationWatch accumulation_;
  model::Vector limit_;    ///< ξ where events accumulate
  bool at_limit_ = false;  ///< the present event is that limit
  bool open_ = false;
  double late_ = 0.0;  ///< rounding error of the present instant's time
  double length_before_ = 0.0;
  bool opened_at_limit_ = false;
  bool is_as_before_ = false;  ///< open, and no mode selected yet
  bool is_coarse_ = false;     ///< open, and a mode was accepted at the coarsest rounding level
  std::uint64_t coarse_selections_ = 0;
  double first_coarse_ = 0.0;
  bool is_set_ = false;     ///< a switch of it, since the instant began
  bool undecided_ = false;  ///< the present event is only a time at which the locator could not decide
  bool all_rest_ = false;   ///< and no mode changed at it: guards at zero are examined again once they are visibly negative
  int rests_ = -1;          ///< port whose guard reached zero without a change of mode: it counts once it is visibly negative

  std::vector<double> work_, scratch_, outputs_;
  std::vector<std::pair<const model::Mode*, const model::Mode*>> visible_changes_;
  std::vector<int> guard_rows_;
  std::vector<model::Departure> departures_;  ///< of guard_rows_
};

}  // namespace pwlsim::engine
