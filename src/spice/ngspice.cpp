#include "spice/ngspice.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include "base/names.hpp"

extern char** environ;

namespace pwlsim::spice {
namespace {

namespace fs = std::filesystem;

/// A folder that goes with the object.
class Folder {
 public:
  Folder() {
    std::string pattern = (fs::temp_directory_path() / "pwlsim-XXXXXX").string();
    if (::mkdtemp(pattern.data()) != nullptr) path_ = pattern;
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove_all(path_, ignored);
  }
  [[nodiscard]] bool made() const { return !path_.empty(); }
  [[nodiscard]] std::string file(const char* name) const { return (path_ / name).string(); }

 private:
  fs::path path_;
};

std::string read_all(const std::string& name) {
  std::ifstream file(name, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return std::move(text).str();
}

/// The process, its output in `log`; -1 where it cannot be started.
pid_t start(const std::string& program, const Folder& folder) {
  const std::string deck = folder.file("deck.cir"), raw = folder.file("deck.raw"), log = folder.file("log");
  std::array<const char*, 7> arguments{program.c_str(), "-n", "-b", "-r", raw.c_str(), deck.c_str(), nullptr};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  pid_t child = -1;
  const int failure = ::posix_spawn(&child, program.c_str(), &actions, nullptr, const_cast<char**>(arguments.data()), environ);
  posix_spawn_file_actions_destroy(&actions);
  return failure == 0 ? child : -1;
}

struct Ending {
  bool in_time = false;
  int status = 0;
  double seconds = 0.0;
};

double cpu_seconds(const rusage& usage) {
  const auto seconds = [](const timeval& t) { return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec); };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

Ending wait_for(pid_t child, const RunLimits& limits) {
  using Clock = std::chrono::steady_clock;
  const auto stop = Clock::now() + std::chrono::duration<double>(limits.seconds);
  Ending ending{true, 0, 0.0};
  rusage usage{};
  while (::wait4(child, &ending.status, WNOHANG, &usage) == 0) {
    const bool interrupted = limits.interrupt != nullptr && *limits.interrupt != 0;
    if (interrupted || Clock::now() > stop) {
      ending.in_time = false;
      ::kill(child, SIGKILL);
      ::wait4(child, &ending.status, 0, &usage);
      break;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  ending.seconds = cpu_seconds(usage);
  return ending;
}

bool tells_failure(std::string_view line) {
  static constexpr std::array<std::string_view, 9> marks{"error",  "too small",  "singular", "aborted",     "no convergence",
                                                         "failed", "can't find", "unknown",  "not converge"};
  const std::string plain = without_case(line);
  if (plain.find("init file") != std::string::npos || plain.find("spinit") != std::string::npos) return false;
  return std::any_of(marks.begin(), marks.end(), [&](std::string_view mark) { return plain.find(mark) != std::string::npos; });
}

/// The first lines that tell of a failure, each once.
std::string words_of(const std::string& log) {
  constexpr std::size_t most = 3;
  std::vector<std::string> lines;
  std::istringstream text(log);
  for (std::string line; std::getline(text, line) && lines.size() < most;) {
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
    if (tells_failure(line) && std::find(lines.begin(), lines.end(), line) == lines.end()) lines.push_back(line);
  }
  std::string words;
  for (const std::string& line : lines) words += (words.empty() ? "" : "; ") + line;
  return words;
}

double analysis_seconds(const std::string& log) {
  constexpr std::string_view mark = "Total analysis time (seconds) = ";
  const std::size_t at = log.find(mark);
  return at == std::string::npos ? 0.0 : std::strtod(log.c_str() + at + mark.size(), nullptr);
}

}  // namespace

std::optional<std::string> find_ngspice() {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    const std::string candidate = (fs::path(folder.empty() ? "." : folder) / "ngspice").string();
    if (::access(candidate.c_str(), X_OK) == 0 && !fs::is_directory(candidate)) return candidate;
  }
  return std::nullopt;
}

NgspiceRun run_ngspice(const std::string& program, const std::string& deck, const RunLimits& limits) {
  NgspiceRun run;
  const Folder folder;
  std::ofstream file(folder.made() ? folder.file("deck.cir") : "");
  file << deck;
  file.close();
  const pid_t child = folder.made() && file ? start(program, folder) : -1;
  if (child < 0) {
    run.words = "ngspice could not be started, or there is no room for its files";
    return run;
  }
  const Ending ending = wait_for(child, limits);
  const std::string log = read_all(folder.file("log"));
  run.raw = waveform::read_raw(read_all(folder.file("deck.raw")));
  run.ended = ending.in_time && WIFEXITED(ending.status) && WEXITSTATUS(ending.status) == 0;
  run.words = ending.in_time ? words_of(log) : "stopped: it took too long";
  run.seconds = ending.seconds;
  run.seconds_analysis = analysis_seconds(log);
  return run;
}

}  // namespace pwlsim::spice
