#include "model/energy_coordinates.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "model/assembly.hpp"
#include "model/tolerances.hpp"

namespace pwlsim::model {

namespace {

/// Which stores share a state: the parts into which the pattern of a projector falls.
std::vector<std::vector<int>> parts_of(const Matrix& projector) {
  const auto count = static_cast<int>(projector.rows());
  std::vector<int> part(static_cast<std::size_t>(count));
  std::iota(part.begin(), part.end(), 0);
  for (int i = 0; i < count; ++i)
    for (int j = 0; j < i; ++j)
      if (const int from = part[static_cast<std::size_t>(i)], to = part[static_cast<std::size_t>(j)];
          from != to && std::abs(projector(i, j)) > tolerance::unit_vector_entry)
        std::replace(part.begin(), part.end(), std::max(from, to), std::min(from, to));
  std::vector<std::vector<int>> parts(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) parts[static_cast<std::size_t>(part[static_cast<std::size_t>(i)])].push_back(i);
  std::erase_if(parts, [](const auto& p) { return p.empty(); });
  return parts;
}

/// Orthonormal rows that span the range of a projector, part by part: its columns, the largest first, each less what the rows before hold.
Matrix readable_basis(Matrix projector, Eigen::Index rank) {
  Matrix basis(rank, projector.cols());
  Eigen::Index row = 0;
  for (const auto& part : parts_of(projector))
    while (row < rank) {
      int pivot = part.front();
      for (const int i : part)
        if (projector(i, i) > projector(pivot, pivot) * (1.0 + tolerance::unit_vector_entry)) pivot = i;
      if (projector(pivot, pivot) < tolerance::unit_vector_entry) break;
      Vector next = projector.col(pivot) / std::sqrt(projector(pivot, pivot));
      for (double& entry : next)
        if (std::abs(entry) < tolerance::unit_vector_entry) entry = 0.0;
      next.normalize();
      projector -= next * next.transpose();
      basis.row(row++) = next.transpose();
    }
  return basis;
}

/// Names of stores; those of one element with several are numbered, `oc#1`, `oc#2`.
template <class Store>
std::vector<std::string> names_of(const std::vector<Store>& stores) {
  std::map<std::string, int> count, next;
  for (const auto& store : stores) ++count[store.label.name];
  std::vector<std::string> names;
  for (const auto& store : stores) {
    names.push_back(store.label.name);
    if (count[store.label.name] > 1) names.back() += '#' + std::to_string(++next[store.label.name]);
  }
  return names;
}

std::vector<EnergyState> states_of(const Assembly& assembly, const Matrix& basis) {
  const auto& capacitors = assembly.network.capacitors;
  const auto& inductors = assembly.network.inductors;
  const auto first_flux = static_cast<Eigen::Index>(capacitors.size());
  const Matrix of_inductors = linalg::clean_product(basis.rightCols(basis.cols() - first_flux), assembly.inductance_root().transpose());
  const std::vector<std::string> capacitor_names = names_of(capacitors), inductor_names = names_of(inductors);
  std::vector<EnergyState> states(static_cast<std::size_t>(basis.rows()));
  for (std::size_t row = 0; row < states.size(); ++row) {
    const auto r = static_cast<Eigen::Index>(row);
    for (std::size_t i = 0; i < capacitors.size(); ++i)
      if (const double x = basis(r, static_cast<Eigen::Index>(i)); x != 0.0)
        states[row].terms.push_back({capacitor_names[i], true, x * std::sqrt(std::abs(capacitors[i].capacitance))});
    for (std::size_t i = 0; i < inductors.size(); ++i)
      if (const double x = of_inductors(r, static_cast<Eigen::Index>(i)); x != 0.0)
        states[row].terms.push_back({inductor_names[i], false, x});
  }
  return states;
}

}  // namespace

StateSpace in_energy_coordinates(const Island& island, const Extraction& extraction) {
  const Assembly assembly(island.network, true);
  const System& system = extraction.system;
  const Matrix& reduce = extraction.equations.reduce;
  const Matrix basis = readable_basis(linalg::clean_product(reduce.transpose(), reduce), system.n);
  const Matrix turn = linalg::clean_product(basis, reduce.transpose());
  Vector u_unit(system.ports), y_unit(system.ports);
  for (int i = 0; i < system.ports; ++i) {
    u_unit[i] = system.port[static_cast<std::size_t>(i)].u_unit;
    y_unit[i] = system.port[static_cast<std::size_t>(i)].y_unit;
  }
  const Vector per_u = u_unit.cwiseInverse();
  StateSpace result;
  result.states = states_of(assembly, basis);
  result.a = linalg::clean_product(linalg::clean_product(turn, system.a.topLeftCorner(system.n, system.n)), turn.transpose());
  result.b = assembly.energy_unit() * linalg::clean_product(turn, system.b.topRows(system.n)) * per_u.asDiagonal();
  result.c = y_unit.asDiagonal() * linalg::clean_product(system.c.leftCols(system.n), turn.transpose()) / assembly.energy_unit();
  result.d = y_unit.asDiagonal() * system.d * per_u.asDiagonal();
  return result;
}

}  // namespace pwlsim::model
