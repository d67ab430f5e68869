#pragma once
/// A file that appears complete or not at all: bytes go to `NAME.partial` beside the target, which is renamed when complete.
/// Standard output ("-"), pipes and devices are written directly.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace pwlsim::waveform {

class OutputFile {
 public:
  /// Creates the temporary file; the target is unchanged. If that fails, or the target is a directory or write-protected,
  /// nothing is created and `problem` says why ("No such file or directory").
  /// If another process writes the same target, the temporary file is `NAME.partial.<process id>`.
  [[nodiscard]] static std::optional<OutputFile> open(const std::string& target, std::string& problem);

  OutputFile(OutputFile&& other) noexcept;
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(OutputFile&&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;
  /// Without commit() the temporary file is removed, unless writing failed: then the written bytes stay in it.
  ~OutputFile();

  /// Writes whole lines, or whole rows of `row_bytes` each. False from the first failure on; the temporary file then ends after the last whole
  /// line or row that was written.
  bool write(std::string_view bytes, std::size_t row_bytes = 0);
  /// From now on bytes can be overwritten: output that would be written directly waits in an unnamed temporary file until commit().
  bool hold();
  /// Replaces bytes that were written, also after a failed write. False if that is not possible.
  bool overwrite(std::uint64_t at, std::string_view bytes);
  /// Bytes written.
  [[nodiscard]] std::uint64_t size() const { return size_; }
  /// Completes and renames. False if writing, now or before, or renaming failed.
  bool commit();

  /// A part of the file is useless: removes the temporary file.
  void discard();

  [[nodiscard]] bool failed() const { return failure_ != 0; }
  [[nodiscard]] bool closed_pipe() const;
  /// The operating system's text for the failure, "" without one.
  [[nodiscard]] std::string problem() const;
  /// As given to open(); "standard output" for "-".
  [[nodiscard]] std::string name() const;
  /// Where the bytes are until commit(); "" if they are written directly.
  [[nodiscard]] const std::string& partial_name() const { return partial_; }

 private:
  OutputFile() = default;
  void fail(int error_number, std::uint64_t kept_of_last = 0);
  bool release();

  std::string given_;   // as the user wrote it
  std::string target_;  // with symbolic links followed
  std::string partial_;
  std::uint64_t size_ = 0;
  int descriptor_ = -1;
  int destination_ = -1;  // of bytes that wait; -1: none do
  int failure_ = 0;       // errno
};

/// Where a file of that name is written: symbolic links at its end are followed, also one to a file that does not exist yet.
[[nodiscard]] std::string final_target(const std::string& name);

/// The file that holds the bytes for `name` until it is complete.
[[nodiscard]] std::string partial_of(const std::string& name);

/// Whether both names lead to one existing file.
[[nodiscard]] bool same_file(const std::string& a, const std::string& b);

/// Writes all bytes to an open descriptor; 0, or errno. `written` counts the bytes written.
[[nodiscard]] int write_all(int descriptor, std::string_view bytes, std::size_t& written);

}  // namespace pwlsim::waveform
