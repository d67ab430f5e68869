#include "engine/sparse/factors.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/arithmetic.hpp"
#include "engine/sparse/tolerances.hpp"
#include "lcp/condition.hpp"

namespace pwlsim::engine::sparse {

namespace {

constexpr std::size_t most_bytes = 192u << 20;  ///< of all factors together
constexpr std::size_t bytes_of_entry = 16;
constexpr std::size_t fewest_factors = 3, most_factors = 256;
/// A position so few ports away from one that is factored is reached by their columns; solved for so often, by a factor of its own.
constexpr std::size_t most_closings = 4;
constexpr std::size_t most_shared = 8;  ///< ties of a position among which the least norm is sought
constexpr int uses_of_update = 32;

}  // namespace

void Factor::solve_base(std::vector<double>& r) const {
  klu_->solve(r.data());
  for (std::size_t i = static_cast<std::size_t>(descriptor_->nodes()); i < r.size(); ++i) r[i] *= unit_;
}

/// What the flipped closing rows ask for goes into t alone: the current that a diode is to lose is no voltage across it.
void Factor::solve(std::vector<double>& r) const {
  linalg::Vector t(static_cast<Eigen::Index>(flips_.size()));
  for (std::size_t i = 0; i < flips_.size(); ++i)
    t[static_cast<Eigen::Index>(i)] = -std::exchange(r[static_cast<std::size_t>(flipped(i).row)], 0.0);
  solve_base(r);
  if (flips_.empty()) return;
  for (std::size_t i = 0; i < flips_.size(); ++i) t[static_cast<Eigen::Index>(i)] += flipped(i).response(flipped_on_[i] == 0, r.data());
  const linalg::Vector share = scale_.asDiagonal() * small_.solve(scale_.asDiagonal() * t);
  for (std::size_t i = 0; i < flips_.size(); ++i) {
    const double factor = share[static_cast<Eigen::Index>(i)];
    for (std::size_t k = 0; k < r.size(); ++k) r[k] -= factor * columns_[i][k];
  }
}

Factors::Factors(const model::Network& network, const Descriptor& descriptor, double reltol)
    : descriptor_(descriptor),
      ordering_(descriptor.pattern()),
      epsilon_(std::clamp(tolerance::epsilon_share * reltol, tolerance::least_epsilon, tolerance::largest_epsilon)) {
  if (descriptor.passive()) parts_.emplace(network);
}

Factors::Entry* Factors::find(double shift, const Position& on) {
  const auto is_it = [&](const Entry& entry) { return std::abs(entry.shift - shift) <= tolerance::same_shift * shift && entry.on == on; };
  if (last_ < entries_.size() && is_it(entries_[last_])) return &entries_[last_];
  for (Entry& entry : entries_)
    if (is_it(entry)) return &entry;
  return nullptr;
}

/// Once there is no room: the oldest of at least two with the same position, whose pivots are good, or the oldest of all.
Factors::Entry& Factors::slot(const Position& on) {
  const bool known = !entries_.empty() && entries_.front().factor.klu_;
  const std::size_t each = known ? bytes_of_entry * entries_.front().factor.klu_->entries() +
                                       most_closings * sizeof(double) * static_cast<std::size_t>(descriptor_.size())
                                 : 0;
  const std::size_t room = each == 0 ? fewest_factors : std::clamp(most_bytes / each, fewest_factors, most_factors);
  if (entries_.size() < room) return entries_.emplace_back(Entry{});
  Entry* oldest = &entries_.front();
  Entry* alike = nullptr;
  int count = 0;
  for (Entry& entry : entries_) {
    if (entry.used < oldest->used) oldest = &entry;
    if (entry.used == 0 || !entry.factor.flips_.empty() || entry.on != on) continue;
    ++count;
    if (!alike || entry.used < alike->used) alike = &entry;
  }
  return count > 1 ? *alike : *oldest;
}

linalg::Factored Factors::factor(Entry& entry, const Descriptor::Closing& closing, const linalg::KluFactor* pivots) {
  Factor& f = entry.factor;
  descriptor_.matrix(entry.shift, closing, f.unit_, values_);
  const auto factored = pivots ? f.klu_->refactor_as(*pivots, values_) : f.klu_->factor(values_);
  if (factored != linalg::Factored::good) return factored;
  const bool may_be_rounding = !(parts_ && parts_->tells_all()) && f.klu_->pivot_ratio() < tolerance::doubtful_pivot;
  return may_be_rounding && !recovers(f, entry.shift, closing) ? linalg::Factored::singular : factored;
}

/// A solution of our own, with no component like another: whether it comes back from its right-hand side. What a singular matrix leaves open does not, as a pivot
/// that is rounding meets a right-hand side that is; where pivots are small because units and time constants are far apart, it does.
bool Factors::recovers(const Factor& factor, double shift, const Descriptor::Closing& closing) {
  const auto n = static_cast<std::size_t>(descriptor_.size());
  descriptor_.matrix(shift, closing, 1.0, values_);
  std::vector<double> right(n), solution(n);
  const auto own = [](std::size_t i) { return 1.0 + static_cast<double>(i * i % 17) / 8.0; };
  for (std::size_t i = 0; i < n; ++i) solution[i] = own(i);
  linalg::multiply(descriptor_.pattern(), values_, solution.data(), right.data());
  factor.solve_base(right);
  for (std::size_t i = 0; i < n; ++i)
    if (!(std::abs(right[i] - own(i)) <= tolerance::recovered * own(i))) return false;
  return true;
}

/// A factor of the same position at another shift, whose pivots serve.
const linalg::KluFactor* Factors::like(const Entry& entry) const {
  for (const Entry& other : entries_)
    if (&other != &entry && other.used > 0 && !other.factor.closing_ && other.factor.flips_.empty() && other.on == entry.on)
      return other.factor.klu_.get();
  return nullptr;
}

linalg::Factored Factors::factor(Entry& entry, const std::vector<int>& ties, bool same_pivots) {
  Factor& f = entry.factor;
  f.descriptor_ = &descriptor_;
  f.flips_.clear();
  f.columns_.clear();
  f.closing_.reset();
  f.ties_.clear();
  f.open_.clear();
  f.unit_ = descriptor_.mean_admittance(entry.shift);
  if (!f.klu_ || f.klu_.use_count() > 1) {
    f.klu_ = std::make_shared<linalg::KluFactor>(ordering_);
    same_pivots = false;
  }
  const linalg::KluFactor* pivots = same_pivots ? f.klu_.get() : like(entry);
  Descriptor::Closing closing = descriptor_.closing(entry.shift, entry.on, 0.0);
  if (!ties.empty()) f.stiffest_ = descriptor_.tie(entry.shift, entry.on, ties, closing);
  auto factored = factor(entry, closing, pivots);
  if (factored == linalg::Factored::good) {
    f.ties_ = ties;
    find_open(entry);
  }
  for (const double epsilon : {epsilon_, 100.0 * epsilon_}) {
    if (factored != linalg::Factored::singular) break;
    closing = descriptor_.closing(entry.shift, entry.on, epsilon);
    factored = factor(entry, closing, nullptr);
    if (factored == linalg::Factored::good) f.closing_ = std::move(closing);
  }
  return factored;
}

void Factors::find_open(Entry& entry) {
  Factor& f = entry.factor;
  const auto count = static_cast<Eigen::Index>(f.ties_.size());
  if (count == 0 || f.ties_.size() > most_shared) return;
  const auto& ports = descriptor_.ports();
  linalg::Matrix free(static_cast<Eigen::Index>(ports.size()), count);
  for (Eigen::Index j = 0; j < count; ++j) {
    std::vector<double>& column = f.open_.emplace_back(static_cast<std::size_t>(descriptor_.size()), 0.0);
    column[static_cast<std::size_t>(ports[static_cast<std::size_t>(f.ties_[static_cast<std::size_t>(j)])].row)] = 1.0;
    f.solve_base(column);
    const double most = largest(column);
    for (double& value : column) value /= most;
    for (std::size_t i = 0; i < ports.size(); ++i)
      free(static_cast<Eigen::Index>(i), j) = ports[i].response(entry.on[i] != 0, column.data());
  }
  f.shares_.compute(free.transpose() * free);
}

/// From a factor of the same shift that few ports tell from the wanted one.
bool Factors::update(Entry& entry) {
  const Entry* base = nullptr;
  std::vector<int> flips, of_base;
  for (const Entry& other : entries_) {
    if (&other == &entry || other.used == 0 || other.factor.closing_ || !other.factor.ties_.empty() || !other.factor.flips_.empty())
      continue;
    if (std::abs(other.shift - entry.shift) > tolerance::same_shift * entry.shift) continue;
    of_base.clear();
    for (std::size_t i = 0; i < entry.on.size() && of_base.size() <= most_closings; ++i)
      if (entry.on[i] != other.on[i]) of_base.push_back(static_cast<int>(i));
    if (of_base.size() > most_closings || (base && of_base.size() >= flips.size())) continue;
    base = &other;
    flips = of_base;
  }
  if (!base) return false;
  Factor f = base->factor;
  f.flips_ = flips;
  const auto k = static_cast<Eigen::Index>(flips.size());
  linalg::Matrix s(k, k);
  f.flipped_on_.clear();
  for (const int port : flips) f.flipped_on_.push_back(entry.on[static_cast<std::size_t>(port)]);
  for (std::size_t j = 0; j < flips.size(); ++j) {
    std::vector<double> column(static_cast<std::size_t>(descriptor_.size()), 0.0);
    column[static_cast<std::size_t>(descriptor_.ports()[static_cast<std::size_t>(flips[j])].row)] = 1.0;
    f.solve_base(column);
    for (std::size_t i = 0; i < flips.size(); ++i)
      s(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
          descriptor_.ports()[static_cast<std::size_t>(flips[i])].response(f.flipped_on_[i] == 0, column.data());
    f.columns_.push_back(std::move(column));
  }
  if (!(s.diagonal().cwiseAbs().minCoeff() > 0.0)) return false;
  f.scale_ = s.diagonal().cwiseAbs().cwiseSqrt().cwiseInverse();
  f.small_.compute(f.scale_.asDiagonal() * s * f.scale_.asDiagonal());
  if (!(lcp::reciprocal_condition(f.small_) > tolerance::update_condition)) return false;
  if (!is_sound(f, entry)) return false;
  entry.factor = std::move(f);
  return true;
}

/// Whether a factor solves a right-hand side of its own matrix with a small residual in every row: one near a singular position need not.
bool Factors::is_sound(const Factor& factor, const Entry& entry) {
  const auto n = static_cast<std::size_t>(descriptor_.size());
  descriptor_.matrix(entry.shift, descriptor_.closing(entry.shift, entry.on, 0.0), 1.0, values_);
  std::vector<double> solution(n), right(n), product(n), size(n);
  for (std::size_t i = 0; i < n; ++i) solution[i] = 1.0 + static_cast<double>(i % 7) / 8.0;
  linalg::multiply(descriptor_.pattern(), values_, solution.data(), right.data());
  solution = right;
  factor.solve(solution);
  linalg::multiply(descriptor_.pattern(), values_, solution.data(), product.data());
  linalg::multiply_absolute(descriptor_.pattern(), values_, solution.data(), size.data());
  for (std::size_t i = 0; i < n; ++i)
    if (!(std::abs(product[i] - right[i]) <= tolerance::update_residual * (size[i] + std::abs(right[i])))) return false;
  return true;
}

const Factor* Factors::at(double shift, const Position& on) {
  Entry* entry = find(shift, on);
  const bool worn = entry && !entry->factor.flips_.empty() && entry->uses >= uses_of_update;
  if (!entry || worn) {
    if (!entry) entry = &slot(on);
    const bool same_pivots = entry->used > 0 && !worn && entry->on == on && entry->factor.flips_.empty();
    entry->used = 0;
    entry->uses = 0;
    entry->shift = shift;
    entry->on = on;
    const std::vector<int> ties = parts_ ? parts_->ties(on) : std::vector<int>{};
    if (worn || !ties.empty() || !by_columns_ || !update(*entry)) {
      const auto factored = factor(*entry, ties, same_pivots);
      if (factored != linalg::Factored::good) {
        singular_unknown_ = entry->factor.klu_->singular_column();
        out_of_memory_ = factored == linalg::Factored::no_memory;
        entry->shift = -1.0;
        return nullptr;
      }
    }
  }
  ++entry->uses;
  entry->used = ++clock_;
  last_ = static_cast<std::size_t>(entry - entries_.data());
  return &entry->factor;
}

}  // namespace pwlsim::engine::sparse
