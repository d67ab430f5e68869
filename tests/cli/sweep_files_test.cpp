// Sweeps that fit a disk: --no-rows, --jobs, and the warning before large files.

#include <catch2/catch.hpp>

#include "cli/run_in.hpp"
#include "support/json.hpp"

using namespace pwlsim::test;
using Catch::Matchers::Contains;

namespace {

// A divider: v(b) = R/(1 + R).
const std::string sweep = "s\nV1 a 0 1\nR1 a b 1\nR2 b 0 {R}\n.step param R list 1 3\n.meas m avg v(b)\n.tran 1 2\n.save v(b)\n";

}  // namespace

TEST_CASE("--no-rows: measurements without a file", "[unit]") {
  const Scratch scratch;
  scratch.write("s.net", sweep);
  const auto before = scratch.names();
  const Finished finished = run_in(scratch, {"s.net", "--no-rows", "--jobs", "1"});
  CHECK(finished.status == 0);
  CHECK(finished.out == "R,m\n1,0.5\n3,0.75\n");
  CHECK_THAT(finished.err, Contains("wrote nothing: 2 runs, 0 rows"));
  CHECK(scratch.names() == before);
  const Json json = read_json(run_in(scratch, {"s.net", "--no-rows", "--json"}).out);
  CHECK(json["output"].kind == Json::Kind::null);
  CHECK(json["runs"].array[1]["measurements"].array[0]["value"].number == Approx(0.75).epsilon(1e-12));
}

TEST_CASE("--no-rows contradicts what needs rows, and --jobs is a number", "[unit]") {
  const Scratch scratch;
  scratch.write("s.net", sweep);
  for (const std::string option : {"--events", "--split", "--check", "-oa.csv", "--plot=a.svg", "--report=a.html", "--format=raw"}) {
    const Finished finished = run_in(scratch, {"s.net", "--no-rows", option});
    CHECK(finished.status == 2);
    CHECK_THAT(finished.err, Contains("error[E-option-conflict]: `--no-rows` and `--"));
  }
  for (const std::string jobs : {"0", "-1", "x", "1.5", "9999"}) {
    const Finished finished = run_in(scratch, {"s.net", "--jobs=" + jobs});
    CHECK(finished.status == 2);
    CHECK_THAT(finished.err, Contains("error[E-option-value]: `--jobs " + jobs + "` is not a number from 1 to 1024"));
  }
}

TEST_CASE("a file of more than a gigabyte is announced", "[unit]") {
  const Scratch scratch;
  // Ends after some 700 microseconds, when v(a) = exp(t / 1 us) leaves the range of numbers.
  scratch.write("g.net", "g\nC1 a 0 1u ic=1\nR1 a 0 -1\n.save v(a)\n.tran 10n 1 uic\n");
  // 1e8 rows of two numbers, 19 bytes each.
  CHECK_THAT(run_in(scratch, {"g.net"}).err,
             Contains("warning[W-large-output]: about 3.8 GB of rows go to g.csv (1e+08 rows of 2 columns)"));
  CHECK_THAT(run_in(scratch, {"g.net", "-o", "/dev/null"}).err, !Contains("W-large-output"));
  CHECK_THAT(run_in(scratch, {"g.net", "--no-rows"}).err, !Contains("W-large-output"));
}
