#include "linalg/fast_decays.hpp"

#include <algorithm>
#include <cmath>

#include "linalg/elimination.hpp"
#include "linalg/factorisations.hpp"
#include "linalg/tolerances.hpp"

namespace pwlsim::linalg {

namespace {

using Eigen::Index;

/// Ratio of neighbouring rates that makes a cut, and where none is as large. At a hundred, what the slow motion does while the decays last hides an event (a boost rectifier's
/// diode, from rest); where decays are only told apart in what is followed as a whole, less is enough.
constexpr double gap = 1e4, least_gap = 1e3;
constexpr int most_turns_of_subspace = 32;
/// Before a change that does not shrink to `least_progress` counts as rounding: a gap of thirty makes it a quarter of the last.
constexpr int fewest_turns_of_subspace = 3;
constexpr Wide least_progress = 0.5L;

template <class Visit>
void for_each_cut(const Rates& rates, double longest, double other, double ratio, Visit visit) {
  for (std::size_t i = 0; i < rates.size(); ++i) {
    const double rate = std::abs(rates[i]);
    if (!(rate * longest > 1.0) || !(-rates[i].real() > least_damping * rate)) break;
    const double next = std::max(i + 1 < rates.size() ? std::abs(rates[i + 1]) : 0.0, other);
    if (rate > ratio * next) visit(Cut{static_cast<Index>(i) + 1, next, rate, std::abs(rates.front())});
  }
}

Cut cut_at(const Rates& rates, double longest, double other, double ratio) {
  Cut last;
  for_each_cut(rates, longest, other, ratio, [&](const Cut& cut) { last = cut; });
  return last;
}

}  // namespace

Rates rates_by_speed(const Matrix& a) {
  const Eigen::EigenSolver<Matrix> solver(a, false);
  if (solver.info() != Eigen::Success) return {};
  Rates rates(solver.eigenvalues().begin(), solver.eigenvalues().end());
  std::sort(rates.begin(), rates.end(), [](const auto& x, const auto& y) { return std::abs(x) > std::abs(y); });
  return rates;
}

Cut find_cut(const Rates& rates, double longest, double other) {
  const Cut cut = cut_at(rates, longest, other, gap);
  return cut.fast > 0 ? cut : cut_at(rates, longest, other, least_gap);
}

std::vector<Cut> find_cuts(const Rates& rates, double longest, double other, double ratio) {
  std::vector<Cut> cuts;
  for_each_cut(rates, longest, other, ratio, [&](const Cut& cut) { cuts.push_back(cut); });
  return cuts;
}

WideMatrix orthonormal(WideMatrix m) {
  for (Index j = 0; j < m.cols(); ++j) {
    auto column = m.col(j);
    for (int round = 0; round < 2; ++round)
      for (Index i = 0; i < j; ++i) column -= m.col(i).dot(column) * m.col(i);
    const Wide norm = column.norm();
    if (norm > 0) column /= norm;
  }
  return m;
}

WideMatrix leading_columns(WideMatrix m, Index count) {
  for (Index j = 0; j < count; ++j) {
    Index longest = 0;
    const Wide norm = std::sqrt(m.rightCols(m.cols() - j).colwise().squaredNorm().maxCoeff(&longest));
    if (!(norm > 0)) break;
    m.col(j).swap(m.col(j + longest));
    m.col(j) /= norm;
    for (Index i = j + 1; i < m.cols(); ++i) m.col(i) -= m.col(j).dot(m.col(i)) * m.col(j);
  }
  return m.leftCols(count);
}

WideMatrix complement(WideMatrix m) {
  const Index n = m.rows(), k = m.cols();
  WideVector twice(k);  // 2/vᵀv of each reflection, whose v stands below the diagonal of m
  for (Index j = 0; j < k; ++j) {
    auto v = m.col(j).tail(n - j);
    const Wide norm = v.norm();
    v[0] += v[0] < 0 ? -norm : norm;
    const Wide square = v.squaredNorm();
    twice[j] = square > 0 ? 2 / square : 0;
    for (Index i = j + 1; i < k; ++i) m.col(i).tail(n - j) -= twice[j] * v.dot(m.col(i).tail(n - j)) * v;
  }
  WideMatrix basis = WideMatrix::Identity(n, n).rightCols(n - k);
  for (Index j = k; j-- > 0;) {
    const auto v = m.col(j).tail(n - j);
    for (Index i = 0; i < n - k; ++i) basis.col(i).tail(n - j) -= twice[j] * v.dot(basis.col(i).tail(n - j)) * v;
  }
  return basis;
}

WideMatrix dominant_subspace(const WideMatrix& s, WideMatrix start, Index dimension) {
  if (dimension == 0) return WideMatrix(s.rows(), 0);
  WideMatrix basis = orthonormal(leading_columns(std::move(start), dimension));
  Wide last = INFINITY;
  for (int k = 0; k < most_turns_of_subspace; ++k) {
    WideMatrix next = orthonormal(product(s, basis));
    const Wide change = (next - product(basis, product(basis.transpose(), next))).norm();
    basis = std::move(next);
    if (change <= tolerance::converged_subspace || (k >= fewest_turns_of_subspace && change > least_progress * last)) break;
    last = change;
  }
  return basis;
}

std::optional<FastPart> fast_part(const Matrix& a, const Rates& rates) {
  if (rates.empty()) return std::nullopt;
  const double slowest = std::abs(rates.back());
  Cut cut = find_cut(rates, INFINITY, slowest);
  if (cut.fast == 0) cut = cut_at(rates, INFINITY, slowest, gap_of_motions);
  const std::optional<WideFastPart> part = fast_part(a, cut.fast);
  if (!part) return std::nullopt;
  return FastPart{part->fast.cast<double>(), part->coordinates.cast<double>(), cut.fast_rate};
}

std::optional<WideFastPart> fast_part(const Matrix& a, Index count) {
  if (count == 0) return std::nullopt;
  const WideMatrix wide = a.cast<Wide>(), transposed = wide.transpose();
  const WideMatrix fast = dominant_subspace(wide, wide, count), of_rows = dominant_subspace(transposed, transposed, count);
  const WideElimination between(product(of_rows.transpose(), fast), 0);
  if (between.rank() < count) return std::nullopt;
  return WideFastPart{fast, between.solve(of_rows.transpose())};
}

}  // namespace pwlsim::linalg
