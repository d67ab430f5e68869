#include "engine/sparse/factors.hpp"

#include <algorithm>
#include <cmath>

namespace pwlsim::engine::sparse {

namespace {

constexpr double same_shift = 1e-11;
constexpr double epsilons[] = {0.0, 1e-10, 1e-8, 1e-6};
/// Smallest over largest pivot: below this a pivot may be nothing but rounding.
constexpr double least_pivot_ratio = 3e-15;
constexpr std::size_t most_bytes = 256u << 20;  ///< of all factors together
constexpr std::size_t bytes_of_entry = 12;
constexpr std::size_t fewest_factors = 3, most_factors = 64;

}  // namespace

Factors::Entry* Factors::find(double shift, const Position& on) {
  for (Entry& entry : entries_)
    if (std::abs(entry.shift - shift) <= same_shift * shift && entry.on == on) return &entry;
  return nullptr;
}

Factors::Entry& Factors::slot() {
  const std::size_t each = entries_.empty() ? 0 : std::max<std::size_t>(entries_.front().factor.entries(), 1) * bytes_of_entry;
  const std::size_t room = each == 0 ? fewest_factors : std::clamp(most_bytes / each, fewest_factors, most_factors);
  if (entries_.size() < room) return entries_.emplace_back(Entry{0.0, {}, linalg::KluFactor(ordering_), 0});
  return *std::min_element(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) { return a.used < b.used; });
}

linalg::Factored Factors::factor(Entry& entry, bool same_pivots) {
  auto factored = linalg::Factored::singular;
  for (const double epsilon : epsilons) {
    descriptor_.matrix(entry.shift, entry.on, epsilon, values_);
    factored = same_pivots ? entry.factor.refactor(values_) : entry.factor.factor(values_);
    if (factored == linalg::Factored::no_memory) return factored;
    if (factored == linalg::Factored::good && entry.factor.pivot_ratio() >= least_pivot_ratio) return factored;
    same_pivots = false;
  }
  return factored;
}

const linalg::KluFactor* Factors::at(double shift, const Position& on) {
  Entry* entry = find(shift, on);
  if (!entry) {
    entry = &slot();
    const bool same_pivots = entry->used > 0 && entry->on == on;
    entry->shift = shift;
    entry->on = on;
    const auto factored = factor(*entry, same_pivots);
    if (factored != linalg::Factored::good) {
      singular_unknown_ = entry->factor.singular_column();
      out_of_memory_ = factored == linalg::Factored::no_memory;
      entry->shift = -1.0;
      entry->used = 0;
      return nullptr;
    }
  }
  entry->used = ++clock_;
  return &entry->factor;
}

}  // namespace pwlsim::engine::sparse
