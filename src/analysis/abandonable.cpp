#include "analysis/abandonable.hpp"

#include <chrono>
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>

namespace pwlsim::analysis {
namespace {

constexpr auto between_looks = std::chrono::milliseconds(50);
constexpr auto patience = std::chrono::milliseconds(500);

std::atomic<bool> abandoned = false;

/// Shared with the thread, which may outlive the call.
struct Job {
  std::function<void()> work;
  std::mutex mutex;
  std::condition_variable ended;
  bool done = false;
  std::exception_ptr failure;

  void run() {
    std::exception_ptr thrown;
    try {
      work();
    } catch (...) {
      thrown = std::current_exception();
    }
    const std::scoped_lock lock(mutex);
    failure = thrown;
    done = true;
    ended.notify_one();
  }

  /// False where it was left to itself.
  bool wait(const std::atomic<int>& interrupt) {
    std::unique_lock lock(mutex);
    const auto is_done = [this] { return done; };
    while (!ended.wait_for(lock, between_looks, is_done))
      if (interrupt.load(std::memory_order_relaxed) != 0) return ended.wait_for(lock, patience, is_done);
    return true;
  }
};

}  // namespace

bool finished_in_time(std::function<void()> work, const std::atomic<int>& interrupt) {
  const auto job = std::make_shared<Job>();
  job->work = std::move(work);
  std::thread thread;
  try {
    thread = std::thread([job] { job->run(); });
  } catch (const std::system_error&) {  // no thread is to be had
    job->work();
    return true;
  }
  if (!job->wait(interrupt)) {
    thread.detach();
    abandoned = true;
    return false;
  }
  thread.join();
  if (job->failure) std::rethrow_exception(job->failure);
  return true;
}

bool any_abandoned() { return abandoned; }

}  // namespace pwlsim::analysis
