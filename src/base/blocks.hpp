#pragma once
/// Blocks (biconnected components) of a graph with parallel edges and loops: the largest sets of edges of which any two lie on one cycle, or one edge alone. Blocks share single nodes, at which they hang
/// on each other in a tree (Tarjan, SIAM J. Comput. 1, 1972).

#include <cstddef>
#include <utility>
#include <vector>

namespace pwlsim {

class Blocks {
 public:
  struct Block {
    std::vector<int> edges;
    int hangs_on;  ///< the node at which the search from node 0 enters it; of what node 0 does not reach, from its least node
    bool is_loop;  ///< an edge from that node to itself
  };
  /// `edges`: the ends of each among 0 … nodes − 1. A block comes after the one that it hangs on.
  Blocks(int nodes, const std::vector<std::pair<int, int>>& edges);

  [[nodiscard]] const std::vector<Block>& list() const { return blocks_; }

 private:
  struct Visit {
    int node, by;      ///< the edge that led to it, −1: none
    std::size_t next;  ///< of its edges
  };
  void search(int root);
  void follow(int edge);
  void leave(const Visit& visit);
  [[nodiscard]] int other_end(int edge, int node) const;

  const std::vector<std::pair<int, int>>& ends_;
  std::vector<int> start_, at_;  ///< edges of each node
  std::vector<int> order_, low_;
  std::vector<char> is_seen_;  ///< edges
  std::vector<Visit> path_;
  std::vector<int> open_;  ///< edges of blocks that are not complete
  std::vector<Block> blocks_;
  int visited_ = 0;
};

}  // namespace pwlsim
