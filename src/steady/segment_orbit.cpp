#include "steady/segment_orbit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "steady/derivative_space.hpp"
#include "steady/known_inverse.hpp"
#include "steady/newton_cycle.hpp"
#include "steady/tolerances.hpp"

namespace pwlsim::steady {
namespace {

using engine::sparse::PeriodMap;
using State = PeriodMap::State;

constexpr int most_vectors = 300;     ///< of a space
constexpr int few_vectors = 4;        ///< between two looks at a residual
constexpr double gain_of_step = 0.5;  ///< of a residual
constexpr double natural = 0.75;      ///< of a step: what the next one may be
constexpr double pays = 0.5;          ///< the same, of a step that is taken for progress
constexpr int steps_that_need_not_pay = 3, implicit_steps = 6, phases_between_runs = 4;
constexpr double first_periods = 4.0, fewer = 0.25, more = 2.0,
                 many_more = 8.0;                             ///< of an implicit step, and what becomes of them from one to the next
constexpr double solved = 0.1;                                ///< of the residual at its begin: what is left of an implicit step's equation
constexpr int most_inner = 8;                                 ///< steps of Newton's method in it
constexpr double damping = 0.25, least_damping = 1.0 / 64.0;  ///< of those that do not lessen it
/// Of the residual of the best state: where one after the other of many stages begins to conduct, the residual rises and falls on the way to the orbit.
constexpr double far_worse = 8.0;
constexpr int drifts_followed = 5;
constexpr int most_returns = 8;  ///< towards the best state, from runs that fail
constexpr int leading = 6;       ///< multipliers sought
constexpr int looks_apart = 10;  ///< vectors between two looks at eigenvalues
constexpr int most_for_multipliers = 160;
constexpr int laps_on_end = 16;  ///< their time is absolute

/// Of a number of our own, without a pattern: −1 … 1.
double scattered(std::uint64_t i) {
  std::uint64_t x = (i + 1) * 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  x ^= x >> 27U;
  return static_cast<double>(x >> 11U) * 0x1p-52 - 1.0;
}

class SegmentSearch {
 public:
  SegmentSearch(PeriodMap& map, State& state, const OrbitTask& task)
      : map_(map),
        task_(task),
        state_(state),
        phi_{[this](Vector& v) { return map_.derivative(v); }, [this](const Vector& v) { return map_.energies(v); }} {}

  Orbit run() {
    orbit_.period = task_.period;
    if (!simulate(std::max(task_.periods_before, 1) * task_.multiple)) return std::move(orbit_);
    if (!lap()) return std::move(orbit_);
    while (orbit_.periods_simulated < task_.most_periods && orbit_.iterations < task_.most_iterations) {
      orbit_.residuals.push_back(norm_ / orbit_.largest);
      if (!map_.keeps_switches(state_, end_)) {
        if (!go_on(1)) return std::move(orbit_);
        continue;
      }
      if (is_small()) return finish();
      if (best_norm_ < 0.0 || norm_ < pays * best_norm_) keep();
      const Progress progress = follows_ > 0 ? implicit_step() : newton_step();
      if (progress == Progress::done) return finish();
      if (progress == Progress::failed) return std::move(orbit_);
      if (progress == Progress::stuck && !begin_to_follow()) return std::move(orbit_);
    }
    if (orbit_.residuals.empty()) orbit_.residuals.push_back(norm_ / orbit_.largest);
    orbit_.verdict = Verdict::not_converged;
    const auto before = map_.positions();
    State next = end_;
    const bool runs_on = map_.advance(next, task_.period, true).outcome == engine::Outcome::completed;
    orbit_.repeats_modes = runs_on && map_.positions_of_last() == before;
    return std::move(orbit_);
  }

 private:
  enum class Progress { stepped, stuck, done, failed };

  bool fail(engine::Answer answer) {
    orbit_.verdict = answer.outcome == engine::Outcome::interrupted ? Verdict::interrupted : Verdict::run_failed;
    orbit_.answer = std::move(answer);
    return false;
  }

  bool simulate(int periods) {
    const int laps = (periods + task_.multiple - 1) / task_.multiple;
    for (int done = 0; done < laps;) {
      const int count = std::min(laps_on_end, laps - done);
      engine::Answer answer = map_.advance(state_, count * task_.period, false);
      orbit_.periods_simulated += count * task_.multiple;
      done += count;
      if (answer.outcome != engine::Outcome::completed) return fail(std::move(answer));
    }
    return true;
  }

  /// The period from state_ on. False: failed.
  bool lap() {
    engine::Answer answer = run_from(state_, end_, false);
    if (answer.outcome != engine::Outcome::completed) return fail(std::move(answer));
    orbit_.answer = std::move(answer);
    map_.keep();
    take_residual();
    return true;
  }

  engine::Answer run_from(const State& state, State& end, bool is_trial) {
    end = state;
    orbit_.periods_simulated += task_.multiple;
    return map_.advance(end, task_.period, true, is_trial);
  }

  void take_residual() {
    residual_ = map_.unknowns(end_) - map_.unknowns(state_);
    norm_ = map_.energies(residual_).norm();
    orbit_.largest = std::max({map_.largest(), map_.energies(map_.unknowns(end_)).norm(), 1e-300});
  }

  bool go_on(int periods) {
    state_ = end_;
    return ((periods <= 1 || simulate((periods - 1) * task_.multiple)) && lap()) || go_back();
  }

  /// A run that fails on the way: the search begins again from between the state that it began with and the best one so far, half as far from that each time. (The motion from the best one itself
  /// may lead to the same failure again.) False: failed.
  bool go_back() {
    const Vector failed = map_.unknowns(state_);
    while (orbit_.verdict != Verdict::interrupted && !best_state_.empty() && returns_ < most_returns) {
      const Vector best = map_.unknowns(best_state_);
      const double share = std::ldexp(1.0, -++returns_);
      state_ = best_state_;
      map_.step_to(state_, (1.0 - share) * best + share * failed);
      follows_ = implicit_steps;
      inner_ = 0;
      if (lap()) return true;
    }
    return false;
  }

  [[nodiscard]] bool is_small() const {
    const double floor = tolerance::lap_rounding * std::sqrt(static_cast<double>(1 + map_.segments()));
    return norm_ <= std::max(floor, task_.tolerance) * orbit_.largest;
  }

  /// A space that solves (s − Φ) δ = right. Empty: Φ has no products.
  [[nodiscard]] std::optional<DerivativeSpace> space_for(const Vector& right, double s, double wanted) {
    return space_of(phi_, right, s, wanted, most_vectors);
  }

  /// The same with what is known of Φ, and so many vectors at most.
  [[nodiscard]] std::optional<DerivativeSpace> space_of(const DerivativeSpace::Operator& phi, const Vector& right, double s, double wanted,
                                                        int most) {
    DerivativeSpace space(phi, right);
    while (!space.is_full() && space.dimension() < most) {
      if (!space.grow()) {
        orbit_.kink = map_.failure();
        return std::nullopt;
      }
      if ((space.dimension() <= few_vectors || space.dimension() % few_vectors == 0) && space.residual(s) <= wanted) break;
    }
    return space;
  }

  /// (1 − Φ) δ = right by what is known of the inverse. Empty: it takes more vectors than without, and is forgotten.
  [[nodiscard]] std::optional<Vector> solve_by_known(const Vector& right, double wanted, bool learns) {
    if (known_.is_empty()) return std::nullopt;
    const auto space = space_of(known_.psi(), right, 1.0, wanted, vectors_of_phi_);
    if (!space || !(space->residual(1.0) <= wanted)) {
      known_.forget();
      return std::nullopt;
    }
    Vector delta = known_.applied(space->solve(1.0).delta);
    if (learns) known_.learn(*space);
    return delta;
  }

  struct Correction {
    Vector delta, mapped;  ///< (1 − Φ) δ is the residual, and Φ δ
    Vector drift;          ///< what of the residual no δ has, in √J; may be empty
  };
  /// Empty: Φ has no products.
  [[nodiscard]] std::optional<Correction> correction() {
    if (auto delta = solve_by_known(residual_, tolerance::solved_system, true)) {
      Vector mapped = *delta;  // by the product itself: its zeros are exact
      if (!phi_.apply(mapped)) return std::nullopt;
      return Correction{std::move(*delta), std::move(mapped), {}};
    }
    const auto space = space_for(residual_, 1.0, tolerance::solved_system);
    if (!space) return std::nullopt;
    DerivativeSpace::Solution solution = space->solve(1.0);
    vectors_of_phi_ = space->dimension();
    known_.learn(*space);
    return Correction{std::move(solution.delta), std::move(solution.mapped),
                      space->measured(space->part_at_one(tolerance::multiplier_at_one))};
  }

  /// A step from the lap at hand.
  struct Trial {
    State state, end;
    engine::Answer answer;
    Vector residual;
    double norm = 0.0;
    [[nodiscard]] bool is_complete() const { return answer.outcome == engine::Outcome::completed; }
    [[nodiscard]] bool is_interrupted() const { return answer.outcome == engine::Outcome::interrupted; }
  };

  /// The state moves from the end of the lap by `by`, which fits its position there.
  Trial try_step(const Vector& by) {
    Trial trial;
    trial.state = end_;
    map_.step_to(trial.state, map_.unknowns(end_) + by);
    ++orbit_.iterations;
    trial.answer = run_from(trial.state, trial.end, true);
    if (!trial.is_complete()) return trial;
    trial.residual = map_.unknowns(trial.end) - map_.unknowns(trial.state);
    trial.norm = map_.energies(trial.residual).norm();
    return trial;
  }

  void accept(Trial trial) {
    state_ = std::move(trial.state);
    end_ = std::move(trial.end);
    orbit_.answer = std::move(trial.answer);
    map_.keep();
    take_residual();
  }

  /// A step of Newton's method. It must pass the natural test, or be one of a few that need not. `done`: no step lessens the residual, which is rounding.
  Progress newton_step() {
    orbit_.kink.clear();
    const bool is_close = norm_ <= tolerance::close_lap * orbit_.largest;
    if (is_close) known_.forget();  // its rounding would be that of the orbit
    const std::optional<Correction> found = correction();
    if (!found) return is_close && stands_still() ? Progress::done : stuck_without_derivative();
    if (found->drift.norm() > tolerance::unreachable_residual * orbit_.largest) return drift(found->drift);
    Trial trial = try_step(found->mapped);
    if (trial.is_interrupted()) {
      fail(std::move(trial.answer));
      return Progress::failed;
    }
    if (!trial.is_complete() || !map_.keeps_switches(trial.state, trial.end)) return Progress::stuck;
    if (is_close && trial.norm > gain_of_step * norm_) {
      if (trial.norm < norm_) accept(std::move(trial));
      return Progress::done;
    }
    if ((!passes(trial, map_.energies(found->delta).norm()) && bold_-- <= 0) || cycle_.closes(norm_)) return Progress::stuck;
    accept(std::move(trial));
    return Progress::stepped;
  }

  /// Deuflhard's natural test: the step that Φ, of the point before, makes from the trial is shorter.
  bool passes(const Trial& trial, double length) {
    auto delta = solve_by_known(trial.residual, tolerance::solved_roughly, false);
    if (!delta) {
      const auto space = space_for(trial.residual, 1.0, tolerance::solved_roughly);
      if (!space) return false;
      delta = space->solve(1.0).delta;
    }
    return map_.energies(*delta).norm() <= natural * length;
  }

  Progress stuck_without_derivative() { return go_on(1) ? Progress::stepped : Progress::failed; }

  [[nodiscard]] bool stands_still() {
    const bool still = last_norm_ >= 0.0 && norm_ >= gain_of_step * last_norm_;
    last_norm_ = norm_;
    return still;
  }

  /// Newton's method for one step of the implicit Euler method along x' = φ(x) − x, x a function of the number of periods, over `pace_` of them:
  /// g = φ(x) − x − (x − x₀)/pace = 0. In a circuit whose switches follow time alone φ does not expand, and each such step has one solution, from which φ(x) − x is smaller than from x₀.
  Progress implicit_step() {
    const Vector at = map_.unknowns(state_);
    if (pace_ == 0.0) pace_ = first_periods;
    if (inner_ == 0) begin_implicit(at);
    Vector g = residual_ - (at - anchor_) / pace_;
    const bool is_solved = inner_ > 0 && map_.energies(g).norm() <= solved * anchor_norm_;
    if (is_solved || inner_ >= most_inner) {
      pace_ = std::max(1.0, pace_ * (!is_solved ? fewer : inner_ == 1 ? many_more : more));
      if (!is_solved && norm_ > anchor_norm_) {
        state_ = anchor_state_;
        if (!lap() && !go_back()) return Progress::failed;
      }
      if (--follows_ == 0) best_norm_ = -1.0;
      inner_ = 0;
      return Progress::stepped;
    }
    const double shift = 1.0 + 1.0 / pace_;
    const auto space = space_for(g, shift, tolerance::solved_roughly);
    if (!space) return leave_implicit();
    const Vector step = space->solve(shift).delta;
    const double size = map_.energies(g).norm();
    for (double share = 1.0; share >= least_damping; share *= damping) {
      Trial trial = try_step(share * step - residual_);
      if (trial.is_interrupted()) {
        fail(std::move(trial.answer));
        return Progress::failed;
      }
      if (!trial.is_complete() || !map_.keeps_switches(trial.state, trial.end)) continue;
      const Vector left = trial.residual - (map_.unknowns(trial.state) - anchor_) / pace_;
      if (!(map_.energies(left).norm() < size)) continue;
      ++inner_;
      accept(std::move(trial));
      return Progress::stepped;
    }
    inner_ = most_inner;
    if (pace_ > 1.0) return Progress::stepped;
    return leave_implicit();
  }

  void begin_implicit(const Vector& at) {
    anchor_ = at;
    anchor_state_ = state_;
    anchor_norm_ = norm_;
  }

  Progress leave_implicit() {
    inner_ = 0;
    if (follows_ > 0 && --follows_ == 0) best_norm_ = -1.0;
    return go_on(1) ? Progress::stepped : Progress::failed;
  }

  void keep() {
    best_state_ = state_;
    best_norm_ = norm_;
    bold_ = steps_that_need_not_pay;
    cycle_.restart();
    returns_ = 0;
  }

  bool begin_to_follow() {
    if (norm_ > far_worse * best_norm_) {
      state_ = best_state_;
      if (!lap()) return false;
    }
    follows_ = implicit_steps;
    inner_ = 0;
    if (++phases_ % phases_between_runs != 0) return true;
    patience_ *= 2;
    return go_on(patience_);
  }

  /// The residual has a part along an eigenvalue 1: each period adds the same.
  Progress drift(const Vector& part) {
    orbit_.drift = part;
    if (drifts_ < drifts_followed) {
      ++drifts_;
      return go_on(4 << drifts_) ? Progress::stepped : Progress::failed;
    }
    orbit_.verdict = Verdict::drifts;
    return Progress::failed;
  }

  Orbit finish() {
    orbit_.verdict = Verdict::found;
    for (std::size_t i = 0; i < state_.size(); ++i) state_[i].signals = end_[i].signals;  // of a step they are those of the lap before
    orbit_.residual = norm_ / orbit_.largest;
    take_uncertainty();
    take_multipliers();
    take_repeats();
    return std::move(orbit_);
  }

  /// What is left of a step of Newton's method, or where that has no derivative, of the residual: rounding of a lap leaves the more, the slower the orbit attracts.
  void take_uncertainty() {
    orbit_.uncertainty = share_of_unit(residual_);
    if (!(norm_ > 0.0)) return;
    const auto space = space_for(residual_, 1.0, tolerance::solved_roughly);
    orbit_.kink.clear();
    if (space && space->part_at_one(tolerance::multiplier_at_one).norm() == 0.0)
      orbit_.uncertainty = std::max(orbit_.uncertainty, share_of_unit(space->solve(1.0).delta));
  }

  /// The largest of a deviation's stores, of the largest of its unit in the lap.
  [[nodiscard]] double share_of_unit(const Vector& deviation) const {
    const Vector values = map_.largest_values(), apart = map_.values(map_.energies(deviation));
    std::map<std::string, double> largest;
    const auto& stores = map_.stores();
    for (std::size_t i = 0; i < stores.size(); ++i) {
      double& most = largest[stores[i].unit];
      most = std::max(most, std::abs(values[static_cast<Eigen::Index>(i)]));
    }
    double share = 0.0;
    for (std::size_t i = 0; i < stores.size(); ++i)
      if (const double most = largest[stores[i].unit]; most > 0.0)
        share = std::max(share, std::abs(apart[static_cast<Eigen::Index>(i)]) / most);
    return share;
  }

  /// From a vector in which all take part.
  void take_multipliers() {
    orbit_.has_leading_only = true;
    orbit_.kink.clear();
    Vector start(residual_.size());
    for (Eigen::Index i = 0; i < start.size(); ++i) start[i] = scattered(static_cast<std::uint64_t>(i));
    if (map_.energies(start).size() == 0) return;
    if (!map_.smooth(start) || !map_.derivative(start)) {
      orbit_.kink = map_.failure();
      return;
    }
    DerivativeSpace space(phi_, start);
    LeadingPairs leading_pairs;
    if (!find_leading(space, leading_pairs) || space.start_norm() == 0.0 || leading_pairs.pairs.empty()) return;
    const auto& [pairs, known] = leading_pairs;
    if (known == 0) orbit_.unknown_stability = fmt::format("the largest multiplier is known to {:.1g} only", pairs.front().residual);
    if (known == 0 || !follows(space, pairs.front())) return;
    for (std::size_t i = 0; i < known && std::abs(pairs[i].value) > tolerance::zero_leading_multiplier; ++i)
      add_multiplier(space, pairs[i]);
  }

  /// Eigenvalues of the derivative, the largest first, of which the first `known` are known.
  struct LeadingPairs {
    std::vector<DerivativeSpace::Pair> pairs;
    std::size_t known = 0;
  };

  /// False where the map has no derivative.
  bool find_leading(DerivativeSpace& space, LeadingPairs& found) {
    while (!space.is_full() && space.dimension() < most_for_multipliers) {
      if (!space.grow()) {
        look(space, found);
        if (space.dimension() > 0 && found.known == found.pairs.size())
          break;  // the vector that cannot be followed is what rounding leaves
        orbit_.kink = map_.failure();
        return false;
      }
      for (const auto& beside : map_.beside()) note(beside);
      if (space.dimension() % looks_apart != 0 && !space.is_full()) continue;
      look(space, found);
      if (found.known >= leading) break;
    }
    return true;
  }

  static void look(const DerivativeSpace& space, LeadingPairs& found) {
    auto& [pairs, known] = found;
    pairs = space.pairs();
    known = 0;
    while (known < pairs.size() && pairs[known].residual <= tolerance::known_multiplier * std::max(1.0, std::abs(pairs[known].value)))
      ++known;
  }

  void add_multiplier(const DerivativeSpace& space, const DerivativeSpace::Pair& pair) {
    Multiplier m;
    m.value = pair.value;
    const Vector re = pair.coordinates.real(), im = pair.coordinates.imag();
    m.direction =
        space.measured(re).cast<std::complex<double>>() + std::complex<double>(0.0, 1.0) * space.measured(im).cast<std::complex<double>>();
    m.residual = std::max(pair.residual, map_.worst_error());
    if (std::abs(m.value - 1.0) <= tolerance::multiplier_at_one) orbit_.free_directions.push_back(m.direction.real().normalized());
    orbit_.multipliers.push_back(std::move(m));
  }

  /// Whether a run beside the orbit, on either side, ends where the derivative says.
  bool follows(const DerivativeSpace& space, const DerivativeSpace::Pair& pair) {
    const Vector coordinates = pair.coordinates.real();
    const Vector from = space.unknowns(coordinates), to = space.mapped(coordinates);
    const double size = map_.energies(from).norm(), length = tolerance::beside_orbit * orbit_.largest / size;
    const Vector end = map_.unknowns(end_);
    double worst = 0.0;
    for (const double sign : {1.0, -1.0}) {
      State beside = end_;
      map_.move_to(beside, end + sign * length * from);
      const engine::Answer answer = map_.advance(beside, task_.period, false);
      if (answer.outcome != engine::Outcome::completed) return true;  // no run, no objection
      const Vector error = map_.unknowns(beside) - end - sign * length * to;
      worst = std::max(worst, map_.energies(error).norm() / (length * size));
    }
    if (worst <= tolerance::follows_derivative) return true;
    orbit_.unknown_stability = fmt::format("runs beside the orbit differ from its derivative by {:.1g}", worst);
    return false;
  }

  void note(const engine::sparse::SegmentDeviation::Beside& beside) {
    const auto same = [&](const NamedBeside& other) { return other.name == beside.port && other.time == beside.time; };
    auto& list = orbit_.named_beside;
    if (std::none_of(list.begin(), list.end(), same)) list.push_back({beside.time, beside.port});
  }

  void take_repeats() {
    for (int part = 1; part <= task_.multiple / 2; ++part) {
      if (task_.multiple % part != 0) continue;
      State state = end_;
      if (map_.advance(state, task_.period * part / task_.multiple, false).outcome != engine::Outcome::completed) continue;
      if (map_.energies(map_.unknowns(state) - map_.unknowns(end_)).norm() > tolerance::repeated_point * orbit_.largest) continue;
      orbit_.repeats_after = part;
      return;
    }
  }

  PeriodMap& map_;
  const OrbitTask& task_;
  State& state_;
  DerivativeSpace::Operator phi_;
  KnownInverse known_{phi_};
  int vectors_of_phi_ = 0;  ///< of the last space that began without it
  Orbit orbit_;
  State end_, best_state_, anchor_state_;
  Vector residual_, anchor_;  ///< the point from which an implicit step is taken
  double norm_ = 0.0, anchor_norm_ = 0.0, best_norm_ = -1.0, last_norm_ = -1.0, pace_ = 0.0;
  NewtonCycle cycle_;
  int bold_ = 0, follows_ = 0, inner_ = 0, phases_ = 0, patience_ = 1, drifts_ = 0, returns_ = 0;
};

}  // namespace

Orbit find_segment_orbit(PeriodMap& map, State& state, const OrbitTask& task) { return SegmentSearch(map, state, task).run(); }

}  // namespace pwlsim::steady
