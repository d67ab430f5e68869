/// Descriptor: ports that resistors alone meet.
#include <algorithm>
#include <cmath>

#include "engine/sparse/descriptor.hpp"

namespace pwlsim::engine::sparse {

/// Equations of ports that have nothing but node voltages and inputs in them.
void Descriptor::note_leaks() {
  struct Row {
    double conductance = 0.0;
    std::vector<int> ports{};
    bool has_more = false;
  };
  std::vector<Row> rows(static_cast<std::size_t>(size()));
  const auto each = [&](const linalg::SparseMatrix& matrix, auto take) {
    for (int j = 0; j < size(); ++j)
      for (int k = matrix.pattern.start[static_cast<std::size_t>(j)]; k < matrix.pattern.start[static_cast<std::size_t>(j) + 1]; ++k)
        take(rows[static_cast<std::size_t>(matrix.pattern.row[static_cast<std::size_t>(k)])], j,
             matrix.values[static_cast<std::size_t>(k)]);
  };
  each(memory_, [](Row& row, int, double) { row.has_more = true; });
  each(conduction_, [&](Row& row, int column, double value) {
    if (column < nodes())
      row.conductance += std::abs(value);
    else if (column >= unknowns_.port(0) && std::abs(value) == 1.0)
      row.ports.push_back(column - unknowns_.port(0));
    else
      row.has_more = true;
  });
  for (const SourceEntry& entry : sources_) rows[static_cast<std::size_t>(entry.row)].has_more = true;
  leaky_nodes_.resize(ports_.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Row& row = rows[i];
    if (row.has_more || row.conductance == 0.0 || constant_[i] != 0.0) continue;
    for (const int port : row.ports) leaky_nodes_[static_cast<std::size_t>(port)].push_back({row.conductance, row.ports});
  }
}

double Descriptor::leaks_at(std::size_t port, const Position& on) const {
  double least = INFINITY;
  for (const LeakyNode& node : leaky_nodes_[port]) {
    const auto meets = [&](int other) { return static_cast<std::size_t>(other) != port && on[static_cast<std::size_t>(other)] != 0; };
    if (std::none_of(node.ports.begin(), node.ports.end(), meets)) least = std::min(least, node.conductance);
  }
  return least;
}

}  // namespace pwlsim::engine::sparse
