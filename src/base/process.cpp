#include "base/process.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <thread>

extern char** environ;

namespace pwlsim {
namespace {

namespace fs = std::filesystem;

/// -1 where it cannot be started.
pid_t start(const std::vector<std::string>& arguments, const std::string& log) {
  std::vector<char*> words;
  for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  pid_t child = -1;
  const int failure = ::posix_spawn(&child, words[0], &actions, nullptr, words.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  return failure == 0 ? child : -1;
}

double seconds_of(const rusage& usage) {
  const auto seconds = [](const timeval& t) { return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec); };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

}  // namespace

std::optional<std::string> find_program(std::string_view name) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    const std::string candidate = (fs::path(folder.empty() ? "." : folder) / name).string();
    std::error_code unknown;
    if (::access(candidate.c_str(), X_OK) == 0 && !fs::is_directory(candidate, unknown)) return candidate;
  }
  return std::nullopt;
}

TemporaryFolder::TemporaryFolder() {
  std::error_code unknown;
  std::string pattern = (fs::temp_directory_path(unknown) / "pwlsim-XXXXXX").string();
  if (::mkdtemp(pattern.data()) != nullptr) path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  if (made()) fs::remove_all(path_, ignored);
}

ProcessEnd run_process(const std::vector<std::string>& arguments, const std::string& log, const ProcessLimits& limits) {
  using Clock = std::chrono::steady_clock;
  const auto stop = Clock::now() + std::chrono::duration<double>(limits.seconds);
  const pid_t child = start(arguments, log);
  if (child < 0) return {};
  ProcessEnd end{true, true, false, 0.0};
  int status = 0;
  rusage usage{};
  while (::wait4(child, &status, WNOHANG, &usage) == 0) {
    const bool interrupted = limits.interrupt != nullptr && *limits.interrupt != 0;
    if (interrupted || Clock::now() > stop) {
      end.in_time = false;
      ::kill(child, SIGKILL);
      ::wait4(child, &status, 0, &usage);
      break;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  end.cpu_seconds = seconds_of(usage);
  end.succeeded = end.in_time && WIFEXITED(status) && WEXITSTATUS(status) == 0;
  return end;
}

std::string read_bytes(const std::string& name) {
  std::ifstream file(name, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return std::move(text).str();
}

}  // namespace pwlsim
