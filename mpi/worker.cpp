#include "worker.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <stdexcept>

namespace pwlsim::mpi {
namespace {

constexpr const char* lost = "E-worker-lost";

bool write_all(int file, const void* data, std::size_t size) {
  const char* at = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t written = ::write(file, at, size);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    at += written;
    size -= static_cast<std::size_t>(written);
  }
  return true;
}

bool read_all(int file, void* data, std::size_t size) {
  char* at = static_cast<char*>(data);
  while (size > 0) {
    const ssize_t got = ::read(file, at, size);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    at += got;
    size -= static_cast<std::size_t>(got);
  }
  return true;
}

/// Its length, then itself, in one piece.
bool send(int file, const std::string& bytes) {
  const std::uint64_t size = bytes.size();
  std::string whole(reinterpret_cast<const char*>(&size), sizeof size);
  whole += bytes;
  return write_all(file, whole.data(), whole.size());
}

bool receive(int file, std::string& bytes) {
  std::uint64_t size = 0;
  if (!read_all(file, &size, sizeof size)) return false;
  bytes.resize(size);
  return read_all(file, bytes.data(), size);
}

template <class Value>
void put(std::string& bytes, const Value& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

template <class Value>
Value take(const std::string& bytes, std::size_t& at) {
  Value value{};
  if (at + sizeof value > bytes.size()) throw std::runtime_error("a record is too short");
  std::memcpy(&value, bytes.data() + at, sizeof value);
  at += sizeof value;
  return value;
}

/// Until there are no more requests. A worker starts with the first of them: ranks that only hand out runs prepare nothing.
[[noreturn]] void work(int requests, int records, const std::function<Worker::Run()>& prepare) {
  std::uint64_t number = 0;
  if (!read_all(requests, &number, sizeof number)) std::_Exit(0);
  const Worker::Run run = prepare();
  do
    if (!send(records, bytes_of(run(number)))) break;
  while (read_all(requests, &number, sizeof number));
  std::_Exit(0);
}

[[noreturn]] void supervise(int requests, int records, const std::function<Worker::Run()>& prepare) {
  for (;;) {
    const pid_t worker = ::fork();
    if (worker == 0) work(requests, records, prepare);
    int status = 0;
    while (worker > 0 && ::waitpid(worker, &status, 0) < 0 && errno == EINTR) {
    }
    if (worker > 0 && WIFEXITED(status) && WEXITSTATUS(status) == 0) std::_Exit(0);
    if (!send(records, bytes_of({0, lost, {}}))) std::_Exit(1);
  }
}

}  // namespace

std::string bytes_of(const Record& record) {
  std::string bytes;
  put(bytes, record.number);
  put(bytes, std::uint64_t{record.id.size()});
  bytes += record.id;
  for (const double value : record.measurements) put(bytes, value);
  return bytes;
}

Record record_of(const std::string& bytes) {
  Record record;
  std::size_t at = 0;
  record.number = take<std::uint64_t>(bytes, at);
  const auto length = take<std::uint64_t>(bytes, at);
  record.id = bytes.substr(at, length);
  for (at += length; at < bytes.size();) record.measurements.push_back(take<double>(bytes, at));
  return record;
}

Worker::Worker(const std::function<Run()>& prepare) {
  std::array<int, 2> to{}, from{};
  if (::pipe(to.data()) != 0 || ::pipe(from.data()) != 0) throw std::runtime_error("no pipe to a worker");
  std::signal(SIGPIPE, SIG_IGN);
  supervisor_ = ::fork();
  if (supervisor_ < 0) throw std::runtime_error("no process for a worker");
  if (supervisor_ == 0) {
    ::close(to[1]);
    ::close(from[0]);
    supervise(to[0], from[1], prepare);
  }
  ::close(to[0]);
  ::close(from[1]);
  requests_ = to[1];
  records_ = from[0];
}

Worker::~Worker() {
  ::close(requests_);
  ::close(records_);
  ::waitpid(supervisor_, nullptr, 0);
}

Record Worker::run(std::uint64_t number) {
  for (int attempt = 0; attempt < 2; ++attempt) {
    if (!write_all(requests_, &number, sizeof number)) break;
    Record record{number, lost, {}};
    do {  // where a worker was lost between two runs, the one behind it has done a run twice
      std::string bytes;
      if (!receive(records_, bytes)) return {number, lost, {}};
      record = record_of(bytes);
    } while (record.id != lost && record.number != number);
    if (record.id != lost) return record;
  }
  return {number, lost, {}};
}

}  // namespace pwlsim::mpi
