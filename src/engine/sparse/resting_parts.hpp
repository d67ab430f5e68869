#pragma once
/// What is at rest in a position of the ports, exactly: parts of the network that exchange nothing with the rest.
///
/// A conducting ideal diode, a closed ideal switch and a wire make one node of two. Where a part of the network hangs on the rest by one such node alone (or by ground), no current flows through
/// that node into the part, and no voltage across the part is one of the rest: it is a circuit of its own, as what is behind a diode that conducts to ground. Without sources, controlled ones included, and with all its stores
/// empty, it stays empty: all its voltages are that of the node, and all its currents zero. A solution of the equations with a factor of all of them leaves the rounding of the rest in it, which
/// ideal ports there would take for signs.
///
/// Storage that is less than the rounding of the rest counts as none.

#include <utility>
#include <vector>

#include "base/disjoint_sets.hpp"
#include "engine/sparse/descriptor.hpp"

namespace pwlsim::engine::sparse {

class RestingParts {
 public:
  /// The descriptor must outlive it.
  explicit RestingParts(const Descriptor& descriptor);

  struct Origin {
    const std::vector<double>& z;
    const std::vector<double>& more;  ///< charges and fluxes beside those of z; may be empty
    bool has_sources = true;          ///< false: z is a deviation, which sources and drops have none of
  };
  /// The parts at rest from `start` on. `weights`: of states, whose squares add up to that of `size`.
  void find(const Position& on, const Origin& start, const std::vector<double>& weights, double size);
  /// Takes the rounding out of what is at rest.
  void hold(std::vector<double>& z) const;

 private:
  struct Edge {
    int a, b;  ///< nodes from 1 on, ground 0
    bool is_wire = false, is_source = false;
    int port = -1;
    std::vector<int> currents{};  ///< unknowns that are zero where it is at rest
    std::vector<int> coupled{};   ///< edges of inductors
    bool is_controlled = false;   ///< by what may lie anywhere, deviations included
  };
  void add_ports();
  [[nodiscard]] bool conducts(const Edge& edge) const { return edge.port < 0 || (*on_)[static_cast<std::size_t>(edge.port)] != 0; }
  [[nodiscard]] bool is_wire(const Edge& edge) const { return edge.is_wire && !is_source(edge); }
  [[nodiscard]] bool is_source(const Edge& edge) const { return has_sources_ && edge.is_source; }
  [[nodiscard]] bool merge(const Origin& start);
  [[nodiscard]] bool rests(int edge, const Origin& start);
  [[nodiscard]] bool enter(int edge);
  void add_part();
  void take_out_ends();

  const Descriptor& descriptor_;
  std::vector<Edge> edges_;
  std::vector<int> wires_;            ///< those that may be wires
  std::vector<std::vector<int>> at_;  ///< edges of each node
  // of the last search
  const Position* on_ = nullptr;
  bool has_sources_ = true;
  DisjointSets merged_;
  std::vector<char> shared_, charged_;  ///< of sets of nodes
  std::vector<char> holds_, rests_;     ///< of edges: storage that is no rounding; at rest
  std::vector<int> seen_;               ///< the number of the part in which they have been seen
  std::vector<int> part_edges_, part_nodes_;
  int part_ = 0, part_hangs_on_ = 0;
  std::vector<std::pair<int, int>> nodes_;  ///< unknowns of nodes at rest, and that which they are at (−1: ground)
  std::vector<int> currents_;
};

}  // namespace pwlsim::engine::sparse
