#include "engine/sparse/start.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <span>

#include "base/arithmetic.hpp"
#include "base/disjoint_sets.hpp"
#include "engine/sparse/port_solver.hpp"
#include "engine/sparse/sources.hpp"
#include "engine/sparse/tolerances.hpp"
#include "engine/switch_rounds.hpp"
#include "model/conditions.hpp"

namespace pwlsim::engine::sparse {

namespace {

using model::Network;

/// Sizes of the steps that find the operating point, in mean time constants, and what counts as rest.
constexpr double first_step = 1e4, last_step = 1e14, step_growth = 1e2;
constexpr int steps_of_a_size = 3;
/// Beside the point that was found, of the largest voltage or of 1 V, and what is left of it after long steps where something does not lead back.
constexpr double beside = 1e-4, shift_left = 0.01;
constexpr int steps_back = 2;
constexpr const char* no_rest = "no DC state exists with inductors short and capacitors open";

double mean_time(const Descriptor& d) {
  LogMean mean;
  for (const State& state : d.states()) mean.add(std::abs(state.storage) * (state.is_current ? 1.0 / d.r0() : d.r0()));
  return mean.value();
}

class RestFinder {
 public:
  RestFinder(const Network& network, const Descriptor& descriptor)
      : descriptor_(descriptor),
        factors_(network, descriptor),
        ports_(descriptor, factors_, largest_held_voltage(network, 0.0)),
        controls_(controls_of(network, descriptor)) {
    on = first_position(network, descriptor);
    Sources(network).evaluate(0.0, w_);
  }

  /// A position without a rest may be left by what is driven elsewhere.
  bool run() {
    SwitchRounds rounds(controls_.size());
    while (!rounds.exhausted()) {
      const bool found = find_rest();
      if (is_singular) return false;
      if (!flip_switches(rounds.together())) return found;
      if (rounds.turns_to_one_by_one(on)) changed_.clear();
    }
    problem.clear();
    return false;
  }

  /// With the switches as they are.
  bool find_rest() {
    std::vector<double> before;
    z.assign(static_cast<std::size_t>(descriptor_.size()), 0.0);
    const double time = mean_time(descriptor_);
    for (double size = first_step; size <= last_step; size *= step_growth)
      for (int step = 0; step < steps_of_a_size; ++step) {
        before = z;
        const Solved solved = take_step(1.0 / (size * time), before, on, z);
        if (solved != Solved::yes) {
          // What sources contradict is singular in any step; what only a long one finds singular is an inductor that is short by then.
          is_singular = solved == Solved::singular && !(size > first_step);
          problem = is_singular                  ? singular_problem()
                    : solved == Solved::singular ? no_rest
                                                 : "no position of the diodes satisfies the circuit";
          z = before;
          return false;
        }
        if (step > 0 && rests(before)) {
          settle_slowest(size);
          return true;
        }
      }
    problem = no_rest;
    return false;
  }

  /// Whether long steps from either side of the point that was found lead back to it. In a passive network, whose operating points are a convex set, they do only if it is the only one.
  [[nodiscard]] bool is_unique() { return !leaves_charges_open() && leads_back(beside) && leads_back(-beside); }

  Position on;
  std::vector<double> z;
  std::string problem;  ///< empty: switches keep toggling
  bool is_singular = false;
  [[nodiscard]] std::vector<std::string> restless() const {
    std::vector<std::string> names;
    for (const std::size_t port : changed_) names.push_back(descriptor_.ports()[port].name);
    return names;
  }
  [[nodiscard]] const std::vector<double>& w() const { return w_; }

 private:
  /// What moves by less than the nine digits of a rest may have far to go by leaks.
  void settle_slowest(double size) {
    if (!(size < last_step)) return;
    Position position = on;
    std::vector<double> rest;
    if (take_step(1.0 / (last_step * mean_time(descriptor_)), z, position, rest) != Solved::yes) return;
    on = position;
    z = std::move(rest);
  }

  /// Implicit Euler's, from `before` to `after`, in the position that fits it.
  [[nodiscard]] Solved take_step(double shift, const std::vector<double>& before, Position& position, std::vector<double>& after) {
    std::vector<double> right(before.size()), moved;
    descriptor_.rates(before.data(), w_.data(), right.data());
    return ports_.solve({shift, before, right, w_}, position, moved, after);
  }

  /// Whether a capacitor joins parts that nothing else joins but ports that block, or carry nothing: these may shift against each other as far as diodes allow. Long steps, in which ties hold such a part, would not show that.
  [[nodiscard]] bool leaves_charges_open() const {
    if (!descriptor_.passive()) return false;
    const Network& network = descriptor_.network();
    DisjointSets sets(static_cast<int>(network.nodes.size()) + 1);
    const auto join = [&](const auto& part) { sets.join(part.p + 1, part.n + 1); };
    for (const auto& r : network.resistors) join(r);
    for (const auto& l : network.inductors) join(l);
    for (const auto& branch : network.branches) join(branch);
    const double current = largest(std::span(z).subspan(static_cast<std::size_t>(descriptor_.nodes())));
    for (std::size_t i = 0; i < on.size(); ++i) {
      const DescriptorPort& port = descriptor_.ports()[i];
      const bool carries = std::abs(z[static_cast<std::size_t>(port.row)]) > tolerance::dc_rest * current;
      if (on[i] != 0 && (carries || port.is_switch)) join(port);
    }
    return std::any_of(network.capacitors.begin(), network.capacitors.end(),
                       [&](const auto& c) { return sets.find(c.p + 1) != sets.find(c.n + 1); });
  }

  [[nodiscard]] bool leads_back(double share) {
    const double aside = share * (largest(z) > 0.0 ? largest(z) : 1.0), shift = 1.0 / (last_step * mean_time(descriptor_));
    std::vector<double> before, reached = z;
    for (std::size_t i = 0; i < z.size(); ++i) reached[i] += aside * std::sin(1.0 + 37.0 * static_cast<double>(i * i + 1));
    Position position = on;
    for (int step = 0; step < steps_back; ++step) {
      before = reached;
      if (take_step(shift, before, position, reached) != Solved::yes) return true;
    }
    return std::all_of(descriptor_.states().begin(), descriptor_.states().end(), [&](const State& state) {
      return std::abs(state.value(reached.data()) - state.value(z.data())) <= shift_left * std::abs(aside);
    });
  }

  [[nodiscard]] std::string singular_problem() const {
    const int unknown = factors_.singular_unknown();
    return unknown >= 0 ? fmt::format("the equations do not determine {}", descriptor_.unknown_name(unknown))
                        : "the equations are singular";
  }

  [[nodiscard]] bool rests(const std::vector<double>& before) const {
    double change[2] = {0.0, 0.0}, size[2] = {0.0, 0.0};
    for (const State& state : descriptor_.states()) {
      const int kind = state.is_current ? 1 : 0;
      change[kind] = std::max(change[kind], std::abs(state.value(z.data()) - state.value(before.data())));
      size[kind] = std::max(size[kind], std::abs(state.value(z.data())));
    }
    double total = 0.0;
    for (const double value : z) total = std::max(total, std::abs(value));
    return change[0] <= tolerance::dc_rest * std::max(size[0], tolerance::dc_least * total) &&
           change[1] <= tolerance::dc_rest * std::max(size[1], tolerance::dc_least * total);
  }

  /// All that their controls contradict; `together` false: only the first, for a latch that would change sides for ever. Where there are none, once
  /// each, those whose control rests at a threshold that counts as passed.
  bool flip_switches(bool together) { return flip_switches(together, false) || flip_switches(together, true); }

  bool flip_switches(bool together, bool at_rest) {
    bool flipped = false;
    const double unknown = largest(z);
    for (WatchedControl& control : controls_) {
      const double slack = std::max(tolerance::dc_rest * control.level_size(), control.rounding(unknown));
      const double margin = control.margin(on, control.value.value(z.data(), w_.data()));
      const double rounding = std::max(slack, tolerance::dc_rest * control.value.size(z.data(), w_.data()));
      const bool rests = at_rest && !control.has_rested && control.passes_at_rest(on) && margin <= rounding;
      if (!rests && margin >= -slack) continue;
      control.has_rested |= rests;
      on[control.port] ^= 1;
      changed_.insert(control.port);
      flipped = true;
      if (!together) break;
    }
    return flipped;
  }

  const Descriptor& descriptor_;
  Factors factors_;
  PortSolver ports_;
  std::vector<WatchedControl> controls_;
  std::vector<double> w_;
  std::set<std::size_t> changed_;  ///< switches, since they change one by one
};

/// Whether the equations without `.ic` leave nothing open.
bool is_regular(const Network& network, const Descriptor& descriptor) {
  RestFinder point(network, descriptor);
  return point.run() || !point.is_singular;
}

}  // namespace

PartStart start_from_initial_values(const Network& network, const Descriptor& descriptor) {
  PartStart start;
  start.on = first_position(network, descriptor);
  const Network initial = model::with_initial_values(network);
  for (const auto& c : initial.capacitors) start.states.push_back(c.initial_voltage);
  for (const auto& l : initial.inductors) start.states.push_back(descriptor.r0() * l.initial_current);
  return start;
}

PartStart start_from_operating_point(const Network& network, const Descriptor& descriptor) {
  const bool told = std::any_of(network.capacitors.begin(), network.capacitors.end(), [](const auto& c) { return c.starts_there; });
  if (told) return start_from_initial_values(network, descriptor);
  PartStart start;
  const Network forced = model::with_held_conditions(network);
  const Descriptor system(forced, Descriptor::Steps::to_rest);
  RestFinder point(forced, system);
  if (!point.run()) {
    const bool is_forced = forced.branches.size() + forced.injections.size() > network.branches.size() + network.injections.size();
    if (point.is_singular && is_forced && is_regular(network, descriptor)) {
      start.answer.outcome = Outcome::no_solution;
      start.answer.id = "E-ic-contradiction";
      start.answer.message = fmt::format(".ic forces voltages or currents that contradict sources or each other: {}", point.problem);
      return start;
    }
    start = start_from_initial_values(model::without_initial_values(network), descriptor);
    if (point.problem.empty())
      start.missing.add_restless(point.restless());
    else
      start.missing.parts.push_back(fmt::format("in the part with {} {}", descriptor.unknown_name(0), point.problem));
    return start;
  }
  start.on = point.on;
  start.is_unique = point.is_unique();
  for (const State& state : system.states())
    start.states.push_back(state.value(point.z.data()) * (state.is_current ? descriptor.r0() / system.r0() : 1.0));
  for (const auto& signal : network.signals) start.signals.push_back(system.form(signal.form).value(point.z.data(), point.w().data()));
  return start;
}

std::optional<Rest> rest_of(const Network& network) {
  const Descriptor descriptor(network, Descriptor::Steps::to_rest);
  RestFinder point(network, descriptor);
  if (!point.find_rest()) return std::nullopt;
  Rest rest;
  for (const State& state : descriptor.states()) {
    const double value = state.value(point.z.data());
    state.is_current ? rest.currents.push_back(value / descriptor.r0()) : rest.voltages.push_back(value);
  }
  for (const auto& signal : network.signals) rest.signals.push_back(descriptor.form(signal.form).value(point.z.data(), point.w().data()));
  return rest;
}

}  // namespace pwlsim::engine::sparse
