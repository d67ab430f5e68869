#include "linalg/dense.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <type_traits>
#include <vector>

#include "linalg/columns.hpp"
#include "linalg/factorisations.hpp"
#include "linalg/small.hpp"

namespace pwlsim::linalg {

namespace {

using FullSvd = Eigen::JacobiSVD<Matrix, Eigen::FullPivHouseholderQRPreconditioner>;

Eigen::Index numerical_rank(const Vector& singular_values, double tolerance, double scale) {
  if (singular_values.size() == 0) return 0;
  const double threshold = tolerance * (scale > 0.0 ? scale : singular_values[0]);
  Eigen::Index rank = 0;
  while (rank < singular_values.size() && singular_values[rank] > threshold) ++rank;
  return rank;
}

template <class M, class Tolerance>
void clean(M& m, const M& bound, Tolerance tolerance) {
  for (Eigen::Index j = 0; j < m.cols(); ++j)
    for (Eigen::Index i = 0; i < m.rows(); ++i)
      if (std::abs(m(i, j)) <= tolerance * bound(i, j)) m(i, j) = 0;
}

/// Larger left factors are read by rows, which then lie together in memory.
constexpr Eigen::Index read_as_it_is = 256;  ///< entries

/// Where rows of X begin, and how far their entries lie apart.
template <class M>
class Rows {
 public:
  explicit Rows(const M& x) : start_(x.data()), between_rows_(1), between_entries_(x.rows()) {
    if (x.size() <= read_as_it_is) return;
    transposed_ = x.transpose();
    start_ = transposed_.data();
    between_rows_ = x.cols();
    between_entries_ = 1;
  }
  const typename M::Scalar* row(Eigen::Index i) const { return start_ + i * between_rows_; }
  Eigen::Index step() const { return between_entries_; }

 private:
  M transposed_;
  const typename M::Scalar* start_;
  Eigen::Index between_rows_, between_entries_;
};

/// work(i, count) with a constant count, for the rows i … i + count − 1: sums of several rows do not wait for each other's additions.
template <int most, class Work>
void for_rows(Eigen::Index rows, const Work& work) {
  Eigen::Index i = 0;
  for (; i + most <= rows; i += most) work(i, std::integral_constant<int, most>{});
  for (; i < rows; ++i) work(i, std::integral_constant<int, 1>{});
}

/// B + X·Y, cleaned. Entry by entry, so that sums of extended precision stay in registers: storing one costs as much as four additions.
template <class M, class Scalar>
M clean_sum_of(M base, const M& x, const M& y, Scalar tolerance) {
  const Eigen::Index rows = base.rows();
  const Rows<M> left(x);
  const Eigen::Index step = left.step();
  std::vector<Eigen::Index> used;
  used.reserve(static_cast<std::size_t>(x.cols()));
  for (Eigen::Index j = 0; j < base.cols(); ++j) {
    const Scalar* factors = y.data() + j * y.rows();
    Scalar* column = base.data() + j * rows;
    used.clear();
    for (Eigen::Index k = 0; k < x.cols(); ++k)
      if (factors[k] != 0) used.push_back(k);
    if (used.empty()) continue;
    for_rows<2>(rows, [&](Eigen::Index i, auto count) {
      std::array<Scalar, count> sum, bound;
      std::array<const Scalar*, count> row;
      for (int r = 0; r < count; ++r) {
        sum[r] = column[i + r];
        bound[r] = std::abs(sum[r]);
        row[r] = left.row(i + r);
      }
      for (const Eigen::Index k : used)
        for (int r = 0; r < count; ++r) {
          const Scalar term = row[r][k * step] * factors[k];
          sum[r] += term;
          bound[r] += std::abs(term);
        }
      for (int r = 0; r < count; ++r) column[i + r] = std::abs(sum[r]) <= tolerance * bound[r] ? 0 : sum[r];
    });
  }
  return base;
}

constexpr auto itself = [](Wide value) { return value; };
constexpr auto magnitude = [](Wide value) { return std::abs(value); };

/// f(X)·f(Y), f entry by entry.
template <class Function>
WideMatrix product_of(const WideMatrix& x, const WideMatrix& y, Function f) {
  const Eigen::Index rows = x.rows();
  const Eigen::Index inner = x.cols();
  const Rows<WideMatrix> left(x);
  const Eigen::Index step = left.step();
  WideMatrix result(rows, y.cols());
  for (Eigen::Index j = 0; j < y.cols(); ++j) {
    const Wide* factors = y.data() + j * inner;
    for_rows<4>(rows, [&](Eigen::Index i, auto count) {
      std::array<Wide, count> sum{};
      std::array<const Wide*, count> row;
      for (int r = 0; r < count; ++r) row[r] = left.row(i + r);
      for (Eigen::Index k = 0; k < inner; ++k)
        for (int r = 0; r < count; ++r) sum[r] += f(row[r][k * step]) * f(factors[k]);
      for (int r = 0; r < count; ++r) result(i + r, j) = sum[r];
    });
  }
  return result;
}

/// The same, f(0) = 0, by the entries of X and Y that are not zero.
template <class Function>
WideMatrix sparse_product_of(const WideMatrix& x, const WideMatrix& y, Function f) {
  std::vector<Eigen::Index> row, first;  ///< of the entries of X, column by column
  for (Eigen::Index k = 0; k < x.cols(); ++k) {
    first.push_back(static_cast<Eigen::Index>(row.size()));
    for (Eigen::Index i = 0; i < x.rows(); ++i)
      if (x(i, k) != 0) row.push_back(i);
  }
  first.push_back(static_cast<Eigen::Index>(row.size()));
  WideMatrix result = WideMatrix::Zero(x.rows(), y.cols());
  for (Eigen::Index j = 0; j < y.cols(); ++j)
    for (Eigen::Index k = 0; k < x.cols(); ++k) {
      if (y(k, j) == 0) continue;
      const Wide factor = f(y(k, j));
      for (Eigen::Index entry = first[static_cast<std::size_t>(k)]; entry < first[static_cast<std::size_t>(k) + 1]; ++entry) {
        const Eigen::Index i = row[static_cast<std::size_t>(entry)];
        result(i, j) += f(x(i, k)) * factor;
      }
    }
  return result;
}

Eigen::Index rank_of(Eigen::ColPivHouseholderQR<WideMatrix>& qr, double tolerance, double scale) {
  if (!(qr.maxPivot() > 0)) return 0;
  qr.setThreshold(scale > 0.0 ? tolerance * scale / qr.maxPivot() : static_cast<Wide>(tolerance));
  return qr.rank();
}

/// sum += M x.
template <int rows>
void add_product(const Matrix& m, const double* x, Small<rows>& sum) {
  const double* a = m.data();
  const Eigen::Index columns = m.cols();
  for (Eigen::Index j = 0; j < columns; ++j, a += rows) sum.add_multiple(a, x[j]);
}

/// Of a symmetric tridiagonal matrix: x is above all eigenvalues where all pivots of x − T are positive. Halving by as much as there are digits.
double largest_eigenvalue(const Vector& diagonal, const Vector& beside) {
  const Eigen::Index n = diagonal.size();
  const auto side = [&](Eigen::Index i) { return i >= 0 && i + 1 < n ? std::abs(beside[i]) : 0.0; };
  double low = diagonal.maxCoeff(), high = low;
  for (Eigen::Index i = 0; i < n; ++i) high = std::max(high, diagonal[i] + side(i - 1) + side(i));
  const auto is_above = [&](double x) {
    double pivot = x - diagonal[0];
    for (Eigen::Index i = 1; i < n && pivot > 0.0; ++i) pivot = x - diagonal[i] - beside[i - 1] * beside[i - 1] / pivot;
    return pivot > 0.0;
  };
  for (int i = 0; i < std::numeric_limits<double>::digits; ++i) {
    const double middle = 0.5 * (low + high);
    (is_above(middle) ? high : low) = middle;
  }
  return high;
}

}  // namespace

void copy(const double* x, Eigen::Index n, double* y) {
  const bool small = with_length(n, [&]<int length>(Length<length>) { Small<length>::load(x).store(y); });
  if (!small) std::copy_n(x, n, y);
}

void multiply(const Matrix& m, const double* x, double* y) {
  const bool small = with_length(m.rows(), [&]<int rows>(Length<rows>) {
    Small<rows> sum;
    add_product(m, x, sum);
    sum.store(y);
  });
  if (small) return;
  std::fill(y, y + m.rows(), 0.0);
  add_product(first_columns(m, m.cols()), x, y);
}

void multiply_sparse(const Matrix& m, const double* x, Vector& rows) {
  rows.setZero();
  for (Eigen::Index j = 0; j < m.cols(); ++j)
    if (x[j] != 0.0) rows += m.col(j).head(rows.size()) * x[j];
}

void multiply_two(const Matrix& m, const double* x, const Matrix& n, const double* y, double* z) {
  const bool small = with_length(m.rows(), [&]<int rows>(Length<rows>) {
    Small<rows> sum;
    add_product(m, x, sum);
    add_product(n, y, sum);
    sum.store(z);
  });
  if (small) return;
  multiply(m, x, z);
  add_product(first_columns(n, n.cols()), y, z);
}

void multiply_repeatedly(const Matrix& a, int k, double* powers) {
  const Eigen::Index n = a.rows();
  const bool small = with_length(n, [&]<int length>(Length<length>) {
    auto power = Small<length>::load(powers);
    for (int i = 1; i <= k; ++i) {
      power = linalg::product(a.data(), power);
      power.store(powers + i * length);
    }
  });
  if (small) return;
  for (int i = 0; i < k; ++i) multiply(a, powers + i * n, powers + (i + 1) * n);
}

WideMatrix rows_of(const WideMatrix& m, const std::vector<int>& numbers) {
  WideMatrix result(static_cast<Eigen::Index>(numbers.size()), m.cols());
  for (Eigen::Index j = 0; j < m.cols(); ++j)
    for (std::size_t i = 0; i < numbers.size(); ++i) result(static_cast<Eigen::Index>(i), j) = m(numbers[i], j);
  return result;
}

WideMatrix columns_of(const WideMatrix& m, const std::vector<int>& numbers) {
  WideMatrix result(m.rows(), static_cast<Eigen::Index>(numbers.size()));
  for (std::size_t j = 0; j < numbers.size(); ++j) result.col(static_cast<Eigen::Index>(j)) = m.col(numbers[j]);
  return result;
}

double append_to_hessenberg(const Eigen::Ref<const Matrix>& basis, Vector& x, Matrix& h) {
  const Eigen::Index j = basis.cols();
  const DenseColumns columns = first_columns(basis, j);
  Vector taken = Vector::Zero(j);
  for (int sweep = 0; sweep < 2; ++sweep) {
    Vector more = Vector::Zero(j);
    add_transposed_product(columns, x.data(), more.data());
    taken += more;
    more = -more;
    add_product(columns, more.data(), x.data());
  }
  const double norm = x.norm();
  h.conservativeResize(j + 1, j);
  h.row(j).setZero();
  h.col(j - 1).head(j) = taken;
  h(j, j - 1) = norm;
  return norm;
}

WideMatrix product(const WideMatrix& x, const WideMatrix& y) { return product_of(x, y, itself); }

WideMatrix absolute_product(const WideMatrix& x, const WideMatrix& y) { return product_of(x, y, magnitude); }

WideMatrix sparse_product(const WideMatrix& x, const WideMatrix& y) { return sparse_product_of(x, y, itself); }

WideMatrix sparse_absolute_product(const WideMatrix& x, const WideMatrix& y) { return sparse_product_of(x, y, magnitude); }

Matrix cleaned(Matrix m, const Matrix& bound) {
  clean(m, bound, clean_tolerance);
  return m;
}

Matrix clean_sum(Matrix base, const Matrix& x, const Matrix& y) { return clean_sum_of(std::move(base), x, y, clean_tolerance); }

Matrix clean_product(const Matrix& x, const Matrix& y) { return clean_sum(Matrix::Zero(x.rows(), y.cols()), x, y); }

WideMatrix wide_clean_sum(WideMatrix base, const WideMatrix& x, const WideMatrix& y) {
  return clean_sum_of(std::move(base), x, y, wide_clean_tolerance);
}

WideMatrix wide_cleaned(WideMatrix m, const WideMatrix& bound) {
  clean(m, bound, wide_clean_tolerance);
  return m;
}

WideMatrix wide_clean_product(const WideMatrix& x, const WideMatrix& y) {
  return wide_clean_sum(WideMatrix::Zero(x.rows(), y.cols()), x, y);
}

Matrix null_space(const Matrix& m, double tolerance, double scale) {
  if (m.cols() == 0) return Matrix(0, 0);
  if (m.rows() == 0) return Matrix::Identity(m.cols(), m.cols());
  const FullSvd svd(m, Eigen::ComputeFullV);
  const Eigen::Index rank = numerical_rank(svd.singularValues(), tolerance, scale);
  return svd.matrixV().rightCols(m.cols() - rank);
}

// In extended precision by factorisations that end after a fixed number of steps on any machine, where a singular value decomposition
// iterates until its precision is reached.
WideMatrix wide_null_space(const WideMatrix& m, double tolerance, double scale) {
  if (m.cols() == 0) return WideMatrix(0, 0);
  if (m.rows() == 0) return WideMatrix::Identity(m.cols(), m.cols());
  Eigen::ColPivHouseholderQR<WideMatrix> qr(m.transpose());
  const Eigen::Index rank = rank_of(qr, tolerance, scale);
  return (qr.householderQ() * WideMatrix::Identity(m.cols(), m.cols())).rightCols(m.cols() - rank);
}

WideMatrix wide_range_space(const WideMatrix& m, double tolerance, double scale) {
  if (m.cols() == 0 || m.rows() == 0) return WideMatrix(m.rows(), 0);
  Eigen::ColPivHouseholderQR<WideMatrix> qr(m);
  const Eigen::Index rank = rank_of(qr, tolerance, scale);
  return qr.householderQ() * WideMatrix::Identity(m.rows(), rank);
}

WideVector wide_least_squares(const WideMatrix& m, const WideVector& b) { return Eigen::ColPivHouseholderQR<WideMatrix>(m).solve(b); }

WideMatrix wide_pseudo_inverse(const WideMatrix& m, double tolerance) {
  if (m.cols() == 0 || m.rows() == 0) return WideMatrix::Zero(m.cols(), m.rows());
  Eigen::CompleteOrthogonalDecomposition<WideMatrix> decomposition;
  decomposition.setThreshold(tolerance);
  decomposition.compute(m);
  return decomposition.pseudoInverse();
}

double spectral_norm(const Matrix& m) {
  if (m.size() == 0) return 0.0;
  const Matrix gram = m.rows() < m.cols() ? Matrix(m * m.transpose()) : Matrix(m.transpose() * m);
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(gram, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, eigen.eigenvalues()[gram.rows() - 1]));
}

double rate_of(const Matrix& a) {
  const double norm = spectral_norm(a);
  return norm > 0.0 ? norm : 1.0;
}

double logarithmic_norm(const Matrix& m) {
  if (m.size() == 0) return 0.0;
  const Eigen::Tridiagonalization<Matrix> tridiagonal(0.5 * (m + m.transpose()));
  return largest_eigenvalue(tridiagonal.diagonal(), tridiagonal.subDiagonal());
}

}  // namespace pwlsim::linalg
