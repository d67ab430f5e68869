#include "engine/sparse/factors.hpp"

#include <algorithm>
#include <cmath>

namespace pwlsim::engine::sparse {

namespace {

constexpr double same_shift = 1e-11;
constexpr double epsilon_share = 1e-3, least_epsilon = 1e-10, largest_epsilon = 1e-7;
/// Smallest over largest pivot: below this a pivot may be nothing but rounding.
constexpr double least_pivot_ratio = 3e-15;
constexpr std::size_t most_bytes = 256u << 20;  ///< of all factors together
constexpr std::size_t bytes_of_entry = 12;
constexpr std::size_t fewest_factors = 3, most_factors = 64;

}  // namespace

void Factor::solve(std::vector<double>& r) const {
  klu_.solve(r.data());
  for (std::size_t i = static_cast<std::size_t>(nodes_); i < r.size(); ++i) r[i] *= unit_;
}

Factors::Factors(const Descriptor& descriptor, double reltol)
    : descriptor_(descriptor),
      ordering_(descriptor.pattern()),
      epsilon_(std::clamp(epsilon_share * reltol, least_epsilon, largest_epsilon)) {}

Factors::Entry* Factors::find(double shift, const Position& on) {
  for (Entry& entry : entries_)
    if (std::abs(entry.shift - shift) <= same_shift * shift && entry.on == on) return &entry;
  return nullptr;
}

Factors::Entry& Factors::slot() {
  const std::size_t each = entries_.empty() ? 0 : std::max<std::size_t>(entries_.front().factor.klu_.entries(), 1) * bytes_of_entry;
  const std::size_t room = each == 0 ? fewest_factors : std::clamp(most_bytes / each, fewest_factors, most_factors);
  if (entries_.size() < room) return entries_.emplace_back(Entry{0.0, {}, Factor(ordering_, descriptor_.nodes()), 0});
  return *std::min_element(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) { return a.used < b.used; });
}

linalg::Factored Factors::factor(Entry& entry, bool same_pivots) {
  auto factored = linalg::Factored::singular;
  linalg::KluFactor& klu = entry.factor.klu_;
  const double unit = entry.factor.unit_ = descriptor_.mean_admittance(entry.shift);
  for (const double epsilon : {0.0, epsilon_, 100.0 * epsilon_}) {
    descriptor_.matrix(entry.shift, entry.on, epsilon, unit, values_);
    factored = same_pivots ? klu.refactor(values_) : klu.factor(values_);
    if (factored == linalg::Factored::no_memory) return factored;
    if (factored == linalg::Factored::good && klu.pivot_ratio() >= least_pivot_ratio) return factored;
    same_pivots = false;
  }
  return factored;
}

const Factor* Factors::at(double shift, const Position& on) {
  Entry* entry = find(shift, on);
  if (!entry) {
    entry = &slot();
    const bool same_pivots = entry->used > 0 && entry->on == on;
    entry->shift = shift;
    entry->on = on;
    const auto factored = factor(*entry, same_pivots);
    if (factored != linalg::Factored::good) {
      singular_unknown_ = entry->factor.klu_.singular_column();
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
