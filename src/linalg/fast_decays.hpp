#pragma once
/// Motions of x' = A x that are plain decays far faster than the rest, and what an iteration for dominant subspaces tells of them (Golub & Van Loan, Matrix Computations, §7.3).

#include <complex>
#include <optional>
#include <vector>

#include "linalg/dense.hpp"

namespace pwlsim::linalg {

/// Ratio of neighbouring rates that tells two motions apart.
inline constexpr double gap_of_motions = 1e2;
/// Of a plain decay, −Re λ/|λ| is more.
inline constexpr double least_damping = 0.999;

/// Eigenvalues, 1/s, the fastest first.
using Rates = std::vector<std::complex<double>>;

/// None where they cannot be computed.
[[nodiscard]] Rates rates_by_speed(const Matrix& a);

/// How many of the motions are such decays (none: no cut), and the rates on both sides of the cut, 1/s.
struct Cut {
  Eigen::Index fast = 0;
  double slow_rate = 0.0, fast_rate = 0.0, fastest_rate = 0.0;
};

/// The cut with the slowest decays whose time constant is at most `longest`, s. `other`: a rate that is there beside those, 1/s.
[[nodiscard]] Cut find_cut(const Rates& rates, double longest, double other);

/// All cuts whose gap is wider than `ratio`, the fastest first.
[[nodiscard]] std::vector<Cut> find_cuts(const Rates& rates, double longest, double other, double ratio = gap_of_motions);

/// Orthonormal basis of the columns' span, by Gram and Schmidt's method, twice (Giraud, Langou, Rozložník, Comput. Math. Appl. 50 (2005)). A column that depends on those before it becomes zero.
[[nodiscard]] WideMatrix orthonormal(WideMatrix m);

/// The columns of m that are furthest from each other's span, in turn, as a basis with rounding.
[[nodiscard]] WideMatrix leading_columns(WideMatrix m, Eigen::Index count);

/// Orthonormal basis of what is orthogonal to independent columns, by Householder's reflections (Golub & Van Loan, Matrix Computations, §5.1, 5.2): Q's last columns.
[[nodiscard]] WideMatrix complement(WideMatrix m);

/// Orthonormal basis of what repeated application of S turns everything to. `start`: S on vectors that have no part in what S², or a higher power of it, takes to zero.
[[nodiscard]] WideMatrix dominant_subspace(const WideMatrix& s, WideMatrix start, Eigen::Index dimension);

/// x = fast·φ + what is slow, φ = coordinates·x.
struct FastPart {
  Matrix fast;           ///< orthonormal columns
  Matrix coordinates;    ///< a row for each
  double slowest = 0.0;  ///< rate of them, 1/s
};

/// The same in extended precision.
struct WideFastPart {
  WideMatrix fast, coordinates;
};

/// Of the `count` fastest motions. None where they are not told apart.
[[nodiscard]] std::optional<WideFastPart> fast_part(const Matrix& a, Eigen::Index count);

/// `rates`: those of A. None where it has no such decays, whatever their time constants.
[[nodiscard]] std::optional<FastPart> fast_part(const Matrix& a, const Rates& rates);

}  // namespace pwlsim::linalg
