#pragma once
/// Sets of port numbers.

#include <cstdint>
#include <functional>
#include <vector>

namespace pwlsim::model {

/// Up to 64 ports take no heap.
class IndexSet {
 public:
  explicit IndexSet(int ports = 0) : more_(ports > 64 ? (static_cast<std::size_t>(ports) - 1) / 64 : 0, 0) {}
  ~IndexSet() = default;
  IndexSet(const IndexSet&) = default;
  IndexSet(IndexSet&&) = default;
  IndexSet& operator=(const IndexSet& other) {
    first_ = other.first_;
    if (!more_.empty() || !other.more_.empty()) more_ = other.more_;
    return *this;
  }
  IndexSet& operator=(IndexSet&&) = default;

  [[nodiscard]] bool contains(int i) const { return (word(i) >> (i & 63)) & 1U; }
  void set(int i, bool member) {
    const std::uint64_t bit = std::uint64_t{1} << (i & 63);
    word(i) = member ? word(i) | bit : word(i) & ~bit;
  }
  void flip(int i) { word(i) ^= std::uint64_t{1} << (i & 63); }

  friend bool operator==(const IndexSet& a, const IndexSet& b) { return a.first_ == b.first_ && (a.more_.empty() || a.more_ == b.more_); }

  struct Hash {
    std::size_t operator()(const IndexSet& s) const {
      std::size_t hash = s.first_ * 0x9E3779B97F4A7C15ULL;
      for (const std::uint64_t w : s.more_) hash = (hash ^ (hash >> 29) ^ w) * 0x9E3779B97F4A7C15ULL;
      return hash ^ (hash >> 32);
    }
  };

 private:
  [[nodiscard]] const std::uint64_t& word(int i) const { return i < 64 ? first_ : more_[static_cast<std::size_t>(i) / 64 - 1]; }
  std::uint64_t& word(int i) { return i < 64 ? first_ : more_[static_cast<std::size_t>(i) / 64 - 1]; }

  std::uint64_t first_ = 0;
  std::vector<std::uint64_t> more_;
};

/// Goes through all sets of the first `ports` ports, the others as they are in `set`, until accept(set) is true.
template <class Accept>
bool any_set(IndexSet set, int ports, const Accept& accept) {
  for (unsigned bits = 0; bits < (1U << static_cast<unsigned>(ports)); ++bits) {
    for (int i = 0; i < ports; ++i) set.set(i, ((bits >> static_cast<unsigned>(i)) & 1U) != 0);
    if (accept(set)) return true;
  }
  return false;
}

}  // namespace pwlsim::model
