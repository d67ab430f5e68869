#pragma once

/// Tolerances of this room. Each says what it is relative to (Of) and why it has that size (Why);
/// docs/developer/tolerances.md is made from these lines by docs/developer/make_tolerances.
namespace pwlsim::lcp::tolerance {

/// Of: the largest entry of its kind (q', w or z).
/// Why: some thousand roundings of double: a negative entry of smaller magnitude counts as zero.
inline constexpr double sign = 1e-12;
/// Of: the largest entry of z.
/// Why: some hundred roundings of double, after a solution with a regular basis.
inline constexpr double rounding_of_largest = 1e-13;
/// Of: a problem whose diagonal is about one.
/// Why: the square root of rounding: it makes degenerate problems solvable, and the answer is assessed without it.
inline constexpr double regularisation = 1e-8;

/// Of: the largest entry of the tableau in double, Lemke's method and principal pivoting.
/// Why: rounding of a tableau after some ten exchanges; a smaller pivot is zero.
inline constexpr double pivot = 1e-11;
/// Of: the ratios that are compared, in double.
/// Why: below the pivot tolerance, so that a tie is decided by the lexicographic rule.
inline constexpr double tie = 1e-12;
/// Of: the largest entry of M in double.
/// Why: the rounding error of an entry that is a difference after an exchange; small entries of a column turn it into large ratios.
inline constexpr double entry_rounding = 1e-15;
/// Of: the largest entry of the tableau in extended precision.
/// Why: as `pivot`, for the longer fraction.
inline constexpr long double wide_pivot = 1e-15L;
/// Of: the ratios that are compared, in extended precision.
/// Why: as `tie`, for the longer fraction.
inline constexpr long double wide_tie = 1e-16L;
/// Of: the largest entry of M in extended precision.
/// Why: as `entry_rounding`, for the longer fraction.
inline constexpr long double wide_entry_rounding = 1e-18L;

/// Of: one, as a reciprocal condition number.
/// Why: below it four digits are left, and a basis counts as singular.
inline constexpr double singular_condition = 1e-12;

}  // namespace pwlsim::lcp::tolerance
