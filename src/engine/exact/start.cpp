#include "engine/exact/start.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "engine/exact/static_solution.hpp"
#include "engine/exact/tolerances.hpp"
#include "engine/remarks.hpp"
#include "engine/sparse/start.hpp"
#include "engine/switch_rounds.hpp"
#include "model/conditions.hpp"
#include "model/leaks.hpp"

namespace pwlsim::engine {

namespace {

using linalg::Vector;

Vector zeta_before_start(const model::System& s) {
  Vector zeta = Vector::Zero(s.n_zeta);
  const auto phase = s.exosystem->start();
  s.exosystem->evaluate(phase, 0.0, zeta.data());
  return zeta;
}

std::string island_elements(const model::System& s) { return s.name; }

/// Active flags of the switch ports of one island for the given switch positions.
std::vector<char> active_switches(const model::System& s, const std::vector<char>& on) {
  std::vector<char> active;
  for (int i = s.diodes; i < s.ports; ++i) {
    const auto index = static_cast<std::size_t>(i - s.diodes);
    const bool closed = (on[static_cast<std::size_t>(s.switch_number[index])] != 0) != (s.switch_inverted[index] != 0);
    active.push_back(closed == s.port[static_cast<std::size_t>(i)].input_is_current);
  }
  return active;
}

/// Where an island without an operating point starts: at its `.ic` values, and zero elsewhere.
StaticSolution start_without_rest(const IslandModel& island, std::vector<Remark>& remarks);

class OperatingPointSolver {
 public:
  /// `systems`: those of the islands, or with their `.ic` values held.
  OperatingPointSolver(const ExactModel& model, std::vector<const model::System*> systems)
      : model_(model), systems_(std::move(systems)), given_(systems_.size(), 0), solutions_(systems_.size()), asked_(systems_.size()) {
    for (const auto& s : model.switches) on.push_back(s.initially_on);
    restless_.resize(on.size());
    rested_.resize(on.size());
    frozen_.resize(on.size());
  }

  /// An island whose state at the start is not its to find.
  void give(std::size_t island, StaticSolution solution) {
    solutions_[island] = std::move(solution);
    given_[island] = 1;
  }

  /// Islands without a rest, and those that hold or drive switches without one, start otherwise; `missing` says which.
  void run(MissingRest& missing, std::vector<Remark>& remarks) {
    while (!settles(missing, remarks)) give_up_restless(missing, remarks);
  }

  [[nodiscard]] const StaticSolution& solution(std::size_t i) const { return solutions_[i]; }
  /// Its own, or with its `.ic` values held.
  [[nodiscard]] const model::System& system(std::size_t i) const { return *systems_[i]; }
  std::vector<char> on;

 private:
  /// An island without a solution is asked again once the others
  /// have moved its switches, and given up where nothing moves any more. False: some keep toggling.
  bool settles(MissingRest& missing, std::vector<Remark>& remarks) {
    SwitchRounds rounds(on.size());
    while (!rounds.exhausted()) {
      solve_all();
      if (!flip_switches(rounds.together())) {
        if (!give_up_unsolved(missing, remarks)) return true;
        rounds.start_anew();
      }
      if (rounds.turns_to_one_by_one(on)) std::fill(restless_.begin(), restless_.end(), 0);
    }
    return false;
  }

  void solve_all() {
    for (std::size_t i = 0; i < systems_.size(); ++i) {
      if (given_[i] != 0) continue;
      const model::System& s = *systems_[i];
      std::vector<char> active = active_switches(s, on);
      if (active == asked_[i]) continue;
      solutions_[i] = solve_static(s, zeta_before_start(s), active);
      asked_[i] = std::move(active);
    }
  }

  [[nodiscard]] bool is_solved(std::size_t i) const { return given_[i] != 0 || solutions_[i].status == StaticSolution::Status::solved; }

  bool give_up_unsolved(MissingRest& missing, std::vector<Remark>& remarks) {
    bool any = false;
    for (std::size_t i = 0; i < systems_.size(); ++i) {
      if (is_solved(i)) continue;
      missing.parts.push_back(fmt::format("in the part with {}, with its inductors short and its capacitors open, no solution exists",
                                          island_elements(*systems_[i])));
      start_from_values(i, remarks);
      any = true;
    }
    return any;
  }

  void start_from_values(std::size_t i, std::vector<Remark>& remarks) {
    systems_[i] = &model_.islands[i].extraction.system;
    give(i, start_without_rest(model_.islands[i], remarks));
  }

  /// Restless switches stand where they do at the start of a run with uic.
  void give_up_restless(MissingRest& missing, std::vector<Remark>& remarks) {
    std::vector<std::string> names;
    for (std::size_t k = 0; k < on.size(); ++k) {
      if (restless_[k] == 0) continue;
      names.push_back(model_.switches[k].name);
      frozen_[k] = 1;
      on[k] = model_.switches[k].initially_on;
      for (std::size_t i = 0; i < systems_.size(); ++i) {
        const auto drives_it = [k](const model::Control& control) { return static_cast<std::size_t>(control.driven) == k; };
        const auto &controls = systems_[i]->controls, &clocked = systems_[i]->clocked;
        const bool drives =
            std::any_of(controls.begin(), controls.end(), drives_it) || std::any_of(clocked.begin(), clocked.end(), drives_it);
        if (given_[i] == 0 && (drives || model_.switches[k].island == static_cast<int>(i))) start_from_values(i, remarks);
      }
    }
    if (!names.empty()) missing.add_restless(names);
  }

  /// All that their controls contradict; `together` false: only the first, for a latch that would change sides for ever. Where there are none, once
  /// each, those whose control rests at a threshold that counts as passed.
  bool flip_switches(bool together) { return flip_switches(together, false) || flip_switches(together, true); }

  bool flip_switches(bool together, bool at_rest) {
    bool flipped = false;
    for (std::size_t i = 0; i < systems_.size(); ++i) {
      if (!is_solved(i)) continue;
      for (const auto* controls : {&systems_[i]->clocked, &systems_[i]->controls})
        for (const model::Control& control : *controls) {
          if (!flip_contradicted(control, solutions_[i], at_rest)) continue;
          flipped = true;
          if (!together) return true;
        }
    }
    return flipped;
  }

  bool flip_contradicted(const model::Control& control, const StaticSolution& solution, bool at_rest) {
    const auto k = static_cast<std::size_t>(control.driven);
    if (frozen_[k] != 0) return false;
    const double value = control.value.state.dot(solution.x) + control.value.input.dot(solution.u);
    const double margin = on[k] != 0 ? value - control.off_level : control.on_level - value;
    const double rounding = rounding_at(solution, control);
    const bool is_off_at_rest = control.on_level == control.off_level;
    const bool rests = at_rest && is_off_at_rest && on[k] != 0 && rested_[k] == 0 && margin <= rounding;
    if (!rests && margin >= -rounding) return false;
    on[k] = on[k] == 0;
    if (rests) rested_[k] = 1;
    restless_[k] = 1;
    return true;
  }

  /// Of a control's value: against its terms, and against the largest current or voltage of a port where it reads ports.
  [[nodiscard]] static double rounding_at(const StaticSolution& at, const model::Control& control) {
    double size = std::max(std::abs(control.on_level), std::abs(control.off_level));
    size += control.value.state.cwiseAbs().dot(at.x.cwiseAbs());
    if (at.u.size() > 0) size += control.value.input.cwiseAbs().maxCoeff() * at.u.cwiseAbs().maxCoeff();
    return tolerance::control_at_start * size;
  }

  const ExactModel& model_;
  std::vector<const model::System*> systems_;
  std::vector<char> given_;
  std::vector<StaticSolution> solutions_;
  std::vector<std::optional<std::vector<char>>> asked_;  ///< with which switches active each island was solved last
  std::vector<char> restless_;                           ///< switches that have changed sides since they do so one by one
  std::vector<char> rested_;                             ///< those that changed sides since their control rests at a threshold
  std::vector<char> frozen_;                             ///< and those that are no longer asked
};

bool has_conditions(const model::Island& island) {
  return !island.network.node_conditions.empty() || !island.network.current_conditions.empty();
}

/// The island with its sources at rest and its `.ic` values held by sources; behind its own signals come the capacitors' voltages and the inductors' currents.
model::Island with_conditions(const model::Island& island) {
  model::Island forced = island;
  model::Network& n = forced.network;
  n = model::with_held_conditions(model::with_resting_sources(n));
  for (std::size_t i = 0; i < n.capacitors.size(); ++i) {
    const auto& c = n.capacitors[i];
    n.signals.push_back({"", {{model::Term::Kind::node_voltage, c.p, 1.0}, {model::Term::Kind::node_voltage, c.n, -1.0}}});
  }
  for (std::size_t i = 0; i < n.inductors.size(); ++i)
    n.signals.push_back({"", {{model::Term::Kind::inductor_current, static_cast<int>(i), 1.0}}});
  forced.signal_number.resize(n.signals.size(), -1);
  return forced;
}

/// Energy coordinates of an island from the forced solution's capacitor voltages and inductor currents.
Vector energy_from(const IslandModel& original, const model::System& forced, const StaticSolution& solution) {
  model::Island island = original.island;
  const auto value = [&](std::size_t i) {
    const auto& row = forced.outputs[i];
    return row.state.dot(solution.x) + row.input.dot(solution.u);
  };
  std::size_t next = island.network.signals.size();
  for (auto& c : island.network.capacitors) c.initial_voltage = value(next++);
  for (auto& l : island.network.inductors) l.initial_current = value(next++);
  return original.extraction.equations.reduce * model::initial_state(island);
}

model::Island with_initial_values(model::Island island) {
  island.network = model::with_initial_values(std::move(island.network));
  return island;
}

/// Whether values given were moved: any that is not zero, and a zero that a capacitor's own ic= says.
bool contradicts(const model::Network& network, const Vector& given, const Vector& taken) {
  if (given.size() == 0) return false;
  const Vector moved = (taken - given).cwiseAbs();
  if (given.norm() > 0.0 && moved.norm() > tolerance::moved_start * given.norm()) return true;
  for (std::size_t i = 0; i < network.capacitors.size(); ++i)
    if (network.capacitors[i].has_initial && moved[static_cast<Eigen::Index>(i)] > tolerance::moved_start * taken.norm()) return true;
  return false;
}

/// Without the part of the values that loops of capacitors and sources, or cutsets of inductors, do not allow. `values`: the island with those meant.
Vector projected_initial_state(const IslandModel& island, const model::Island& values, std::vector<Remark>& remarks) {
  const model::Equations& d = island.extraction.equations;
  const model::System& s = island.extraction.system;
  const Vector full = model::initial_state(with_initial_values(values));
  Vector x(s.size());
  const Vector zeta = zeta_before_start(s);
  x << d.start * full + d.start_sources * zeta, zeta;
  if (contradicts(values.network, full, d.store_state * x))
    remarks.push_back(
        {"W-start-projected", fmt::format("the initial values of the part with {} contradict the circuit; they are projected at t = 0 "
                                          "like any jump, conserving charge and flux",
                                          island_elements(s))});
  return x.head(s.n);
}

StaticSolution at_state(const model::System& s, const Vector& xi) {
  StaticSolution solution;
  solution.x.resize(s.size());
  solution.x << xi, zeta_before_start(s);
  solution.u = Vector::Zero(s.ports);
  return solution;
}

StaticSolution start_without_rest(const IslandModel& island, std::vector<Remark>& remarks) {
  model::Island values = island.island;
  values.network = model::without_initial_values(std::move(values.network));
  return at_state(island.extraction.system, projected_initial_state(island, values, remarks));
}

/// A raw system, which starts where it is told to, with uic or without: no input acts before the start.
bool starts_where_told(const IslandModel& island) {
  const auto& capacitors = island.island.network.capacitors;
  return std::any_of(capacitors.begin(), capacitors.end(), [](const model::Capacitor& c) { return c.starts_there; });
}

/// In its own equations sources that move would not be at rest, which only shows where their rates of change act.
bool has_own_rest(const IslandModel& island) {
  return !has_conditions(island.island) && (!island.extraction.equations.reads_source_rates || starts_where_told(island));
}

/// Islands as `.ic` forces them, or with sources at rest, by number. Null where `.ic` contradicts them; `start` says so.
using Forced = std::map<std::size_t, model::Extraction>;
std::optional<Forced> forced_islands(const ExactModel& model, RunStart& start) {
  Forced forced;
  for (std::size_t i = 0; i < model.islands.size(); ++i) {
    if (has_own_rest(model.islands[i])) continue;
    Diagnostics ignored;
    auto extraction = model::extract(with_conditions(model.islands[i].island), ignored);
    if (!extraction) {
      start.answer.outcome = Outcome::no_solution;
      start.answer.id = "E-ic-contradiction";
      start.answer.message = fmt::format(".ic forces voltages or currents that contradict sources or each other in the part with {}",
                                         island_elements(model.islands[i].extraction.system));
      return std::nullopt;
    }
    forced.emplace(i, std::move(*extraction));
  }
  return forced;
}

/// Its rest by another way, where rounding leaves the one that was found few digits, in energy coordinates: what both agree in to that rounding is right to more digits there. `on`: of all switches.
struct SharperRest {
  Vector xi;
  std::vector<double> signals;
};
std::optional<SharperRest> sharper_rest(const IslandModel& island, const StaticSolution& solution, const std::vector<char>& on) {
  if (!solution.unique || !(solution.doubt > tolerance::dc_doubt)) return std::nullopt;
  model::Island at = island.island;
  for (std::size_t i = 0; i < at.network.switches.size(); ++i)
    at.network.switches[i].initially_on = on[static_cast<std::size_t>(at.switch_number[i])] != 0;
  const auto rest = sparse::rest_of(model::without_ports_of_leaks(at.network));
  if (!rest) return std::nullopt;
  for (std::size_t i = 0; i < rest->voltages.size(); ++i) at.network.capacitors[i].initial_voltage = rest->voltages[i];
  for (std::size_t i = 0; i < rest->currents.size(); ++i) at.network.inductors[i].initial_current = rest->currents[i];
  SharperRest sharper{island.extraction.equations.reduce * model::initial_state(at), rest->signals};
  const Vector found = solution.x.head(sharper.xi.size());
  const double most = std::min(tolerance::dc_doubts * solution.doubt, tolerance::dc_largest_doubt) * found.cwiseAbs().maxCoeff();
  if (!((sharper.xi - found).cwiseAbs().maxCoeff() <= most)) return std::nullopt;
  return sharper;
}

/// The island's state, and its signals before t = 0 where `has_before`. `system`: the one that was solved, or as it is forced.
void take_solution(const IslandModel& island, const model::System& system, const StaticSolution& solution, bool has_before,
                   RunStart& start) {
  const model::System& s = island.extraction.system;
  if (!solution.unique) start.answer.remarks.push_back(operating_point_not_unique(island_elements(s), "the one of least energy"));
  const auto sharper = &system == &s ? sharper_rest(island, solution, start.on) : std::nullopt;
  start.xi.push_back(&system != &s ? energy_from(island, system, solution) : sharper ? sharper->xi : Vector(solution.x.head(s.n)));
  if (!has_before) return;
  if (sharper) {
    start.signals.push_back(sharper->signals);
    return;
  }
  std::vector<double>& values = start.signals.emplace_back();
  for (std::size_t k = 0; k < s.outputs.size(); ++k) {
    const model::OutputRow& row = system.outputs[k];
    values.push_back(row.state.dot(solution.x) + row.input.dot(solution.u));
  }
}

}  // namespace

RunStart start_from_operating_point(const ExactModel& model) {
  RunStart start;
  const std::optional<Forced> forced = forced_islands(model, start);
  if (!forced) return start;
  std::vector<const model::System*> systems;
  for (std::size_t i = 0; i < model.islands.size(); ++i) {
    const auto found = forced->find(i);
    systems.push_back(found != forced->end() ? &found->second.system : &model.islands[i].extraction.system);
  }
  OperatingPointSolver solver(model, std::move(systems));
  for (std::size_t i = 0; i < model.islands.size(); ++i) {
    const IslandModel& island = model.islands[i];
    if (starts_where_told(island))
      solver.give(i, at_state(island.extraction.system, island.extraction.equations.reduce * model::initial_state(island.island)));
  }
  solver.run(start.missing, start.answer.remarks);
  start.on = solver.on;
  for (std::size_t i = 0; i < model.islands.size(); ++i)
    take_solution(model.islands[i], solver.system(i), solver.solution(i), start.missing.empty(), start);
  return start;
}

RunStart start_from_initial_values(const ExactModel& model) {
  RunStart start;
  for (const auto& s : model.switches) start.on.push_back(s.initially_on);
  for (const auto& island : model.islands) start.xi.push_back(projected_initial_state(island, island.island, start.answer.remarks));
  for (const auto& island : model.left_out) projected_initial_state(island, island.island, start.answer.remarks);
  return start;
}

RunStart start_from(const ExactModel& model, const GivenStores& values) {
  RunStart start;
  for (const auto& s : model.switches) start.on.push_back(s.initially_on);
  const auto value_of = [](const auto& known, const std::string& name) {
    const auto found = known.find(name);
    return found != known.end() ? found->second : 0.0;
  };
  std::vector<Remark> contradictions;
  for (const auto& island : model.islands) {
    model::Island at = island.island;
    for (auto& c : at.network.capacitors) {
      c.has_initial = true;
      c.initial_voltage = value_of(values.voltages, c.label.name);
    }
    for (auto& l : at.network.inductors) {
      l.has_initial = true;
      l.initial_current = value_of(values.currents, l.label.name);
    }
    start.xi.push_back(projected_initial_state(island, at, contradictions));
  }
  return start;
}

}  // namespace pwlsim::engine
