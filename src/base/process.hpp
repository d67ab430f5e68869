#pragma once
/// Finds other programs and runs them, each in its own folder.

#include <atomic>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pwlsim {

/// The program of this name in the folders of PATH.
[[nodiscard]] std::optional<std::string> find_program(std::string_view name);

/// A new folder, readable to this user only, that is removed with the object.
class TemporaryFolder {
 public:
  TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder();
  /// False if it could not be created.
  [[nodiscard]] bool made() const { return !path_.empty(); }
  [[nodiscard]] std::string file(const char* name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

struct ProcessLimits {
  double seconds = 60.0;                        ///< after this time it is killed
  const std::atomic<int>* interrupt = nullptr;  ///< it is also killed when this is not zero
};

struct ProcessEnd {
  bool started = false;
  bool in_time = false;
  bool succeeded = false;    ///< it ended in time, with status 0
  double cpu_seconds = 0.0;  ///< user and system time
};

/// Runs `arguments[0]`, a path, with no input and its output in the file `log`, and waits for it.
[[nodiscard]] ProcessEnd run_process(const std::vector<std::string>& arguments, const std::string& log, const ProcessLimits& limits);

/// All bytes; empty if the file cannot be read.
[[nodiscard]] std::string read_bytes(const std::string& name);

}  // namespace pwlsim
