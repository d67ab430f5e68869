#pragma once
/// SPICE numbers: "10k", "1Meg", "4R7", "1k5", "10uF", "inf".

#include <string_view>

namespace pwlsim::netlist {

struct NumberText {
  bool valid = false;            ///< the whole text is a number with optional suffix and unit letters
  double value = 0.0;            ///< correctly rounded from the decimal text, suffix included
  bool infinite = false;         ///< a written `inf`
  bool bare_femto = false;       ///< the suffix is a single F directly after digits: femto, with a warning for a capacitance
  char decimal_digits[40] = {};  ///< the same number as plain decimal text "-12.5e-6", suffix folded into the exponent ("" if too long)
};

/// Not case-sensitive. Suffixes T G Meg K Mil m u µ n p f, then any letters; a suffix letter (or R) may replace the decimal point.
[[nodiscard]] NumberText read_number(std::string_view text);

}  // namespace pwlsim::netlist
