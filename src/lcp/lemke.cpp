#include "lcp/lemke.hpp"

#include <algorithm>
#include <cmath>

#include "lcp/tolerances.hpp"

namespace pwlsim::lcp {

namespace {

using linalg::Matrix;
using linalg::Vector;

template <class Scalar>
struct Tolerance;

template <>
struct Tolerance<double> {
  static constexpr double pivot = tolerance::pivot, tie = tolerance::tie, entry_rounding = tolerance::entry_rounding;
};

template <>
struct Tolerance<linalg::Wide> {
  static constexpr linalg::Wide pivot = tolerance::wide_pivot, tie = tolerance::wide_tie, entry_rounding = tolerance::wide_entry_rounding;
};

/// Tableau of  w − M z − 1·z0 = q.  Columns: w (k), z (k), z0, right-hand side. The w columns hold the basis inverse,
/// which is what the lexicographic rule compares.
template <class Scalar>
class Tableau {
 public:
  using M = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
  using V = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;

  Tableau(const M& m, const V& q, Scalar scale)
      : k_(static_cast<int>(q.size())),
        t_(k_, 2 * k_ + 2),
        rounding_(Tolerance<Scalar>::entry_rounding * (Scalar{1} + m.cwiseAbs().maxCoeff())),
        basic_(k_) {
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
  [[nodiscard]] Scalar rhs(int row) const { return t_(row, right()); }
  [[nodiscard]] static int complement(int variable, int k) { return variable < k ? variable + k : variable - k; }

  /// Row of the lexicographic minimum ratio for the entering column; −1: none (a ray). z0 leaves whenever it is tied.
  [[nodiscard]] int leaving_row(int column) const {
    std::vector<int> rows;
    for (int i = 0; i < k_; ++i)
      if (t_(i, column) > Tolerance<Scalar>::pivot) rows.push_back(i);
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
    Scalar smallest = INFINITY;
    for (const int row : rows) smallest = std::min(smallest, t_(row, numerator) / t_(row, column));
    std::erase_if(rows, [&](int row) {
      const Scalar entry = t_(row, column);
      const Scalar size = numerator == right() ? std::min(size_[row], entry) : entry;
      const Scalar tie = Tolerance<Scalar>::tie * (size + std::abs(smallest) * entry) + rounding_ * std::abs(smallest);
      return t_(row, numerator) > smallest * entry + tie;
    });
  }

  int k_;
  Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> t_;
  V size_;           ///< of what each right-hand side is a sum of, at most
  Scalar rounding_;  ///< of an entry
  std::vector<int> basic_;
};

template <class Scalar>
void read_off(const Tableau<Scalar>& tableau, int k, Scalar scale, Solution& solution) {
  for (int row = 0; row < k; ++row) {
    const int variable = tableau.basic(row);
    const auto value = static_cast<double>(tableau.rhs(row) * scale);
    if (variable < k) solution.w[variable] = value;
    if (variable >= k && variable < 2 * k) {
      solution.z[variable - k] = value;
      solution.basis.push_back(variable - k);
    }
  }
  std::sort(solution.basis.begin(), solution.basis.end());
}

template <class Scalar>
Solution solution_of(const Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>& m, const Eigen::Matrix<Scalar, Eigen::Dynamic, 1>& q) {
  const int k = static_cast<int>(q.size());
  Solution solution{Status::solved, Vector::Zero(k), q.template cast<double>(), {}, 0};
  const Scalar scale = k == 0 ? Scalar{0} : q.cwiseAbs().maxCoeff();
  if (scale == 0 || q.minCoeff() >= 0) return solution;
  solution.w.setZero();

  Tableau<Scalar> tableau(m, q, scale);
  int row = tableau.first_row();
  int leaving = tableau.basic(row);
  tableau.pivot(row, tableau.artificial());
  solution.pivots = 1;
  const int limit = 50 * k + 100;
  while (leaving != tableau.artificial()) {
    const int entering = Tableau<Scalar>::complement(leaving, k);
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

}  // namespace

Solution lemke(const Matrix& m, const Vector& q) { return solution_of<double>(m, q); }

Solution lemke_wide(const linalg::WideMatrix& m, const linalg::WideVector& q) { return solution_of<linalg::Wide>(m, q); }

}  // namespace pwlsim::lcp
