#include "engine/exact/start.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "engine/exact/static_solution.hpp"
#include "engine/remarks.hpp"
#include "model/conditions.hpp"

namespace pwlsim::engine {

namespace {

using linalg::Vector;

constexpr int most_rounds = 64;  ///< of switches answering each other
constexpr int simultaneous_rounds = 16;

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

using Given = std::map<std::size_t, StaticSolution>;

class OperatingPointSolver {
 public:
  /// `given`: islands whose state at the start is not theirs to find.
  OperatingPointSolver(const std::vector<const model::System*>& systems, const std::vector<SwitchInfo>& switches, Given given)
      : systems_(systems), given_(std::move(given)), solutions_(systems.size()) {
    for (const auto& s : switches) {
      on.push_back(s.initially_on);
      names_.push_back(s.name);
    }
    restless_.resize(names_.size());
  }

  bool run(Answer& answer) {
    for (int round = 0; round < most_rounds; ++round) {
      if (round == simultaneous_rounds) std::fill(restless_.begin(), restless_.end(), 0);
      if (!solve_all(answer)) return false;
      if (!flip_switches(round < simultaneous_rounds)) return true;
    }
    answer.outcome = Outcome::no_solution;
    answer.id = no_operating_point;
    for (std::size_t i = 0; i < names_.size(); ++i)
      if (restless_[i] != 0) answer.elements.push_back(names_[i]);
    answer.message = fmt::format("no DC operating point: {} {} no rest", fmt::join(answer.elements, ", "),
                                 answer.elements.size() == 1 ? "finds" : "find");
    return false;
  }

  [[nodiscard]] const StaticSolution& solution(std::size_t i) const { return solutions_[i]; }
  std::vector<char> on;

 private:
  bool solve_all(Answer& answer) {
    for (std::size_t i = 0; i < systems_.size(); ++i) {
      const model::System& s = *systems_[i];
      if (const auto it = given_.find(i); it != given_.end()) {
        solutions_[i] = it->second;
        continue;
      }
      solutions_[i] = solve_static(s, zeta_before_start(s), active_switches(s, on));
      if (solutions_[i].status == StaticSolution::Status::solved) continue;
      answer.outcome = Outcome::no_solution;
      answer.id = no_operating_point;
      answer.message =
          fmt::format("no DC operating point in the part with {}: with its inductors short and its capacitors open no solution exists",
                      island_elements(s));
      return false;
    }
    return true;
  }

  /// All that their controls contradict; `together` false: only the first, for a latch that would change sides for ever.
  bool flip_switches(bool together) {
    bool flipped = false;
    for (std::size_t i = 0; i < systems_.size(); ++i)
      for (const auto& control : systems_[i]->controls) {
        const double value = control.value.state.dot(solutions_[i].x) + control.value.input.dot(solutions_[i].u);
        char& is_on = on[static_cast<std::size_t>(control.driven)];
        // On the threshold itself nothing moves: it is a value at rest.
        const bool flip = is_on != 0 ? value < control.off_level : value > control.on_level;
        if (!flip) continue;
        is_on = is_on == 0;
        restless_[static_cast<std::size_t>(control.driven)] = 1;
        flipped = true;
        if (!together) return true;
      }
    return flipped;
  }

  std::vector<const model::System*> systems_;
  Given given_;
  std::vector<StaticSolution> solutions_;
  std::vector<std::string> names_;
  std::vector<char> restless_;  ///< switches that have changed sides since they do so one by one
};

bool has_conditions(const model::Island& island) {
  return !island.network.node_conditions.empty() || !island.network.current_conditions.empty();
}

/// The island with its `.ic` values held by sources; behind its own signals come the capacitors' voltages and the inductors' currents.
model::Island with_conditions(const model::Island& island) {
  model::Island forced = island;
  model::Network& n = forced.network;
  n = model::with_held_conditions(n);
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
  return original.extraction.descriptor.reduce * model::initial_state(island);
}

model::Island with_initial_values(model::Island island) {
  island.network = model::with_initial_values(std::move(island.network));
  return island;
}

/// Whether values given were moved: any that is not zero, and a zero that a capacitor's own ic= says.
bool contradicts(const model::Network& network, const Vector& given, const Vector& taken) {
  constexpr double rounding = 1e-9;
  if (given.size() == 0) return false;
  const Vector moved = (taken - given).cwiseAbs();
  if (given.norm() > 0.0 && moved.norm() > rounding * given.norm()) return true;
  for (std::size_t i = 0; i < network.capacitors.size(); ++i)
    if (network.capacitors[i].has_initial && moved[static_cast<Eigen::Index>(i)] > rounding * taken.norm()) return true;
  return false;
}

/// Without the part of the values that loops of capacitors and sources, or cutsets of inductors, do not allow.
Vector projected_initial_state(const IslandModel& island, std::vector<Remark>& remarks) {
  const model::Descriptor& d = island.extraction.descriptor;
  const model::System& s = island.extraction.system;
  const Vector full = model::initial_state(with_initial_values(island.island));
  Vector x(s.size());
  x << d.reduce * full, zeta_before_start(s);
  if (contradicts(island.island.network, full, d.store_state * x))
    remarks.push_back(
        {"W-start-projected", fmt::format("the initial values of the part with {} contradict the circuit; they are projected at t = 0 "
                                          "as any jump, conserving charge and flux",
                                          island_elements(s))});
  return x.head(s.n);
}

/// Islands of states that start where they are told to, with uic or without: no input acts before the start.
Given given_starts(const ExactModel& model) {
  Given given;
  for (std::size_t i = 0; i < model.islands.size(); ++i) {
    const auto& capacitors = model.islands[i].island.network.capacitors;
    if (!std::any_of(capacitors.begin(), capacitors.end(), [](const model::Capacitor& c) { return c.starts_there; })) continue;
    const model::System& s = model.islands[i].extraction.system;
    StaticSolution solution;
    solution.x.resize(s.size());
    solution.x << model.islands[i].extraction.descriptor.reduce * model::initial_state(model.islands[i].island), zeta_before_start(s);
    solution.u = Vector::Zero(s.ports);
    given.emplace(i, std::move(solution));
  }
  return given;
}

}  // namespace

Start start_from_operating_point(const ExactModel& model) {
  Start start;
  std::map<std::size_t, model::Extraction> forced;
  std::vector<const model::System*> systems;
  for (std::size_t i = 0; i < model.islands.size(); ++i) {
    systems.push_back(&model.islands[i].extraction.system);
    if (!has_conditions(model.islands[i].island)) continue;
    Diagnostics ignored;
    auto extraction = model::extract(with_conditions(model.islands[i].island), ignored);
    if (!extraction) {
      start.answer.outcome = Outcome::no_solution;
      start.answer.id = "E-ic-contradiction";
      start.answer.message = fmt::format(".ic forces voltages or currents that contradict sources or each other in the part with {}",
                                         island_elements(model.islands[i].extraction.system));
      return start;
    }
    forced.emplace(i, std::move(*extraction));
    systems.back() = &forced.at(i).system;
  }
  OperatingPointSolver solver(systems, model.switches, given_starts(model));
  if (!solver.run(start.answer)) return start;
  start.on = solver.on;
  for (std::size_t i = 0; i < model.islands.size(); ++i) {
    const StaticSolution& solution = solver.solution(i);
    const model::System& s = model.islands[i].extraction.system;
    if (!solution.unique)
      start.answer.remarks.push_back(
          {"W-op-not-unique", fmt::format("the DC operating point of the part with {} is not unique (a loop without resistance or a "
                                          "floating capacitor); the run starts from the one of least energy",
                                          island_elements(s))});
    if (const auto it = forced.find(i); it != forced.end()) {
      start.xi.push_back(energy_from(model.islands[i], it->second.system, solution));
    } else {
      start.xi.push_back(solution.x.head(s.n));
    }
    std::vector<double>& values = start.signals.emplace_back();
    for (std::size_t k = 0; k < s.outputs.size(); ++k) {
      const model::OutputRow& row = systems[i]->outputs[k];
      values.push_back(row.state.dot(solution.x) + row.input.dot(solution.u));
    }
  }
  return start;
}

Start start_from_initial_values(const ExactModel& model) {
  Start start;
  for (const auto& s : model.switches) start.on.push_back(s.initially_on);
  for (const auto& island : model.islands) start.xi.push_back(projected_initial_state(island, start.answer.remarks));
  for (const auto& island : model.left_out) projected_initial_state(island, start.answer.remarks);
  return start;
}

}  // namespace pwlsim::engine
