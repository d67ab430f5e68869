#pragma once
/// What is at rest in a position of the ports, exactly: parts of the network that exchange nothing with the rest.
///
/// Blocks of the network (base/blocks.hpp) share single nodes, and what flows into all that hangs at such a node adds up to nothing: each block is a circuit of its own, but for controlled sources and
/// coupled inductors. One without sources and with all its stores empty stays empty: its nodes are at one voltage, and its currents are zero. So is the current of an element that is a block alone, as
/// one at which nothing else hangs. A conducting ideal diode, a closed ideal switch and a wire make one node of two. A solution of the equations with a factor of all of them leaves the rounding of the
/// rest in what rests, which ideal ports there would take for signs, and capacitors add up.
///
/// Storage that is less than the rounding of the rest counts as none.

#include <utility>
#include <vector>

#include "base/blocks.hpp"
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
    [[nodiscard]] bool has_more(int unknown) const { return !more.empty() && more[static_cast<std::size_t>(unknown)] != 0.0; }
  };
  /// The parts at rest from `start` on. `weights`: of states, whose squares add up to that of `size`.
  void find(const Position& on, const Origin& start, const std::vector<double>& weights, double size);
  /// Takes the rounding out of what is at rest.
  void hold(std::vector<double>& z) const;
  /// No current in what is at rest. The current of an inductor that is a block alone goes at once; its impulse of voltage lifts all that hangs on it, and moves nothing there.
  void cut_off(std::vector<double>& z) const;
  /// Adds these impulses where the inductors carried the currents of `start`: of each volt-seconds are −`stores` times the current.
  void add_impulses(const std::vector<double>& start, const std::vector<double>& stores, double factor, std::vector<double>& z);
  /// Of each port whether its current is zero in a position whatever is stored and whatever drives: it is a block alone, or in one of ideal wires, around which nothing drives a current.
  [[nodiscard]] const std::vector<char>& idle_ports(const Position& on);

 private:
  struct Edge {
    int a, b;  ///< nodes from 1 on, ground 0
    bool is_wire = false, is_source = false;
    int port = -1;
    std::vector<int> currents{};  ///< unknowns that are zero where it is at rest
    std::vector<int> coupled{};   ///< edges of inductors
    bool is_controlled = false;   ///< by what may lie anywhere, deviations included
    bool is_injection = false;
    /// Whether its current is zero where the network allows none: that of a source is given, and the unknown of a coupled inductor is what magnetises all of its windings.
    [[nodiscard]] bool is_free() const { return !is_injection && coupled.empty(); }
  };
  void add_ports();
  [[nodiscard]] bool conducts(const Edge& edge) const { return edge.port < 0 || (*on_)[static_cast<std::size_t>(edge.port)] != 0; }
  [[nodiscard]] bool is_wire(const Edge& edge) const { return edge.is_wire && !is_source(edge); }
  [[nodiscard]] bool is_source(const Edge& edge) const { return has_sources_ && edge.is_source; }
  struct Held {
    int node, at;                  ///< unknowns of a node at rest, and of that whose voltage it has (−1: ground)
    std::vector<int> followers{};  ///< nodes that hang on it and move
  };
  void divide(const Position& on);
  [[nodiscard]] bool cuts_current() const;
  void find_conducting();
  void merge();
  void find_blocks(const Origin& start);
  [[nodiscard]] bool moves(std::size_t edge, const Origin& start);
  [[nodiscard]] static bool has_more_current(const Edge& edge, const Origin& start);
  [[nodiscard]] bool is_pushed(std::size_t edge, const Origin& start);
  void spread(std::vector<char>& moving);
  void rest(std::size_t edge);
  void rest_nodes(const Block& block);
  void follow_nodes(const Block& block);
  [[nodiscard]] const std::vector<int>& sets_of(const Block& block);
  [[nodiscard]] static bool is_alone(const Block& block) { return block.end - block.first == 1 && !block.is_loop; }
  void take_out_ends(const Origin& start);

  const Descriptor& descriptor_;
  std::vector<Edge> edges_;
  std::vector<int> wires_;            ///< those that may be wires
  std::vector<std::vector<int>> at_;  ///< edges of each node
  // of the last search
  const Position* on_ = nullptr;
  bool is_divided_ = false;  ///< the blocks are known, those of this position
  Position divided_on_;
  bool has_blocks_ = false;  ///< they are those of the last `find`
  bool has_sources_ = true;
  DisjointSets merged_;
  std::vector<std::vector<int>> members_;  ///< of merged nodes
  std::vector<char> charged_;              ///< sets of nodes
  std::vector<char> holds_, rests_;        ///< of edges: storage that is no rounding; at rest
  std::vector<int> conducting_;            ///< edges between sets
  std::vector<std::pair<int, int>> ends_;  ///< and their sets
  Blocks blocks_;                          ///< of these
  std::vector<int> anchor_;                ///< of sets: the first of the nodes at rest that they hang on
  std::vector<int> open_;                  ///< nodes to be looked at
  std::vector<Held> nodes_;
  std::vector<int> currents_;
  std::vector<char> idle_;  ///< ports
};

}  // namespace pwlsim::engine::sparse
