#include "engine/exact/steering.hpp"

#include <algorithm>

namespace pwlsim::engine {

namespace {

using Lists = std::vector<std::vector<std::size_t>>;

/// Islands in the order in which a search in depth leaves them.
std::vector<std::size_t> finishing_order(const Lists& next) {
  std::vector<std::size_t> order;
  std::vector<char> seen(next.size(), 0);
  std::vector<std::pair<std::size_t, std::size_t>> path;  // an island, and how many of its successors are done
  for (std::size_t root = 0; root < next.size(); ++root) {
    if (seen[root] != 0) continue;
    seen[root] = 1;
    path.emplace_back(root, 0);
    while (!path.empty()) {
      auto& [island, done] = path.back();
      if (done == next[island].size()) {
        order.push_back(island);
        path.pop_back();
        continue;
      }
      const std::size_t successor = next[island][done++];
      if (seen[successor] == 0) {
        seen[successor] = 1;
        path.emplace_back(successor, 0);
      }
    }
  }
  return order;
}

/// All that reaches `root` and is in no group yet.
void collect(const Lists& before, std::size_t root, std::size_t number, std::vector<std::size_t>& group_of,
             std::vector<std::size_t>& members) {
  group_of[root] = number;
  members.push_back(root);
  for (std::size_t i = 0; i < members.size(); ++i)
    for (const std::size_t island : before[members[i]])
      if (group_of[island] == before.size()) {
        group_of[island] = number;
        members.push_back(island);
      }
  std::sort(members.begin(), members.end());
}

}  // namespace

/// Strongly connected components after Kosaraju and Sharir (Computers & Mathematics with Applications 7 (1981) 67–72).
std::vector<SteeringGroup> steering_groups(std::size_t count, const std::vector<std::pair<std::size_t, std::size_t>>& steers) {
  Lists next(count), before(count);
  for (const auto& [from, to] : steers) {
    next[from].push_back(to);
    before[to].push_back(from);
  }
  std::vector<SteeringGroup> groups;
  std::vector<std::size_t> group_of(count, count);
  std::vector<std::size_t> order = finishing_order(next);
  std::reverse(order.begin(), order.end());
  for (const std::size_t root : order) {
    if (group_of[root] != count) continue;
    groups.emplace_back();
    collect(before, root, groups.size() - 1, group_of, groups.back().islands);
  }
  for (std::size_t g = 0; g < groups.size(); ++g) {
    auto& list = groups[g].steered_by;
    for (const std::size_t island : groups[g].islands)
      for (const std::size_t other : before[island])
        if (group_of[other] != g) list.push_back(group_of[other]);
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  return groups;
}

}  // namespace pwlsim::engine
