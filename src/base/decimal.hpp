#pragma once
/// Decimal numbers as the user wrote them, and the few exact operations that output times need:
/// row k is at start + k*step computed from the decimal text, so step 0.1 puts row 3 at 0.3.

#include <cstdint>
#include <optional>
#include <string_view>

namespace pwlsim {

/// mantissa * 10^exponent. Any |exponent| up to 1000 is exact in all functions below.
struct Decimal {
  std::int64_t mantissa = 0;
  int exponent = 0;
};

/// Plain decimal text "-12.5e-6" (sign, digits with an optional point, optional exponent), and nothing else.
/// Trailing zeros of the mantissa are dropped. Empty if the text is something else, has more digits
/// than 64 bits hold, or lies outside the range of normal magnitudes (1e-400 to 1e400).
[[nodiscard]] std::optional<Decimal> parse_decimal(std::string_view text);

/// The shortest decimal that reads back to `value`, which must be finite.
[[nodiscard]] Decimal decimal_from_double(double value);

/// digits * 10^exponent, correctly rounded, for any number of decimal digits; overflows to infinity and underflows to zero.
[[nodiscard]] double scaled_digits(std::string_view digits, std::int64_t exponent);

/// Correctly rounded; overflows to infinity and underflows to zero as text does.
[[nodiscard]] double to_double(const Decimal& value);

/// start + k*step, formed exactly and rounded once to the nearest double (ties to even).
[[nodiscard]] double affine(const Decimal& start, std::int64_t k, const Decimal& step);

/// Sign of start + k*step - other, exactly: -1, 0 or 1.
[[nodiscard]] int compare_affine(const Decimal& start, std::int64_t k, const Decimal& step, const Decimal& other);

/// floor((stop - start) / step), exactly, for step > 0 and stop >= start; at most 2^62.
[[nodiscard]] std::int64_t steps_between(const Decimal& start, const Decimal& stop, const Decimal& step);

/// a - b, where the exact result fits a Decimal.
[[nodiscard]] std::optional<Decimal> difference(const Decimal& a, const Decimal& b);

}  // namespace pwlsim
