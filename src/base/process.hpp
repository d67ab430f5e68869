#pragma once
/// Other programs: where they are, and running one in a folder of its own.

#include <atomic>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pwlsim {

/// The program of this name in the folders of PATH.
[[nodiscard]] std::optional<std::string> find_program(std::string_view name);

/// A new folder, readable to this user only, that goes with the object.
class TemporaryFolder {
 public:
  TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder();
  /// False where there is no room for it.
  [[nodiscard]] bool made() const { return !path_.empty(); }
  [[nodiscard]] std::string file(const char* name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

struct ProcessLimits {
  double seconds = 60.0;                        ///< it is killed after so long
  const std::atomic<int>* interrupt = nullptr;  ///< and when this is not zero
};

struct ProcessEnd {
  bool started = false;
  bool in_time = false;
  bool succeeded = false;    ///< in time, with status 0
  double cpu_seconds = 0.0;  ///< of its user and system time
};

/// Runs `arguments[0]`, a path, with no input and its output in the file `log`, and waits for it.
[[nodiscard]] ProcessEnd run_process(const std::vector<std::string>& arguments, const std::string& log, const ProcessLimits& limits);

/// All bytes; empty where the file cannot be read.
[[nodiscard]] std::string read_bytes(const std::string& name);

}  // namespace pwlsim
