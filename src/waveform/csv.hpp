#pragma once
/// Rows of numbers as CSV after RFC 4180, each line ended by a line feed.
/// A number is the shortest text that reads back to the same double (std::to_chars).

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "waveform/row_writer.hpp"

namespace pwlsim::waveform {

class OutputFile;

/// A field by RFC 4180: quoted if it contains a comma, a quote or a line end, with quotes doubled.
[[nodiscard]] std::string csv_field(std::string_view text);

/// Appends `prefix` and the values as a line.
void append_csv_row(std::string& text, std::string_view prefix, std::span<const double> values);

/// The shortest text that reads back to `value`.
[[nodiscard]] std::string shortest(double value);
/// To this many significant digits; 0: as shortest().
[[nodiscard]] std::string rounded(double value, int digits);

/// Collects rows in a buffer and writes it to `file` when full. `file` must outlive the writer; it is neither opened nor committed here.
class CsvWriter : public RowWriter {
 public:
  /// `names` are the column heads.
  CsvWriter(OutputFile& file, std::span<const std::string> names);

  bool write(std::span<const double> values) override;
  /// Empties the buffer into the file.
  bool flush() override;

 private:
  OutputFile& file_;
  std::size_t columns_;
  std::size_t row_room_;  // bytes that hold any row
  std::size_t capacity_;
  std::unique_ptr<char[]> buffer_;
  std::size_t used_ = 0;
};

}  // namespace pwlsim::waveform
