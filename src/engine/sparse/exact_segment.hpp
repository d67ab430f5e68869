#pragma once
/// A segment between events in a space of few vectors (krylov_space.hpp), with the guards of all ports and controls as rows on its coordinates, on which the exact
/// engine's search for events and its test of signs work as they do on a dense mode.

#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "engine/exact/locator.hpp"
#include "engine/sparse/attempts.hpp"
#include "engine/sparse/controls.hpp"
#include "engine/sparse/krylov_bound.hpp"
#include "engine/sparse/krylov_space.hpp"
#include "engine/sparse/sources.hpp"
#include "linalg/fast_decays.hpp"

namespace pwlsim::engine::sparse {

class StateScale;

/// Vectors that a segment may have; one that needs more is made shorter.
constexpr int most_of_segment = 40;
/// So many cost more than a part of the tolerance, or another γ.
constexpr int many_vectors = 20;
/// Radians of the fastest oscillation in γ, where that decides it, and most where a space is full.
constexpr double usual_turn = 0.5, longest_turn = 4.0;

class ExactSegment {
 public:
  /// All must outlive it. `tolerance`: bound on the estimated error of a segment, of the largest √energy so far.
  ExactSegment(const Descriptor& descriptor, const Sources& sources, const std::vector<WatchedControl>& controls, double tolerance,
               double stop);
  /// From now on errors count in each state, too, against its size: what has little of the energy has its digits, and what a network amplifies. It must outlive the segment.
  void count_by(const StateScale& scale) { scale_ = &scale; }
  /// From now on signs of currents count beyond so many times their ordinary rounding, those of all guards beyond so many times a segment's tolerance, and guards that are positive by less than
  /// that are so until they are seen to pass.
  void relax(double factor, double noise, bool takes_positive) {
    relaxation_ = factor;
    noise_ = noise;
    takes_positive_ = takes_positive;
  }
  [[nodiscard]] double relaxation() const { return relaxation_; }
  /// Segments are first made for that share of their usual length: what decays within them is then followed.
  void shorten(double share) { share_ = share; }
  [[nodiscard]] double share() const { return share_; }
  /// Solutions are corrected by their residuals, in all segments, or from now on in the position of the one that is open.
  void refine(bool does) { refines_ = does; }
  void refine_position() { habits_[key_].refines = true; }
  [[nodiscard]] bool is_refined() const { return refines_ || habits_.at(key_).refines; }
  /// The guard that has just passed zero, at the end of the segment that is open, and how well that time is known, s; −1: none.
  void note_passing(int guard, double doubt);
  /// An instant that finds the ports in that position, at z.
  void note_instant(double time, const Position& on, const std::vector<double>& z);

  /// States come from a jump at which voltages were as large as this: their rounding is of it. 0: no longer.
  void note_jump(double voltage) { jump_voltage_ = voltage; }

  struct Origin {
    double time = 0.0;
    const Position& on;
    const std::vector<double>& z;
    const std::vector<double>& more;  ///< charges and fluxes beside those of z
    double longest = 0.0;             ///< to what is known to happen next, s
    double stepped = 0.0;             ///< z is the end of an implicit Euler step of that length, s, and so are its sources
  };
  /// contradicted: the position is none of the network. unresolved: not even the shortest segment meets the tolerance.
  enum class Opened { yes, singular, contradicted, unresolved };
  [[nodiscard]] Opened open(Factors& factors, const Origin& start) { return open(factors, start, 0); }

  /// An implicit Euler step over a jump, h, s: z := its end, sources included. 0: it has no digits. As S = (1 − h A)⁻¹ P, a segment that begins with z and is taken
  /// back by that step, to (1 − h A) z, begins with what the jump P leads to, whatever h: impulses may be as small as a long step makes them. False: h is too long for
  /// what decays in the segment.
  [[nodiscard]] double step(Factors& factors, const Origin& start, std::vector<double>& z);
  [[nodiscard]] bool take_back(double h, std::vector<double>& z);
  /// After `open`: the end of an implicit Euler step of length h, s, from where the segment begins.
  [[nodiscard]] std::vector<double> euler_end(double h) const;

  /// After `open`, where states jump: what impulses make of the unknowns in a step of the segment's own.
  [[nodiscard]] std::vector<double> impulses() { return space_.impulses(); }
  /// Its length, s.
  [[nodiscard]] double step_length() const { return 1.0 / space_.shift(); }
  /// √energy of the difference of two points' states, of the largest √energy.
  [[nodiscard]] double distance(const std::vector<double>& a, const std::vector<double>& b) const { return space_.distance(a, b) / size_; }
  /// The end of that step.
  [[nodiscard]] std::vector<double> first_unknowns() const { return space_.first_unknowns(); }

  [[nodiscard]] double start() const { return start_; }
  /// How far its error is within the tolerance, s.
  [[nodiscard]] double length() const { return length_; }
  /// Guards that fall below zero at once: ports by number, then controls.
  [[nodiscard]] const std::vector<int>& negative() const { return negative_; }
  /// Whether the position differs from that one in a switch, or in a port that leaves zero: one at zero may be on either side.
  [[nodiscard]] bool changes_visibly(const Position& before);

  /// Ports that are off with no voltage across them for good: they may be on as well, and share a current.
  [[nodiscard]] const std::vector<int>& free_ports() const { return free_; }
  /// Ports that are on and carry nothing.
  [[nodiscard]] const std::vector<int>& idle_ports() const { return idle_; }

  /// What the largest input of the segment is a sum of, volts.
  [[nodiscard]] double input_terms() const { return input_terms_; }

  struct Passage {
    bool found = false;
    double tau = 0.0;
    int guard = -1;  ///< −1: none could be named
  };
  /// The first passage of a guard up to `end` (s from the start), else the end of what can be said.
  [[nodiscard]] const Passage& locate(double end);

  /// A guard at y: ports by number, then controls. Of a slope of y: its own, 1/s.
  [[nodiscard]] double guard(int guard, const std::vector<double>& y) const { return linalg::row_times(mode_->guards, guard, y.data()); }
  /// y' at y, 1/s.
  [[nodiscard]] std::vector<double> slope(const std::vector<double>& y) const;
  /// Whether rounding decides the sign that a port has in the unknowns at y: it is below zero for no longer than times have digits, on its way up from rounding at the start, or only by what is left of
  /// a decay that is over, which its guard leaves out.
  [[nodiscard]] bool is_at_zero(int port, const std::vector<double>& y) const;
  /// The slope of a guard at y, 1/s.
  [[nodiscard]] double guard_rate(int guard, const std::vector<double>& y) const;
  /// Guards of ports that are at zero at y, to rounding, and fall.
  [[nodiscard]] std::vector<int> falling_guards(const std::vector<double>& y) const;
  /// How well the time is known at which a guard passes zero at y, s.
  [[nodiscard]] double time_doubt(int guard, const std::vector<double>& y) const {
    return rounding_of(guard, y) / std::abs(guard_rate(guard, y));
  }
  /// The largest √energy so far.
  [[nodiscard]] double size() const { return size_; }

  /// y at τ, and what is made of it.
  [[nodiscard]] const std::vector<double>& at(double tau) { return later(segment_.y0, std::max(tau, 0.0)); }
  /// The same where it was y so long before, s.
  [[nodiscard]] const std::vector<double>& later(const std::vector<double>& y, double length);
  void unknowns(const std::vector<double>& y, std::vector<double>& z) const { space_.unknowns(y.data(), z); }
  void rates(const std::vector<double>& y, std::vector<double>& k, std::vector<double>& sizes) { space_.rates(y.data(), k, sizes); }
  /// The rows of signals, without their sources, in `values`.
  void set_signals(const std::vector<Form>& signals);
  [[nodiscard]] double signal(std::size_t i, const std::vector<double>& y) const;
  /// The sum of the magnitudes of its terms, which its rounding is relative to.
  [[nodiscard]] double signal_terms(std::size_t i, const std::vector<double>& y) const;

  /// States of that size, in volts, are not small.
  void note_least_voltage(double least);
  /// The run follows the segment that has been opened, and no other from there.
  void accept();
  /// Expected length of a segment in that position, s.
  [[nodiscard]] double usual_length(const Position& on, double longest) const;
  /// The segment ended at τ, by an event or as far as its error is within the tolerance.
  void note_event(double tau);
  void note_end(double tau);
  /// A guard that fell again at once counts from where it is visibly negative; the others as before.
  void mute(int guard);
  /// Where no guard could be named at once, and the position stays: signs decide at the end of a first interval.
  void sample_start() { samples_start_ = true; }
  /// The run has gone on.
  void unmute() {
    muted_.clear();
    samples_start_ = false;
  }

  /// From now on a position is left as soon as a few vectors show ports far on the wrong side: it is no segment to follow, `negative` says these ports.
  void reject_early(bool does) { rejects_early_ = does; }
  /// Whether the last one was.
  [[nodiscard]] bool is_rejected() const { return is_rejected_; }

  /// From now on a search for an event ends undecided once that is not zero. May be null.
  void heed(const std::atomic<int>* interrupt) { locator_.heed(interrupt); }

  /// From now on the ladder of 1/γ is so many times as high. Results must not depend on it.
  void scale_shifts(double factor) { shift_factor_ = factor; }

  /// From now on all segments are as exact, however much of the run they are.
  void keep_tolerance() { keeps_tolerance_ = true; }

  struct Counts {
    std::uint64_t segments = 0, vectors = 0, intervals = 0, sampled = 0;
  };
  [[nodiscard]] Counts counts() const { return {segments_, vectors_, locator_.intervals(), locator_.sampled()}; }
  /// After `open` from a point z: by how much its states at τ may be farther from those of the network's own motion than z is, √energy (krylov_bound.hpp). That is what `first`, where it
  /// begins, is off from z, and what comes after that.
  [[nodiscard]] double start_error(const std::vector<double>& z, const std::vector<double>& first) const {
    return space_.energy_distance(z, first);
  }
  [[nodiscard]] ErrorGrowth error_growth(double tau) const;
  /// Its error as estimated, of the largest √energy.
  [[nodiscard]] double relative_error() const { return size_ > 0.0 ? estimate_ / size_ : 0.0; }
  /// The largest estimate of an error so far, of the largest √energy.
  [[nodiscard]] double worst_estimate() const { return worst_; }

 private:
  static constexpr double share_of_norm = 0.1;  ///< of ‖row‖‖y‖: what a guard's rounding is measured by at least
  struct Habit {
    double length = 0.0, turning = 0.0;  ///< s, and radians per s
    double refused = INFINITY;           ///< the shortest length that could not be made, s
    Attempts attempts;                   ///< of such lengths
    int vectors = 0;                     ///< that its next segment is expected to need
    int most_vectors = most_of_segment;  ///< that have digits
    std::vector<double> shifts;
    bool refines = false;                              ///< solutions are corrected by their residuals
    bool stays_undecided = false;                      ///< a guard has no sign at the first length either
    bool is_regular = false;                           ///< it has had a factor without ε
    Attempts more_vectors;                             ///< than those that have digits
    double turn = usual_turn, longest = longest_turn;  ///< radians in γ
    bool turns_many_vectors = false;                   ///< the fastest oscillation was one of a space of many vectors
    bool turns = false;                                ///< it is seen in a space that is made for it, too
    double no_turning = INFINITY;                      ///< one so fast was nothing but rounding, radians per s
  };
  [[nodiscard]] static std::string key(const Position& on) { return {on.begin(), on.end()}; }
  [[nodiscard]] double steps_wanted() const;
  [[nodiscard]] bool is_for_turning(const Habit& habit, double length) const;
  [[nodiscard]] double wanted_shift(const Habit& habit, double length) const;
  [[nodiscard]] double rung_for(const Habit& habit, double length) const;
  [[nodiscard]] double shift_for(double length);
  bool takes_own_shift(double length, double failed);
  void note_attempt(double length, bool success);
  [[nodiscard]] double first_length() const;
  [[nodiscard]] bool is_undecided_by_habit(double longest);
  void count_states(const std::vector<double>& z);
  [[nodiscard]] Opened build(Factors& factors, const Origin& start);
  [[nodiscard]] Opened build(Factors& factors, const Origin& start, double length, double ratio, int attempts);
  [[nodiscard]] bool has_lost_rank(const Factor& factor);
  [[nodiscard]] bool resolve();
  [[nodiscard]] int first_dimension() const;
  [[nodiscard]] int expected_vectors() const;
  [[nodiscard]] double tolerance_for(double length) const;
  [[nodiscard]] bool has_wrong_signs();
  [[nodiscard]] bool is_wrong_by_signs(Factors& factors, double shift, const Origin& start, bool& is_begun);
  [[nodiscard]] bool is_cut_within(const std::vector<KrylovSpace::Checkpoint>& points);
  void look(Segment& segment, double reach, Located& located);
  [[nodiscard]] bool look_without_decays(double reach, Located& located);
  [[nodiscard]] std::optional<linalg::WideFastPart> decays_over(double reach) const;
  [[nodiscard]] bool begins_within_rounding(int row) const;
  [[nodiscard]] double last_zero(int row, double tau);
  void stretch(double longest);
  [[nodiscard]] bool reaches(double longer);
  [[nodiscard]] bool has_digits();
  [[nodiscard]] bool shows_growth(double length);
  [[nodiscard]] bool leaves_out_growth();
  [[nodiscard]] bool keeps_digits();
  [[nodiscard]] bool takes_longer_turn();
  [[nodiscard]] bool takes_shorter_turn();
  [[nodiscard]] bool takes_back(double length);
  [[nodiscard]] bool turns_by_more(bool is_cut);
  [[nodiscard]] bool forgets_turning();
  [[nodiscard]] int most_vectors_now();
  void note_digits(int vectors, bool has_all);
  void note_all_decays();
  [[nodiscard]] Opened open(Factors& factors, const Origin& start, int again);
  [[nodiscard]] bool ends_with_decay();
  void watch_guards(const Position& on);
  void take_guards(const Position& on);
  void find_parallel_ports();
  [[nodiscard]] bool is_short_circuited(int row) const;
  void drop_empty_guards();
  static void bound_mode(model::Mode& m);
  void bound_guards();
  void leave_out_decays();
  void note_rounding();
  void note_later_rounding();
  void judge_hidden();
  void note_terms();
  [[nodiscard]] double noise_of_row(int row, double least) const;
  [[nodiscard]] double size_by_leaks(std::size_t port) const;
  [[nodiscard]] double size_of_kind(int row) const;
  [[nodiscard]] double terms_of(int row) const;
  [[nodiscard]] double node_rounding(int row) const;
  [[nodiscard]] double rounding_size(const WatchedControl& control) const;
  [[nodiscard]] bool passes_at_rest(int row) const;
  [[nodiscard]] bool has_just_passed(int row) const;
  [[nodiscard]] bool is_taken_back(int row) const;
  [[nodiscard]] bool begins_at_zero(int row) const;
  void judge_start();
  [[nodiscard]] double rounding_of(int row, const std::vector<double>& y) const;

  const Descriptor& descriptor_;
  const Sources& sources_;
  const std::vector<WatchedControl>& controls_;
  const StateScale* scale_ = nullptr;  ///< sizes of states; null: their errors count by energy
  double tolerance_, stop_, least_voltage_ = 0.0, jump_voltage_ = 0.0, relaxation_ = 1.0, noise_ = 1.0, share_ = 1.0, shift_factor_ = 1.0;
  KrylovSpace space_;
  double start_ = 0.0, length_ = 0.0, peak_ = 0.0, worst_ = 0.0, estimate_ = 0.0, expected_ = 0.0, size_ = 0.0;
  double voltage_ = 0.0, current_ = 0.0;            ///< largest voltage, and other unknown, of the point it starts from, volts
  double most_voltage_ = 0.0, most_current_ = 0.0;  ///< the largest of those in the run
  Position on_;
  bool is_passive_ = false;
  bool takes_positive_ = false, refines_ = false;
  bool has_all_decays_ = false;  ///< of all rates: all vectors there are do not resolve them at the usual γ
  int passing_ = -1;
  double doubt_ = 0.0;        ///< of the time at which it passed, s
  std::vector<double> held_;  ///< of ports: the slack they have, or had, while on, until that is left behind
  Position passed_from_;      ///< where it was seen to
  Position passed_to_;        ///< the same with that port alone on its other side; of a control empty
  bool samples_start_ = false;
  bool rejects_early_ = false, is_rejected_ = false, keeps_tolerance_ = false;
  double present_tolerance_ = 0.0;  ///< of the segment at hand
  int vectors_of_last_ = 0, vectors_of_one_before_ = 0;
  std::string key_;
  std::unordered_map<std::string, Habit> habits_;
  std::unordered_map<int, double> muted_;
  model::System system_;
  std::unique_ptr<model::Mode> mode_;
  Segment segment_;
  Locator locator_;
  Passage passage_;
  bool located_ = false;
  double hidden_decay_ = 0.0;  ///< rate of a decay that it begins with, 1/s, if its error hides what that does to a guard
  bool hides_sign_ = false;    ///< such a decay, or its rounding, hides whether the guard is below zero once it is over
  std::vector<int> negative_, free_, idle_;
  /// Guards that begin below zero by rounding and rise; and the one that has just passed zero, where it is below for a small part of the segment: a leak carries what rounding leaves of a current.
  std::vector<int> rising_;
  std::vector<std::vector<int>> beside_;  ///< of each port those in parallel
  linalg::Vector terms_;                  ///< of guards: the magnitudes that each is a sum of at the start
  double input_ = 0.0;                    ///< the largest of those of currents
  std::vector<char> left_out_;            ///< of guards: a decay that is over is taken out of the row
  std::vector<double> later_noise_;       ///< of guards that read a decay that is not, once it is; infinite: they do not
  double start_rounding_ = 0.0;           ///< √energy
  std::vector<double> zeta_, y_, work_;
  double node_terms_ = 0.0, input_terms_ = 0.0;  ///< of the largest voltage, and of the largest input
  linalg::Matrix signal_rows_;
  std::vector<double> signal_constants_;
  std::uint64_t segments_ = 0, vectors_ = 0;
};

}  // namespace pwlsim::engine::sparse
