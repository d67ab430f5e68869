#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <mutex>
#include <stdexcept>
#include <string_view>
#include <thread>

#include "cli/program.hpp"
#include "random_decks/deck_trial.hpp"
#include "support/spawn.hpp"
#include "waveform/output_file.hpp"

namespace pwlsim::test {
namespace {

using Clock = std::chrono::steady_clock;

#ifdef PWLSIM_SANITIZED
constexpr double patience = 30.0;  ///< it takes three times as long
#else
constexpr double patience = 12.0;  ///< seconds of the processor: other processes may take their share of the machine
#endif
constexpr double last_patience = 60.0;
constexpr double share_of_machine = 0.05;  ///< that a run has at least: what does not run at all is ended too

class SpawningRunner : public TrialRunner {
 public:
  Trial run(const Scratch& folder, const std::vector<std::string>& arguments) override {
    SpawnOptions options;
    options.folder = folder.path().string();
    options.seconds = last_patience;
    const Finished finished = run_program(arguments, options);
    return {finished.status, finished.out, finished.err, finished.cpu_seconds, finished.resident_mebibytes};
  }
};

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// Ends what does not end.
class Watchdog {
 public:
  Watchdog() : thread_([this] { watch(); }) {}
  Watchdog(const Watchdog&) = delete;
  Watchdog& operator=(const Watchdog&) = delete;
  ~Watchdog() {
    set(State::over);
    thread_.join();
  }
  void begin() { set(State::running); }
  void end() { set(State::idle); }

 private:
  enum class State { idle, running, over };

  void set(State state) {
    const std::lock_guard lock(mutex_);
    state_ = state;
    start_ = Clock::now();
    cpu_start_ = cpu_seconds();
    ++changes_;
    changed_.notify_one();
  }

  void watch() {
    std::unique_lock lock(mutex_);
    while (state_ != State::over) {
      if (state_ == State::idle) {
        changed_.wait(lock, [this, change = changes_] { return changes_ != change; });
      } else if (const int change = changes_; !ends_within(patience, change, lock)) {
        ::kill(::getpid(), SIGINT);
        if (!ends_within(patience + last_patience, change, lock)) give_up();
      }
    }
  }

  bool ends_within(double seconds, int change, std::unique_lock<std::mutex>& lock) {
    const auto end = start_ + std::chrono::duration<double>(seconds / share_of_machine);
    while (cpu_seconds() - cpu_start_ < seconds && Clock::now() < end)
      if (changed_.wait_for(lock, std::chrono::seconds(1), [&] { return changes_ != change; })) return true;
    return false;
  }

  /// The standard descriptors are captured.
  [[noreturn]] void give_up() const {
    static constexpr std::string_view text = "the program does not end, nor can it be interrupted\n";
    std::size_t written = 0;
    (void)waveform::write_all(output_, text, written);
    ::_exit(EXIT_FAILURE);
  }

  const int output_ = ::dup(STDOUT_FILENO);
  std::mutex mutex_;
  std::condition_variable changed_;
  State state_ = State::idle;
  Clock::time_point start_ = Clock::now();
  double cpu_start_ = 0.0;
  int changes_ = 0;
  std::thread thread_;
};

/// One of the standard descriptors, gathered in memory while it lives.
class Captured {
 public:
  explicit Captured(int descriptor) : descriptor_(descriptor), kept_(::dup(descriptor)), memory_(::memfd_create("captured", MFD_CLOEXEC)) {
    if (kept_ < 0 || memory_ < 0 || ::dup2(memory_, descriptor_) < 0) throw std::runtime_error("cannot capture output");
  }
  Captured(const Captured&) = delete;
  Captured& operator=(const Captured&) = delete;
  ~Captured() {
    ::dup2(kept_, descriptor_);
    ::close(kept_);
    ::close(memory_);
  }
  [[nodiscard]] std::string text() const {
    std::string result(static_cast<std::size_t>(::lseek(memory_, 0, SEEK_END)), '\0');
    if (::pread(memory_, result.data(), result.size(), 0) != static_cast<ssize_t>(result.size()))
      throw std::runtime_error("cannot read output");
    return result;
  }

 private:
  int descriptor_, kept_, memory_;
};

void forget_resident_peak() { std::ofstream("/proc/self/clear_refs") << 5; }

double resident_peak() {
  std::ifstream file("/proc/self/status");
  for (std::string line; std::getline(file, line);)
    if (line.starts_with("VmHWM:")) return std::strtod(line.c_str() + 6, nullptr) / 1024.0;
  return 0.0;
}

class InnerRunner : public TrialRunner {
 public:
  Trial run(const Scratch& folder, const std::vector<std::string>& arguments) override {
    if (::chdir(folder.path().c_str()) != 0) throw std::runtime_error("no folder");
    std::vector<std::string> words{"pwlsim"};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());

    std::fflush(stdout);
    forget_resident_peak();
    Trial result;
    const Captured out(STDOUT_FILENO), err(STDERR_FILENO);
    const double start = cpu_seconds();
    watchdog_.begin();
    result.status = cli::run_program(static_cast<int>(pointers.size()), pointers.data(), "test");
    watchdog_.end();
    result.seconds = cpu_seconds() - start;
    result.out = out.text();
    result.err = err.text();
    result.resident_mebibytes = resident_peak();
    return result;
  }

 private:
  Watchdog watchdog_;
};

}  // namespace

std::unique_ptr<TrialRunner> make_spawning_runner() { return std::make_unique<SpawningRunner>(); }
std::unique_ptr<TrialRunner> make_inner_runner() { return std::make_unique<InnerRunner>(); }

}  // namespace pwlsim::test
