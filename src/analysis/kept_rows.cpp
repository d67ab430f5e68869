#include "analysis/kept_rows.hpp"

#include <algorithm>

namespace pwlsim::analysis {
namespace {

constexpr std::size_t most_values = 1'000'000;  ///< 8 MB; a check keeps some ten times as much of the other engine
constexpr std::size_t most_rows = 20'000, fewest_rows = 200;

}  // namespace

KeptRows::KeptRows(waveform::RowWriter& writer, std::size_t columns)
    : writer_(writer), columns_(columns), most_rows_(std::clamp(most_values / columns, fewest_rows, most_rows)) {}

bool KeptRows::write(std::span<const double> values) {
  for (std::size_t at = 0; at < values.size(); at += columns_) keep(values.subspan(at, columns_));
  return writer_.write(values);
}

void KeptRows::keep(std::span<const double> row) {
  if (rows() != 0 && time(rows() - 1) == row[0]) {
    std::copy(row.begin(), row.end(), values_.end() - static_cast<std::ptrdiff_t>(columns_));
    return;
  }
  if (seen_++ % stride_ != 0) return;
  if (rows() == most_rows_) thin();
  values_.insert(values_.end(), row.begin(), row.end());
}

void KeptRows::thin() {
  const std::size_t kept = (rows() + 1) / 2;
  for (std::size_t row = 1; row < kept; ++row)
    std::copy_n(values_.begin() + static_cast<std::ptrdiff_t>(2 * row * columns_), columns_,
                values_.begin() + static_cast<std::ptrdiff_t>(row * columns_));
  values_.resize(kept * columns_);
  stride_ *= 2;
}

}  // namespace pwlsim::analysis
