#include "model/certificate.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "model/tolerances.hpp"

namespace pwlsim::model {

namespace {

/// The principal minors without the first index are those of the rest; those with it are m(0,0) times those of the Schur complement.
bool positive_minors(const Matrix& m) {
  if (m.rows() == 0) return true;
  if (!(m(0, 0) > tolerance::minor)) return false;
  const auto rest = m.rows() - 1;
  const Matrix without = m.bottomRightCorner(rest, rest);
  return positive_minors(without) &&
         positive_minors(linalg::clean_sum(without, -m.bottomLeftCorner(rest, 1) / m(0, 0), m.topRightCorner(1, rest)));
}

/// How many elements end at each node.
std::vector<int> ends_at_nodes(const Network& network) {
  std::vector<int> ends(network.nodes.size(), 0);
  const auto count = [&](const auto& elements) {
    for (const auto& element : elements)
      for (const NodeIndex node : {element.p, element.n})
        if (node != ground) ++ends[static_cast<std::size_t>(node)];
  };
  count(network.resistors);
  count(network.capacitors);
  count(network.inductors);
  count(network.branches);
  count(network.injections);
  count(network.diodes);
  count(network.switches);
  return ends;
}

}  // namespace

double kyp_residual(const System& system) {
  const int n = system.n;
  const int k = system.ports;
  const Matrix a = system.time_scale * system.a.topLeftCorner(n, n);
  const Matrix b = system.time_scale * system.b.topRows(n);
  const Matrix c = system.c.leftCols(n);
  Matrix kyp(n + k, n + k);
  kyp.topLeftCorner(n, n) = a + a.transpose();
  kyp.topRightCorner(n, k) = b - c.transpose();
  kyp.bottomLeftCorner(k, n) = b.transpose() - c;
  kyp.bottomRightCorner(k, k) = -(system.d + system.d.transpose());
  const double rate = linalg::spectral_norm(a);
  if (rate > 0.0) {
    kyp.topRows(n) /= std::sqrt(rate);
    kyp.leftCols(n) /= std::sqrt(rate);
  }
  return linalg::logarithmic_norm(kyp);
}

bool always_has_solution(const System& system) {
  if (!system.passive) return false;
  Matrix stacked(system.n + system.ports, system.ports);
  stacked << system.b.topRows(system.n), system.d + system.d.transpose();
  for (auto half : {stacked.topRows(system.n), stacked.bottomRows(system.ports)}) half.normalize();
  for (auto column : stacked.colwise()) column.normalize();
  return linalg::null_space(stacked, tolerance::rank).cols() == 0;
}

bool has_positive_principal_minors(Matrix m) {
  if (m.rows() == 0) return true;
  for (auto row : m.rowwise())
    if (const double largest = row.cwiseAbs().maxCoeff(); largest > 0.0) row /= largest;
  for (auto column : m.colwise())
    if (const double largest = column.cwiseAbs().maxCoeff(); largest > 0.0) column /= largest;
  return positive_minors(m);
}

bool has_passive_parts_only(const Network& network) {
  const auto is_source = [](const Injection& injection) { return is_independent(injection.current); };
  const auto no_gain = [](const auto& element) { return element.resistance >= 0.0; };
  const std::vector<int> ends = ends_at_nodes(network);
  const auto is_alone_at = [&](NodeIndex node) { return node != ground && ends[static_cast<std::size_t>(node)] == 1; };
  const auto branch_has_no_gain = [&](std::size_t index) {
    const Branch& branch = network.branches[index];
    if (is_alone_at(branch.p) || is_alone_at(branch.n)) return true;  // it carries no current
    return std::all_of(branch.voltage.begin(), branch.voltage.end(), [&](const Term& term) {
      const bool own_resistance =
          term.kind == Term::Kind::branch_current && term.index == static_cast<int>(index) && term.coefficient >= 0.0;
      return is_independent(term) || own_resistance;
    });
  };
  for (std::size_t i = 0; i < network.branches.size(); ++i)
    if (!branch_has_no_gain(i)) return false;
  if (!network.complementarities.empty()) return false;
  return std::all_of(network.injections.begin(), network.injections.end(), is_source) &&
         std::all_of(network.resistors.begin(), network.resistors.end(), no_gain) &&
         std::all_of(network.diodes.begin(), network.diodes.end(), no_gain) &&
         std::all_of(network.switches.begin(), network.switches.end(), no_gain);
}

}  // namespace pwlsim::model
