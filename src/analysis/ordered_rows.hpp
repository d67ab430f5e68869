#pragma once
/// Rows of runs side by side, into one file in the order of the runs, in bounded memory.

#include <condition_variable>
#include <cstddef>
#include <map>
#include <mutex>
#include <string>

#include "waveform/output_file.hpp"
#include "waveform/row_writer.hpp"

namespace pwlsim::analysis {

/// Shared by the threads. The first run that is not finished writes through; runs after it keep their text, and wait when they have much of it.
class OrderedRows {
 public:
  /// Not more than `ahead` runs are begun beyond the first unfinished one.
  OrderedRows(waveform::OutputFile& file, std::size_t ahead) : file_(file), ahead_(ahead) {}

  /// Waits until the run may begin. Runs begin in their order.
  void wait_to_begin(std::size_t run);
  /// Takes of `text` what can be written now. False from the first failure to write on.
  bool write(std::size_t run, std::string& text);
  /// Takes the rest; the run after it may write.
  bool finish(std::size_t run, std::string text);
  /// Whether the file takes no more.
  [[nodiscard]] bool failed();
  /// What stands before the rows.
  bool write_head(const std::string& text) { return file_.write(text); }

 private:
  bool put(const std::string& text);

  waveform::OutputFile& file_;
  std::size_t ahead_;
  std::mutex mutex_;
  std::condition_variable turn_;
  std::size_t next_ = 0;  ///< first run that is not finished
  std::map<std::size_t, std::string> finished_;
};

/// Rows of one of these runs as CSV: first the values that were stepped, then the row.
class SteppedRows : public waveform::RowWriter {
 public:
  SteppedRows(OrderedRows& rows, std::size_t run, std::string prefix, std::size_t columns)
      : rows_(rows), run_(run), prefix_(std::move(prefix)), columns_(columns) {}

  bool write(std::span<const double> values) override;
  bool flush() override { return rows_.finish(run_, std::move(text_)); }

 private:
  OrderedRows& rows_;
  std::size_t run_;
  std::string prefix_;
  std::size_t columns_;
  std::string text_;
};

}  // namespace pwlsim::analysis
