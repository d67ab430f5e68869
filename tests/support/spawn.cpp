#include "support/spawn.hpp"

#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <stdexcept>
#include <thread>

namespace pwlsim::test {
namespace {

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

void limit(int resource, rlim_t value) {
  const rlimit bounds{value, value};
  ::setrlimit(static_cast<__rlimit_resource>(resource), &bounds);
}

// In the child, between fork and exec: only system calls.
[[noreturn]] void become_program(char** arguments, const SpawnOptions& options, int out, int err) {
  const int in = ::open("/dev/null", O_RDONLY);
  ::dup2(in, STDIN_FILENO);
  ::dup2(out, STDOUT_FILENO);
  ::dup2(err, STDERR_FILENO);
  for (int descriptor = 0; options.no_streams && descriptor < 3; ++descriptor) ::close(descriptor);
  if (::chdir(options.folder.c_str()) != 0) ::_exit(126);
#ifndef PWLSIM_SANITIZED
  if (options.limit_memory) limit(RLIMIT_AS, rlim_t{2} << 30);
#endif
  if (options.file_size != 0) limit(RLIMIT_FSIZE, options.file_size);
  ::execv(arguments[0], arguments);
  ::_exit(127);
}

void make_pipe(int (&ends)[2]) {
  if (::pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
}

void make_terminal(int (&ends)[2]) {
  if (::openpty(&ends[0], &ends[1], nullptr, nullptr, nullptr) != 0) throw std::runtime_error("no terminal");
  for (const int end : ends) ::fcntl(end, F_SETFD, FD_CLOEXEC);
}

}  // namespace

Spawned::Spawned(const std::vector<std::string>& arguments, const SpawnOptions& options) : start_(now()), limit_(options.seconds) {
  std::vector<std::string> words{options.program.empty() ? PWLSIM_PROGRAM : options.program};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);

  int out[2], err[2];
  make_pipe(out);
  options.terminal ? make_terminal(err) : make_pipe(err);
  int target = out[1];
  if (!options.standard_output.empty()) {
    target = ::open(options.standard_output.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (target < 0) throw std::runtime_error("cannot open " + options.standard_output);
  }
  process_ = ::fork();
  if (process_ < 0) throw std::runtime_error("cannot fork");
  if (process_ == 0) become_program(pointers.data(), options, target, err[1]);
  ::close(out[1]);
  ::close(err[1]);
  if (target != out[1]) ::close(target);
  out_ = out[0];
  err_ = err[0];
}

Spawned::~Spawned() {
  if (process_ > 0) {
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
  }
  close_output();
  if (err_ >= 0) ::close(err_);
}

void Spawned::send(int signal_number) const { ::kill(process_, signal_number); }

void Spawned::close_output() {
  if (out_ >= 0) ::close(out_);
  out_ = -1;
}

Finished Spawned::finish() {
  Finished result;
  std::string* const texts[2] = {&result.out, &result.err};
  int* const sources[2] = {&out_, &err_};
  bool killed = false;
  while (out_ >= 0 || err_ >= 0) {
    pollfd polled[2] = {{out_, POLLIN, 0}, {err_, POLLIN, 0}};  // a negative descriptor is passed over
    const double left = start_ + limit_ - now();
    if (left <= 0.0 && !killed) {
      killed = true;
      send(SIGKILL);
    }
    if (::poll(polled, 2, killed ? 1000 : static_cast<int>(left * 1000.0) + 1) <= 0) continue;
    for (int index = 0; index < 2; ++index) {
      if (polled[index].revents == 0) continue;
      char block[65536];
      const ssize_t count = ::read(*sources[index], block, sizeof block);
      if (count > 0) {
        texts[index]->append(block, static_cast<std::size_t>(count));
      } else if (count == 0 || errno != EINTR) {  // a terminal whose other end is closed gives EIO
        ::close(*sources[index]);
        *sources[index] = -1;
      }
    }
  }
  int status = 0;
  rusage usage{};
  ::wait4(process_, &status, 0, &usage);
  process_ = -1;
  for (const timeval& spent : {usage.ru_utime, usage.ru_stime})
    result.cpu_seconds += static_cast<double>(spent.tv_sec) + 1e-6 * static_cast<double>(spent.tv_usec);
  result.resident_mebibytes = static_cast<double>(usage.ru_maxrss) / 1024.0;
  result.status = WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
  result.seconds = now() - start_;
  return result;
}

void pause(int milliseconds) { std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds)); }

}  // namespace pwlsim::test
