#include "linalg/klu.hpp"

#include <klu.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "linalg/partial_factor.hpp"
#include "linalg/shallow_order.hpp"
#include "linalg/sifted.hpp"
#include "linalg/tolerances.hpp"

namespace pwlsim::linalg {

namespace {

int* writable(const std::vector<int>& v) { return const_cast<int*>(v.data()); }  // KLU takes no const, and writes nothing

/// Largest sum of a column.
double norm(const SparsePattern& pattern, const std::vector<double>& values) {
  double most = 0.0;
  for (std::size_t j = 0; j < static_cast<std::size_t>(pattern.size); ++j) {
    double sum = 0.0;
    for (int e = pattern.start[j]; e < pattern.start[j + 1]; ++e) sum += std::abs(values[static_cast<std::size_t>(e)]);
    most = std::max(most, sum);
  }
  return most;
}

struct Columns {
  void resize(std::size_t n, int entries) {
    start.resize(n + 1);
    row.resize(static_cast<std::size_t>(entries));
    value.resize(static_cast<std::size_t>(entries));
  }
  std::vector<int> start, row;
  std::vector<double> value;
};

/// Columns one after the other, in arrays that have room for all. `row_of`: of each number that they have for a row.
class PackedColumns {
 public:
  PackedColumns(std::vector<int>& rows, std::vector<double>& values, std::size_t room, const std::vector<int>& row_of) : row_of_(row_of) {
    rows.resize(room);
    values.resize(room);
    row_ = rows.data();
    value_ = values.data();
  }
  void add(const Columns& from, int first, int end) {
    for (int e = first; e < end; ++e) {
      row_[size_] = row_of_[static_cast<std::size_t>(from.row[static_cast<std::size_t>(e)])];
      value_[size_++] = from.value[static_cast<std::size_t>(e)];
    }
  }
  [[nodiscard]] int size() const { return size_; }

 private:
  const std::vector<int>& row_of_;
  int* row_;
  double* value_;
  int size_ = 0;
};

/// Entries of the factors for each of the matrix: so much room is made at first.
constexpr double usual_fill = 2.0;
/// Columns that factors eliminate beside those they take over, for each of the matrix, before an order is sought in which they are few: that takes as long.
constexpr double columns_before_shallow = 8.0;

/// As KLU numbers them.
enum class Ordering { minimum_degree = 0, by_columns = 1, shallow = 3 };

/// The order of a block. 0: none.
int order_block(int size, int* start, int* row, int* order, klu_common*) {
  const auto found = shallow_order({size, {start, start + size + 1}, {row, row + start[size]}});
  if (!found) return 0;
  std::copy(found->begin(), found->end(), order);
  return start[size];
}

}  // namespace

struct KluOrdering::Handle {
  explicit Handle(const SparsePattern& whole) : pattern(whole) {
    klu_defaults(&common);
    common.user_order = order_block;
  }
  /// Of KLU's ordering by that method. False: it found none.
  bool find_order(Ordering method);
  /// The factorisation in that order, which is then the order, where it has so many entries at most. Null: the order stays.
  std::unique_ptr<Elimination> try_order(Ordering method, const std::vector<double>& values, double most_entries);
  /// Factors have had to eliminate so many columns that an order in which these are few pays.
  [[nodiscard]] bool is_shallow_due() const { return !shallow_tried && eliminated_columns > columns_before_shallow * pattern.size; }
  /// More than the ordering counts on, while another has not been tried.
  [[nodiscard]] bool is_fill_unexpected(double entries) const {
    return !by_columns_tried && entries > tolerance::most_fill * expected_fill;
  }
  void take_order(BlockOrder other) {
    order = std::move(other);
    sifter.emplace(pattern, order);
    partial.emplace(*sifter);
    ++orders;
  }

  const SparsePattern& pattern;
  klu_common common{};
  bool is_regular = true, by_columns_tried = false, shallow_tried = false;
  double eliminated_columns = 0.0;  ///< of factors that took over others
  double expected_fill = 0.0;       ///< entries of L and U, with all pivots on the ordering's diagonal
  double fill = usual_fill;         ///< entries of the last factor for each of its matrix
  BlockOrder order;
  std::optional<Sifter> sifter;
  std::optional<PartialFactor> partial;
  int orders = 0;               ///< so far
  Columns lower, upper, outer;  ///< room for what KLU found
  std::vector<double> size;     ///< of rows
};

bool KluOrdering::Handle::find_order(Ordering method) {
  const int usual = std::exchange(common.ordering, static_cast<int>(method));
  klu_symbolic* symbolic = klu_analyze(pattern.size, writable(pattern.start), writable(pattern.row), &common);
  common.ordering = usual;
  if (symbolic == nullptr) return false;
  is_regular = symbolic->structural_rank == pattern.size;
  expected_fill = symbolic->lnz + symbolic->unz;
  const int n = pattern.size;
  take_order({{symbolic->P, symbolic->P + n}, {symbolic->Q, symbolic->Q + n}, {symbolic->R, symbolic->R + symbolic->nblocks + 1}});
  klu_free_symbolic(&symbolic, &common);
  return true;
}

KluOrdering::KluOrdering(SparsePattern pattern) : pattern_(std::move(pattern)), handle_(std::make_unique<Handle>(pattern_)) {
  if (pattern_.size > 0) handle_->is_regular = handle_->find_order(Ordering::minimum_degree) && handle_->is_regular;
}

KluOrdering::~KluOrdering() = default;

void KluOrdering::pivot_on_largest() { handle_->common.tol = 1.0; }

bool KluOrdering::structurally_regular() const { return handle_->is_regular; }

/// A factorisation by KLU of a matrix without its zeros.
class KluOrdering::Elimination {
 public:
  Elimination(Handle& handle, const std::vector<double>& values);
  ~Elimination() { klu_free_numeric(&numeric_, &handle_.common); }
  Elimination(const Elimination&) = delete;
  Elimination& operator=(const Elimination&) = delete;

  [[nodiscard]] int status() const { return status_; }
  [[nodiscard]] bool is_regular() const { return numeric_ != nullptr && status_ == KLU_OK; }
  /// Entries of L and U.
  [[nodiscard]] double fill() const { return static_cast<double>(numeric_->lnz) + static_cast<double>(numeric_->unz); }
  /// The same, and those between blocks.
  [[nodiscard]] double entries() const { return fill() - numeric_->n + numeric_->nzoff; }
  [[nodiscard]] FixedPivotFactor take();

 private:
  void find_symbolic();

  Handle& handle_;
  Sifted sifted_;
  std::vector<double> entries_of_lower_;
  klu_symbolic symbolic_{};
  klu_numeric* numeric_ = nullptr;
  int status_ = KLU_OK;
};

KluOrdering::Elimination::Elimination(Handle& handle, const std::vector<double>& values)
    : handle_(handle), sifted_(handle.sifter->sift(values)) {
  find_symbolic();
  std::vector<double> kept(sifted_.entry.size());
  for (std::size_t e = 0; e < kept.size(); ++e) kept[e] = values[static_cast<std::size_t>(sifted_.entry[e])];
  numeric_ = klu_factor(sifted_.pattern.start.data(), sifted_.pattern.row.data(), kept.data(), &symbolic_, &handle.common);
  status_ = handle.common.status;
  if (is_regular()) handle.fill = fill() / static_cast<double>(kept.size());
}

std::unique_ptr<KluOrdering::Elimination> KluOrdering::Handle::try_order(Ordering method, const std::vector<double>& values,
                                                                         double most_entries) {
  const BlockOrder usual = order;
  auto elimination = find_order(method) ? std::make_unique<Elimination>(*this, values) : nullptr;
  if (elimination && elimination->is_regular() && elimination->entries() < most_entries) return elimination;
  take_order(usual);
  return nullptr;
}

/// What KLU calls so, with the blocks that are left.
void KluOrdering::Elimination::find_symbolic() {
  BlockOrder& order = sifted_.rest.order;
  symbolic_.n = sifted_.pattern.size;
  symbolic_.nz = static_cast<int>(sifted_.pattern.entries());
  symbolic_.P = order.row.data();
  symbolic_.Q = order.column.data();
  symbolic_.R = order.block.data();
  symbolic_.nzoff = sifted_.entries_above;
  symbolic_.nblocks = static_cast<int>(order.block.size()) - 1;
  symbolic_.structural_rank = symbolic_.n;
  for (int b = 0; b < symbolic_.nblocks; ++b) {
    const auto i = static_cast<std::size_t>(b);
    symbolic_.maxblock = std::max(symbolic_.maxblock, order.block[i + 1] - order.block[i]);
    entries_of_lower_.push_back(0.5 * handle_.fill * sifted_.entries_of_block[i]);
  }
  symbolic_.Lnz = entries_of_lower_.data();
}

/// KLU puts the ones of L first in their columns and the pivots last in those of U.
FixedPivotFactor KluOrdering::Elimination::take() {
  const auto n = static_cast<std::size_t>(symbolic_.n);
  Columns &lower = handle_.lower, &upper = handle_.upper, &outer = handle_.outer;
  lower.resize(n, numeric_->lnz);
  upper.resize(n, numeric_->unz);
  outer.resize(n, numeric_->nzoff);
  handle_.size.resize(n);
  auto pivots = std::make_shared<Pivots>();
  FixedPivotFactor::Values values;
  for (auto* indices : {&pivots->row, &pivots->column, &pivots->place}) indices->resize(n);
  pivots->block.resize(static_cast<std::size_t>(symbolic_.nblocks) + 1);
  values.row_size.resize(n);
  values.row_factor.resize(n);
  values.inverse_pivot.resize(n);
  klu_extract(numeric_, &symbolic_, lower.start.data(), lower.row.data(), lower.value.data(), upper.start.data(), upper.row.data(),
              upper.value.data(), outer.start.data(), outer.row.data(), outer.value.data(), pivots->row.data(), pivots->column.data(),
              handle_.size.data(), pivots->block.data(), &handle_.common);
  PackedColumns in_lower(pivots->lower_row, values.lower, lower.row.size() - n, pivots->row);
  PackedColumns in_upper(pivots->upper_row, values.upper, upper.row.size() - n + outer.row.size(), pivots->row);
  pivots->lower_start.reserve(n + 1);
  pivots->upper_start.reserve(n + 1);
  for (std::size_t k = 0; k < n; ++k) {
    const auto row = static_cast<std::size_t>(pivots->row[k]);
    pivots->place[row] = static_cast<int>(k);
    values.row_size[row] = handle_.size[k];
    values.row_factor[row] = 1.0 / handle_.size[k];
    values.inverse_pivot[k] = 1.0 / upper.value[static_cast<std::size_t>(upper.start[k + 1]) - 1];
    in_lower.add(lower, lower.start[k] + 1, lower.start[k + 1]);
    in_upper.add(outer, outer.start[k], outer.start[k + 1]);
    in_upper.add(upper, upper.start[k], upper.start[k + 1] - 1);
    pivots->lower_start.push_back(in_lower.size());
    pivots->upper_start.push_back(in_upper.size());
  }
  pivots->single_rows = sifted_.rest.single_rows;
  pivots->zeros = std::move(sifted_.zeros);
  return {std::move(pivots), std::move(values)};
}

Factored KluFactor::factor(const std::vector<double>& values) {
  singular_column_ = -1;
  if (ordering_->pattern_.size == 0) return Factored::good;
  if (!ordering_->structurally_regular()) return Factored::singular;
  KluOrdering::Handle& handle = *ordering_->handle_;
  auto elimination = std::make_unique<KluOrdering::Elimination>(handle, values);
  ++ordering_->counts.factorizations;
  // Minimum degree counts on pivots on the diagonal. Where many are zero there, an ordering of columns (COLAMD) that expects any pivot may fill less.
  if (elimination->is_regular() && handle.is_fill_unexpected(elimination->fill())) {
    handle.by_columns_tried = true;
    if (auto other = handle.try_order(Ordering::by_columns, values, elimination->entries())) elimination = std::move(other);
  }
  if (!elimination->is_regular()) {
    const int status = elimination->status();
    if (status == KLU_SINGULAR) singular_column_ = handle.common.singular_col;
    return status == KLU_OUT_OF_MEMORY || status == KLU_TOO_LARGE ? Factored::no_memory : Factored::singular;
  }
  keep(elimination->take(), values);
  return Factored::good;
}

void KluFactor::keep(FixedPivotFactor factor, const std::vector<double>& values) {
  numeric_ = std::move(factor);
  first_pivot_ratio_ = numeric_.pivot_ratio();
  values_ = values;
  order_ = ordering_->handle_->orders;
  has_own_pivots_ = true;
}

Factored KluFactor::factor_near(const KluFactor& other, const std::vector<double>& values) {
  KluOrdering::Handle& handle = *ordering_->handle_;
  if (!other.has_own_pivots_ || other.values_.size() != values.size() || other.order_ != handle.orders) return factor(values);
  auto partial = handle.partial->factor({other.numeric_, other.values_}, values, handle.common.tol);
  if (!partial || handle.is_fill_unexpected(static_cast<double>(partial->entries()))) return factor(values);
  handle.eliminated_columns += handle.partial->eliminated_columns();
  const double entries = static_cast<double>(partial->entries());
  keep(std::move(*partial), values);
  ++ordering_->counts.partial_factorizations;
  if (handle.is_shallow_due()) {
    handle.shallow_tried = handle.by_columns_tried = true;
    if (const auto shallow = handle.try_order(Ordering::shallow, values, tolerance::shallow_fill * entries)) keep(shallow->take(), values);
  }
  return Factored::good;
}

bool KluFactor::pivots_are_good(const std::vector<double>& values) const {
  if (!(numeric_.growth() >= tolerance::least_growth)) return false;
  if (numeric_.pivot_ratio() >= tolerance::suspicious_ratio * first_pivot_ratio_) return true;
  return numeric_.inverse_norm(ordering_->work_) * norm(ordering_->pattern_, values) <= tolerance::largest_condition;
}

Factored KluFactor::factor_by(const std::shared_ptr<const Pivots>& pivots, int order, const std::vector<double>& values) {
  if (!pivots) return factor(values);
  values_ = values;
  order_ = order;
  has_own_pivots_ = false;
  const bool done = numeric_.factor(ordering_->pattern_, values, pivots, ordering_->work_);
  ++ordering_->counts.refactorizations;
  return done && pivots_are_good(values) ? Factored::good : factor(values);
}

Factored KluFactor::refactor(const std::vector<double>& values) { return factor_by(numeric_.pivots(), order_, values); }

Factored KluFactor::refactor_as(const KluFactor& other, const std::vector<double>& values) {
  first_pivot_ratio_ = other.first_pivot_ratio_;
  return factor_by(other.numeric_.pivots(), other.order_, values);
}

void KluFactor::solve(double* b, int columns) const {
  const auto n = static_cast<std::size_t>(ordering_->pattern_.size);
  if (n == 0) return;
  for (int j = 0; j < columns; ++j) numeric_.solve(b + static_cast<std::size_t>(j) * n, ordering_->work_);
  ordering_->counts.solves += static_cast<std::uint64_t>(columns);
}

}  // namespace pwlsim::linalg
