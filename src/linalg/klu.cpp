#include "linalg/klu.hpp"

#include <klu.h>

#include <utility>

namespace pwlsim::linalg {

namespace {

/// Largest entry of a column over the largest of U: below this the kept pivots have let the entries grow.
constexpr double least_growth = 1e-4;
/// A pivot ratio below this part of what pivoting reached is looked into; beyond that condition it is factored anew.
constexpr double suspicious_ratio = 1e-3;
constexpr double largest_condition = 1e12;

int* writable(const std::vector<int>& v) { return const_cast<int*>(v.data()); }           // KLU takes no const, and writes nothing
double* writable(const std::vector<double>& v) { return const_cast<double*>(v.data()); }  // likewise

}  // namespace

struct KluOrdering::Handle {
  klu_common common{};
  klu_symbolic* symbolic = nullptr;
};

KluOrdering::KluOrdering(SparsePattern pattern) : pattern_(std::move(pattern)), handle_(std::make_unique<Handle>()) {
  klu_defaults(&handle_->common);
  if (pattern_.size > 0) handle_->symbolic = klu_analyze(pattern_.size, writable(pattern_.start), writable(pattern_.row), &handle_->common);
}

KluOrdering::~KluOrdering() { klu_free_symbolic(&handle_->symbolic, &handle_->common); }

bool KluOrdering::structurally_regular() const {
  return pattern_.size == 0 || (handle_->symbolic != nullptr && handle_->symbolic->structural_rank == pattern_.size);
}

struct KluFactor::Numeric {
  klu_numeric* numeric = nullptr;
};

KluFactor::KluFactor(const KluOrdering& ordering) : ordering_(&ordering), numeric_(std::make_unique<Numeric>()) {}

KluFactor::~KluFactor() {
  if (numeric_) klu_free_numeric(&numeric_->numeric, &ordering_->handle_->common);
}

KluFactor::KluFactor(KluFactor&&) noexcept = default;

KluFactor& KluFactor::operator=(KluFactor&& other) noexcept {
  std::swap(ordering_, other.ordering_);
  std::swap(numeric_, other.numeric_);
  pivot_ratio_ = other.pivot_ratio_;
  first_pivot_ratio_ = other.first_pivot_ratio_;
  singular_column_ = other.singular_column_;
  return *this;
}

Factored KluFactor::factor(const std::vector<double>& values) {
  singular_column_ = -1;
  if (ordering_->pattern_.size == 0) return Factored::good;
  auto& [common, symbolic] = *ordering_->handle_;
  if (!ordering_->structurally_regular()) return Factored::singular;
  klu_free_numeric(&numeric_->numeric, &common);
  const SparsePattern& p = ordering_->pattern_;
  numeric_->numeric = klu_factor(writable(p.start), writable(p.row), writable(values), symbolic, &common);
  ++ordering_->counts.factorizations;
  if (numeric_->numeric != nullptr && common.status == KLU_OK) {
    klu_rcond(symbolic, numeric_->numeric, &common);
    pivot_ratio_ = first_pivot_ratio_ = common.rcond;
    return Factored::good;
  }
  if (common.status == KLU_SINGULAR) singular_column_ = common.singular_col;
  const bool memory = common.status == KLU_OUT_OF_MEMORY || common.status == KLU_TOO_LARGE;
  klu_free_numeric(&numeric_->numeric, &common);
  return memory ? Factored::no_memory : Factored::singular;
}

bool KluFactor::pivots_are_good(const std::vector<double>& values) {
  auto& [common, symbolic] = *ordering_->handle_;
  const SparsePattern& p = ordering_->pattern_;
  if (klu_rgrowth(writable(p.start), writable(p.row), writable(values), symbolic, numeric_->numeric, &common) == 0) return false;
  if (!(common.rgrowth >= least_growth)) return false;
  if (klu_rcond(symbolic, numeric_->numeric, &common) == 0) return false;
  pivot_ratio_ = common.rcond;
  if (pivot_ratio_ >= suspicious_ratio * first_pivot_ratio_) return true;
  if (klu_condest(writable(p.start), writable(values), symbolic, numeric_->numeric, &common) == 0) return false;
  return common.condest <= largest_condition;
}

Factored KluFactor::refactor(const std::vector<double>& values) {
  if (ordering_->pattern_.size == 0 || numeric_->numeric == nullptr) return factor(values);
  auto& [common, symbolic] = *ordering_->handle_;
  const SparsePattern& p = ordering_->pattern_;
  const int done = klu_refactor(writable(p.start), writable(p.row), writable(values), symbolic, numeric_->numeric, &common);
  ++ordering_->counts.refactorizations;
  if (done != 0 && common.status == KLU_OK && pivots_are_good(values)) return Factored::good;
  return factor(values);
}

void KluFactor::solve(double* b, int columns) const {
  if (ordering_->pattern_.size == 0 || columns == 0) return;
  auto& [common, symbolic] = *ordering_->handle_;
  klu_solve(symbolic, numeric_->numeric, symbolic->n, columns, b, &common);
  ordering_->counts.solves += static_cast<std::uint64_t>(columns);
}

std::size_t KluFactor::entries() const {
  if (numeric_->numeric == nullptr) return 0;
  return static_cast<std::size_t>(numeric_->numeric->lnz) + static_cast<std::size_t>(numeric_->numeric->unz);
}

}  // namespace pwlsim::linalg
