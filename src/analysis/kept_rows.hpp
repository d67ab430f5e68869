#pragma once
/// Keeps the written rows of a run for a check, in bounded memory.

#include <cstddef>
#include <span>
#include <vector>

#include "waveform/row_writer.hpp"

namespace pwlsim::analysis {

/// Passes rows on to a writer. When memory is full it keeps every second row, then every fourth, and so on; of two rows at one time, those before and after
/// an event, it keeps the second.
class KeptRows : public waveform::RowWriter {
 public:
  /// `columns` includes the time.
  KeptRows(waveform::RowWriter& writer, std::size_t columns);

  bool write(std::span<const double> values) override;
  bool flush() override { return writer_.flush(); }

  [[nodiscard]] std::size_t rows() const { return values_.size() / columns_; }
  [[nodiscard]] std::size_t signals() const { return columns_ - 1; }
  [[nodiscard]] double time(std::size_t row) const { return values_[row * columns_]; }
  [[nodiscard]] double value(std::size_t row, std::size_t signal) const { return values_[row * columns_ + 1 + signal]; }

 private:
  void keep(std::span<const double> row);
  void thin();

  waveform::RowWriter& writer_;
  std::size_t columns_, most_rows_;
  std::size_t stride_ = 1, seen_ = 0;
  std::vector<double> values_;
};

}  // namespace pwlsim::analysis
