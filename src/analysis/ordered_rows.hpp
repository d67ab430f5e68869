#pragma once
/// Writes rows of simultaneous runs into one file in the order of the runs, in bounded memory.

#include <condition_variable>
#include <cstddef>
#include <functional>
#include <map>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "waveform/output_file.hpp"
#include "waveform/row_writer.hpp"

namespace pwlsim::analysis {

/// Shared by the threads. The first unfinished run writes directly; runs after it keep their text, and wait when it grows large.
class OrderedRows {
 public:
  /// At most `ahead` runs are started beyond the first unfinished one. `row_bytes`: of each row of a binary file, 0 for lines of text.
  OrderedRows(waveform::OutputFile& file, std::size_t ahead, std::size_t row_bytes) : file_(file), ahead_(ahead), row_bytes_(row_bytes) {}

  /// Waits until the run may start. Runs start in order.
  void wait_to_begin(std::size_t run);
  /// Removes from `text` the part that can be written now. False from the first failed write on.
  bool write(std::size_t run, std::string& text);
  /// Takes the remaining text; the next run may write.
  bool finish(std::size_t run, std::string text);
  /// Whether writing to the file has failed.
  [[nodiscard]] bool failed();

 private:
  bool put(const std::string& text);

  waveform::OutputFile& file_;
  std::size_t ahead_, row_bytes_;
  std::mutex mutex_;
  std::condition_variable turn_;
  std::size_t next_ = 0;  ///< first run that is not finished
  std::map<std::size_t, std::string> finished_;
};

/// Appends one row to a text.
using RowFormatter = std::function<void(std::string& text, std::span<const double> row)>;

/// A line of CSV: first the stepped values, then the row.
[[nodiscard]] RowFormatter stepped_csv(const std::vector<double>& stepped);
/// Doubles: the row, then the stepped values.
[[nodiscard]] RowFormatter stepped_doubles(const std::vector<double>& stepped);

/// Rows of one of these runs, formatted.
class SteppedRows : public waveform::RowWriter {
 public:
  SteppedRows(OrderedRows& rows, std::size_t run, std::size_t columns, RowFormatter format)
      : rows_(rows), run_(run), columns_(columns), format_(std::move(format)) {}

  bool write(std::span<const double> values) override;
  bool flush() override { return rows_.finish(run_, std::move(text_)); }

 private:
  OrderedRows& rows_;
  std::size_t run_, columns_;
  RowFormatter format_;
  std::string text_;
};

}  // namespace pwlsim::analysis
