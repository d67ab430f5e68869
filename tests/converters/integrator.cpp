#include "converters/integrator.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <stdexcept>

#include "converters/stepper.hpp"

namespace pwlsim::test::converters {
namespace {

constexpr std::size_t stages = Radau::stages;
constexpr std::size_t looks = 17;  ///< points of a step at which slacks are looked for a dip …
constexpr Real graze = 1e-4L;      ///< … that comes so near to zero, against how much the slack moves in the step: the polynomial's error

double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// Times at which a gate passes its threshold or a source changes its slope, up to the end.
void collect_edges(const Wave& wave, bool kinks, double stop, std::vector<Real>& times) {
  if (wave.kind != Wave::Kind::pulse) return;
  for (std::size_t n = 0;; ++n) {
    const Real start = static_cast<Real>(wave.delay) + static_cast<Real>(n) * wave.period;
    if (start > stop) break;
    const Real top = start + wave.rise, fall = top + wave.width, end = fall + wave.fall;
    if (kinks) {
      for (const Real time : {start, top, fall, end}) times.push_back(time);
    } else {
      for (const Real time : {(start + top) / 2, (fall + end) / 2}) times.push_back(time);
    }
  }
}

class Integrator {
 public:
  Integrator(const Converter& converter, const Settings& settings)
      : converter_(converter),
        settings_(settings),
        equations_(converter),
        stepper_(equations_),
        deadline_(processor_seconds() + settings.patience) {
    for (std::size_t k = 0; k < equations_.states(); ++k) states_.push_back(equations_.initial(k));
    result_.scales.assign(equations_.states(), 0);
    for (const Branch& branch : converter.branches)
      if (branch.kind == Branch::Kind::source) volts_ = std::max<Real>(volts_, branch.wave.largest());
    amperes_ = volts_ / 1000;
    for (std::size_t k = 0; k < settings.scales.size(); ++k) note_size(k, settings.scales[k]);
    for (const Real place : {0.15L, 0.4L, 0.5L, 0.7L, 0.93L}) between_.push_back(radau().weights(place));
    for (std::size_t i = 0; i < looks; ++i) looks_.push_back(radau().weights(static_cast<Real>(i) / (looks - 1)));
    most_step_ = static_cast<Real>(converter.fast) / 8;
    step_ = most_step_;
    mode_.assign(equations_.valves(), '0');
    may_conduct_.assign(equations_.valves(), 1);
  }

  Waveforms run() {
    for (std::size_t k = 0;; ++k) {
      // The exact product of the decimal numbers is within one rounding of this.
      const double time = static_cast<double>(static_cast<Real>(converter_.row_step) * static_cast<Real>(k));
      if (time > converter_.stop * (1 + 1e-12)) break;
      result_.times.push_back(std::min(time, converter_.stop));
    }
    if (result_.times.back() < converter_.stop * (1 - 1e-12)) result_.times.push_back(converter_.stop);
    std::vector<Real> edges;
    for (const Wave& gate : converter_.gates) collect_edges(gate, false, converter_.stop, edges);
    for (const Branch& branch : converter_.branches)
      if (branch.kind == Branch::Kind::source) collect_edges(branch.wave, true, converter_.stop, edges);
    std::sort(edges.begin(), edges.end());
    follow(edges);
    return std::move(result_);
  }

 private:
  void follow(const std::vector<Real>& edges) {
    const Real together = 1e-13L * converter_.stop;
    std::size_t row = 0, edge = 0;
    while (edge < edges.size() && edges[edge] <= together) ++edge;
    bool fresh = true;
    if (result_.times[0] == 0) {
      row = 1;
      Piece piece = piece_from(0, next_stop(row, edges, edge));
      begin(piece);
      if (!result_.trouble.empty()) return;
      put_row();
    }
    while (row < result_.times.size()) {
      const Real row_time = result_.times[row];
      const Real edge_time = edge < edges.size() ? edges[edge] : static_cast<Real>(infinity);
      const bool at_edge = edge_time <= row_time + together;
      const Real inside_end = std::max(at_edge ? edge_time : row_time, time_);
      Piece piece = piece_from(time_, inside_end);
      if (inside_end > time_) advance(piece, fresh);
      if (!result_.trouble.empty()) return;
      time_ = inside_end;
      fresh = at_edge;
      if (at_edge)
        while (edge < edges.size() && edges[edge] <= edge_time + together) ++edge;
      if (row_time <= inside_end + together) {
        put_row();
        ++row;
      }
    }
  }

  Real next_stop(std::size_t row, const std::vector<Real>& edges, std::size_t edge) const {
    const Real time = result_.times[row];
    return edge < edges.size() ? std::min(time, edges[edge]) : time;
  }

  Piece piece_from(Real from, Real to) const {
    Piece piece{from, to, {}};
    for (const Wave& gate : converter_.gates) piece.gates += gate.value(piece.inside(), piece.inside()) > 0.5L ? '1' : '0';
    return piece;
  }

  /// Row 0 stands after t = 0: what is continuous has not changed yet.
  void begin(const Piece& piece) {
    enter(piece);
    Vector solution;
    // Shorter than any L/Roff.
    if (settle(piece, 1e-24L * converter_.fast, solution)) take(solution);
  }

  void enter(const Piece& piece) {
    mode_ = mode_.substr(0, equations_.valves()) + piece.gates;
    for (std::size_t d = 0; d < equations_.valves(); ++d) may_conduct_[d] = !is_latch(d) || mode_[d] == '1';
  }

  /// Whether the valve is a thyristor whose gate is off: what conducts may end, what blocks stays so.
  bool is_latch(std::size_t valve) const {
    const Branch& branch = equations_.valve(valve);
    return branch.kind == Branch::Kind::thyristor && mode_[equations_.valves() + branch.gate] == '0';
  }

  /// What its slack must not fall below.
  Real least_slack(std::size_t valve) const {
    return mode_[valve] == '1' && is_latch(valve) ? static_cast<Real>(equations_.valve(valve).holding) : 0;
  }

  Real margin(const Vector& solution, std::size_t valve) const { return equations_.slack(solution, mode_, valve) - least_slack(valve); }

  void put_row() {
    std::vector<double> row;
    for (const Real value : states_) row.push_back(static_cast<double>(value));
    result_.rows.push_back(std::move(row));
  }

  void advance(const Piece& piece, bool fresh) {
    time_ = piece.from;
    enter(piece);
    Real euler = settings_.first_step * converter_.fast;
    const Real first = euler, end_slack = 1e-17L * converter_.stop;
    while (piece.to - time_ > end_slack) {
      if ((++result_.steps & 63) == 0 && processor_seconds() > deadline_) return fail("takes too long");
      if (!fresh) {
        const Outcome outcome = radau_advance(piece);
        if (!result_.trouble.empty()) return;
        if (outcome == Outcome::moved) {
          euler = first;
          continue;
        }
        if (outcome == Outcome::event) {
          ++result_.events;
          fresh = true;
          continue;
        }
      }
      const Real step = std::min(euler, piece.to - time_);
      Vector solution;
      if (!settle(piece, step, solution)) return;
      take(solution);
      time_ += step;
      euler *= 2;
      fresh = false;
    }
  }

  enum class Outcome { moved, event, stuck };

  /// One step, as long as the error allows, to the first event at most.
  Outcome radau_advance(const Piece& piece) {
    const Real least = settings_.first_step * converter_.fast / 4;
    for (;;) {
      if ((++result_.steps & 63) == 0 && processor_seconds() > deadline_) return fail("takes too long"), Outcome::stuck;
      const Real left = piece.to - time_;
      const bool short_step = left <= step_ * 1.0001L;
      const Real step = short_step ? left : step_;
      Trial trial = stepper_.radau_step(mode_, states_, piece, time_, step, !short_step);
      if (!trial.solved) return fail("singular"), Outcome::stuck;
      const Real error = error_of(trial);
      if (error > settings_.tolerance) {
        if (step < least) return Outcome::stuck;
        while (step_ >= step) step_ /= 2;
        if (error > 32 * settings_.tolerance) step_ /= 2;
        continue;
      }
      const Real place = first_violation(trial);
      if (place > 1 && step > least && may_dip(trial)) {
        while (step_ >= step) step_ /= 2;
        continue;
      }
      if (place > 1) {
        take(trial.solutions.back());
        time_ = short_step ? piece.to : time_ + step;
        if (error < settings_.tolerance / 100 && !short_step) step_ = std::min(step_ * 2, most_step_);
        return Outcome::moved;
      }
      return locate(piece, step, place);
    }
  }

  Outcome locate(const Piece& piece, Real high, Real place) {
    Real low = 0, guess = place * high;
    Vector best;
    Real best_step = 0;
    const Real resolution = 1e-17L * converter_.stop, least = settings_.first_step * converter_.fast / 4;
    for (int count = 0; count < 80; ++count) {
      if (high - low <= resolution || high < least) break;
      if (!(guess > low && guess < high)) guess = (low + high) / 2;
      const Trial trial = stepper_.radau_step(mode_, states_, piece, time_, guess, false);
      if (!trial.solved) return fail("singular"), Outcome::stuck;
      const Real next = first_violation(trial);
      if (next <= 1) {
        high = guess;
        guess = next * guess;
        if (guess >= high) guess = (low + high) / 2;
        if (count > 12) guess = (low + high) / 2;
        continue;
      }
      low = guess;
      best = trial.solutions.back();
      best_step = guess;
      if (almost_zero(best)) break;
      const Real beyond = root_beyond(trial, high / guess);
      guess = beyond > 1 && count < 12 ? beyond * guess : (low + high) / 2;
    }
    if (best_step == 0) return Outcome::stuck;
    take(best);
    time_ += best_step;
    return Outcome::event;
  }

  /// The slack of some valve is zero up to rounding.
  bool almost_zero(const Vector& solution) const {
    for (std::size_t d = 0; d < equations_.valves(); ++d)
      if (may_conduct_[d] != 0 && std::abs(margin(solution, d)) < tolerance_of(mode_, d)) return true;
    return false;
  }

  Real tolerance_of(const Mode& mode, std::size_t diode) const {
    if (Equations::slack_is_voltage(mode, diode)) return 1e-14L * volts_;
    return 1e-15L * amperes_ + 1e-7L * volts_ * equations_.leak();
  }

  static Real combine(const Radau::Stages& weights, const std::array<Real, stages>& values) {
    Real result = 0;
    for (std::size_t i = 0; i < stages; ++i) result += weights[i] * values[i];
    return result;
  }

  /// Part of the step after which a valve's sign is violated; 2 where none is.
  Real first_violation(const Trial& trial) const {
    Real result = 2;
    for (std::size_t d = 0; d < equations_.valves(); ++d) {
      if (may_conduct_[d] == 0) continue;
      std::array<Real, stages> slacks;
      for (std::size_t i = 0; i < stages; ++i) slacks[i] = margin(trial.solutions[i], d);
      const Real tolerance = tolerance_of(mode_, d);
      const Real least = *std::min_element(slacks.begin(), slacks.end());
      const Real most = *std::max_element(slacks.begin(), slacks.end());
      if (least > most - least) continue;  // far from zero, so is the polynomial
      Real before = 0;
      for (std::size_t i = 0; i < stages; ++i) {
        const Real place = radau().nodes[i + 1];
        if (const Real inner = combine(between_[i], slacks); inner < -tolerance - 0.02L * (most - least) && place_of_between(i) < result) {
          result = std::min(result, root(slacks, before, place_of_between(i)));
        }
        if (slacks[i] < -tolerance) {
          result = std::min(result, root(slacks, before, place));
          break;
        }
        before = place;
      }
    }
    return result;
  }

  /// Whether some slack has a least value between two points inside the step that is so near to zero, or so little below it, that only a shorter step tells.
  bool may_dip(const Trial& trial) const {
    for (std::size_t d = 0; d < equations_.valves(); ++d) {
      if (may_conduct_[d] == 0) continue;
      std::array<Real, stages> slacks;
      for (std::size_t i = 0; i < stages; ++i) slacks[i] = margin(trial.solutions[i], d);
      const auto [least, most] = std::minmax_element(slacks.begin(), slacks.end());
      const Real spread = *most - *least;
      if (*least > spread) continue;
      std::array<Real, looks> values;
      for (std::size_t i = 0; i < looks; ++i) values[i] = combine(looks_[i], slacks);
      for (std::size_t i = 1; i + 1 < looks; ++i)
        if (values[i] <= values[i - 1] && values[i] <= values[i + 1] &&
            vertex(values[i - 1], values[i], values[i + 1]) < graze * spread - tolerance_of(mode_, d))
          return true;
    }
    return false;
  }

  /// The least value of the parabola through three values at equal distances.
  static Real vertex(Real before, Real here, Real after) {
    const Real slope = (after - before) / 2, bend = before - 2 * here + after;
    return bend > 0 ? here - slope * slope / (2 * bend) : here;
  }

  static Real place_of_between(std::size_t i) {
    static constexpr std::array<Real, stages> places{0.15L, 0.4L, 0.5L, 0.7L, 0.93L};
    return places[i];
  }

  /// Of the polynomial through the stages, negative at `high`.
  static Real root(const std::array<Real, stages>& slacks, Real low, Real high) {
    if (combine(radau().weights(low), slacks) <= 0) return high / 2;
    for (int k = 0; k < 50; ++k) {
      const Real middle = (low + high) / 2;
      (combine(radau().weights(middle), slacks) > 0 ? low : high) = middle;
    }
    return (low + high) / 2;
  }

  /// First zero of the polynomials beyond the end of the step, to `most` times the step; 0 where there is none.
  Real root_beyond(const Trial& trial, Real most) const {
    Real result = 0;
    for (std::size_t d = 0; d < equations_.valves(); ++d) {
      if (may_conduct_[d] == 0) continue;
      std::array<Real, stages> slacks;
      for (std::size_t i = 0; i < stages; ++i) slacks[i] = margin(trial.solutions[i], d);
      Real low = 1, high = result > 1 ? result : most;
      if (combine(radau().weights(low), slacks) <= 0 || combine(radau().weights(high), slacks) > 0) continue;
      for (int k = 0; k < 60; ++k) {
        const Real middle = (low + high) / 2;
        (combine(radau().weights(middle), slacks) > 0 ? low : high) = middle;
      }
      result = (low + high) / 2;
    }
    return result;
  }

  /// The highest coefficient of the collocation polynomial, relative to each state.
  Real error_of(const Trial& trial) const {
    Real result = 0;
    for (std::size_t k = 0; k < states_.size(); ++k) {
      Real coefficient = 0;
      for (std::size_t i = 0; i < stages; ++i) coefficient += radau().leading[i] * (equations_.state(trial.solutions[i], k) - states_[k]);
      result = std::max(result, std::abs(coefficient) / scale(k));
    }
    return result;
  }

  Real scale(std::size_t k) const {
    const Real kind = equations_.is_voltage(k) ? volts_ : amperes_;
    return std::max(result_.scales[k], 1e-3L * kind);
  }

  void note_size(std::size_t k, Real value) {
    result_.scales[k] = std::max(result_.scales[k], std::abs(value));
    Real& kind = equations_.is_voltage(k) ? volts_ : amperes_;
    kind = std::max(kind, std::abs(value));
  }

  void take(const Vector& solution) {
    for (std::size_t k = 0; k < states_.size(); ++k) note_size(k, states_[k] = equations_.state(solution, k));
  }

  /// A step of implicit Euler whose valves have their signs; thyristors without a gate that block at its end, or are below their holding current, are latched off.
  bool settle(const Piece& piece, Real step, Vector& solution) {
    for (bool ended = true; ended;) {
      if (!settle_signs(piece, step, solution)) return false;
      ended = false;
      for (std::size_t d = 0; d < equations_.valves(); ++d) {
        if (!is_latch(d) || may_conduct_[d] == 0) continue;
        const bool falls = mode_[d] == '1' && margin(solution, d) < tolerance_of(mode_, d);
        if (mode_[d] == '1' && !falls) continue;
        may_conduct_[d] = 0;
        mode_[d] = '0';
        ended |= falls;
      }
    }
    return true;
  }

  /// All valves that violate their signs are exchanged, and where that does not end the first of them only (Murty; it ends for passive circuits).
  bool settle_signs(const Piece& piece, Real step, Vector& solution) {
    for (int count = 0; count < 20000; ++count) {
      if (!stepper_.euler_step(mode_, states_, piece, time_, step, solution)) return fail("singular in an Euler step"), false;
      std::vector<std::size_t> wrong;
      for (std::size_t d = 0; d < equations_.valves(); ++d)
        if (may_conduct_[d] != 0 && equations_.slack(solution, mode_, d) < -tolerance_of(mode_, d)) wrong.push_back(d);
      if (wrong.empty()) return true;
      for (const std::size_t d : wrong) {
        mode_[d] = mode_[d] == '1' ? '0' : '1';
        if (count > 15) break;
      }
      if ((count & 255) == 255 && processor_seconds() > deadline_) break;
    }
    return fail("no positions of the valves"), false;
  }

  void fail(const char* why) {
    if (result_.trouble.empty())
      result_.trouble = std::string(why) + " at t = " + std::to_string(static_cast<double>(time_ / converter_.stop)) + " of the run";
  }

  const Converter& converter_;
  const Settings& settings_;
  Equations equations_;
  Stepper stepper_;
  Waveforms result_;
  Vector states_;
  Mode mode_;
  std::vector<char> may_conduct_;  ///< of each valve: not where a thyristor is latched off
  std::vector<Radau::Stages> between_, looks_;
  Real time_ = 0, step_ = 0, most_step_ = 0, volts_ = 1e-3L, amperes_ = 0;
  double deadline_;
};

}  // namespace

Waveforms integrate(const Converter& converter, const Settings& settings) { return Integrator(converter, settings).run(); }

}  // namespace pwlsim::test::converters
