#include "cli/signals.hpp"

#include <csignal>

namespace pwlsim::cli {
namespace {

std::atomic<int> caught = 0;
static_assert(std::atomic<int>::is_always_lock_free, "only a lock-free flag may be set in a signal handler");

extern "C" void remember(int signal_number) { caught.store(signal_number, std::memory_order_relaxed); }

void handle_once(int signal_number) {
  struct sigaction action {};
  action.sa_handler = remember;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  ::sigaction(signal_number, &action, nullptr);
}

}  // namespace

void catch_signals() {
  caught.store(0, std::memory_order_relaxed);
  handle_once(SIGINT);
  handle_once(SIGTERM);
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

const std::atomic<int>& caught_signal() { return caught; }

}  // namespace pwlsim::cli
