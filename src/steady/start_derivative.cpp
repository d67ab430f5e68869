#include "steady/start_derivative.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/exact/static_solution.hpp"
#include "linalg/factorisations.hpp"
#include "model/conditions.hpp"
#include "model/store_values.hpp"
#include "steady/tolerances.hpp"

namespace pwlsim::steady {
namespace {

using linalg::Wide;
using linalg::WideMatrix;
using linalg::WideVector;
using model::System;

bool has_conditions(const model::Network& network) { return !network.node_conditions.empty() || !network.current_conditions.empty(); }

Vector initial_values(const engine::IslandModel& island, const ParameterInputs& parameter) {
  model::Island moved = island.island;
  for (auto& item : moved.network.capacitors) item.initial_voltage = 0.0;
  for (auto& item : moved.network.inductors) item.initial_current = 0.0;
  const auto condition_of = [&](bool is_current, const std::string& name) {
    double sum = 0.0;
    for (const ConditionMove& condition : parameter.conditions)
      if (condition.is_current == is_current && condition.name == name) sum += condition.value;
    return sum;
  };
  for (auto& item : moved.network.node_conditions) item.voltage = condition_of(false, item.label.name);
  for (auto& item : moved.network.current_conditions) {
    item.current = condition_of(true, item.label.name);
    moved.network.inductors[static_cast<std::size_t>(item.inductor)].initial_current = item.current;
  }
  moved.network = model::with_initial_values(std::move(moved.network));
  const auto add = [](auto& list, const std::string& name, auto member, double value) {
    for (auto& item : list)
      if (item.label.name == name) {
        item.has_initial = true;
        item.*member += value;
      }
  };
  for (const StartMove& start : parameter.starts)
    start.is_capacitor ? add(moved.network.capacitors, start.name, &model::Capacitor::initial_voltage, start.value)
                       : add(moved.network.inductors, start.name, &model::Inductor::initial_current, start.value);
  return island.extraction.equations.reduce * model::initial_state(moved);
}

/// One island at rest.
class Rest {
 public:
  Rest(const engine::IslandModel& island, std::size_t number, const LinearisedOrbit& orbit, const engine::RunStart& start,
       const ParameterInputs& parameter)
      : island_(island), system_(island.extraction.system), number_(number), orbit_(orbit), on_(start.on), parameter_(parameter) {}

  StartDerivative solve() {
    StartDerivative result{Vector::Zero(system_.n), ""};
    Vector zeta = Vector::Zero(system_.n_zeta);
    system_.exosystem->evaluate(system_.exosystem->start(), 0.0, zeta.data());
    std::vector<char> active_switches;
    for (int port = system_.diodes; port < system_.ports; ++port) active_switches.push_back(is_active(port) ? 1 : 0);
    const engine::StaticSolution rest = engine::solve_static(system_, zeta, active_switches);
    if (rest.status != engine::StaticSolution::Status::solved) {
      result.failure = fmt::format("the part with {} has no operating point", system_.name);
      return result;
    }
    x_ = rest.x;
    u_ = rest.u;
    const Vector w = moved_sources();
    if (w.isZero(0.0)) return result;
    const std::vector<int> active = active_ports();
    const auto n = static_cast<Eigen::Index>(system_.n), ports = static_cast<Eigen::Index>(active.size());
    const auto exact = system_.unrounded_matrices();
    WideMatrix k(n + ports, n + ports);
    WideVector right(n + ports);
    k.topLeftCorner(n, n) = exact->a.topLeftCorner(n, n);
    right.head(n) = -(exact->a.topRightCorner(n, system_.n_zeta) * w.cast<Wide>());
    for (Eigen::Index j = 0; j < ports; ++j) {
      const int port = active[static_cast<std::size_t>(j)];
      k.col(n + j).head(n) = exact->b.col(port).head(n);
      k.row(n + j).head(n) = exact->c.row(port).head(n);
      right[n + j] = -(exact->c.row(port).tail(system_.n_zeta) * w.cast<Wide>()).value();
      for (Eigen::Index i = 0; i < ports; ++i) k(n + j, n + i) = exact->d(port, active[static_cast<std::size_t>(i)]);
    }
    if (right.isZero(0.0)) return result;
    const WideVector solution = solve(k, right, result.failure);
    result.xi = solution.head(n).cast<double>();
    return result;
  }

 private:
  /// u that is open, and ξ that is not moved, may be left by the equations; ξ may not.
  WideVector solve(WideMatrix k, WideVector right, std::string& failure) const {
    const Eigen::Index size = k.rows();
    for (int round = 0; round < 3; ++round)
      for (Eigen::Index i = 0; i < size; ++i) {
        const Wide row = k.row(i).cwiseAbs().maxCoeff();
        if (row == 0.0L) continue;
        k.row(i) /= row;
        right[i] /= row;
      }
    WideVector scale = WideVector::Ones(size);
    for (Eigen::Index i = 0; i < size; ++i)
      if (const Wide column = k.col(i).cwiseAbs().maxCoeff(); column > 0.0L) {
        scale[i] = 1.0L / column;
        k.col(i) *= scale[i];
      }
    Eigen::FullPivLU<WideMatrix> lu(k);
    lu.setThreshold(tolerance::dc_pivot);
    const WideVector solution = size > 0 ? WideVector(lu.solve(right)) : right;
    if (size > 0 && !lu.isInvertible()) {
      const WideMatrix kernel = lu.kernel();
      const bool is_open = kernel.topRows(system_.n).cwiseAbs().maxCoeff() > tolerance::dc_share * kernel.cwiseAbs().maxCoeff();
      const bool is_solved = (k * solution - right).norm() <= tolerance::dc_share * right.norm();
      if ((system_.n > 0 && is_open) || !is_solved)
        failure = fmt::format("the operating point of the part with {} is not unique", system_.name);
    }
    return scale.cwiseProduct(solution);
  }

  [[nodiscard]] Vector moved_sources() const {
    Vector w = Vector::Zero(system_.n_zeta);
    const auto column = [&](int input) { return orbit_.columns(number_, static_cast<std::size_t>(input)).value; };
    for (const Wave& wave : parameter_.waves)
      if (column(wave.input) >= 0) w[column(wave.input)] += wave_row(wave).dot(wave_state(wave, 0.0, -1e-300, false));
    for (const Drive& drive : parameter_.drives)
      if (column(drive.input) >= 0) w[column(drive.input)] += drive.weight * value_of(drive);
    return w;
  }

  [[nodiscard]] double value_of(const Drive& drive) const {
    if (drive.held) return held_value(*drive.held);
    if (drive.signal < 0) {
      const model::StoreValues values(island_.island, island_.extraction);
      const auto at = std::find(values.names().begin(), values.names().end(), drive.store);
      return at == values.names().end() ? 0.0 : values.values(x_)[at - values.names().begin()];
    }
    double value = 0.0;
    for (std::size_t k = 0; k < system_.outputs.size(); ++k)
      if (system_.output_signal[k] == drive.signal) value += system_.outputs[k].state.dot(x_) + system_.outputs[k].input.dot(u_);
    return value;
  }

  [[nodiscard]] double held_value(const Drive::HeldVoltage& held) const {
    Vector zeta = Vector::Zero(system_.n_zeta);
    system_.exosystem->evaluate(system_.exosystem->start(), 0.0, zeta.data());
    double value = held.constant;
    const auto& local = island_.island.network.sources;
    for (const auto& [name, coefficient] : held.sources)
      for (std::size_t k = 0; k < local.size(); ++k)
        if (local[k].label.name == name) value += coefficient * system_.exosystem->rows().row(static_cast<Eigen::Index>(k)).dot(zeta);
    return value;
  }

  [[nodiscard]] bool is_active(int port) const {
    const auto k = static_cast<std::size_t>(port - system_.diodes);
    const bool is_closed = (on_[static_cast<std::size_t>(system_.switch_number[k])] != 0) != (system_.switch_inverted[k] != 0);
    return is_closed == system_.port[static_cast<std::size_t>(port)].input_is_current;
  }

  [[nodiscard]] std::vector<int> active_ports() const {
    const Vector y = system_.c * x_ + system_.d * u_;
    std::vector<int> active;
    for (int port = 0; port < system_.diodes; ++port)
      if (std::abs(u_[port]) > std::abs(y[port])) active.push_back(port);
    for (int port = system_.diodes; port < system_.ports; ++port)
      if (is_active(port)) active.push_back(port);
    return active;
  }

  const engine::IslandModel& island_;
  const System& system_;
  std::size_t number_;
  const LinearisedOrbit& orbit_;
  Vector x_, u_;
  const std::vector<char>& on_;
  const ParameterInputs& parameter_;
};

}  // namespace

StartDerivative of_initial_values(const engine::ExactModel& model, const Stacking& stacking, const ParameterInputs& parameter) {
  StartDerivative result{Vector::Zero(stacking.size()), ""};
  for (std::size_t i = 0; i < model.islands.size(); ++i)
    if (stacking.count(i) > 0) result.xi.segment(stacking.first(i), stacking.count(i)) = initial_values(model.islands[i], parameter);
  return result;
}

StartDerivative of_operating_point(const engine::ExactModel& model, const LinearisedOrbit& orbit, const engine::RunStart& start,
                                   const ParameterInputs& parameter) {
  const Stacking& stacking = orbit.stacking();
  StartDerivative result{Vector::Zero(stacking.size()), ""};
  if (!start.missing.empty()) {
    result.failure = "the run has no operating point to start from";
    return result;
  }
  for (std::size_t i = 0; i < model.islands.size(); ++i) {
    const engine::IslandModel& island = model.islands[i];
    const auto& capacitors = island.island.network.capacitors;
    StartDerivative own;
    if (std::any_of(capacitors.begin(), capacitors.end(), [](const model::Capacitor& c) { return c.starts_there; })) {
      own.xi = initial_values(island, parameter);
    } else if (has_conditions(island.island.network)) {
      own.failure =
          fmt::format("the part with {} starts at values of .ic, which have no derivative here; try uic", island.extraction.system.name);
    } else {
      own = Rest(island, i, orbit, start, parameter).solve();
    }
    if (!own.failure.empty() && result.failure.empty()) result.failure = own.failure;
    if (own.failure.empty() && stacking.count(i) > 0) result.xi.segment(stacking.first(i), stacking.count(i)) = own.xi;
  }
  return result;
}

}  // namespace pwlsim::steady
