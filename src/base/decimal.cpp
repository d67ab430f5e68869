#include "base/decimal.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>
#include <system_error>
#include <vector>

namespace pwlsim {

namespace {

// __extension__ keeps -Wpedantic quiet about the 128-bit integer.
__extension__ using Wide = __int128;
__extension__ using WideUnsigned = unsigned __int128;

constexpr int largest_exponent = 400;
constexpr int limb_digits = 9;
constexpr std::int64_t limb_base = 1'000'000'000;

constexpr std::array<std::int64_t, 19> powers_of_ten = [] {
  std::array<std::int64_t, 19> powers{1};
  for (std::size_t i = 1; i < powers.size(); ++i) {
    powers[i] = powers[i - 1] * 10;
  }
  return powers;
}();

WideUnsigned magnitude(Wide value) { return value < 0 ? ~static_cast<WideUnsigned>(value) + 1 : static_cast<WideUnsigned>(value); }

std::string digits_of(WideUnsigned value) {
  std::string digits;
  do {
    digits.push_back(static_cast<char>('0' + static_cast<int>(value % 10)));
    value /= 10;
  } while (value != 0);
  std::reverse(digits.begin(), digits.end());
  return digits;
}

/// value * 10^exponent, rounded once.
double round_wide(Wide value, int exponent) {
  const bool negative = value < 0;
  const WideUnsigned size = magnitude(value);
  constexpr int exact_power = 18;  // 10^18 and smaller are exact doubles
  if (size <= (WideUnsigned{1} << 53) && std::abs(exponent) <= exact_power) {
    const double whole = static_cast<double>(static_cast<std::uint64_t>(size));
    const auto power = static_cast<double>(powers_of_ten[static_cast<std::size_t>(std::abs(exponent))]);
    const double rounded = exponent < 0 ? whole / power : whole * power;
    return negative ? -rounded : rounded;
  }
  const double rounded = scaled_digits(digits_of(size), exponent);
  return negative ? -rounded : rounded;
}

/// A signed sum of decimals of any exponents: limbs in base 1e9, the lowest of weight 10^lowest_exponent.
class ExactSum {
 public:
  explicit ExactSum(int lowest_exponent) : lowest_exponent_(lowest_exponent) {}

  /// Adds k * value; value.exponent must not lie below the lowest exponent.
  void add(const Decimal& value, std::int64_t k) {
    const Wide product = static_cast<Wide>(value.mantissa) * k;
    if (product == 0) {
      return;
    }
    const int shift = value.exponent - lowest_exponent_;
    assert(shift >= 0);
    const std::int64_t scale = powers_of_ten[static_cast<std::size_t>(shift % limb_digits)];
    const std::int64_t sign = product < 0 ? -1 : 1;
    WideUnsigned rest = magnitude(product);
    for (auto limb = static_cast<std::size_t>(shift / limb_digits); rest != 0; ++limb) {
      const std::int64_t part = static_cast<std::int64_t>(rest % limb_base) * scale;
      limb_at(limb) += sign * (part % limb_base);
      limb_at(limb + 1) += sign * (part / limb_base);
      rest /= limb_base;
    }
  }

  /// Makes all limbs of one sign, in [0, 1e9) by magnitude, and returns that sign.
  int normalize() {
    int sign = carry();
    if (sign < 0) {
      for (auto& limb : limbs_) {
        limb = -limb;
      }
      carry();
    }
    return sign;
  }

  /// The magnitude as decimal digits, after normalize().
  [[nodiscard]] std::string digits() const {
    std::string text;
    for (auto limb = limbs_.rbegin(); limb != limbs_.rend(); ++limb) {
      const std::string part = std::to_string(*limb);
      text.append(static_cast<std::size_t>(limb_digits) - part.size(), '0');
      text += part;
    }
    text.erase(0, std::min(text.find_first_not_of('0'), text.size()));
    return text.empty() ? "0" : text;
  }

  [[nodiscard]] int lowest_exponent() const { return lowest_exponent_; }

 private:
  std::int64_t& limb_at(std::size_t index) {
    if (index >= limbs_.size()) {
      limbs_.resize(index + 1, 0);
    }
    return limbs_[index];
  }

  /// Carries upwards so that all limbs but the highest lie in [0, 1e9); returns the sign of the sum.
  int carry() {
    std::int64_t carried = 0;
    bool zero = true;
    for (auto& limb : limbs_) {
      limb += carried;
      carried = limb >= 0 ? limb / limb_base : -((limb_base - 1 - limb) / limb_base);
      limb -= carried * limb_base;
      zero = zero && limb == 0;
    }
    if (carried != 0) {
      limbs_.push_back(carried);
      zero = false;
    }
    if (zero) {
      return 0;
    }
    return limbs_.back() < 0 ? -1 : 1;
  }

  int lowest_exponent_;
  std::vector<std::int64_t> limbs_;
};

struct Digits {
  std::string text;  ///< without leading and trailing zeros; empty for zero
  std::int64_t exponent = 0;
};

/// "0.0120" as {12, -3}; nothing where `text` is not digits with at most one point.
std::optional<Digits> significant_digits(std::string_view text) {
  Digits digits;
  bool any_digit = false;
  bool after_point = false;
  for (const char c : text) {
    if (c == '.' && !after_point) {
      after_point = true;
    } else if (c >= '0' && c <= '9') {
      any_digit = true;
      digits.exponent -= after_point ? 1 : 0;
      if (c != '0' || !digits.text.empty()) {
        digits.text.push_back(c);
      }
    } else {
      return std::nullopt;
    }
  }
  if (!any_digit) {
    return std::nullopt;
  }
  const std::size_t kept = digits.text.find_last_not_of('0') + 1;
  digits.exponent += static_cast<std::int64_t>(digits.text.size() - kept);
  digits.text.resize(kept);
  return digits;
}

std::optional<int> read_exponent(std::string_view text) {
  if (text.starts_with('+') && !text.starts_with("+-")) {
    text.remove_prefix(1);
  }
  int exponent = 0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), exponent);
  const bool whole = result.ec == std::errc{} && result.ptr == text.data() + text.size();
  return whole ? std::optional<int>(exponent) : std::nullopt;
}

}  // namespace

double scaled_digits(std::string_view digits, std::int64_t exponent) {
  std::string text(digits);
  text += 'e';
  text += std::to_string(exponent);
  double value = 0.0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  // from_chars leaves the value alone where it is out of range; strtod tells overflow from underflow.
  return result.ec == std::errc::result_out_of_range ? std::strtod(text.c_str(), nullptr) : value;
}

std::optional<Decimal> parse_decimal(std::string_view text) {
  const bool negative = text.starts_with('-');
  if (negative || text.starts_with('+')) {
    text.remove_prefix(1);
  }
  const std::size_t mark = std::min(text.find_first_of("eE"), text.size());
  const auto digits = significant_digits(text.substr(0, mark));
  const auto written_exponent = mark == text.size() ? std::optional<int>(0) : read_exponent(text.substr(mark + 1));
  if (!digits || !written_exponent) {
    return std::nullopt;
  }
  if (digits->text.empty()) {
    return Decimal{};
  }
  const std::int64_t exponent = *written_exponent + digits->exponent;
  Decimal value;
  const auto result = std::from_chars(digits->text.data(), digits->text.data() + digits->text.size(), value.mantissa);
  if (result.ec != std::errc{} || std::abs(exponent) > largest_exponent) {
    return std::nullopt;
  }
  value.mantissa = negative ? -value.mantissa : value.mantissa;
  value.exponent = static_cast<int>(exponent);
  return value;
}

Decimal decimal_from_double(double value) {
  assert(std::isfinite(value));
  std::array<char, 40> text{};
  const auto result = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::scientific);
  const auto decimal = parse_decimal({text.data(), static_cast<std::size_t>(result.ptr - text.data())});
  assert(decimal.has_value());
  return decimal.value_or(Decimal{});
}

double to_double(const Decimal& value) { return round_wide(value.mantissa, value.exponent); }

double affine(const Decimal& start, std::int64_t k, const Decimal& step) {
  const int lowest = std::min(start.exponent, step.exponent);
  const int start_shift = start.exponent - lowest;
  const int step_shift = step.exponent - lowest;
  const auto bounded = [](std::int64_t number, int bits) { return std::abs(number) < (std::int64_t{1} << bits); };
  // 2^62 * 10^15 and 2^62 * 2^30 * 10^9 are each below 2^125, so the sum fits 127 bits.
  if (bounded(start.mantissa, 62) && bounded(step.mantissa, 62) && bounded(k, 30) && start_shift <= 15 && step_shift <= 9) {
    const Wide sum = static_cast<Wide>(start.mantissa) * powers_of_ten[static_cast<std::size_t>(start_shift)] +
                     static_cast<Wide>(step.mantissa) * k * powers_of_ten[static_cast<std::size_t>(step_shift)];
    return round_wide(sum, lowest);
  }
  ExactSum sum(lowest);
  sum.add(start, 1);
  sum.add(step, k);
  const int sign = sum.normalize();
  return sign * scaled_digits(sum.digits(), lowest);
}

int compare_affine(const Decimal& start, std::int64_t k, const Decimal& step, const Decimal& other) {
  ExactSum sum(std::min({start.exponent, step.exponent, other.exponent}));
  sum.add(start, 1);
  sum.add(step, k);
  sum.add(other, -1);
  return sum.normalize();
}

std::int64_t steps_between(const Decimal& start, const Decimal& stop, const Decimal& step) {
  assert(step.mantissa > 0);
  std::int64_t within = 0;
  std::int64_t beyond = std::int64_t{1} << 62;
  if (compare_affine(start, beyond, step, stop) <= 0) {
    return beyond;
  }
  while (beyond - within > 1) {
    const std::int64_t middle = within + (beyond - within) / 2;
    (compare_affine(start, middle, step, stop) <= 0 ? within : beyond) = middle;
  }
  return within;
}

std::optional<Decimal> difference(const Decimal& a, const Decimal& b) {
  ExactSum sum(std::min(a.exponent, b.exponent));
  sum.add(a, 1);
  sum.add(b, -1);
  const int sign = sum.normalize();
  auto result = parse_decimal(sum.digits() + 'e' + std::to_string(sum.lowest_exponent()));
  if (result && sign < 0) {
    result->mantissa = -result->mantissa;
  }
  return result;
}

}  // namespace pwlsim
