/// Blocks of random graphs, against their definition: two edges are of one block if no node separates them.
#include "base/blocks.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "base/disjoint_sets.hpp"

using pwlsim::Block;
using pwlsim::Blocks;
using pwlsim::blocks_of;

namespace {

using Edges = std::vector<std::pair<int, int>>;

bool meet(const std::pair<int, int>& e, const std::pair<int, int>& f, int without) {
  const auto has = [](const std::pair<int, int>& edge, int node) { return edge.first == node || edge.second == node; };
  return (e.first != without && has(f, e.first)) || (e.second != without && has(f, e.second));
}

/// Of each edge the least edge of its block.
std::vector<int> by_definition(int nodes, const Edges& edges) {
  const int count = static_cast<int>(edges.size());
  std::vector<std::vector<int>> together(edges.size());
  for (int node = 0; node < nodes; ++node) {
    pwlsim::DisjointSets sets(count);
    for (int e = 0; e < count; ++e)
      for (int f = 0; f < e; ++f)
        if (meet(edges[static_cast<std::size_t>(e)], edges[static_cast<std::size_t>(f)], node)) sets.join(e, f);
    for (int e = 0; e < count; ++e) together[static_cast<std::size_t>(e)].push_back(sets.find(e));
  }
  std::vector<int> least;
  for (const auto& of_edge : together)
    least.push_back(static_cast<int>(std::find(together.begin(), together.end(), of_edge) - together.begin()));
  return least;
}

}  // namespace

TEST_CASE("blocks are what no node separates", "[unit]") {
  std::mt19937 random(1);
  for (int run = 0; run < 2000; ++run) {
    const int nodes = 1 + static_cast<int>(random() % 8), count = static_cast<int>(random() % 13);
    Edges edges;
    for (int e = 0; e < count; ++e)
      edges.emplace_back(static_cast<int>(random() % static_cast<unsigned>(nodes)),
                         static_cast<int>(random() % static_cast<unsigned>(nodes)));
    std::vector<int> found(edges.size(), -1);
    std::vector<char> is_entered(static_cast<std::size_t>(nodes), 0);
    const Blocks blocks = blocks_of(nodes, edges);
    for (const Block& block : blocks.list) {
      const std::span<const int> own = blocks.edges_of(block);
      const int least = *std::min_element(own.begin(), own.end());
      for (const int e : own) {
        const auto [a, b] = edges[static_cast<std::size_t>(e)];
        CHECK(block.is_loop == (a == b));
        found[static_cast<std::size_t>(e)] = least;
        for (const int node : {a, b})
          if (node != block.hangs_on) CHECK(std::exchange(is_entered[static_cast<std::size_t>(node)], 1) <= (own.size() > 1 ? 1 : 0));
      }
    }
    CHECK(found == by_definition(nodes, edges));
  }
}

TEST_CASE("a block comes after the one that it hangs on", "[unit]") {
  // A triangle at ground, an edge from it, and at the end of that two parallel edges and a loop; a part that ground does not reach.
  const Edges edges{{3, 4}, {4, 3}, {4, 4}, {2, 3}, {1, 2}, {0, 1}, {2, 0}, {6, 5}};
  const Blocks blocks = blocks_of(7, edges);
  std::vector<std::vector<int>> sorted;
  std::vector<char> known(7, 0);
  known[0] = known[5] = 1;
  for (const Block& block : blocks.list) {
    CHECK(known[static_cast<std::size_t>(block.hangs_on)] == 1);
    const std::span<const int> own = blocks.edges_of(block);
    for (const int e : own)
      known[static_cast<std::size_t>(edges[static_cast<std::size_t>(e)].first)] =
          known[static_cast<std::size_t>(edges[static_cast<std::size_t>(e)].second)] = 1;
    std::vector<int>& last = sorted.emplace_back(own.begin(), own.end());
    std::sort(last.begin(), last.end());
  }
  std::sort(sorted.begin(), sorted.end());
  CHECK(sorted == std::vector<std::vector<int>>{{0, 1}, {2}, {3}, {4, 5, 6}, {7}});
}
