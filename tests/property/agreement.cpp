#include "property/agreement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>

#include "property/independent.hpp"
#include "property/program_run.hpp"

namespace pwlsim::test {
namespace {

using States = std::vector<double>;
using Rows = std::vector<States>;

constexpr int levels = 4;                  ///< h, h/2, h/4, h/8
constexpr int coarsest_steps = 480;        ///< of length h in a window
constexpr double shrinking = 8.0;          ///< of the window where it is too long for the steps
constexpr int most_shrinkings = 5;         ///< the fastest tanks have 10⁶ rad/s, the longest runs 50 ms
constexpr double resolved_change = 0.005;  ///< most that the last halving may change
constexpr double settling = 0.8;           ///< most by which a halving may shrink the change, on average (0.5: order 1)
/// A tank that implicit Euler damps away is off by no more than its amplitude; a shorter window that resolves it sees it move by as much.
constexpr double least_motion = 0.5;
constexpr double safety = 3.0;              ///< between an error and its estimate by the last halvings
constexpr double rounding = 1e-8;           ///< of thousands of steps, each solved to 1e-12
constexpr double worth_explaining = 1e-6;   ///< of the norm: a disagreement in one state of a window that was too long
constexpr double nothing = 1e-12;           ///< of 10 V or 10 mA: rounding of a state that is zero
constexpr int most_events = 6;              ///< around which windows are laid
constexpr int cover_fineness = 2;           ///< halvings of all steps where windows cover the whole run
constexpr int cover_windows = 32;           ///< at least
constexpr int cover_parts = 4;              ///< of a window that is too long
constexpr int cover_cuts = 3;               ///< one after the other
constexpr int first_edges = 3;              ///< of each source and switch, around which too
constexpr double in_the_middle = 0.381966;  ///< of the run, and one more window there

/// Norm of the stored energy.
struct Norm {
  std::vector<NetworkPart> parts;

  double of(const States& x) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < parts.size(); ++i) sum += parts[i].value * x[i] * x[i];
    return std::sqrt(sum);
  }
  double largest(const Rows& rows) const {
    double result = 0.0;
    for (const auto& row : rows) result = std::max(result, of(row));
    return result;
  }
  /// What rounding leaves of states of this size.
  double noise(double scale) const {
    States typical;
    for (const NetworkPart& part : parts) typical.push_back(typical_state(part));
    return rounding * scale + nothing * of(typical);
  }
  double distance(const Rows& a, const Rows& b) const {
    double result = 0.0;
    for (std::size_t k = 0; k < a.size(); ++k) {
      States difference = a[k];
      for (std::size_t i = 0; i < difference.size(); ++i) difference[i] -= b[k][i];
      result = std::max(result, of(difference));
    }
    return result;
  }
};

Rows extrapolated(const Rows& fine, const Rows& coarse) {
  Rows result = fine;
  for (std::size_t k = 0; k < fine.size(); ++k)
    for (std::size_t i = 0; i < fine[k].size(); ++i) result[k][i] += fine[k][i] - coarse[k][i];
  return result;
}

void raise(States& values, const States& others) {
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = std::max(values[i], others[i]);
}

/// Largest difference of one state.
double distance_of(std::size_t state, const Rows& a, const Rows& b) {
  double result = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) result = std::max(result, std::abs(a[k][state] - b[k][state]));
  return result;
}

struct Window {
  double start = 0.0, length = 0.0;
};

/// Implicit Euler with all step sizes in one window.
struct Refinement {
  StepGrid grid;
  States initial;
  std::array<Rows, levels> rows;
  std::string problem;

  double change(const Norm& norm, int level) const {
    return norm.distance(rows[static_cast<std::size_t>(level)], rows[static_cast<std::size_t>(level - 1)]);
  }

  double scale(const Norm& norm) const { return std::max(norm.of(initial), norm.largest(rows.back())); }

  bool resolves(const Norm& norm) const {
    const double scale = this->scale(norm);
    const double last = change(norm, levels - 1);
    return last <= norm.noise(scale) || (last <= resolved_change * scale && last <= settling * settling * change(norm, 1));
  }
};

Refinement refine(const RandomNetwork& network, const Window& window, const States& initial, int fineness) {
  Refinement result;
  result.initial = initial;
  result.grid = make_grid(network, window.start, window.start + window.length, coarsest_steps);
  for (std::size_t level = 0; level < levels && result.problem.empty(); ++level) {
    Trajectory trajectory = implicit_euler(network, result.grid, initial, 1 << (fineness + level), fineness + level == 0);
    result.problem = trajectory.problem;
    result.rows[level] = std::move(trajectory.states);
  }
  return result;
}

class Comparison {
 public:
  Comparison(const RandomNetwork& network, const RandomNetwork& beside) : network_(network), beside_(beside), norm_{states_of(network)} {}

  Agreement run(std::initializer_list<int> finenesses) {
    if (norm_.parts.empty()) return result_;
    for (const int fineness : finenesses) {
      begin(fineness);
      examine_whole();
      if (!undecided_) break;
    }
    return result_;
  }

  /// Windows one after the other over the whole run, each from the program's states: what all of them agree with needs no explanation.
  Agreement cover() {
    begin(cover_fineness);
    for (int k = 0; k < cover_windows && result_.kind == Agreement::Kind::agrees; ++k)
      cover({network_.stop * k / cover_windows, network_.stop / cover_windows}, cover_cuts);
    return result_;
  }

  [[nodiscard]] bool undecided() const { return undecided_; }

 private:
  void begin(int fineness) {
    fineness_ = fineness;
    undecided_ = false;
    result_ = {};
    unexplained_ = moved_ = States(norm_.parts.size(), 0.0);
  }

  /// The window, or the parts of it if it is too long; so often.
  void cover(const Window& window, int cuts) {
    const States initial = states_at(window.start);
    if (initial.empty()) return;
    const Refinement refinement = refine(beside_, window, initial, fineness_);
    if (!refinement.problem.empty()) return fail("implicit Euler", refinement.problem);
    bool agrees = false;
    if (refinement.resolves(norm_)) {
      const Rows exact = program_at(refinement.grid);
      if (exact.empty()) return;
      agrees = compare(window, refinement, exact);
    }
    if (agrees) return;
    if (cuts == 0) return fail("independent solution", disagreement_);
    for (int k = 0; k < cover_parts && result_.kind == Agreement::Kind::agrees; ++k)
      cover({window.start + window.length * k / cover_parts, window.length / cover_parts}, cuts - 1);
  }

  void examine_whole() {
    const double length = examine_about(0.0, network_.stop);
    result_.whole = result_.windows == 1 && length == network_.stop;
    if (result_.kind != Agreement::Kind::agrees || result_.whole) return;
    for (const double instant : later_instants(length)) {
      examine_about(instant, length);
      if (result_.kind != Agreement::Kind::agrees) return;
    }
    for (std::size_t i = 0; i < moved_.size(); ++i)
      if (moved_[i] < least_motion * unexplained_[i])
        return fail_undecided(
            fmt::format("\n  {} does not move more than {:.3g}; unexplained {:.3g}", norm_.parts[i].name, moved_[i], unexplained_[i]));
  }

  /// Edges of the sources, events of the program's run, and an instant in the middle, that no window of this length at the start holds.
  std::vector<double> later_instants(double length) {
    std::vector<double> instants = some_of(edges_of(network_, network_.stop));
    for (const NetworkPart& part : network_.parts) {
      const auto own = edges_of({network_.nodes, {part}, network_.stop}, network_.stop);
      instants.insert(instants.end(), own.begin(), own.begin() + std::min<std::ptrdiff_t>(std::ssize(own), first_edges));
    }
    const auto events = some_of(program_events());
    instants.insert(instants.end(), events.begin(), events.end());
    instants.push_back(network_.stop * in_the_middle);
    std::erase_if(instants, [length](double t) { return t <= length; });
    std::sort(instants.begin(), instants.end());
    instants.erase(std::unique(instants.begin(), instants.end()), instants.end());
    return instants;
  }

  /// The instant lies a third of the window after its start, however short the window.
  Window window_about(double instant, double length) const {
    const double start = std::max(0.0, instant - length / 3.0);
    return {start, std::min(length, network_.stop - start)};
  }

  static std::vector<double> some_of(const std::vector<double>& times) {
    std::vector<double> result;
    const std::size_t stride = times.size() / most_events + 1;
    for (std::size_t k = 0; k < times.size(); k += stride) result.push_back(times[k]);
    return result;
  }

  std::vector<double> program_events() {
    const ProgramRun run = run_program(to_model(network_), {0.0, network_.stop}, true);
    std::vector<double> times;
    for (std::size_t k = 1; k < run.rows.size(); ++k)
      if (run.rows[k][0] == run.rows[k - 1][0]) times.push_back(run.rows[k][0]);
    return times;
  }

  void fail(const char* what, std::string detail) {
    result_.kind = Agreement::Kind::wrong;
    result_.what = what;
    result_.detail = std::move(detail);
  }

  /// The states of the program at these times; empty where it fails.
  Rows program(const std::vector<double>& times) {
    const ProgramRun run = run_program(to_model(network_), times);
    if (run.finding.kind != Finding::Kind::fine) {
      result_.kind = run.finding.kind == Finding::Kind::refused ? Agreement::Kind::refused : Agreement::Kind::wrong;
      result_.what = run.finding.what;
      result_.detail = run.finding.detail;
      return {};
    }
    Rows rows;
    for (const auto& row : run.rows) rows.emplace_back(row.begin() + 1, row.end());
    return rows;
  }

  void fail_undecided(const std::string& detail) {
    undecided_ = true;
    fail("independent solution", disagreement_ + detail);
  }

  /// Empty where the program fails.
  States states_at(double time) {
    if (time == 0.0) return initial_states(network_);
    const Rows rows = program({0.0, time});
    return rows.empty() ? States{} : rows.back();
  }

  /// Windows about this instant, shorter and shorter. The longest length that agrees, or the last that was looked at.
  double examine_about(double instant, double length) {
    States longer(norm_.parts.size(), 0.0);  // largest disagreements, or changes by the last halving, in longer windows about it
    double agreeing = 0.0;
    bool disagrees = false;
    for (int k = 0; k <= most_shrinkings; ++k, length /= shrinking) {
      const Window window = window_about(instant, length);
      const States initial = states_at(window.start);
      if (initial.empty()) return length;
      const Refinement refinement = refine(beside_, window, initial, fineness_);
      if (!refinement.problem.empty()) {
        fail("implicit Euler", refinement.problem);
        return length;
      }
      if (!refinement.resolves(norm_)) {
        raise(longer, differences(refinement, refinement.rows[levels - 1], refinement.rows[levels - 2]));
        disagreement_ += fmt::format("\n  window {} + {}: implicit Euler does not settle", window.start, window.length);
        continue;
      }
      const Rows exact = program_at(refinement.grid);
      if (exact.empty()) return length;
      if (!compare(window, refinement, exact)) {
        raise(longer, differences(refinement, exact, refinement.rows.back()));
        disagrees = true;
        continue;
      }
      const States moves = motion(exact);
      raise(moved_, moves);
      if (explains(moves, longer)) return length;
      agreeing = std::max(agreeing, length);
      disagreement_ += fmt::format("\n  window {} + {}: agrees, but nothing moves that could explain these", window.start, window.length);
    }
    if (agreeing == 0.0) {
      disagrees ? fail("independent solution", disagreement_) : fail_undecided({});
      return length;
    }
    // What begins to move later is for the windows around events and edges to explain.
    raise(unexplained_, longer);
    return agreeing;
  }

  Rows program_at(const StepGrid& grid) {
    std::vector<double> times{0.0};
    for (const std::size_t sample : grid.samples) times.push_back(grid.times[sample]);
    Rows rows = program(times);
    if (!rows.empty()) rows.erase(rows.begin());
    return rows;
  }

  /// False where they disagree: the window may be too long still, where a tank rings below the changes of all others.
  bool compare(const Window& window, const Refinement& refinement, const Rows& exact) {
    const Measured measured = measure(exact, refinement);
    if (!measured.complaint.empty()) {
      disagreement_ += text_of(window, measured);
      return false;
    }
    ++result_.windows;
    if (measured.noise) return true;
    if (measured.error.back() > result_.difference) {
      result_.difference = measured.error.back();
      result_.order = std::log2(measured.error.front() / measured.error.back()) / (levels - 1);
    }
    result_.extrapolated = std::max(result_.extrapolated, measured.extrapolated);
    return true;
  }

  /// Of each state, the largest difference, where it needs an explanation.
  States differences(const Refinement& refinement, const Rows& a, const Rows& b) const {
    const double scale = refinement.scale(norm_), least = norm_.noise(scale) + worth_explaining * scale;
    States result;
    for (std::size_t i = 0; i < norm_.parts.size(); ++i) {
      const double difference = distance_of(i, a, b);
      result.push_back(difference * std::sqrt(norm_.parts[i].value) > least ? difference : 0.0);
    }
    return result;
  }

  static States motion(const Rows& rows) {
    States result;
    for (std::size_t i = 0; i < rows.front().size(); ++i) result.push_back(distance_of(i, rows, Rows(rows.size(), rows.front())));
    return result;
  }

  static bool explains(const States& moves, const States& differences) {
    for (std::size_t i = 0; i < moves.size(); ++i)
      if (moves[i] < least_motion * differences[i]) return false;
    return true;
  }

  struct Measured {
    std::array<double, levels> error{};  ///< relative
    double extrapolated = 0.0;
    bool noise = false;  ///< the differences are rounding
    std::string complaint;
  };

  Measured measure(const Rows& exact, const Refinement& refinement) const {
    Measured result;
    const auto& rows = refinement.rows;
    const double scale = refinement.scale(norm_), noise = norm_.noise(scale), unit = scale + noise, floor = noise / unit;
    for (std::size_t level = 0; level < levels; ++level) result.error[level] = norm_.distance(exact, rows[level]) / unit;
    result.extrapolated = norm_.distance(exact, extrapolated(rows[3], rows[2])) / unit;
    result.noise = result.error[3] <= floor;
    const double last_change = norm_.distance(rows[3], rows[2]) / unit;
    if (result.error[3] > std::max(floor, std::pow(settling, levels - 1) * result.error[0])) result.complaint = "they do not come nearer";
    if (result.extrapolated > last_change + floor) result.complaint = "extrapolation leads elsewhere";
    for (std::size_t i = 0; i < norm_.parts.size(); ++i)
      if (!state_agrees(i, exact, refinement, noise)) result.complaint = norm_.parts[i].name;
    return result;
  }

  static std::string text_of(const Window& window, const Measured& measured) {
    const auto& error = measured.error;
    return fmt::format("\n  window {} + {}: {}: differences {:.3g} {:.3g} {:.3g} {:.3g}, extrapolated {:.3g}", window.start, window.length,
                       measured.complaint, error[0], error[1], error[2], error[3], measured.extrapolated);
  }

  /// Each state for itself, small ones too.
  bool state_agrees(std::size_t state, const Rows& exact, const Refinement& refinement, double noise) const {
    double change = 0.0;
    for (std::size_t level = 1; level < levels; ++level)
      change = std::max(change, std::ldexp(distance_of(state, refinement.rows[level], refinement.rows[level - 1]),
                                           static_cast<int>(level) - (levels - 1)));
    return distance_of(state, exact, refinement.rows[3]) <= safety * change + noise / std::sqrt(norm_.parts[state].value);
  }

  const RandomNetwork& network_;
  const RandomNetwork& beside_;  ///< what implicit Euler solves
  Norm norm_;
  Agreement result_;
  int fineness_ = 0;
  bool undecided_ = false;  ///< finer steps may tell
  States unexplained_;  ///< largest disagreements in windows that were too long, and that no shorter one about the same instant explains
  States moved_;        ///< most that each state moves in a window that agrees
  std::string disagreement_;  ///< of the windows, from the longest on
};

}  // namespace

/// The second fineness (halvings of all steps before the first) is for what the first could not decide.
Agreement compare_with_independent(const RandomNetwork& network) {
  Comparison comparison(network, network);
  const Agreement agreement = comparison.run({0, 3});
  return comparison.undecided() ? comparison.cover() : agreement;
}

Agreement compare_with_independent(const RandomNetwork& network, const RandomNetwork& beside) {
  return Comparison(network, beside).run({0});
}

RandomNetwork smallest_disagreement(const RandomNetwork& network, const Agreement& agreement) {
  return smallest(network, [&](const RandomNetwork& without) {
    const Agreement again = compare_with_independent(without);
    return again.kind == agreement.kind && again.what == agreement.what;
  });
}

}  // namespace pwlsim::test
