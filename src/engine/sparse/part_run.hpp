#pragma once
/// A part of the network with its own steps and events.
///
/// Steps are of TR-BDF2 with all ports in their position, of lengths h_max·2^−j only, so that factors can be reused. A step that a port, a switch's
/// control or a breakpoint of a source ends early is cut there on the parabola through its stages, not repeated (in a network that is not passive it
/// is: a constraint may hold a state two integrations away). If many ports change sides in a step, one of SDIRK2 with
/// all of them free is tried first, and kept if neither its error nor their effect on the saved signals exceeds the tolerance.
///
/// At an instant (source breakpoint, change of sides) three short implicit Euler steps find the new position: the first takes the jump, the others give initial
/// rates and rows.

#include <algorithm>
#include <array>
#include <functional>
#include <optional>
#include <span>
#include <unordered_set>

#include "engine/exact/accumulation.hpp"
#include "engine/remarks.hpp"
#include "engine/sparse/attempts.hpp"
#include "engine/sparse/controls.hpp"
#include "engine/sparse/exact_segment.hpp"
#include "engine/sparse/forecast.hpp"
#include "engine/sparse/open_signals.hpp"
#include "engine/sparse/part.hpp"
#include "engine/sparse/segment_record.hpp"
#include "engine/sparse/stall_watch.hpp"
#include "engine/sparse/start.hpp"
#include "engine/sparse/start_unknowns.hpp"
#include "engine/sparse/step_certifier.hpp"
#include "engine/sparse/stretch.hpp"
#include "engine/sparse/tie_selector.hpp"

namespace pwlsim::engine::sparse {

class PartRun {
 public:
  /// Implicit steps, or exact segments between located events.
  enum class Method { steps, segments };
  /// The part must outlive the run.
  PartRun(const Part& part, const Request& request, double reltol, Method method);

  [[nodiscard]] const Descriptor& descriptor() const { return descriptor_; }
  /// Of a lap: each segment goes there, and the run stops before what happens at its end. Null: neither. It fails where it tries more than `most_openings` positions; 0: any
  /// number.
  void begin_lap(std::vector<SegmentRecord>* records, bool stops_before_end, std::uint64_t most_openings) {
    most_openings_ = most_openings;
    records_ = records;
    if (segment_) segment_->keep_tolerance();
    stops_before_end_ = stops_before_end;
  }
  /// As ExactSegment::scale_shifts.
  void scale_shifts(double factor) {
    if (segment_) segment_->scale_shifts(factor);
  }
  /// Begins at t = 0. False: failed.
  bool begin(const PartStart& start);
  /// Rows before this time are available.
  [[nodiscard]] double time() const { return point_.time; }
  [[nodiscard]] bool finished() const { return finished_; }
  /// Positions tried so far.
  [[nodiscard]] std::uint64_t openings() const { return openings_; }
  /// One accepted step, or the next event. False: failed.
  bool advance();
  /// The saved signals at a time in the last step.
  void signals(double time, double* values);
  /// Some of them, by number.
  void signals(double time, std::span<const int> numbers, double* values);
  /// What the rounding of a saved signal is relative to: the sum of its terms' magnitudes at time(); with segments each unknown counts as the largest voltage, or current,
  /// so far.
  [[nodiscard]] double signal_size(int number) const;

  struct Instant {
    double time = 0.0;
    bool source_edge = false, mode_change = false, jump = false;
    [[nodiscard]] bool happened() const { return source_edge || mode_change || jump; }
  };
  /// The event that the last `advance` handled, with the signals before it (if the request includes events).
  [[nodiscard]] const std::optional<Instant>& instant() const { return instant_; }
  [[nodiscard]] const std::vector<double>& signals_before() const { return signals_before_; }
  /// ∫ dt of each saved signal over the jump of the last `advance` or `begin`, where there are probes; empty where nothing jumped.
  [[nodiscard]] const std::vector<double>& impulses() const { return impulses_; }

  /// The unknowns at time().
  [[nodiscard]] const std::vector<double>& unknowns() const { return point_.z; }
  /// The ports' position at time().
  [[nodiscard]] const Position& position() const { return point_.on; }

  /// Outcome, id, message and elements after a failure.
  [[nodiscard]] const Answer& failure() const { return failure_; }
  void add_statistics(Statistics& statistics) const;
  /// The jumps, if requested.
  [[nodiscard]] const std::vector<Jump>& jumps() const { return jump_details_; }
  [[nodiscard]] const StepCertifier& certificate() const { return certificate_; }
  /// Of the states after all segments, of the largest √energy (Certificate::error_bound). Rounding is in it.
  [[nodiscard]] double error_bound() const { return segment_ && segment_->size() > 0.0 ? error_ / segment_->size() : 0.0; }
  [[nodiscard]] bool error_holds() const { return error_holds_; }
  /// The largest motion that was damped instead of followed, of a state's size.
  [[nodiscard]] double damped() const { return damped_; }
  /// The controls in relation to their thresholds.
  [[nodiscard]] std::vector<Remark> threshold_remarks();
  /// Limits of infinitely many events from which it went on.
  [[nodiscard]] const std::vector<Remark>& limits() const { return limit_remarks_; }
  /// Names of the signals that some of its segments leave open.
  [[nodiscard]] std::vector<std::string> open_signals() const;
  /// Whether the start contradicted the network, so far as the largest values of its states tell: what a leak takes from a store at once is no contradiction.
  [[nodiscard]] bool start_projected() const;

 private:
  using Trial = Stepper::Trial;
  static constexpr int last_level = 96;  ///< of the ladder
  /// Chebyshev points of (0, 1): where the certificate, and what controls do, are looked at inside of a segment, whose ends may both lie near zero.
  static constexpr std::array<double, 3> inner_points{0.066987298107780677, 0.5, 0.93301270189221932};

  // part_run.cpp: steps
  [[nodiscard]] double ladder(int level) const { return h_max_ * std::ldexp(1.0, -level); }
  /// The first whose Euler steps are no longer than shortest_.
  [[nodiscard]] int shortest_level() const {
    return shortest_ < h_max_ ? static_cast<int>(std::ceil(std::min(std::log2(diagonal * h_max_ / shortest_), 1.0 * last_level))) : 0;
  }
  [[nodiscard]] double next_break() const { return std::min(sources_.next_break(), next_gate_); }
  [[nodiscard]] double remaining() const;
  [[nodiscard]] int step_level() const;
  bool step();
  bool absorbs(double h);
  bool absorb(double h);
  void accept(const Trial& trial, double reach);
  void settle_in(Point& next);
  void note_largest_unknowns();
  void control_size(double error);
  bool reduce(double h, double error);
  bool fail_step(Solved solved, double error);
  bool look_back();
  bool give_up(const std::string& what);
  void fail(Outcome outcome, std::string id, std::string text, std::vector<std::string> elements) {
    fail({outcome, std::move(id), std::move(text), std::move(elements)});
  }
  void fail(Ending ending) { end_run(failure_, std::move(ending)); }
  [[nodiscard]] std::vector<std::string> names(const std::vector<int>& ports) const;
  [[nodiscard]] bool matters(const Point& a, const Point& b) const;

  // part_run_crossings.cpp
  /// A port, or the control of a switch, that crosses zero in a step.
  struct Crossing {
    std::size_t index = 0;
    bool is_control = false;
    double at = 0.0;  ///< fraction of the step
  };
  [[nodiscard]] double margin(std::size_t index, bool is_control, const Point& at) const;
  [[nodiscard]] double margin_size(std::size_t index, bool is_control) const;
  [[nodiscard]] std::vector<Crossing> crossings(double h, double reach);
  [[nodiscard]] double largest_input(const Point& at) const;
  bool cut(double h, const std::vector<Crossing>& list, double reach);
  bool locate(double h, Crossing crossing);

  // part_run_events.cpp
  Instant begin_instant();
  bool restart();
  void note_jump(double time, double h);
  void note_impulses(double h);
  void find_next_gate();
  void watch_controls();
  void watch_rest(WatchedControl& control, int number, double value, double noise);
  void watch_inside(double tau);
  [[nodiscard]] double rest_noise(const WatchedControl& control, double unknown) const;
  bool take_gates(double until);
  [[nodiscard]] bool waits_for_jump(const WatchedControl& control, const Position& on) const;
  bool flip_at_rest(const Point& at, Instant& instant);
  bool settle(double h, Instant& instant, Point& first);
  bool flip(const Point& at, bool by_sources, double time, Instant& instant, Position& on);
  /// Before the Euler steps of an instant.
  struct Beginning {
    Position on;
    Instant instant;
  };
  /// A position found, with its Euler steps.
  struct Found : Beginning {
    Point first, second, third;
  };
  [[nodiscard]] Found found(const Instant& instant) const;
  void put_back(const Found& found, Instant& instant);
  [[nodiscard]] bool find_position(const Beginning& beginning, Instant& instant, int& level);
  [[nodiscard]] bool decays(const Beginning& beginning, Instant& instant, int& level, int usual);
  [[nodiscard]] bool go_back(const Beginning& beginning, Instant& instant, int level);
  [[nodiscard]] int levels_too_long(double h) const;
  void end_before_passage(const Beginning& beginning, Instant& instant, int& level);
  [[nodiscard]] Solved euler_steps(double h, Instant& instant);
  [[nodiscard]] bool settled(double h, Instant& instant);
  [[nodiscard]] bool repeats(double shorter, double motion);
  [[nodiscard]] const std::vector<double>& drawn_back(const Point& first, const Point& second);
  [[nodiscard]] double difference(const std::vector<double>& states, const std::vector<double>& z) const;
  [[nodiscard]] std::vector<std::string> changed_ports() const;
  bool watch_crowd(double time);

  // part_run_search.cpp and part_run_segments.cpp: in place of steps
  void note_least_voltage();
  [[nodiscard]] bool begin_on_the_way(const PartStart& start);
  [[nodiscard]] bool begin_segment();
  [[nodiscard]] bool find_segment(const Beginning& beginning, Instant& instant);
  [[nodiscard]] bool follows_directly(const Position& candidate);
  [[nodiscard]] bool follows_as_foretold(const Position& candidate);
  [[nodiscard]] bool follows_by_signs(const Position& candidate);
  enum class Sought { found, jumped, not_found };
  [[nodiscard]] Sought seek_segment(const Beginning& beginning, Instant& instant, double h);
  [[nodiscard]] bool is_shared_by(const Point& step, double h) const;
  [[nodiscard]] bool flip_negative(Position on, int rounds);
  [[nodiscard]] std::vector<std::size_t> first_negative() const;
  [[nodiscard]] bool find_after_steps(const Beginning& beginning, Instant& instant);
  [[nodiscard]] ExactSegment::Opened open_segment(const Position& on);
  struct Standing {
    std::vector<double> z, memory, states;
  };
  void stand(const Standing& at);
  [[nodiscard]] Sought seek_by_steps(const Beginning& beginning, Instant& instant, double h);
  [[nodiscard]] bool share_freely();
  [[nodiscard]] bool correct_rows();
  [[nodiscard]] bool opens_again();
  [[nodiscard]] bool follows_by_ties(const Beginning& beginning, Position candidate);
  [[nodiscard]] double euler_length(const Beginning& beginning) const;
  [[nodiscard]] double room() const;
  [[nodiscard]] bool follow_segment();
  void certify_within(const Point& point, double tau, const SegmentTimes& times);
  [[nodiscard]] std::vector<int> ports_at_zero(double tau);
  [[nodiscard]] Point point_of_segment(double tau, double time, bool has_rates);
  [[nodiscard]] bool begins_at(double time) const;
  [[nodiscard]] const std::vector<double>& signals_at_start();
  void pass(const ExactSegment::Passage& passage);
  [[nodiscard]] bool passes_too(std::size_t control, const std::vector<double>& y, const std::vector<double>& slope) const;
  [[nodiscard]] bool is_same_instant(double a, double b) const;
  [[nodiscard]] double resolved_until(double tau);
  [[nodiscard]] bool is_resolved(double from, double to);
  void finish_instant(const Instant& instant);
  void watch_accumulation(const Beginning& beginning, const Instant& instant, int passed);
  [[nodiscard]] bool may_go_to(const AccumulationWatch::Limit& limit) const;
  void go_to_limit();

  // part_run_jumps.cpp: their jumps
  Sought take_jump_of(const Point& step, double h);
  [[nodiscard]] Sought jump_by_step(const Point& step, double h);
  [[nodiscard]] Sought take_step_of_jump(const Point& step, double h);
  [[nodiscard]] std::vector<std::size_t> backward_impulses(const std::vector<double>& impulses, const std::vector<double>& whole,
                                                           const Position& on, double share) const;
  [[nodiscard]] bool is_jump_of(const Position& on);
  [[nodiscard]] bool is_continuous();
  [[nodiscard]] double least_distance() const;
  [[nodiscard]] bool moves(const std::vector<double>& states, const std::vector<double>& from, const std::vector<double>& to) const;
  void add_impulses(const std::vector<double>& impulses, const std::vector<double>& whole, double length);
  void note_start_jumps(const std::vector<double>& states, const std::vector<double>& z);
  void note_segment_impulses();
  static double largest_share(const Form& signal, const std::vector<std::vector<double>>& decays);
  void add_error(double tau);
  void record_begin(const Point& first);
  [[nodiscard]] std::vector<double> rates_at(const Point& point) const;
  void record_end(const Point& last, double tau, const ExactSegment::Passage& passage);
  [[nodiscard]] FallingGuard falling(int guard, double rate) const;

  const Part& part_;
  const Request& request_;
  double reltol_;
  const Descriptor& descriptor_;
  double source_scale_;  ///< V: the largest source of voltage; for segments those of current, too, times R0
  Factors factors_;
  PortSolver ports_;
  Sources sources_;
  Stepper stepper_;
  StateScale scale_;
  std::vector<WatchedControl> controls_;  ///< of switches that are no gates
  std::vector<Gate> gates_;
  double next_gate_ = model::forever;
  ThresholdWatch thresholds_;
  std::vector<char> watched_on_;  ///< positions of switches, as their controls have them, when controls were looked at last
  std::vector<Form> signals_;
  std::vector<double> signal_scale_;
  double largest_voltage_ = 0.0, largest_current_ = 0.0;  ///< of segments that are measured
  bool signals_read_sources_ = false;
  StepCertifier certificate_;
  double error_ = 0.0;  ///< √energy, of all segments
  bool error_holds_ = true;
  bool passive_ = false;
  StallWatch stall_;
  Stretch stretch_;
  std::unique_ptr<ExactSegment> segment_;  ///< where the method is segments
  struct {
    Position on;
    std::vector<double> z, memory;  ///< what it begins from
    int passed = -1;                ///< the port that ended the one before; −1: none
    std::vector<double> signals;    ///< there; empty until they are asked for
    bool is_given = false;          ///< the states are those that the deck gives, without rounding
  } segment_start_;
  std::unique_ptr<OpenSignals> open_signals_;      ///< null where the network is not passive
  std::unique_ptr<StartUnknowns> start_unknowns_;  ///< null until a row asks for them
  std::vector<SegmentRecord>* records_ = nullptr;
  std::vector<Position> jumps_taken_;  ///< at the instant at hand
  bool stops_before_end_ = false;
  std::vector<Position> refused_jumps_;  ///< of steps of several lengths: positions whose jump asks for impulses backwards
  bool trusts_jumps_ = false;
  bool may_jump_ = true;                     ///< where a position is sought
  bool decays_jump_ = false;                 ///< likewise, what is too fast to be followed
  bool given_jumps_ = false;                 ///< likewise, of what is given at the start
  std::array<Attempts, 2> rejecting_early_;  ///< of openings, at other instants and where a guard passes
  Position position_ahead_;                  ///< where the passage at hand leads
  double segment_tau_ = 0.0;                 ///< so far
  double piece_length_ = 0.0;                ///< of the last piece on which probes are polynomials, s
  Attempts growing_pieces_;                  ///< of pieces, in a segment
  std::unique_ptr<TieSelector> ties_;        ///< likewise
  std::unique_ptr<Forecast> forecast_;       ///< likewise, of a passive part
  Attempts foretelling_;                     ///< of the position behind corners of gates
  int last_guard_ = -1;                      ///< that ended the segment before
  int passing_ = -1;                         ///< the same, until the position behind it is found
  Point point_;
  Position position_before_;  ///< before the instant that is due
  std::unordered_set<std::string>
      unshared_;  ///< positions, with what carries nothing in them, in which ports that are free to conduct would not either
  Trial trial_, free_;
  Point first_, second_, third_;                    ///< of the Euler steps of an instant
  std::pair<Point, Point> jump_steps_;              ///< of segments, the Euler steps that begin with the instant's jump
  std::vector<double> jump_impulses_, jump_terms_;  ///< ∫ dt of the unknowns over its jumps, and what they were parts of
  std::vector<double> w_, signals_before_, impulses_;
  std::vector<double> states_;        ///< of point_, or those given, at an instant
  std::vector<double> start_jumps_;   ///< what a segment's start moved each state by; none: the flag decides
  std::vector<double> start_memory_;  ///< charges of the start beside those of point_
  std::optional<Instant> instant_;
  std::vector<Jump> jump_details_;
  Answer failure_;
  double h_max_ = 0.0, shortest_ = 0.0, tolerance_ = 0.0, break_tolerance_ = 0.0;
  int level_ = 0;
  bool starting_ = false, restart_due_ = false, finished_ = false, start_projected_ = false, rejected_ = false;
  double moved_ = 0.0, motion_left_ = 0.0, damped_ = 0.0;
  Crowd crowd_;
  AccumulationWatch accumulation_;
  double passage_doubt_ = 0.0;                     ///< of the time of the last passage of a port, s
  std::optional<AccumulationWatch::Limit> limit_;  ///< where the segment at hand ends
  std::vector<Remark> limit_remarks_;
  Attempts absorbing_;
  int standing_ = 0, standing_limit_ = 32;  ///< steps accepted in a row without a longer one, and how many are enough to try
  std::uint64_t steps_ = 0, events_ = 0, jumps_ = 0, openings_ = 0, most_openings_ = 0;
  std::unordered_set<std::size_t> positions_;
};

}  // namespace pwlsim::engine::sparse
