#include "netlist/number.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <string>

#include "base/decimal.hpp"
#include "base/names.hpp"

namespace pwlsim::netlist {

namespace {

/// Reads from the front of a text.
class Front {
 public:
  explicit Front(std::string_view rest) : rest_(rest) {}

  [[nodiscard]] bool at_end() const { return rest_.empty(); }
  [[nodiscard]] bool at_digit() const { return !rest_.empty() && is_digit(rest_.front()); }

  char next() {
    const char c = rest_.front();
    rest_.remove_prefix(1);
    return c;
  }

  bool take(std::string_view text) {
    if (!same_name(rest_.substr(0, text.size()), text)) {
      return false;
    }
    rest_.remove_prefix(text.size());
    return true;
  }

  /// Digits, appended to `digits` without leading zeros; returns how many stood there.
  std::int64_t take_digits(std::string& digits) {
    std::int64_t count = 0;
    for (; at_digit(); ++count) {
      const char c = next();
      if (c != '0' || !digits.empty()) {
        digits.push_back(c);
      }
    }
    return count;
  }

  /// One unit letter: a Latin letter, or Ω (Greek letter or ohm sign), or a µ that is not a suffix.
  bool take_letter() {
    if (!rest_.empty() && lower_letter(rest_.front()) >= 'a' && lower_letter(rest_.front()) <= 'z') {
      rest_.remove_prefix(1);
      return true;
    }
    return take("\u03A9") || take("\u2126") || take("\u00B5") || take("\u03BC");
  }

  bool take_letters() {
    bool any = false;
    while (take_letter()) {
      any = true;
    }
    return any;
  }

  /// "e-6" with at least one digit; leaves the text alone where it is something else ("5eV").
  bool take_exponent(std::int64_t& exponent) {
    std::string_view ahead = rest_;
    if (ahead.empty() || lower_letter(ahead.front()) != 'e') {
      return false;
    }
    ahead.remove_prefix(1);
    const bool negative = ahead.starts_with('-');
    if (negative || ahead.starts_with('+')) {
      ahead.remove_prefix(1);
    }
    if (ahead.empty() || !is_digit(ahead.front())) {
      return false;
    }
    constexpr std::int64_t beyond_any_double = 1'000'000'000;
    std::int64_t size = 0;
    for (; !ahead.empty() && is_digit(ahead.front()); ahead.remove_prefix(1)) {
      size = std::min(size * 10 + (ahead.front() - '0'), beyond_any_double);
    }
    exponent += negative ? -size : size;
    rest_ = ahead;
    return true;
  }

 private:
  std::string_view rest_;
};

struct Suffix {
  std::string_view text;
  int exponent;
  int factor = 1;
};

// Longer spellings before those they begin with. R stands for the decimal point only.
constexpr std::array<Suffix, 13> suffixes{{{"meg", 6},
                                           {"mil", -7, 254},
                                           {"t", 12},
                                           {"g", 9},
                                           {"k", 3},
                                           {"m", -3},
                                           {"u", -6},
                                           {"\u00B5", -6},
                                           {"\u03BC", -6},
                                           {"n", -9},
                                           {"p", -12},
                                           {"f", -15},
                                           {"r", 0}}};

const Suffix* take_suffix(Front& text) {
  const auto* const found = std::find_if(suffixes.begin(), suffixes.end(), [&](const Suffix& suffix) { return text.take(suffix.text); });
  return found == suffixes.end() ? nullptr : found;
}

void multiply_digits(std::string& digits, int factor) {
  int carried = 0;
  for (auto digit = digits.rbegin(); digit != digits.rend(); ++digit) {
    carried += (*digit - '0') * factor;
    *digit = static_cast<char>('0' + carried % 10);
    carried /= 10;
  }
  if (carried != 0) {
    digits.insert(0, std::to_string(carried));
  }
}

/// digits * 10^exponent; most numbers of a deck are short enough for one exact operation.
double value_of(const std::string& digits, std::int64_t exponent) {
  constexpr std::size_t exact_digits = 15;
  constexpr std::array<double, 23> powers{1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                          1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
  const auto size = static_cast<std::size_t>(exponent < 0 ? -exponent : exponent);
  if (digits.size() > exact_digits || size >= powers.size()) {
    return digits.empty() ? 0.0 : scaled_digits(digits, exponent);
  }
  std::int64_t whole = 0;
  std::from_chars(digits.data(), digits.data() + digits.size(), whole);
  const auto mantissa = static_cast<double>(whole);
  return exponent < 0 ? mantissa / powers[size] : mantissa * powers[size];
}

void write_decimal(NumberText& number, bool negative, const std::string& digits, std::int64_t exponent) {
  std::string text = negative ? "-" : "";
  text.append(digits.empty() ? "0" : digits);
  text.push_back('e');
  text.append(std::to_string(exponent));
  if (text.size() < sizeof(number.decimal_digits)) {
    std::copy(text.begin(), text.end(), number.decimal_digits);
  }
}

NumberText infinite_number(bool negative) {
  NumberText number;
  number.valid = true;
  number.infinite = true;
  number.value = negative ? -std::numeric_limits<double>::infinity() : std::numeric_limits<double>::infinity();
  return number;
}

}  // namespace

NumberText read_number(std::string_view text) {
  NumberText number;
  const bool negative = text.starts_with('-');
  if (negative || text.starts_with('+')) {
    text.remove_prefix(1);
  }
  if (same_name(text, "inf")) {
    return infinite_number(negative);
  }
  Front front(text);
  std::string digits;
  std::int64_t exponent = 0;
  bool any_digit = front.take_digits(digits) != 0;
  const bool has_point = front.take(".");
  if (has_point) {
    const std::int64_t decimals = front.take_digits(digits);
    any_digit = any_digit || decimals != 0;
    exponent -= decimals;
  }
  if (!any_digit) {
    return number;
  }
  const bool has_exponent = front.take_exponent(exponent);
  if (const Suffix* const suffix = take_suffix(front)) {
    number.bare_femto = suffix->text == "f" && (front.at_end() || front.take("arad"));
    if (front.at_digit()) {
      if (has_point || has_exponent) {
        return {};
      }
      exponent -= front.take_digits(digits);
    }
    exponent += suffix->exponent;
    multiply_digits(digits, suffix->factor);
  }
  front.take_letters();
  if (!front.at_end()) {
    return {};
  }
  number.valid = true;
  number.value = value_of(digits, exponent);
  number.value = negative ? -number.value : number.value;
  write_decimal(number, negative, digits, exponent);
  return number;
}

}  // namespace pwlsim::netlist
