#pragma once
/// Numbers for people.

#include <cstdint>
#include <string>
#include <string_view>

namespace pwlsim::analysis {

/// `value` with a metric prefix and at most `digits` digits: 0.0012345 of "s" is "1.234 ms". A value without a fitting prefix is written
/// with an exponent.
[[nodiscard]] std::string quantity(double value, std::string_view unit, int digits = 6);

/// "1 row", "2 rows".
[[nodiscard]] std::string counted(std::uint64_t count, std::string_view noun);

/// Of a saved signal by its name: "V" of `v(out)`, "A" of `i(L1)`, "" of a quantity of a raw system.
[[nodiscard]] std::string_view unit_of_signal(std::string_view name);

}  // namespace pwlsim::analysis
