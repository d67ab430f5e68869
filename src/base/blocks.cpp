#include "base/blocks.hpp"

#include <algorithm>
#include <cstddef>

namespace pwlsim {

namespace {

std::size_t place(int i) { return static_cast<std::size_t>(i); }

class BlockSearch {
 public:
  BlockSearch(int nodes, const std::vector<std::pair<int, int>>& edges);
  [[nodiscard]] Blocks run();

 private:
  struct Visit {
    int node, by;      ///< the edge that led to it, −1: none
    std::size_t next;  ///< of its edges
  };
  void search(int root);
  void follow(int edge);
  void leave(const Visit& visit);
  void add(std::size_t edges, int hangs_on, bool is_loop);
  [[nodiscard]] int other_end(int edge, int node) const;

  const std::vector<std::pair<int, int>>& ends_;
  std::vector<int> start_, at_;  ///< edges of each node
  std::vector<int> order_, low_;
  std::vector<char> is_seen_;  ///< edges
  std::vector<Visit> path_;
  std::vector<int> open_;  ///< edges of blocks that are not complete
  Blocks blocks_;
  int visited_ = 0;
};

BlockSearch::BlockSearch(int nodes, const std::vector<std::pair<int, int>>& edges)
    : ends_(edges), start_(place(nodes) + 1, 0), order_(place(nodes), -1), low_(place(nodes), 0), is_seen_(edges.size(), 0) {
  for (const auto& [a, b] : edges) {
    ++start_[place(a) + 1];
    if (b != a) ++start_[place(b) + 1];
  }
  for (std::size_t i = 1; i < start_.size(); ++i) start_[i] += start_[i - 1];
  at_.resize(place(start_.back()));
  std::vector<int> end(start_.begin(), start_.end() - 1);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const auto [a, b] = edges[i];
    at_[place(end[place(a)]++)] = static_cast<int>(i);
    if (b != a) at_[place(end[place(b)]++)] = static_cast<int>(i);
  }
}

Blocks BlockSearch::run() {
  blocks_.edges.reserve(ends_.size());
  for (int root = 0; root < static_cast<int>(order_.size()); ++root)
    if (order_[place(root)] < 0) search(root);
  std::reverse(blocks_.list.begin(), blocks_.list.end());  // the last one is complete first
  return std::move(blocks_);
}

int BlockSearch::other_end(int edge, int node) const {
  const auto [a, b] = ends_[place(edge)];
  return a == node ? b : a;
}

void BlockSearch::search(int root) {
  path_.push_back({root, -1, place(start_[place(root)])});
  order_[place(root)] = low_[place(root)] = visited_++;
  while (!path_.empty()) {
    Visit& visit = path_.back();
    if (visit.next < place(start_[place(visit.node) + 1])) {
      follow(at_[visit.next++]);
      continue;
    }
    const Visit done = visit;
    path_.pop_back();
    if (done.by >= 0) leave(done);
  }
}

/// An edge of the last node of the path.
void BlockSearch::follow(int edge) {
  if (is_seen_[place(edge)] != 0) return;
  is_seen_[place(edge)] = 1;
  const int node = path_.back().node, next = other_end(edge, node);
  if (next == node) {
    blocks_.edges.push_back(edge);
    add(1, node, true);
    return;
  }
  open_.push_back(edge);
  if (order_[place(next)] >= 0) {
    low_[place(node)] = std::min(low_[place(node)], order_[place(next)]);
    return;
  }
  order_[place(next)] = low_[place(next)] = visited_++;
  path_.push_back({next, edge, place(start_[place(next)])});
}

/// The edge that led to a node ends a block if nothing behind it leads back beyond its begin.
void BlockSearch::leave(const Visit& visit) {
  const int before = other_end(visit.by, visit.node);
  low_[place(before)] = std::min(low_[place(before)], low_[place(visit.node)]);
  if (low_[place(visit.node)] < order_[place(before)]) return;
  const auto first = std::find(open_.rbegin(), open_.rend(), visit.by).base() - 1;
  blocks_.edges.insert(blocks_.edges.end(), first, open_.end());
  add(static_cast<std::size_t>(open_.end() - first), before, false);
  open_.erase(first, open_.end());
}

/// Of the last edges.
void BlockSearch::add(std::size_t edges, int hangs_on, bool is_loop) {
  const int end = static_cast<int>(blocks_.edges.size());
  blocks_.list.push_back({end - static_cast<int>(edges), end, hangs_on, is_loop});
}

}  // namespace

Blocks blocks_of(int nodes, const std::vector<std::pair<int, int>>& edges) { return BlockSearch(nodes, edges).run(); }

}  // namespace pwlsim
