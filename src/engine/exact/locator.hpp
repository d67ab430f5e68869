#pragma once
/// Guaranteed event location: the first time at which a guard g(τ) = row·y(τ) of a mode falls below zero.
///
/// On an interval [τ, τ+h] every guard is excluded, shown to have exactly one root, shown to touch zero without crossing (a graze:
/// no event), or the interval is halved. The state is y = (c, ζ) of model/mode.hpp: c' = A₁c + E₁ζ, and ζ are the sources. The tests use the
/// bound, valid for every τ ≥ 0 in the segment,
///
///     |g^{(j)}| ≤ K_j = ‖row_c‖·e^{μ⁺h}(‖c^{(j)}‖ + h·max‖E₁ζ^{(j)}‖) + max|row_ζ ζ^{(j)}|,
///
/// with μ⁺ the logarithmic norm of A₁, or 0 if that is negative. It is insensitive to stiffness because energy coordinates make e^{A₁τ} a
/// contraction for passive circuits. Guards that start at zero are safe on (0, (m+1)g_m/K_{m+1}] if their first nonzero derivative g_m > 0 has
/// order m.
///
/// Ways to search, in the order in which `march` tries them; each decides some length of the segment, or leaves it to the next:
///
/// 1. straight lines: all guards are polynomials of time; exact (locator.cpp);
/// 2. two derivatives ahead: a falling guard whose bend is bounded up to its root (locator_ahead.cpp);
/// 3. eigenvectors: the guard as a sum of exponentials, each enclosed by itself; after three intervals (locator_modal.cpp, modal_search.hpp);
/// 4. Taylor models: a polynomial of degree ten and a bounded remainder; modes that are not stiff (locator_series.cpp);
/// 5. bounds of low order: the second derivative is bounded on the interval; stiff modes (locator.cpp);
/// 6. samples: signs at the interval's end; only where an interval cannot be decided, and the run says so (locator.cpp).
///
/// A segment that begins with fast decays (model::Decays) is searched by the sum of the slow motion and the decays (locator_decays.cpp), then as
/// above. docs/developer/performance.md, "Which rung decides", counts how often each of them does.

#include <atomic>
#include <cmath>
#include <vector>

#include "engine/exact/modal_search.hpp"
#include "engine/exact/tolerances.hpp"
#include "model/mode.hpp"
#include "model/verify.hpp"

namespace pwlsim::engine {

/// A segment: one mode from its anchor on. `tau` counts from the anchor.
struct Segment {
  const model::System* system = nullptr;
  const model::Mode* mode = nullptr;
  double anchor = 0.0;                       ///< absolute time, s
  double late = 0.0;                         ///< rounding error of the anchor
  double longest = INFINITY;                 ///< s: its mode serves for no longer, and for no other
  std::vector<double> y0;                    ///< state at the anchor
  std::vector<int> rows;                     ///< guard rows to watch
  std::vector<model::Departure> departures;  ///< of each at the anchor

  double least_noise = tolerance::graze;  ///< of a guard's terms: a minimum so far below zero touches it
  bool passes_rest = false;               ///< guards that are rounding at both ends of an interval do not pass in between
  bool is_brief = false;                  ///< it lasts as long as fast decays, and may be shorter than the rounding of the anchor
  /// Of such a one, ψ_k at the anchor (model::Decays), then what rounding may add to each; empty: not known yet, or there are none.
  std::vector<double> decays;
  bool decays_fail = false;  ///< they do not describe the guards
  bool is_enclosed = false;  ///< all guards were, by them, on the last interval
  double tau = 0.0;          ///< reached so far; y is the state there
  std::vector<double> y;
  double certified = 0.0;            ///< no guard falls below zero before
  std::uint64_t intervals = 0;       ///< examined so far
  bool sampled = false;              ///< some intervals only by signs at their ends
  bool begins_sampled = false;       ///< the next one is: no bound has decided it
  double step = 0.0;                 ///< length of the last interval decided, 0: none yet
  int turns_without_modal_form = 0;  ///< next intervals in which eigenvectors are not used
  int turns = 0;                     ///< intervals in a stiff mode for which the series is tried (> 0) or not (< 0)
};

struct Located {
  bool found = false;
  double tau = 0.0;
  int row = -1;               ///< guard row that crosses; −1: the interval could not be decided, and the selection decides
  const double* y = nullptr;  ///< state at tau, valid until the next call
};

class Locator {
 public:
  /// First crossing in (certified, end], end counted from the anchor; without one the segment is certified up to `end`.
  void locate(Segment& segment, double end, Located& located);

  /// From now on a search ends undecided once that is not zero. May be null.
  void heed(const std::atomic<int>* interrupt) { interrupt_ = interrupt; }

  [[nodiscard]] std::uint64_t intervals() const { return intervals_; }
  /// Segments whose guards were sampled because the bounds did not decide.
  [[nodiscard]] std::uint64_t sampled() const { return sampled_; }

 private:
  enum class Verdict { excluded, one_root, undecided };
  struct Root {
    Verdict verdict = Verdict::excluded;
    double upper = 0.0;  ///< one root in (lower, upper), g(upper) < 0
    double below = 0.0;  ///< for a guard that stays at zero: the event is where it is this far below zero; before, its sign is rounding
    double lower = 0.0;  ///< up to here the guard does not fall, though it may begin below zero, by what decays hold
  };

  void prepare(Segment& segment);
  /// It follows decays whose sums are known to their end.
  [[nodiscard]] static bool is_sharp(const Segment& segment) { return !segment.decays.empty() && segment.mode->slow->decays->are_sharp; }
  void differentiate_state(const Segment& segment);
  void derive(const Segment& segment);
  struct Bound {
    const double* derivative = nullptr;  ///< at the interval's start
    double growth = 1.0, inputs = 0.0;
    double scaled_growth = 1.0, scaled_inputs = 0.0;  ///< in the balanced norm, where the mode has one
    std::uint64_t reads = 0;                          ///< entries of c that `state` is of (Mode::guard_reads)
    double state = 0.0, scaled_state = 0.0;           ///< times ‖row_c‖, ‖row_c S‖
    bool sources = false;                             ///< block_bound_ holds something
  };
  static void bound_state(const model::Mode& mode, Bound& bound);
  Bound bound_in(const model::Mode& mode, const model::Exosystem& sources, int order, const double* derivative, const double* zeta,
                 double h);
  [[nodiscard]] double bound_in_at(const model::Mode& mode, Bound& bound, int row) const;
  Bound bound_of(const Segment& segment, int order, const double* derivative, double h);
  [[nodiscard]] double bound_at(const Segment& segment, Bound& bound, int row);
  void take_decays(Segment& segment);
  void derive_with_decays(const Segment& segment);
  bool derive_sum(const Segment& segment, std::size_t i, double rate_noise);
  struct Line {
    double value = 0.0, slope = 0.0;
  };
  [[nodiscard]] Line sum_at(const Segment& segment, std::size_t i, double at) const;
  double root_by_values(const Segment& segment, std::size_t i, double lower, double upper, double below);
  void take_slow_state(const Segment& segment, const double* y);
  bool decays_hold(const Segment& segment, double h);
  void bound_slow(const Segment& segment, int order, double h);
  void bound_decays(const Segment& segment, int order, double h);
  struct Enclosed {
    double until = 0.0;  ///< s from the interval's start: decided so far
    bool falls = false;  ///< it has one root before, and is negative there
    double from = 0.0;   ///< the root lies behind
  };
  void take_parts(double h, int halvings);
  const double* left_at(const Segment& segment, std::size_t part);
  void split_at_decays(const Segment& segment, double h);
  [[nodiscard]] Verdict enclose(const Segment& segment, std::size_t i, std::size_t first, std::size_t last);
  [[nodiscard]] Enclosed enclose_in_parts(const Segment& segment, std::size_t i);
  void bound_slow_by_series(const Segment& segment, double h);
  bool enclose_rest(const Segment& segment, double h);
  double enclose_guards(Segment& segment, double h);
  bool decide_by_enclosures(Segment& segment, double h, double end, Located& located);
  [[nodiscard]] Verdict verdict_at_end(const Segment& segment, std::size_t i, double h) const;
  void bound_second(const Segment& segment, double h);
  void bound_bends(const Segment& segment, double h);
  void narrow_bends(const Segment& segment, double h);
  [[nodiscard]] bool stays_positive(std::size_t i, double h) const;
  [[nodiscard]] bool falls_throughout(const Segment& segment, std::size_t i, double h) const;
  struct Outlook {
    Verdict verdict = Verdict::undecided;
    std::size_t row = 0;  ///< number of the guard with the first root
  };
  Outlook outlook(const Segment& segment, double h);
  [[nodiscard]] double length_to_first_root(const Segment& segment, double longest) const;
  bool falling(Segment& segment, std::size_t i, double h, double end, Located& located);
  bool look_ahead(Segment& segment, double end, Located& located);
  const double* third_derivative(const Segment& segment);
  [[nodiscard]] double end_value(const Segment& segment, std::size_t i) const;
  double end_slope(const Segment& segment, std::size_t i);
  Root examine(const Segment& segment, std::size_t i, double h);
  Root convex(const Segment& segment, std::size_t i, double h, double ge, double noise);
  [[nodiscard]] double parabola_root(std::size_t i) const;
  [[nodiscard]] double cubic_root(const Segment& segment, std::size_t i) const;
  double find_root(const Segment& segment, std::size_t i, double lower, double upper, double guess, double below);
  double approach_root(const Segment& segment, std::size_t i, double lower, double upper, double at, double below);
  double go_to_root(const Segment& segment, std::size_t i, double lower, double upper, double guess, double below);
  double polish_or_search(const Segment& segment, std::size_t i, double lower, double upper, double at);
  struct FirstFall {
    double at = INFINITY;  ///< s from the interval's start; infinite: none
    double below = 0.0;    ///< as Root::below
    std::size_t index = 0;
  };
  void take_earlier(const Segment& segment, std::size_t i, const Root& root, FirstFall& first);
  void end_at_event(Segment& segment, std::size_t i, double tau, double end, Located& located);
  bool march_by_bounds(Segment& segment, double end, double shortest, Located& located);
  bool march_by_series(Segment& segment, double end, Located& located);
  void straight_lines(Segment& segment, double end, Located& located);
  void accept(Segment& segment, double h, double end);
  void march(Segment& segment, double end, Located& located);
  [[nodiscard]] bool is_interrupted() const { return interrupt_ != nullptr && interrupt_->load(std::memory_order_relaxed) != 0; }
  static bool is_worth_eigenvectors(const Segment& segment);
  enum class Progress { none, some, to_end };
  static Progress ask_later(Segment& segment, int turns);
  Progress search_modal_form(Segment& segment, double end, double shortest, Located& located);
  Progress pass_without_root(Segment& segment, double end, double shortest, const ModalSearch::Found& found, std::uint64_t used);
  void differentiate(const Segment& segment);
  void series_state(const Segment& segment, double step, double* out);
  struct Isolated {
    Verdict verdict = Verdict::excluded;
    double lower = 0.0, upper = 0.0, guess = 0.0;  ///< one root inside, s from the interval's start
    double below = 0.0;                            ///< as Root::below
  };
  struct FirstRoot {
    bool is_clear = true;  ///< every guard is decided
    bool is_found = false;
    std::size_t row = 0;  ///< number of the guard
    Isolated root;
  };
  FirstRoot first_root(const Segment& segment, double h);
  void end_at_root(Segment& segment, const FirstRoot& first, double end, Located& located);
  Isolated leave_rest(const Segment& segment, std::size_t i, double h);
  /// `powers`: h^j/j!; `next_derivative` bounds the guard's first derivative beyond the series.
  Isolated isolate_root(const Segment& segment, std::size_t i, double h, const double* powers, double next_derivative);
  void state_at(const Segment& segment, double step, double* out);
  bool try_interval(Segment& segment, double h, double end, Located& located, bool& decided);
  bool polish(const Segment& segment, int row, double& tau);
  [[nodiscard]] double noise_of(const Segment& segment, int row) const;
  [[nodiscard]] double noise_at_rest(const Segment& segment, std::size_t i) const;
  [[nodiscard]] bool is_at_rest(const Segment& s, std::size_t i) const;
  [[nodiscard]] bool is_within_rounding(const Segment& s, std::size_t i) const;
  [[nodiscard]] bool rest_at(const Segment& s, const double* y) const;
  bool sample_interval(Segment& segment, double h, double end, Located& located);

  static constexpr int series_order = 10;  ///< of the Taylor models
  /// Relative to its rounding, for a guard that leaves zero within an interval: in a longer one it could fall again unseen.
  static constexpr double leaving_zero = 1e3;
  /// Of where a guard was when its mode was accepted, below zero: from there on it has fallen.
  static constexpr double fallen_further = 2.0;

  std::size_t size_ = 0;  ///< states the buffers are made for
  std::vector<double> ye_, work_, at_, a1_, a2_, event_;
  std::vector<double> g_, gd_, g2_, k2_;
  std::vector<double> least_bend_, most_bend_;  ///< bounds of the guards' second derivatives
  std::vector<double> derivatives_;             ///< A^j y at the interval's start, j = 0 … order + 1
  bool has_third_ = false;                      ///< j = 3 is among them
  std::vector<double> guard_derivatives_;       ///< rows × (order + 1)
  std::vector<double> block_bound_;
  Bound slow_bound_;                 ///< of the slow motion beside decays
  std::vector<double> slope_doubt_;  ///< possible errors of the guards' slopes from rounding of the decays' weights
  std::vector<double> slow_g2_;      ///< second derivatives of the slow motion's guards at the interval's start
  /// Of the slow motion at the interval's start: guards, slopes, their rounding, bounds of the second derivative.
  std::vector<double> slow_g_, slow_gd_, slow_doubt_, slow_k2_;
  bool decays_agree_ = true;         ///< guards and slopes at the interval's start are those sums
  std::vector<double> decay_bound_;  ///< of the derivative of each decay; empty: the mode has none
  std::vector<double> decay_left_;   ///< e^{−τ/T_k}
  std::vector<double> end_left_;     ///< the same at the interval's end
  std::vector<double> slow_series_;  ///< derivatives of the slow motion at the interval's start, from the second on
  std::vector<double> parts_;        ///< ends of the interval's parts, s from its start
  std::vector<double> part_left_;    ///< e^{−τ/T_k} at each of them that was asked for
  std::vector<Enclosed> enclosed_;   ///< each guard
  std::vector<double> guard_noise_;  ///< rounding of each guard
  std::vector<double> whole_state_, slow_state_;
  std::vector<double> slow_slope_, slow_bend_;  ///< of the slow motion at the interval's start
  ModalSearch modal_search_;
  std::vector<ModalSearch::Guard> modal_guards_;
  std::vector<std::size_t> modal_numbers_;  ///< of these among the segment's rows
  std::vector<std::size_t> resting_;        ///< the others
  std::uint64_t intervals_ = 0, sampled_ = 0;
  const std::atomic<int>* interrupt_ = nullptr;
};

}  // namespace pwlsim::engine
