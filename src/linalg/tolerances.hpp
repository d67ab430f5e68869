#pragma once

#include <limits>

/// Tolerances of this room. Each says what it is relative to (Of) and why it has that size (Why);
/// docs/developer/tolerances.md is made from these lines by docs/developer/make_tolerances.
namespace pwlsim::linalg::tolerance {

/// Of: the terms of one operation in doubled extended precision.
/// Why: 2^-91, which a machine that emulates the extended format in doubles can also represent.
inline constexpr long double doubled_rounding = std::numeric_limits<long double>::epsilon() * 0x1p-28L;
/// Of: an entry of a refined solution.
/// Why: an entry that the last refinement may have changed by more is zero in exact arithmetic.
inline constexpr long double unsettled_entry = 1e-3L;

/// Of: the largest term of the series of an exponential.
/// Why: a smaller term cannot change the sum in double.
inline constexpr double negligible_term = 1e-18;
/// Of: one, as rate times the difference of two intervals.
/// Why: its square is below rounding, so e^{A dt} is I + A dt.
inline constexpr double same_interval = 1e-8;

/// Of: the largest value of a polynomial.
/// Why: one unit of rounding of double, rounded up.
inline constexpr double series_rounding = 2.3e-16;
/// Of: one, as a step of Newton's method to a Gauss point.
/// Why: below the rounding of extended precision: no further step changes the point.
inline constexpr long double last_root_step = 1e-20L;

/// Of: one, as the last change of an iteration for a dominant subspace.
/// Why: a hundred units of rounding of extended precision: further steps change nothing.
inline constexpr long double converged_subspace = 1e-17L;

/// Of: the largest entry of a column of U, for the largest entry of that column of the matrix.
/// Why: below it the kept pivots have let entries grow by 10^4, and four digits are lost.
inline constexpr double least_growth = 1e-4;
/// Of: the pivot ratio that pivoting reached.
/// Why: below it the condition of kept pivots is estimated before they are used.
inline constexpr double suspicious_ratio = 1e-3;
/// Of: the entries of L and U that an ordering expects with pivots on its diagonal.
/// Why: above it pivots off the diagonal fill the factors, and an ordering that expects them is tried.
inline constexpr double most_fill = 1.5;
/// Of: the entries of L and U in the order before.
/// Why: a solution takes as much longer where few columns depend on each: less than factors save that take others over.
inline constexpr double shallow_fill = 1.5;
/// Of: one, as a condition number.
/// Why: beyond it four digits are left, and the matrix is factored with new pivots.
inline constexpr double largest_condition = 1e12;

}  // namespace pwlsim::linalg::tolerance
