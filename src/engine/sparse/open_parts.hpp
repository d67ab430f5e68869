#pragma once
/// The quantities that a position of diodes and switches leaves open, by the graph of the network:
///  - parts that only blocking ports tie to other parts: their common potential;
///  - loops of voltage sources and conducting ports without resistance: the current around.
///
/// In a passive network nothing else can be open except currents of perfectly coupled inductors.

#include <vector>

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
  struct Link {
    model::NodeIndex p, n;
  };
  std::size_t nodes_ = 0;
  bool tells_all_ = true;
  std::vector<Link> solid_;   ///< resistors, stores: they tie potentials
  std::vector<Link> shorts_;  ///< voltage sources: they do, and close loops
  std::vector<Link> wires_;   ///< solid ones that do, too
  struct PortLink : Link {
    int index;
    bool is_short;  ///< when it conducts
  };
  std::vector<PortLink> ports_;
};

}  // namespace pwlsim::engine::sparse
