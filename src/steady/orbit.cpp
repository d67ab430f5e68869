#include "steady/orbit.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "linalg/factorisations.hpp"
#include "steady/newton_cycle.hpp"
#include "steady/tolerances.hpp"

namespace pwlsim::steady {
namespace {

using engine::RunState;

constexpr double rounding_levels = 4.0;  ///< of a state, that a residual may have
constexpr double least_gain = 0.5;       ///< of a residual that is close, or it is rounding
constexpr std::size_t few_segments = 8;  ///< of a period, for its largest state to be looked for inside of them
constexpr int points_inside = 7;
constexpr int most_drifts = 12;
constexpr int most_laps_at_once = 16;     ///< of periods on end: their time is absolute
constexpr double much_better = 0.5;       ///< of a residual: a step that pays
constexpr int bold_steps = 3;             ///< of Newton's method that need not pay
constexpr int steps_followed = 6;         ///< implicit ones, before Newton's method is tried again
constexpr int phases_before_periods = 4;  ///< such phases, before periods are simulated
constexpr double first_pace = 4.0, slower = 0.25,
                 faster = 4.0;  ///< periods of an implicit step, and what becomes of them from one to the next

/// The modes of each island, in order.
std::vector<std::pair<std::size_t, const model::Mode*>> modes_of(const Trace& trace) {
  std::vector<std::pair<std::size_t, const model::Mode*>> modes;
  for (const TraceStep& step : trace.steps)
    for (const engine::Change& change : step.changes)
      if (change.before != change.after) modes.emplace_back(change.island, change.after);
  return modes;
}

/// One period from a state.
struct Lap {
  bool is_complete = false;
  bool is_interrupted = false;
  RunState end;
  double time = 0.0;
  Trace trace;
  engine::Answer answer;
};

class Search {
 public:
  Search(engine::March& march, const OrbitTask& task) : march_(march), task_(task), stacking_(march.model()) {}

  Orbit run(const RunState& start) {
    RunState state = start;
    if (!simulate(state, task_.periods_before * task_.multiple)) return std::move(orbit_);
    lap_ = lap(state);
    state_ = state;
    while (lap_.is_complete && orbit_.periods_simulated < task_.most_periods && orbit_.iterations < task_.most_iterations) {
      take_size();
      const Vector f = residual(state_, lap_);
      if (std::exchange(counted_, orbit_.periods_simulated) != orbit_.periods_simulated)
        orbit_.residuals.push_back(f.norm() / orbit_.largest);
      if (!keeps_switches()) {
        go_on();
        continue;
      }
      if (is_small(f)) return finish(f);
      if (best_norm_ < 0.0 || f.norm() < much_better * best_norm_) keep(f);
      const Progress progress = follows_ > 0 ? follow_on(f) : step(f);
      if (progress == Progress::done) return finish(f);
      if (progress == Progress::failed) return std::move(orbit_);
      if (progress == Progress::stuck && !begin_to_follow(f)) return std::move(orbit_);
    }
    if (!lap_.is_complete) {
      fail(lap_);
      return std::move(orbit_);
    }
    if (orbit_.residuals.empty()) {
      take_size();
      orbit_.residuals.push_back(residual(state_, lap_).norm() / orbit_.largest);
    }
    const int simulated = orbit_.periods_simulated;
    orbit_.repeats_modes = modes_of(lap(lap_.end).trace) == modes_of(lap_.trace);
    orbit_.periods_simulated = simulated;  // the look at the period behind is none of the search
    orbit_.begin = state_;
    orbit_.trace = std::move(lap_.trace);
    orbit_.period = lap_.time;
    return std::move(orbit_);
  }

 private:
  enum class Progress { stepped, stuck, done, failed };

  [[nodiscard]] bool is_driven() const { return task_.period > 0.0; }

  Lap lap(const RunState& from) {
    Lap lap;
    lap.end = from;
    orbit_.periods_simulated += task_.multiple;
    if (is_driven()) {
      TraceRecorder recorder(from.on);
      lap.answer = march_.advance(lap.end, task_.period, &recorder);
      lap.trace = recorder.take();
      lap.time = task_.period;
      lap.is_complete = lap.answer.outcome == engine::Outcome::completed;
      return lap;
    }
    int left = task_.multiple;
    TraceRecorder recorder(from.on, [&](const engine::InstantView& view, const std::vector<char>& before) {
      return view.time > 0.0 && task_.section.is_passed(view, before) && --left == 0;
    });
    lap.answer = march_.advance(lap.end, task_.longest, &recorder);
    lap.trace = recorder.take();
    lap.time = lap.answer.time;
    lap.is_complete = recorder.has_ended();
    return lap;
  }

  void fail(const Lap& lap) {
    orbit_.answer = lap.answer;
    orbit_.verdict = lap.answer.outcome == engine::Outcome::interrupted ? Verdict::interrupted
                     : lap.answer.outcome == engine::Outcome::completed ? Verdict::no_event
                                                                        : Verdict::run_failed;
  }

  bool simulate(RunState& state, int periods) {
    for (int done = 0; done < periods;) {
      const int laps = is_driven() ? std::min(most_laps_at_once, (periods - done + task_.multiple - 1) / task_.multiple) : 1;
      Lap next = laps > 1 ? laps_at_once(state, laps) : lap(state);
      if (!next.is_complete) {
        fail(next);
        return false;
      }
      state = std::move(next.end);
      done += laps * task_.multiple;
    }
    return true;
  }

  /// Driven ones on end, of which nothing but the end is needed.
  Lap laps_at_once(const RunState& from, int count) {
    Lap lap;
    lap.end = from;
    orbit_.periods_simulated += count * task_.multiple;
    lap.answer = march_.advance(lap.end, count * task_.period, nullptr);
    lap.time = count * task_.period;
    lap.is_complete = lap.answer.outcome == engine::Outcome::completed;
    return lap;
  }

  void go_on() {
    state_ = lap_.end;
    lap_ = lap(state_);
  }

  bool simulate_on(int periods) {
    RunState state = lap_.end;
    if (!simulate(state, (periods - 1) * task_.multiple)) return false;
    state_ = state;
    lap_ = lap(state_);
    return true;
  }

  [[nodiscard]] bool keeps_switches() const { return lap_.end.on == state_.on; }

  void take_size() {
    orbit_.largest = std::max({stacking_.stacked(state_.xi).norm(), stacking_.stacked(lap_.end.xi).norm(), 1e-300});
    std::vector<double> square(stacking_.islands(), 0.0);
    // A few long segments may begin and end near zero.
    const int inside = lap_.trace.segments() <= few_segments ? points_inside : 1;
    const auto take = [&](const TraceSegment& s) {
      std::vector<double> y = s.y0, work(2 * y.size());
      Vector x(stacking_.system(s.island).size());
      for (int point = 1; point <= inside; ++point) {
        if (inside > 1) s.mode->flow.apply(s.length / inside, y.data(), work.data());
        model::from_mode(stacking_.system(s.island), *s.mode, inside > 1 ? y.data() : s.y1.data(), x.data());
        square[s.island] = std::max(square[s.island], x.head(stacking_.count(s.island)).squaredNorm());
      }
    };
    for (const TraceStep& step : lap_.trace.steps)
      for (const TraceSegment& segment : step.segments) take(segment);
    for (const TraceSegment& segment : lap_.trace.tail) take(segment);
    double sum = 0.0;
    for (const double s : square) sum += s;
    orbit_.largest = std::max(orbit_.largest, std::sqrt(sum));
  }

  [[nodiscard]] Vector residual(const RunState& from, const Lap& to) const {
    return stacking_.stacked(to.end.xi) - stacking_.stacked(from.xi);
  }

  [[nodiscard]] bool is_small(const Vector& f) const {
    const double floor = rounding_levels * model::tolerance::unit_rounding * std::sqrt(static_cast<double>(1 + lap_.trace.segments()));
    return f.norm() <= std::max(floor, task_.tolerance) * orbit_.largest;
  }

  [[nodiscard]] RunState moved(const Vector& by) const {
    RunState state = state_;
    state.xi = stacking_.apart(stacking_.stacked(state_.xi) + by);
    state.active = lap_.end.active;
    return state;
  }

  /// A step of Newton's method. It must pass the natural test, or be one of a few that need not. `done`: no step lessens the residual, which is rounding.
  Progress step(const Vector& f) {
    const Variation v = variation(stacking_, lap_.trace);
    orbit_.kink = v.kink;
    if (!v.kink.empty())
      return f.norm() <= tolerance::close_residual * orbit_.largest && stands_still(f) ? Progress::done : Progress::stuck;
    const Eigen::Index n = stacking_.size();
    const Matrix phi = is_driven() ? v.x : v.return_map();
    const Eigen::JacobiSVD<Matrix> svd(Matrix::Identity(n, n) - phi, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Vector& s = svd.singularValues();
    const double least = tolerance::free_direction * std::max(1.0, n > 0 ? s[0] : 0.0);
    const Eigen::Index rank = (s.array() > least).count();
    if (rank < n) {
      const Vector outside = svd.matrixU().rightCols(n - rank).transpose() * f;
      if (outside.norm() > tolerance::inconsistent_residual * orbit_.largest)
        return drift(f, svd.matrixU().rightCols(n - rank), svd.matrixV().rightCols(n - rank));
    }
    const auto solve = [&](const Vector& b) {
      const Vector c = (svd.matrixU().leftCols(rank).transpose() * b).cwiseQuotient(s.head(rank));
      return Vector(svd.matrixV().leftCols(rank) * c);
    };
    ++orbit_.iterations;
    const Vector delta = solve(f);
    RunState trial = moved(delta);
    Lap next = lap(trial);
    if (next.answer.outcome == engine::Outcome::interrupted) {
      fail(next);
      return Progress::failed;
    }
    if (!next.is_complete || next.end.on != trial.on) return Progress::stuck;
    const Vector f_next = residual(trial, next);
    if (f.norm() <= tolerance::close_residual * orbit_.largest && f_next.norm() > least_gain * f.norm()) return Progress::done;
    const bool passes = solve(f_next).norm() <= 0.75 * delta.norm();
    if ((!passes && bold_-- <= 0) || cycle_.closes(f.norm())) return Progress::stuck;
    return accept(std::move(trial), std::move(next));
  }

  /// Where Newton's method is stuck. Its steps that did not pay are taken back.
  bool begin_to_follow(const Vector& f) {
    if (f.norm() > best_norm_) {
      state_ = best_state_;
      lap_ = best_lap_;
    }
    follows_ = steps_followed;
    if (++phases_ % phases_before_periods != 0) return true;
    patience_ *= 2;
    return simulate_on(patience_);
  }

  Progress follow_on(const Vector& f) {
    if (--follows_ == 0) best_norm_ = -1.0;
    const Progress progress = follow(f);
    if (progress != Progress::stuck) return progress;
    return simulate_on(1) ? Progress::stepped : Progress::failed;
  }

  void keep(const Vector& f) {
    best_state_ = state_;
    best_lap_ = lap_;
    best_norm_ = f.norm();
    bold_ = bold_steps;
    cycle_.restart();
  }

  /// One step of the implicit Euler method along x' = φ(x) − x, x a function of the number of periods, over `pace_` of them: where Newton's method fails,
  /// the way that the circuit goes, several periods at a time. Its pace grows as the residual falls.
  Progress follow(const Vector& f) {
    if (pace_ == 0.0) pace_ = first_pace;
    const Variation v = variation(stacking_, lap_.trace);
    if (!v.kink.empty()) return Progress::stuck;
    const Eigen::Index n = stacking_.size();
    const Matrix phi = is_driven() ? v.x : v.return_map();
    const Eigen::PartialPivLU<Matrix> lu((1.0 + 1.0 / pace_) * Matrix::Identity(n, n) - phi);
    RunState trial = moved(lu.solve(f));
    Lap next = lap(trial);
    ++orbit_.iterations;
    if (next.answer.outcome == engine::Outcome::interrupted) {
      fail(next);
      return Progress::failed;
    }
    if (!next.is_complete) {
      pace_ = std::max(1.0, pace_ * slower);
      return Progress::stuck;
    }
    if (next.end.on != trial.on) {
      // Switches that hold their state are others after the period: the circuit goes on from there.
      pace_ = std::max(1.0, pace_ * slower);
      state_ = next.end;
      lap_ = lap(state_);
      return Progress::stepped;
    }
    const double ratio = f.norm() / std::max(residual(trial, next).norm(), 1e-300);
    pace_ = std::max(1.0, pace_ * std::clamp(ratio, slower, faster));
    return accept(std::move(trial), std::move(next));
  }

  Progress accept(RunState state, Lap next) {
    state_ = std::move(state);
    lap_ = std::move(next);
    return Progress::stepped;
  }

  bool stands_still(const Vector& f) {
    const bool still = last_residual_ >= 0.0 && f.norm() >= 0.5 * last_residual_;
    last_residual_ = f.norm();
    return still;
  }

  /// I − Φ is singular, and the residual has a part that no step can take away: each period adds the same. Where that moves no guard there is no orbit.
  Progress drift(const Vector& f, const Matrix& left, const Matrix& right) {
    const Matrix overlap = left.transpose() * right;
    const Eigen::FullPivLU<Matrix> lu(overlap);
    orbit_.drift = lu.isInvertible() ? Vector(right * lu.solve(left.transpose() * f)) : Vector(left * (left.transpose() * f));
    const bool is_free = !moves_a_guard(stacking_, lap_.trace, orbit_.drift);
    const bool is_alone = (f - orbit_.drift).norm() <= tolerance::lone_drift * f.norm();  // everything else has settled
    if (!(is_free && is_alone) && drifts_ < most_drifts) {
      ++drifts_;
      return simulate_on(4 << std::min(drifts_, 6)) ? Progress::stepped : Progress::failed;
    }
    orbit_.verdict = is_free ? Verdict::no_orbit : Verdict::drifts;
    orbit_.drift_turns = turns(orbit_.drift);
    orbit_.begin = state_;
    orbit_.trace = std::move(lap_.trace);
    orbit_.period = lap_.time;
    return Progress::failed;
  }

  /// Whether a direction that a period leaves as it is moves on the way.
  [[nodiscard]] bool turns(const Vector& direction) const {
    const auto moves = [&](const TraceSegment& s) {
      const int n = stacking_.count(s.island);
      const auto own = direction.segment(stacking_.first(s.island), n);
      const Vector c = s.mode->constrained ? Vector(s.mode->basis.transpose() * own) : Vector(own);
      return n > 0 && (s.mode->flow.a().topLeftCorner(s.mode->n1, s.mode->n1) * c).norm() * lap_.time >
                          tolerance::constant_direction * direction.norm();
    };
    for (const TraceStep& step : lap_.trace.steps)
      if (std::any_of(step.segments.begin(), step.segments.end(), moves)) return true;
    return std::any_of(lap_.trace.tail.begin(), lap_.trace.tail.end(), moves);
  }

  Orbit finish(const Vector& f) {
    orbit_.verdict = Verdict::found;
    orbit_.begin = state_;
    orbit_.begin.active = lap_.end.active;
    orbit_.period = lap_.time;
    orbit_.answer = std::move(lap_.answer);
    orbit_.residual = f.norm() / orbit_.largest;
    const Variation v = variation(stacking_, lap_.trace);
    orbit_.kink = v.kink;
    orbit_.beside = v.beside;
    if (v.kink.empty()) take_multipliers(v);
    // Oscillations that die away in ever shorter periods end where rounding does not let them become smaller.
    if (!is_driven() && !orbit_.free_directions.empty() && f.norm() > tolerance::residual_of_swing * swing())
      orbit_.verdict = Verdict::not_converged;
    orbit_.trace = std::move(lap_.trace);
    return std::move(orbit_);
  }

  /// The largest motion of an island in one mode.
  [[nodiscard]] double swing() const {
    double largest = 0.0;
    const auto take = [&](const TraceSegment& s) {
      const Eigen::Map<const Vector> from(s.y0.data(), s.mode->n1), to(s.y1.data(), s.mode->n1);
      largest = std::max(largest, (to - from).norm());
    };
    for (const TraceStep& step : lap_.trace.steps) std::for_each(step.segments.begin(), step.segments.end(), take);
    std::for_each(lap_.trace.tail.begin(), lap_.trace.tail.end(), take);
    return largest;
  }

  void take_multipliers(const Variation& v) {
    const Eigen::Index n = stacking_.size();
    orbit_.monodromy = v.x;
    if (n == 0) return;
    const Matrix phi = is_driven() ? v.x : v.return_map();
    const Eigen::JacobiSVD<Matrix> svd(Matrix::Identity(n, n) - phi, Eigen::ComputeFullV);
    const Vector& s = svd.singularValues();
    orbit_.least_singular = s[n - 1];
    for (Eigen::Index i = 0; i < n; ++i)
      if (s[i] <= tolerance::free_direction * std::max(1.0, s[0])) orbit_.free_directions.emplace_back(svd.matrixV().col(i));
    const Eigen::EigenSolver<Matrix> eigen(v.x);
    for (Eigen::Index i = 0; i < n; ++i) {
      Multiplier m;
      m.value = eigen.eigenvalues()[i];
      if (std::abs(m.value) <= tolerance::zero_multiplier) continue;
      m.direction = eigen.eigenvectors().col(i);
      orbit_.multipliers.push_back(std::move(m));
    }
    auto& list = orbit_.multipliers;
    if (!is_driven() && !list.empty())
      std::min_element(list.begin(), list.end(), [](const auto& a, const auto& b) {
        return std::abs(a.value - 1.0) < std::abs(b.value - 1.0);
      })->trivial = true;
    std::stable_sort(list.begin(), list.end(), [](const auto& a, const auto& b) { return std::abs(a.value) > std::abs(b.value); });
  }

  engine::March& march_;
  const OrbitTask& task_;
  Stacking stacking_;
  Orbit orbit_;
  RunState state_;
  Lap lap_;
  RunState best_state_;  ///< of the steps of Newton's method since the last implicit one
  Lap best_lap_;
  double best_norm_ = -1.0;
  NewtonCycle cycle_;
  int bold_ = 0, follows_ = 0, phases_ = 0, patience_ = 1;
  double pace_ = 0.0;  ///< periods of an implicit step; 0: there has been none
  int counted_ = -1;   ///< periods simulated when the last residual was noted
  double last_residual_ = -1.0;
  int drifts_ = 0;
};

}  // namespace

Orbit find_orbit(engine::March& march, const engine::RunState& start, const OrbitTask& task) { return Search(march, task).run(start); }

double spectral_radius(const Orbit& orbit) {
  double radius = 0.0;
  for (const Multiplier& m : orbit.multipliers)
    if (!m.trivial) radius = std::max(radius, std::abs(m.value));
  return radius;
}

}  // namespace pwlsim::steady
