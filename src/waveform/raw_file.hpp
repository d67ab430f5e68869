#pragma once
/// SPICE's binary raw file of real numbers: a text head with the names of the vectors, then one row of doubles a point.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pwlsim::waveform {

struct RawFile {
  std::vector<std::string> names;  ///< lower case; the first is the scale ("time")
  std::vector<double> values;      ///< row by row

  [[nodiscard]] std::size_t rows() const { return names.empty() ? 0 : values.size() / names.size(); }
  /// Index of a vector; empty where there is none.
  [[nodiscard]] std::optional<std::size_t> find(std::string_view name) const;
  [[nodiscard]] double at(std::size_t row, std::size_t vector) const { return values[row * names.size() + vector]; }
};

/// Whole rows only: what a run that was cut short wrote is read as far as it goes. Empty where `bytes` is no such file.
[[nodiscard]] std::optional<RawFile> read_raw(std::string_view bytes);

}  // namespace pwlsim::waveform
