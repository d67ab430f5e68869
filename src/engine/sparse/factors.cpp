#include "engine/sparse/factors.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string_view>
#include <utility>

#include "base/arithmetic.hpp"
#include "engine/sparse/tolerances.hpp"
#include "lcp/condition.hpp"

namespace pwlsim::engine::sparse {

namespace {

constexpr std::size_t most_bytes = 192u << 20;  ///< of all factors together
constexpr std::size_t bytes_of_entry = 16;
constexpr std::size_t fewest_factors = 3, most_factors = 1024;  ///< a period of hundreds of segments is gone through again and again
constexpr std::size_t first_kept = 16, growth_of_kept = 2;  ///< factors; where many that were given up are wanted again, so many times more
constexpr double share_of_missed = 0.25;
constexpr std::size_t most_given_up = 4096;  ///< that are known
/// A position so few ports away from one that is factored is reached by their columns, of which it may have so many times more; solved for so often, by a factor of its
/// own.
constexpr std::size_t most_closings = 4, columns_of_flip = 8;
constexpr std::size_t most_shared = 8;  ///< ties of a position among which the least norm is sought
constexpr int uses_of_update = 32;
constexpr std::size_t most_columns_of_rough = 24;  ///< the cost of a factor of its own, at most

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
    const std::vector<double>& column = columns_->of_port[static_cast<std::size_t>(flips_[i])];
    for (std::size_t k = 0; k < r.size(); ++k) r[k] -= factor * column[k];
  }
}

Factors::Factors(const model::Network& network, const Descriptor& descriptor, double reltol)
    : descriptor_(descriptor),
      ordering_(descriptor.pattern()),
      epsilon_(std::clamp(tolerance::epsilon_share * reltol, tolerance::least_epsilon, tolerance::largest_epsilon)),
      kept_(first_kept) {
  if (descriptor.passive()) parts_.emplace(network);
}

Factors::Entry* Factors::find(double shift, const Position& on) {
  const auto is_it = [&](const Entry& entry) { return std::abs(entry.shift - shift) <= tolerance::same_shift * shift && entry.on == on; };
  if (last_ < entries_.size() && is_it(entries_[last_])) return &entries_[last_];
  for (Entry& entry : entries_)
    if (is_it(entry)) return &entry;
  return nullptr;
}

std::size_t Factors::key(double shift, const Position& on) {
  const std::hash<std::string_view> hash;
  return hash({on.data(), on.size()}) ^ std::hash<double>{}(shift);
}

/// A run that goes through many positions once needs few of their factors again, and memory that is used again is mapped and in the cache. Of as many factors as are kept, those are counted that had
/// been given up.
void Factors::keep_more_if_missed(double shift, const Position& on) {
  missed_ += given_up_.erase(key(shift, on));
  if (++made_ < kept_) return;
  if (static_cast<double>(missed_) >= share_of_missed * static_cast<double>(made_)) kept_ = std::min(growth_of_kept * kept_, most_factors);
  made_ = missed_ = 0;
}

/// Once there is no room: the oldest of at least two with the same position, whose pivots are good, or the oldest of all.
Factors::Entry& Factors::slot(const Position& on) {
  const bool known = !entries_.empty() && entries_.front().factor.klu_;
  const std::size_t each =
      known ? bytes_of_entry * entries_.front().factor.klu_->entries() +
                  (most_closings * static_cast<std::size_t>(descriptor_.size()) + descriptor_.pattern().entries()) * sizeof(double)
            : 0;
  const std::size_t room = each == 0 ? fewest_factors : std::clamp(most_bytes / each, fewest_factors, kept_);
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
  Entry& given_up = count > 1 ? *alike : *oldest;
  if (given_up_.size() >= most_given_up) given_up_.clear();
  given_up_.insert(key(given_up.shift, given_up.on));
  return given_up;
}

linalg::Factored Factors::factor(Entry& entry, const Descriptor::Closing& closing, const linalg::KluFactor* pivots) {
  Factor& f = entry.factor;
  descriptor_.matrix(entry.shift, closing, f.unit_, values_);
  const linalg::KluFactor* near = pivots ? nullptr : latest(entry);
  const auto factored = pivots ? f.klu_->refactor_as(*pivots, values_)
                        : near ? f.klu_->factor_near(*near, values_)
                               : f.klu_->factor(values_);
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
    if (has_own_factor(entry, other) && other.on == entry.on) return other.factor.klu_.get();
  return nullptr;
}

bool Factors::has_own_factor(const Entry& entry, const Entry& other) {
  return &other != &entry && other.used > 0 && !other.factor.closing_ && other.factor.flips_.empty();
}

bool Factors::is_base_of(const Entry& entry, const Entry& other) {
  return has_own_factor(entry, other) && std::abs(other.shift - entry.shift) <= tolerance::same_shift * entry.shift;
}

/// The one at the same shift that was used last, from which the wanted one differs little: positions follow on each other by events.
const linalg::KluFactor* Factors::latest(const Entry& entry) const {
  const Entry* latest = nullptr;
  for (const Entry& other : entries_)
    if (is_base_of(entry, other) && other.factor.klu_->has_own_pivots() && (!latest || other.used > latest->used)) latest = &other;
  return latest ? latest->factor.klu_.get() : nullptr;
}

linalg::Factored Factors::factor(Entry& entry, const std::vector<int>& ties, bool same_pivots) {
  Factor& f = entry.factor;
  f.descriptor_ = &descriptor_;
  f.flips_.clear();
  f.columns_ = std::make_shared<Factor::Columns>();
  f.closing_.reset();
  f.ties_.clear();
  f.open_.clear();
  if (entry.shift != unit_.shift) unit_ = {entry.shift, descriptor_.mean_admittance(entry.shift)};
  f.unit_ = unit_.unit;
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

/// The factor of the same shift that the fewest ports tell from the wanted one; null where these are too many.
const Factors::Entry* Factors::nearest(const Entry& entry) const {
  const Entry* best = nullptr;
  std::size_t fewest = entry.on.size() + 1;
  for (const Entry& other : entries_) {
    if (!is_base_of(entry, other) || !other.factor.ties_.empty()) continue;
    const std::size_t enough = std::min(fewest, most_closings + 1);
    std::size_t count = 0;
    for (std::size_t i = 0; i < entry.on.size() && count < enough; ++i) count += entry.on[i] != other.on[i] ? 1 : 0;
    if (count >= enough) continue;
    best = &other;
    fewest = count;
  }
  return best;
}

const std::vector<double>& Factors::column(const Factor& base, int port) const {
  std::vector<double>& column = base.columns_->of_port[static_cast<std::size_t>(port)];
  if (!column.empty()) return column;
  column.assign(static_cast<std::size_t>(descriptor_.size()), 0.0);
  column[static_cast<std::size_t>(descriptor_.ports()[static_cast<std::size_t>(port)].row)] = 1.0;
  base.solve_base(column);
  ++base.columns_->count;
  return column;
}

/// From a factor that few ports tell from the wanted one, which then has at most so many columns. Nothing where too much of it would be rounding.
std::optional<Factor> Factors::reach(const Entry& base, const Position& on, std::size_t most_columns) const {
  Factor f = base.factor;
  f.columns_->of_port.resize(on.size());
  for (std::size_t i = 0; i < on.size(); ++i)
    if (on[i] != base.on[i]) f.flips_.push_back(static_cast<int>(i));
  const auto k = static_cast<Eigen::Index>(f.flips_.size());
  const auto missing = static_cast<std::size_t>(std::count_if(
      f.flips_.begin(), f.flips_.end(), [&](int port) { return f.columns_->of_port[static_cast<std::size_t>(port)].empty(); }));
  if (f.columns_->count + missing > most_columns) return std::nullopt;
  linalg::Matrix s(k, k);
  f.flipped_on_.clear();
  for (const int port : f.flips_) f.flipped_on_.push_back(on[static_cast<std::size_t>(port)]);
  for (Eigen::Index j = 0; j < k; ++j) {
    const std::vector<double>& of_flip = column(f, f.flips_[static_cast<std::size_t>(j)]);
    for (std::size_t i = 0; i < f.flips_.size(); ++i)
      s(static_cast<Eigen::Index>(i), j) = f.flipped(i).response(f.flipped_on_[i] == 0, of_flip.data());
  }
  if (!(s.diagonal().cwiseAbs().minCoeff() > 0.0)) return std::nullopt;
  f.scale_ = s.diagonal().cwiseAbs().cwiseSqrt().cwiseInverse();
  f.small_.compute(f.scale_.asDiagonal() * s * f.scale_.asDiagonal());
  if (!(lcp::reciprocal_condition(f.small_) > tolerance::update_condition)) return std::nullopt;
  return f;
}

/// From a factor of the same shift that few ports tell from the wanted one.
bool Factors::update(Entry& entry) {
  const Entry* base = nearest(entry);
  if (!base) return false;
  std::optional<Factor> f = reach(*base, entry.on, most_closings * columns_of_flip);
  if (!f) return false;
  note_known(*base);
  if (!(backward_error(*f) <= tolerance::update_residual)) return false;
  entry.factor = std::move(*f);
  return true;
}

std::optional<Factors::Rough> Factors::rough(const Position& on) {
  if (last_ >= entries_.size()) return std::nullopt;
  const Entry& base = entries_[last_];
  if (base.used == 0 || !base.factor.is_as_it_stands() || !base.factor.flips_.empty() || base.on == on) return std::nullopt;
  std::optional<Factor> factor = reach(base, on, most_columns_of_rough);
  if (!factor) return std::nullopt;
  return Rough{std::move(*factor), base.shift};
}

/// A solution of our own, no entry of it small.
double Factors::own_solution(std::size_t i) { return 1.0 + static_cast<double>(i % 7) / 8.0; }

/// A right-hand side with a known solution, of a factor that others are reached from.
void Factors::note_known(const Entry& base) {
  const auto n = static_cast<std::size_t>(descriptor_.size());
  Factor::Columns& own = *base.factor.columns_;
  if (!own.known.empty()) return;
  for (std::size_t i = 0; i < n; ++i) own.known.push_back(own_solution(i));
  own.right.resize(n);
  own.size.resize(n);
  descriptor_.matrix(base.shift, descriptor_.closing(base.shift, base.on, 0.0), 1.0, own.values);
  linalg::multiply(descriptor_.pattern(), own.values, own.known.data(), own.right.data());
  linalg::multiply_absolute(descriptor_.pattern(), own.values, own.known.data(), own.size.data());
  for (std::size_t i = 0; i < n; ++i) own.size[i] += std::abs(own.right[i]);
}

/// max |b − A x| / (|A| |x| + |b|) over the rows, for a right-hand side of the factor's own matrix: that of one near a singular position need not be small.
double Factors::backward_error(const Factor& factor) const {
  const auto n = static_cast<std::size_t>(descriptor_.size());
  const Factor::Columns& base = *factor.columns_;
  std::vector<double> right = base.right, size = base.size, product(n);
  const auto closing_row = [&](std::size_t i, const std::vector<double>& z) {
    return factor.flipped(i).response(factor.flipped_on_[i] == 0, z.data());
  };
  for (std::size_t i = 0; i < factor.flips_.size(); ++i) {
    const DescriptorPort& port = factor.flipped(i);
    const auto row = static_cast<std::size_t>(port.row);
    right[row] = closing_row(i, base.known);
    size[row] = std::abs(right[row]) + (factor.flipped_on_[i] != 0 ? Form::size_of(port.slack.z, base.known.data()) : std::abs(right[row]));
  }
  std::vector<double> solution = right;
  factor.solve(solution);
  linalg::multiply(descriptor_.pattern(), base.values, solution.data(), product.data());
  for (std::size_t i = 0; i < factor.flips_.size(); ++i)
    product[static_cast<std::size_t>(factor.flipped(i).row)] = closing_row(i, solution);
  double worst = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double error = std::abs(product[i] - right[i]) / size[i];
    if (size[i] > 0.0 && !(error <= worst)) worst = error;
  }
  return worst;
}

const Factor* Factors::at(double shift, const Position& on) {
  Entry* entry = find(shift, on);
  const bool worn = entry && !entry->factor.flips_.empty() && entry->uses >= uses_of_update;
  if (!entry || worn) {
    if (!entry) {
      keep_more_if_missed(shift, on);
      entry = &slot(on);
    }
    const bool same_pivots = entry->used > 0 && !worn && entry->on == on && entry->factor.flips_.empty();
    entry->used = 0;
    entry->uses = 0;
    entry->shift = shift;
    entry->on = on;
    const std::vector<int> ties = parts_ ? parts_->ties(on) : std::vector<int>{};
    if (worn || !ties.empty() || keeps_digits_ || !update(*entry)) {
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
