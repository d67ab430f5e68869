#include "base/process.hpp"

#include <catch2/catch.hpp>
#include <filesystem>

using namespace pwlsim;

TEST_CASE("programs are found by PATH", "[unit]") {
  REQUIRE(find_program("sh"));
  CHECK(find_program("sh")->ends_with("/sh"));
  CHECK_FALSE(find_program("no-program-has-this-name"));
}

TEST_CASE("a program runs with its output in a file, and its end is told", "[unit]") {
  const TemporaryFolder folder;
  REQUIRE(folder.made());
  const std::string log = folder.file("log");
  CHECK(run_process({*find_program("sh"), "-c", "echo one; echo two >&2"}, log, {}).succeeded);
  CHECK(read_bytes(log) == "one\ntwo\n");
  const ProcessEnd failed = run_process({*find_program("sh"), "-c", "exit 3"}, log, {});
  CHECK((failed.started && failed.in_time && !failed.succeeded));
  CHECK_FALSE(run_process({folder.file("missing")}, log, {}).started);
}

TEST_CASE("a program that takes too long, or is interrupted, is stopped", "[unit]") {
  const TemporaryFolder folder;
  const std::atomic<int> interrupt = 2;
  for (const ProcessLimits& limits : {ProcessLimits{0.05, nullptr}, ProcessLimits{60.0, &interrupt}}) {
    const ProcessEnd end = run_process({*find_program("sleep"), "30"}, folder.file("log"), limits);
    CHECK((end.started && !end.in_time && !end.succeeded));
  }
}

TEST_CASE("a temporary folder goes with its object", "[unit]") {
  std::string name;
  {
    const TemporaryFolder folder;
    name = folder.file("a");
    CHECK(std::filesystem::exists(std::filesystem::path(name).parent_path()));
  }
  CHECK_FALSE(std::filesystem::exists(std::filesystem::path(name).parent_path()));
}
