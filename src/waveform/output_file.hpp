#pragma once
/// A file that is seen whole or not at all: bytes go to `NAME.partial` beside the target, which is renamed when complete.
/// Standard output ("-") and what is no regular file (a pipe, a device) are written directly.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace pwlsim::waveform {

class OutputFile {
 public:
  /// Creates the temporary file; the target stays untouched. Where that fails, or the target is a directory or write-protected,
  /// nothing is created and `problem` says why ("No such file or directory").
  /// Another process that writes the same target does no harm: the temporary file is then `NAME.partial.<process id>`.
  [[nodiscard]] static std::optional<OutputFile> open(const std::string& target, std::string& problem);

  OutputFile(OutputFile&& other) noexcept;
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(OutputFile&&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;
  /// Without commit() the temporary file is removed, unless writing failed: then what was written stays in it.
  ~OutputFile();

  /// Writes whole lines, or whole rows of `row_bytes` each. False from the first failure on; the temporary file then ends behind the last whole
  /// line or row that found room.
  bool write(std::string_view bytes, std::size_t row_bytes = 0);
  /// From now on bytes can be overwritten: what would be written directly is held in a temporary file without a name until commit().
  bool hold();
  /// Replaces bytes that were written; after a failure to write too. False where that is not possible.
  bool overwrite(std::uint64_t at, std::string_view bytes);
  /// Bytes written.
  [[nodiscard]] std::uint64_t size() const { return size_; }
  /// Completes and renames. False where writing, now or before, or renaming failed.
  bool commit();

  /// Part of it is worth nothing: the temporary file goes.
  void discard();

  [[nodiscard]] bool failed() const { return failure_ != 0; }
  [[nodiscard]] bool closed_pipe() const;
  /// The operating system's words for the failure, "" where there is none.
  [[nodiscard]] std::string problem() const;
  /// As given to open(); "standard output" for "-".
  [[nodiscard]] std::string name() const;
  /// Where the bytes are until commit(); "" where they are written directly.
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
  int destination_ = -1;  // of what is held; -1: nothing is
  int failure_ = 0;       // errno
};

/// Where a file of that name is written: symbolic links at its end are followed, also one to a file that does not exist yet.
[[nodiscard]] std::string final_target(const std::string& name);

/// Where the bytes for `name` wait until the file is complete.
[[nodiscard]] std::string partial_of(const std::string& name);

/// Whether both names lead to one existing file.
[[nodiscard]] bool same_file(const std::string& a, const std::string& b);

/// Writes all bytes to an open descriptor; 0, or errno. `written` counts what arrived.
[[nodiscard]] int write_all(int descriptor, std::string_view bytes, std::size_t& written);

}  // namespace pwlsim::waveform
