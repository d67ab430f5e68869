#pragma once
/// Blocks (biconnected components) of a graph with parallel edges and loops: the largest sets of edges of which any two lie on one cycle, or one edge alone. Blocks share single nodes, at which they hang
/// on each other in a tree (Tarjan, SIAM J. Comput. 1, 1972).

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace pwlsim {

struct Block {
  int first, end;  ///< its edges among those of all blocks
  int hangs_on;    ///< the node at which the search from node 0 enters it; of what node 0 does not reach, from its least node
  bool is_loop;    ///< an edge from that node to itself
};

/// A block comes after the one that it hangs on.
struct Blocks {
  std::vector<Block> list;
  std::vector<int> edges;
  [[nodiscard]] std::span<const int> edges_of(const Block& block) const {
    return std::span(edges).subspan(static_cast<std::size_t>(block.first), static_cast<std::size_t>(block.end - block.first));
  }
};

/// `edges`: the ends of each among 0 … nodes − 1.
[[nodiscard]] Blocks blocks_of(int nodes, const std::vector<std::pair<int, int>>& edges);

}  // namespace pwlsim
