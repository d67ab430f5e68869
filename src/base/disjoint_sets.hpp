#pragma once
/// Disjoint sets of 0 … size − 1.

#include <algorithm>
#include <numeric>
#include <vector>

namespace pwlsim {

class DisjointSets {
 public:
  explicit DisjointSets(int size) : parent_(static_cast<std::size_t>(size)) { std::iota(parent_.begin(), parent_.end(), 0); }
  /// The least member of the set that contains i.
  int find(int i) {
    while (parent_[static_cast<std::size_t>(i)] != i) {
      auto& parent = parent_[static_cast<std::size_t>(i)];
      parent = parent_[static_cast<std::size_t>(parent)];
      i = parent;
    }
    return i;
  }
  /// False if they were in one set already.
  bool join(int a, int b) {
    const int x = find(a), y = find(b);
    parent_[static_cast<std::size_t>(std::max(x, y))] = std::min(x, y);
    return x != y;
  }

 private:
  std::vector<int> parent_;
};

}  // namespace pwlsim
