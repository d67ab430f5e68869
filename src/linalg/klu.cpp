#include "linalg/klu.hpp"

#include <klu.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "linalg/tolerances.hpp"

namespace pwlsim::linalg {

namespace {

int* writable(const std::vector<int>& v) { return const_cast<int*>(v.data()); }           // KLU takes no const, and writes nothing
double* writable(const std::vector<double>& v) { return const_cast<double*>(v.data()); }  // likewise

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

}  // namespace

struct KluOrdering::Handle {
  klu_common common{};
  klu_symbolic* symbolic = nullptr;
  bool by_columns_tried = false;
};

KluOrdering::KluOrdering(SparsePattern pattern) : pattern_(std::move(pattern)), handle_(std::make_unique<Handle>()) {
  klu_defaults(&handle_->common);
  if (pattern_.size > 0) handle_->symbolic = klu_analyze(pattern_.size, writable(pattern_.start), writable(pattern_.row), &handle_->common);
}

KluOrdering::~KluOrdering() { klu_free_symbolic(&handle_->symbolic, &handle_->common); }

bool KluOrdering::structurally_regular() const {
  return pattern_.size == 0 || (handle_->symbolic != nullptr && handle_->symbolic->structural_rank == pattern_.size);
}

namespace {

struct Columns {
  Columns(int n, int entries)
      : start(static_cast<std::size_t>(n) + 1), row(static_cast<std::size_t>(entries)), value(static_cast<std::size_t>(entries)) {}
  /// The entries of a column but so many at its begin and end.
  void append(std::size_t k, int at_begin, int at_end, std::vector<int>& rows, std::vector<double>& values) const {
    const int first = start[k] + at_begin, end = start[k + 1] - at_end;
    rows.insert(rows.end(), row.begin() + first, row.begin() + end);
    values.insert(values.end(), value.begin() + first, value.begin() + end);
  }
  std::vector<int> start, row;
  std::vector<double> value;
};

/// What KLU found; it puts the ones of L first in their columns and the pivots last in those of U.
FixedPivotFactor factor_of(klu_numeric* numeric, klu_symbolic* symbolic, klu_common* common) {
  const int size = symbolic->n;
  const auto n = static_cast<std::size_t>(size);
  Columns lower(size, numeric->lnz), upper(size, numeric->unz), outer(size, numeric->nzoff);
  auto pivots = std::make_shared<Pivots>();
  FixedPivotFactor::Values values;
  for (auto* indices : {&pivots->row, &pivots->column, &pivots->place}) indices->resize(n);
  pivots->block.resize(static_cast<std::size_t>(symbolic->nblocks) + 1);
  values.row_factor.resize(n);
  values.inverse_pivot.resize(n);
  klu_extract(numeric, symbolic, lower.start.data(), lower.row.data(), lower.value.data(), upper.start.data(), upper.row.data(),
              upper.value.data(), outer.start.data(), outer.row.data(), outer.value.data(), pivots->row.data(), pivots->column.data(),
              values.row_factor.data(), pivots->block.data(), common);
  pivots->lower_row.reserve(lower.row.size() - n);
  values.lower.reserve(lower.row.size() - n);
  pivots->upper_row.reserve(upper.row.size() - n + outer.row.size());
  values.upper.reserve(upper.row.size() - n + outer.row.size());
  for (std::size_t k = 0; k < n; ++k) {
    pivots->place[static_cast<std::size_t>(pivots->row[k])] = static_cast<int>(k);
    values.row_factor[k] = 1.0 / values.row_factor[k];
    values.inverse_pivot[k] = 1.0 / upper.value[static_cast<std::size_t>(upper.start[k + 1]) - 1];
    lower.append(k, 1, 0, pivots->lower_row, values.lower);
    outer.append(k, 0, 0, pivots->upper_row, values.upper);
    upper.append(k, 0, 1, pivots->upper_row, values.upper);
    pivots->lower_start.push_back(static_cast<int>(pivots->lower_row.size()));
    pivots->upper_start.push_back(static_cast<int>(pivots->upper_row.size()));
  }
  return {std::move(pivots), std::move(values)};
}

double fill(const klu_numeric& numeric) { return static_cast<double>(numeric.lnz) + static_cast<double>(numeric.unz); }

/// Of the minimum degree ordering, with all pivots on its diagonal.
double expected_fill(const klu_symbolic& symbolic) { return symbolic.lnz + symbolic.unz; }

/// Minimum degree counts on pivots on the diagonal. Where many are zero there, as in the rows of ports that may be on either side, an ordering of columns (COLAMD) that
/// expects any pivot fills less. Symbolic and numeric become its own if it does.
void order_by_columns(const SparsePattern& p, const std::vector<double>& values, klu_common& common, klu_symbolic*& symbolic,
                      klu_numeric*& numeric) {
  constexpr int colamd = 1;
  const int minimum_degree = std::exchange(common.ordering, colamd);
  klu_symbolic* other = klu_analyze(p.size, writable(p.start), writable(p.row), &common);
  common.ordering = minimum_degree;
  klu_numeric* factored = other ? klu_factor(writable(p.start), writable(p.row), writable(values), other, &common) : nullptr;
  if (factored != nullptr && common.status == KLU_OK && fill(*factored) < fill(*numeric)) {
    std::swap(symbolic, other);
    std::swap(numeric, factored);
  }
  klu_free_numeric(&factored, &common);
  klu_free_symbolic(&other, &common);
  common.status = KLU_OK;  // of the numeric that stays
}

}  // namespace

Factored KluFactor::factor(const std::vector<double>& values) {
  singular_column_ = -1;
  const SparsePattern& p = ordering_->pattern_;
  if (p.size == 0) return Factored::good;
  auto& [common, symbolic, by_columns_tried] = *ordering_->handle_;
  if (!ordering_->structurally_regular()) return Factored::singular;
  klu_numeric* numeric = klu_factor(writable(p.start), writable(p.row), writable(values), symbolic, &common);
  ++ordering_->counts.factorizations;
  if (numeric != nullptr && common.status == KLU_OK && !by_columns_tried &&
      fill(*numeric) > tolerance::most_fill * expected_fill(*symbolic)) {
    by_columns_tried = true;
    order_by_columns(p, values, common, symbolic, numeric);
  }
  const auto status = common.status;
  const bool regular = numeric != nullptr && status == KLU_OK;
  if (regular) numeric_ = factor_of(numeric, symbolic, &common);
  klu_free_numeric(&numeric, &common);
  if (status == KLU_SINGULAR) singular_column_ = common.singular_col;
  if (!regular) return status == KLU_OUT_OF_MEMORY || status == KLU_TOO_LARGE ? Factored::no_memory : Factored::singular;
  first_pivot_ratio_ = numeric_.pivot_ratio();
  return Factored::good;
}

bool KluFactor::pivots_are_good(const std::vector<double>& values) const {
  if (!(numeric_.growth() >= tolerance::least_growth)) return false;
  if (numeric_.pivot_ratio() >= tolerance::suspicious_ratio * first_pivot_ratio_) return true;
  return numeric_.inverse_norm(ordering_->work_) * norm(ordering_->pattern_, values) <= tolerance::largest_condition;
}

Factored KluFactor::keep(const std::shared_ptr<const Pivots>& pivots, const std::vector<double>& values) {
  if (!pivots) return factor(values);
  const bool done = numeric_.factor(ordering_->pattern_, values, pivots, ordering_->work_);
  ++ordering_->counts.refactorizations;
  return done && pivots_are_good(values) ? Factored::good : factor(values);
}

Factored KluFactor::refactor(const std::vector<double>& values) { return keep(numeric_.pivots(), values); }

Factored KluFactor::refactor_as(const KluFactor& other, const std::vector<double>& values) {
  first_pivot_ratio_ = other.first_pivot_ratio_;
  return keep(other.numeric_.pivots(), values);
}

void KluFactor::solve(double* b, int columns) const {
  const auto n = static_cast<std::size_t>(ordering_->pattern_.size);
  if (n == 0) return;
  for (int j = 0; j < columns; ++j) numeric_.solve(b + static_cast<std::size_t>(j) * n, ordering_->work_);
  ordering_->counts.solves += static_cast<std::uint64_t>(columns);
}

}  // namespace pwlsim::linalg
