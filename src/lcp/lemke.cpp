#include "lcp/lemke.hpp"

#include <algorithm>
#include <cmath>

namespace pwlsim::lcp {

namespace {

using linalg::Matrix;
using linalg::Vector;

constexpr double pivot_tolerance = 1e-11;
constexpr double tie_tolerance = 1e-12;
/// What pivots leave of an entry that is a difference, in units of the largest entry of M: small entries of a column make large ratios of it.
constexpr double entry_rounding = 1e-15;

/// Tableau of  w − M z − 1·z0 = q.  Columns: w (k), z (k), z0, right-hand side. The w columns hold the basis inverse,
/// which is what the lexicographic rule compares.
class Tableau {
 public:
  Tableau(const Matrix& m, const Vector& q, double scale)
      : k_(static_cast<int>(q.size())), t_(k_, 2 * k_ + 2), rounding_(entry_rounding * (1.0 + m.cwiseAbs().maxCoeff())), basic_(k_) {
    t_.leftCols(k_).setIdentity();
    t_.middleCols(k_, k_) = -m;
    t_.col(2 * k_).setConstant(-1.0);
    t_.col(2 * k_ + 1) = q / scale;
    size_ = t_.col(2 * k_ + 1).cwiseAbs();
    for (int i = 0; i < k_; ++i) basic_[i] = i;
  }

  [[nodiscard]] int artificial() const { return 2 * k_; }
  [[nodiscard]] int right() const { return 2 * k_ + 1; }
  [[nodiscard]] int basic(int row) const { return basic_[row]; }
  [[nodiscard]] double rhs(int row) const { return t_(row, right()); }
  [[nodiscard]] static int complement(int variable, int k) { return variable < k ? variable + k : variable - k; }

  /// Row of the lexicographic minimum ratio for the entering column; −1: none (a ray). z0 leaves whenever it is tied.
  [[nodiscard]] int leaving_row(int column) const {
    std::vector<int> rows;
    for (int i = 0; i < k_; ++i)
      if (t_(i, column) > pivot_tolerance) rows.push_back(i);
    if (rows.empty()) return -1;
    keep_smallest(rows, right(), column);
    for (const int row : rows)
      if (basic_[row] == artificial()) return row;
    for (int c = 0; c < k_ && rows.size() > 1; ++c) keep_smallest(rows, c, column);
    return rows.front();
  }

  /// First pivot: the row with the lexicographically least (q, I).
  [[nodiscard]] int first_row() const {
    int best = 0;
    for (int i = 1; i < k_; ++i)
      if (rhs(i) <= rhs(best)) best = i;
    return best;
  }

  void pivot(int row, int column) {
    size_[row] /= std::abs(t_(row, column));
    t_.row(row) /= t_(row, column);
    for (int i = 0; i < k_; ++i) {
      if (i == row || t_(i, column) == 0.0) continue;
      size_[i] += std::abs(t_(i, column)) * size_[row];
      t_.row(i) -= t_(i, column) * t_.row(row);
    }
    basic_[row] = column;
  }

 private:
  void keep_smallest(std::vector<int>& rows, int numerator, int column) const {
    double smallest = INFINITY;
    for (const int row : rows) smallest = std::min(smallest, t_(row, numerator) / t_(row, column));
    std::erase_if(rows, [&](int row) {
      const double entry = t_(row, column);
      const double size = numerator == right() ? std::min(size_[row], entry) : entry;
      const double tie = tie_tolerance * (size + std::abs(smallest) * entry) + rounding_ * std::abs(smallest);
      return t_(row, numerator) > smallest * entry + tie;
    });
  }

  int k_;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> t_;
  Vector size_;      ///< of what each right-hand side is a sum of, at most
  double rounding_;  ///< of an entry
  std::vector<int> basic_;
};

void read_off(const Tableau& tableau, int k, double scale, Solution& solution) {
  for (int row = 0; row < k; ++row) {
    const int variable = tableau.basic(row);
    const double value = tableau.rhs(row) * scale;
    if (variable < k) solution.w[variable] = value;
    if (variable >= k && variable < 2 * k) {
      solution.z[variable - k] = value;
      solution.basis.push_back(variable - k);
    }
  }
  std::sort(solution.basis.begin(), solution.basis.end());
}

}  // namespace

Solution lemke(const Matrix& m, const Vector& q) {
  const int k = static_cast<int>(q.size());
  Solution solution{Status::solved, Vector::Zero(k), q, {}, 0};
  const double scale = k == 0 ? 0.0 : q.cwiseAbs().maxCoeff();
  if (scale == 0.0 || q.minCoeff() >= 0.0) return solution;
  solution.w.setZero();

  Tableau tableau(m, q, scale);
  int row = tableau.first_row();
  int leaving = tableau.basic(row);
  tableau.pivot(row, tableau.artificial());
  solution.pivots = 1;
  const int limit = 50 * k + 100;
  while (leaving != tableau.artificial()) {
    const int entering = Tableau::complement(leaving, k);
    row = tableau.leaving_row(entering);
    if (row < 0 || solution.pivots > limit) {
      solution.status = row < 0 ? Status::ray : Status::pivot_limit;
      return solution;
    }
    leaving = tableau.basic(row);
    tableau.pivot(row, entering);
    ++solution.pivots;
  }
  read_off(tableau, k, scale, solution);
  return solution;
}

}  // namespace pwlsim::lcp
