#pragma once
/// The quantities that a position of diodes and switches leaves open, by the graph of the network:
///  - parts that only blocking ports tie to other parts: their common potential;
///  - loops of voltage sources and conducting ports without resistance: the current around.
///
/// In a passive network nothing else can be open except currents of perfectly coupled inductors.

#include <vector>

#include "base/disjoint_sets.hpp"
#include "engine/sparse/descriptor.hpp"

namespace pwlsim::engine::sparse {

class OpenParts {
 public:
  explicit OpenParts(const model::Network& network);

  /// Whether the graph shows everything that can be open.
  [[nodiscard]] bool tells_all() const { return tells_all_; }
  /// Ports that would settle it: of the blocking ones a tree that ties the parts together, of the conducting ones those that close a loop.
  [[nodiscard]] std::vector<int> ties(const Position& on) const;
  /// Loops without resistance that conducting ports close, wires and sources among them: ports can share a current in these only.
  [[nodiscard]] int loops(const Position& on) const;

 private:
  /// Nodes that are one, ground among them as −1.
  class NodeSets {
   public:
    explicit NodeSets(std::size_t nodes) : sets_(static_cast<int>(nodes) + 1) {}
    /// False: they were one already.
    bool join(model::NodeIndex a, model::NodeIndex b) { return sets_.join(a + 1, b + 1); }

   private:
    static_assert(model::ground == -1);
    DisjointSets sets_;
  };
  bool tells_all_ = true;
  NodeSets parts_;  ///< that resistors, stores and voltage sources tie
  NodeSets loops_;  ///< that voltage sources tie
  NodeSets wired_;  ///< that wires do, too
  struct PortLink {
    model::NodeIndex p, n;
    int index;
    bool is_short;  ///< when it conducts
  };
  std::vector<PortLink> ports_;
};

}  // namespace pwlsim::engine::sparse
