#include "waveform/output_file.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <csignal>
#include <filesystem>

#include "support/scratch.hpp"

using namespace pwlsim;
using test::read_file;
using test::Scratch;
using waveform::OutputFile;
using Names = std::vector<std::string>;

namespace {

OutputFile open(const std::string& target) {
  std::string problem;
  auto file = OutputFile::open(target, problem);
  INFO(problem);
  REQUIRE(file);
  return std::move(*file);
}

std::string problem_of(const std::string& target) {
  std::string problem;
  CHECK_FALSE(OutputFile::open(target, problem));
  return problem;
}

/// No file of this process may grow beyond `bytes`: a full disk, for the writer.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &before_);
    rlimit limit = before_;
    limit.rlim_cur = bytes;
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;
  ~FileSizeLimit() { setrlimit(RLIMIT_FSIZE, &before_); }

 private:
  rlimit before_{};
};

}  // namespace

TEST_CASE("the target appears whole at commit", "[unit]") {
  const Scratch scratch;
  scratch.write("a.csv", "old\n");
  OutputFile file = open(scratch / "a.csv");
  REQUIRE(file.write("new\n"));
  CHECK(read_file(scratch / "a.csv") == "old\n");
  CHECK(read_file(scratch / "a.csv.partial") == "new\n");
  REQUIRE(file.commit());
  CHECK(read_file(scratch / "a.csv") == "new\n");
  CHECK(scratch.names() == Names{"a.csv"});
}

TEST_CASE("a file that is not committed leaves nothing", "[unit]") {
  const Scratch scratch;
  scratch.write("a.csv", "old\n");
  { CHECK(open(scratch / "a.csv").write("new\n")); }
  CHECK(read_file(scratch / "a.csv") == "old\n");
  CHECK(scratch.names() == Names{"a.csv"});
}

TEST_CASE("a full disk keeps whole lines in the partial file and the target untouched", "[unit]") {
  const Scratch scratch;
  scratch.write("a.csv", "old\n");
  {
    OutputFile file = open(scratch / "a.csv");
    const FileSizeLimit limit(10);
    CHECK(file.write("abc\n"));
    CHECK_FALSE(file.write("def\nghi\n"));  // ends after 10 bytes, in "gh"
    CHECK(file.failed());
    CHECK_FALSE(file.closed_pipe());
    CHECK(file.problem() == "File too large");
    CHECK_FALSE(file.write("x\n"));
    CHECK_FALSE(file.commit());
  }
  CHECK(read_file(scratch / "a.csv") == "old\n");
  CHECK(read_file(scratch / "a.csv.partial") == "abc\ndef\n");
}

TEST_CASE("a full disk keeps whole rows of bytes, which can still be overwritten", "[unit]") {
  const Scratch scratch;
  {
    OutputFile file = open(scratch / "a.raw");
    const FileSizeLimit limit(11);
    CHECK(file.write("n=0\n"));
    CHECK_FALSE(file.write("ab\ncd\nef", 3));  // the limit leaves room for seven bytes: two rows
    CHECK(file.size() == 10);
    CHECK(file.overwrite(2, "2"));
  }
  CHECK(read_file(scratch / "a.raw.partial") == "n=2\nab\ncd\n");
}

TEST_CASE("what goes to a device is held back where it shall be overwritten", "[unit]") {
  OutputFile file = open("/dev/full");
  CHECK_FALSE(file.overwrite(0, "x"));
  REQUIRE(file.hold());
  CHECK(file.write("n=0\n"));
  CHECK(file.overwrite(2, "1"));
  CHECK_FALSE(file.commit());
  CHECK(file.problem() == "No space left on device");
}

TEST_CASE("targets that cannot be written are refused and nothing is created", "[unit]") {
  const Scratch scratch;
  CHECK(problem_of(scratch / "missing/a.csv") == "No such file or directory");
  CHECK(problem_of(scratch.path().string()) == "Is a directory");
  CHECK(problem_of("") == "No such file or directory");
  CHECK(scratch.names().empty());
}

TEST_CASE("devices and pipes are written directly", "[unit]") {
  OutputFile file = open("/dev/full");
  CHECK(file.partial_name().empty());
  CHECK_FALSE(file.write("x\n"));
  CHECK(file.problem() == "No space left on device");
}

TEST_CASE("a symbolic link stays and the file behind it is replaced", "[unit]") {
  const Scratch scratch;
  scratch.write("real.csv", "old\n");
  std::filesystem::create_symlink("real.csv", scratch / "link.csv");
  OutputFile file = open(scratch / "link.csv");
  REQUIRE(file.write("new\n"));
  REQUIRE(file.commit());
  CHECK(std::filesystem::is_symlink(scratch / "link.csv"));
  CHECK(read_file(scratch / "real.csv") == "new\n");
}

TEST_CASE("the mode of the older file is kept", "[unit]") {
  const Scratch scratch;
  ::chmod(scratch.write("a.csv", "old\n").c_str(), 0640);
  OutputFile file = open(scratch / "a.csv");
  REQUIRE(file.commit());
  struct stat status {};
  REQUIRE(::stat((scratch / "a.csv").c_str(), &status) == 0);
  CHECK((status.st_mode & 0777) == 0640);
}

TEST_CASE("two writers of one target do not mix", "[unit]") {
  const Scratch scratch;
  OutputFile first = open(scratch / "a.csv");
  OutputFile second = open(scratch / "a.csv");
  REQUIRE(first.write("first\n"));
  REQUIRE(second.write("second\n"));
  REQUIRE(second.commit());
  CHECK(read_file(scratch / "a.csv") == "second\n");
  REQUIRE(first.commit());
  CHECK(read_file(scratch / "a.csv") == "first\n");
  CHECK(scratch.names() == Names{"a.csv"});
}

TEST_CASE("an abandoned partial file is taken over", "[unit]") {
  const Scratch scratch;
  scratch.write("a.csv.partial", "left over from an earlier run\n");
  OutputFile file = open(scratch / "a.csv");
  REQUIRE(file.write("new\n"));
  REQUIRE(file.commit());
  CHECK(read_file(scratch / "a.csv") == "new\n");
  CHECK(scratch.names() == Names{"a.csv"});
}

TEST_CASE("a closed pipe is told from other failures", "[unit]") {
  std::signal(SIGPIPE, SIG_IGN);
  const Scratch scratch;
  REQUIRE(::mkfifo((scratch / "pipe").c_str(), 0600) == 0);
  const int reader = ::open((scratch / "pipe").c_str(), O_RDONLY | O_NONBLOCK);
  OutputFile file = open(scratch / "pipe");
  ::close(reader);
  CHECK_FALSE(file.write("x\n"));
  CHECK(file.closed_pipe());
}

TEST_CASE("one file under two names is recognised", "[unit]") {
  const Scratch scratch;
  scratch.write("a", "");
  scratch.write("b", "");
  CHECK(waveform::same_file(scratch / "a", scratch / "./a"));
  CHECK_FALSE(waveform::same_file(scratch / "a", scratch / "b"));
  CHECK_FALSE(waveform::same_file(scratch / "missing", scratch / "missing"));
}
