#include "waveform/output_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>
#include <vector>

namespace pwlsim::waveform {
namespace {

struct Target {
  std::string path;     // symbolic links followed
  bool regular = true;  // or not there yet
  bool exists = false;
  mode_t mode = 0;
};

// errno, or 0 and the target described.
int examine(const std::string& path, Target& target) {
  struct stat status {};
  if (path.empty()) return ENOENT;
  target.path = final_target(path);
  if (::stat(path.c_str(), &status) != 0) return errno == ENOENT ? 0 : errno;
  if (S_ISDIR(status.st_mode)) return EISDIR;
  target.exists = true;
  target.mode = status.st_mode & 07777;
  target.regular = S_ISREG(status.st_mode);
  if (::access(path.c_str(), W_OK) != 0) return errno;
  return 0;
}

bool leads_to(const std::string& path, int descriptor) {
  struct stat by_name {
  }, by_descriptor{};
  return ::stat(path.c_str(), &by_name) == 0 && ::fstat(descriptor, &by_descriptor) == 0 && by_name.st_ino == by_descriptor.st_ino &&
         by_name.st_dev == by_descriptor.st_dev;
}

// The lock tells two runs with one target apart; an abandoned file of an earlier run carries none and is taken over.
// Descriptor, or -1 with errno; EWOULDBLOCK where another process holds it.
int open_locked(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (descriptor < 0) return -1;
  const bool locked = ::flock(descriptor, LOCK_EX | LOCK_NB) == 0;
  // Between opening and locking the other process may have renamed it: then it is no longer ours to empty.
  const bool taken = locked ? !leads_to(path, descriptor) : errno == EWOULDBLOCK;
  if (!taken && ::ftruncate(descriptor, 0) == 0) return descriptor;
  const int error_number = taken ? EWOULDBLOCK : errno;
  ::close(descriptor);
  errno = error_number;
  return -1;
}

}  // namespace

int write_all(int descriptor, std::string_view bytes, std::size_t& written) {
  written = 0;
  while (written < bytes.size()) {
    const ssize_t count = ::write(descriptor, bytes.data() + written, bytes.size() - written);
    if (count > 0) {
      written += static_cast<std::size_t>(count);
    } else if (count == 0) {
      return ENOSPC;
    } else if (errno != EINTR) {
      return errno;
    }
  }
  return 0;
}

std::string final_target(const std::string& name) {
  constexpr int most_links = 40;  // as the kernel has it
  std::error_code problem;
  std::filesystem::path path = name;
  for (int links = 0; links < most_links && std::filesystem::is_symlink(path, problem); ++links) {
    const std::filesystem::path next = std::filesystem::read_symlink(path, problem);
    if (problem) break;
    path = path.parent_path() / next;  // an absolute link replaces all of it
  }
  return path.string();
}

std::string partial_of(const std::string& name) { return final_target(name) + ".partial"; }

bool same_file(const std::string& a, const std::string& b) {
  struct stat first {
  }, second{};
  return ::stat(a.c_str(), &first) == 0 && ::stat(b.c_str(), &second) == 0 && first.st_ino == second.st_ino &&
         first.st_dev == second.st_dev;
}

std::optional<OutputFile> OutputFile::open(const std::string& name, std::string& problem) {
  OutputFile file;
  file.given_ = name;
  if (name == "-") {
    file.descriptor_ = STDOUT_FILENO;
    return file;
  }
  Target target;
  int error_number = examine(name, target);
  if (error_number == 0) {
    if (target.regular) {
      file.target_ = target.path;
      file.partial_ = partial_of(name);
      file.descriptor_ = open_locked(file.partial_);
      if (file.descriptor_ < 0 && errno == EWOULDBLOCK) {
        file.partial_ += fmt::format(".{}", ::getpid());
        file.descriptor_ = open_locked(file.partial_);
      }
    } else {
      file.descriptor_ = ::open(name.c_str(), O_WRONLY | O_CLOEXEC);
    }
    error_number = file.descriptor_ < 0 ? errno : 0;
  }
  if (error_number != 0) {
    problem = std::strerror(error_number);
    return std::nullopt;
  }
  if (target.exists && target.regular) (void)::fchmod(file.descriptor_, target.mode);
  return file;
}

OutputFile::OutputFile(OutputFile&& other) noexcept
    : given_(std::move(other.given_)),
      target_(std::move(other.target_)),
      partial_(std::move(other.partial_)),
      size_(other.size_),
      descriptor_(std::exchange(other.descriptor_, -1)),
      destination_(std::exchange(other.destination_, -1)),
      failure_(other.failure_) {}

OutputFile::~OutputFile() {
  if (descriptor_ < 0) return;
  if (!partial_.empty() && failure_ == 0) ::unlink(partial_.c_str());
  for (const int descriptor : {descriptor_, destination_})
    if (descriptor >= 0 && descriptor != STDOUT_FILENO) ::close(descriptor);
}

void OutputFile::discard() {
  if (!partial_.empty()) ::unlink(partial_.c_str());
  partial_.clear();
}

bool OutputFile::write(std::string_view bytes, std::size_t row_bytes) {
  if (failure_ != 0) return false;
  std::size_t written = 0;
  const int error_number = write_all(descriptor_, bytes, written);
  if (error_number != 0) {
    fail(error_number, row_bytes != 0 ? written / row_bytes * row_bytes : bytes.substr(0, written).rfind('\n') + 1);
    return false;
  }
  size_ += written;
  return true;
}

void OutputFile::fail(int error_number, std::uint64_t kept_of_last) {
  failure_ = error_number;
  if (partial_.empty()) return;
  size_ += kept_of_last;
  (void)!::ftruncate(descriptor_, static_cast<off_t>(size_));
}

bool OutputFile::hold() {
  if (failure_ != 0) return false;
  if (!partial_.empty() || destination_ >= 0) return true;
  std::error_code unknown;
  std::string name = (std::filesystem::temp_directory_path(unknown) / "pwlsim-XXXXXX").string();
  const int descriptor = ::mkostemp(name.data(), O_CLOEXEC);
  if (descriptor < 0) {
    fail(errno);
    return false;
  }
  ::unlink(name.c_str());
  destination_ = std::exchange(descriptor_, descriptor);
  return true;
}

bool OutputFile::overwrite(std::uint64_t at, std::string_view bytes) {
  if (partial_.empty() && destination_ < 0) return false;
  return ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(at)) == static_cast<ssize_t>(bytes.size());
}

/// What was held goes where it should.
bool OutputFile::release() {
  constexpr std::size_t piece = std::size_t{1} << 18;
  std::vector<char> buffer(piece);
  const int held = std::exchange(descriptor_, std::exchange(destination_, -1));
  ssize_t count = 0;
  for (off_t at = 0; failure_ == 0 && (count = ::pread(held, buffer.data(), piece, at)) > 0; at += count) {
    std::size_t written = 0;
    failure_ = write_all(descriptor_, {buffer.data(), static_cast<std::size_t>(count)}, written);
  }
  if (count < 0) failure_ = errno;
  ::close(held);
  return failure_ == 0;
}

bool OutputFile::commit() {
  if (failure_ != 0) return false;
  if (destination_ >= 0 && !release()) return false;
  if (descriptor_ == STDOUT_FILENO) return true;
  // Renamed before it is closed: closing ends the lock. A file system that writes late reports it when a copy of the descriptor is closed.
  const int copy = ::dup(descriptor_);
  if (copy >= 0 && ::close(copy) != 0) {
    fail(errno);
  } else if (!partial_.empty() && ::rename(partial_.c_str(), target_.c_str()) != 0) {
    failure_ = errno;
  }
  ::close(std::exchange(descriptor_, -1));
  return failure_ == 0;
}

bool OutputFile::closed_pipe() const { return failure_ == EPIPE; }

std::string OutputFile::problem() const { return failure_ == 0 ? std::string() : std::strerror(failure_); }

std::string OutputFile::name() const { return given_ == "-" ? "standard output" : given_; }

}  // namespace pwlsim::waveform
