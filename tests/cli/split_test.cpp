// --split: a file a run of .step, and a table of the runs.

#include <csignal>

#include "cli/run_in.hpp"
#include "support/json.hpp"

using namespace pwlsim::test;
using Catch::Matchers::Contains;
using Names = std::vector<std::string>;

namespace {

/// A rectifier with R into C, and its swept values with a card `steps`.
std::string swept_rectifier(const std::string& steps) {
  return "rectifier\nV1 a 0 SIN(0 10 50)\nD1 a b DI\nRS b out {R}\nC1 out 0 {C}\nR1 out 0 100\n.model DI D\n" + steps +
         ".tran 1m 40m uic\n.save v(out) i(D1)\n";
}

/// Has no solution for x = −2 from 2 ms on, and no first row for x = −1: 1/(x+1) has no value.
const std::string failing =
    "some fail\nI1 0 a PULSE(1 {x} 2m 0 0 1 2)\nD1 a b DI\nR1 b 0 {1/(x+1)}\n.step param x list 1 -2 -1 3\n.model DI D\n.tran 2m 4m\n.save "
    "v(b)\n";

}  // namespace

TEST_CASE("--split writes each run as the deck with its values does by itself, to the last byte", "[unit]") {
  const std::string format = GENERATE("csv", "raw");
  const Scratch scratch;
  scratch.write("r.net", swept_rectifier(".step param R list 1 3\n.step param C list 100u 300u\n"));
  const Finished finished = run_in(scratch, {"r.net", "--split", "--events", "--format", format, "-o", "out." + format});
  CHECK(finished.status == 0);
  CHECK_THAT(finished.err, Contains("wrote out.runs.csv and 4 files of runs: 4 runs, "));
  CHECK(scratch.names() == Names{"out.1." + format, "out.2." + format, "out.3." + format, "out.4." + format, "out.runs.csv", "r.net"});
  std::string table = "R,C,file,rows,end,failure\n";
  int run = 0;
  for (const std::string c : {"1e-04", "3e-04"})
    for (const std::string r : {"1", "3"}) {
      scratch.write("one.net", swept_rectifier(".param R=" + r + " C=" + c + "\n"));
      REQUIRE(run_in(scratch, {"one.net", "--events", "--format", format, "--json", "-o", "one"}).status == 0);
      const std::string name = "out." + std::to_string(++run) + "." + format;
      CHECK(read_file(scratch / name) == read_file(scratch / "one"));
      const double rows = read_json(run_in(scratch, {"one.net", "--events", "--json"}).out)["output"]["rows"].number;
      table += r + "," + c + "," + name + "," + std::to_string(static_cast<int>(rows)) + ",0.04,\n";
    }
  CHECK(read_file(scratch / "out.runs.csv") == table);
}

TEST_CASE("--split: measurements stay one table; --json names the files", "[unit]") {
  const Scratch scratch;
  scratch.write("d.net", "d\nV1 a 0 {V}\nR1 a 0 1\n.step param V list 1 2\n.tran 1 1\n.meas m AVG v(a)\n");
  CHECK(run_in(scratch, {"d.net", "--split", "--quiet"}).out == "V,m\n1,1\n2,2\n");
  const Json json = read_json(run_in(scratch, {"d.net", "--split", "--json"}).out);
  CHECK(json["output"]["file"].string == "d.runs.csv");
  CHECK(json["output"]["rows"].number == 4.0);
  CHECK(json["runs"][1]["file"].string == "d.2.csv");
  CHECK(read_json(run_in(scratch, {"d.net", "--json"}).out)["runs"][1]["file"].kind == Json::Kind::null);
}

TEST_CASE("--split: a run that fails keeps its rows and is in the table; what has no rows has no file", "[unit]") {
  const Scratch scratch;
  scratch.write("f.net", failing);
  scratch.write("f.3.csv", "older\n");
  CHECK(run_in(scratch, {"f.net", "--split"}).status == 1);
  CHECK(scratch.names() == Names{"f.1.csv", "f.2.csv", "f.3.csv", "f.4.csv", "f.net", "f.runs.csv"});
  CHECK(read_file(scratch / "f.2.csv") == "time,v(b)\n0,-1\n");
  CHECK(read_file(scratch / "f.3.csv") == "older\n");
  CHECK(read_file(scratch / "f.4.csv") == "time,v(b)\n0,0.25\n0.002,0.75\n0.004,0.75\n");
  const std::string table = read_file(scratch / "f.runs.csv");
  CHECK_THAT(table,
             Contains("x,file,rows,end,failure\n1,f.1.csv,3,0.004,\n-2,f.2.csv,1,0.002,\"E-no-solution: no solution continues at ") &&
                 Contains("\n-1,,0,0,E-not-finite: division by zero") && Contains("\n3,f.4.csv,3,0.004,\n"));
}

TEST_CASE("--split refuses what it cannot do, and leaves nothing behind", "[unit]") {
  const Scratch scratch;
  const std::string deck = "d\nV1 a 0 {V}\nR1 a 0 1\n.step param V list 1 2\n";
  scratch.write("d.net", deck + ".tran 1 1\n");
  scratch.write("o.net", deck + ".op\n");
  scratch.write("d.2.csv", deck + ".tran 1 1\n");
  const Names before = scratch.names();
  const auto refused = [&](const Names& arguments, const std::string& message) {
    const Finished finished = run_in(scratch, arguments);
    CHECK(finished.status == 2);
    CHECK_THAT(finished.err, Contains(message));
    CHECK(scratch.names() == before);
  };
  refused({"d.net", "--split", "-o", "-"}, "error[E-option-conflict]: `--split` writes several files, which standard output cannot take");
  refused({"d.net", "--split", "-o", "/dev/null"}, "error[E-option-conflict]: `--split` makes the names of its files of `/dev/null`");
  refused({"d.net", "--split", "-o", "./"}, "error[E-option-conflict]: `--split` makes the names of its files of `./`");
  refused({"d.net", "--split", "--stats", "./d.7.csv"}, "error[E-option-conflict]: `--split` and `--stats` would both write `./d.7.csv`");
  refused({"d.net", "--split", "--stats", "d.runs.csv"}, "would both write `d.runs.csv`");
  refused({"o.net", "--split"}, "error[E-no-transient]: the deck has no .tran");
  refused({"d.2.csv", "--split", "-o", "d.csv"}, "error[E-output-is-deck]: d.2.csv is the deck itself");
  CHECK(run_in(scratch, {"d.net", "--split", "-o", "none/d.csv"}).status == 3);
  CHECK(scratch.names() == before);
  CHECK(run_in(scratch, {"d.net", "--split", "--stats", "d.csv", "--quiet"}).status == 0);  // which it does not write
}

TEST_CASE("--split: after a failure to write no run begins, and the table tells", "[unit]") {
  const Scratch scratch;
  // 5000 rows of some 10 bytes: no file may grow so large. The first run has two rows.
  scratch.write("w.net", "w\nV1 a 0 1\nR1 a 0 1\n.step param T list 1m 1 1 1 1 1 1 1\n.tran 1m {5*T}\n.save v(a)\n");
  SpawnOptions options;
  options.file_size = 2000;
  const Finished finished = run_in(scratch, {"w.net", "--split"}, options);
  CHECK(finished.status == 3);
  CHECK_THAT(finished.err, Contains("error[E-cannot-write]: run with T=1: w.") && Contains("the rows written are in w."));
  CHECK(read_file(scratch / "w.1.csv") == "time,v(a)\n0,1\n0.001,1\n0.002,1\n0.003,1\n0.004,1\n0.005,1\n");
  CHECK_FALSE(scratch.holds("w.2.csv"));
  CHECK_THAT(read_file(scratch / "w.runs.csv"),
             Contains("T,file,rows,end,failure\n0.001,w.1.csv,6,0.005,\n1,,") && Contains(",E-cannot-write: w."));

  std::filesystem::create_directory(scratch / "d.2.csv");
  scratch.write("d.net", "d\nV1 a 0 {V}\nR1 a 0 1\n.step param V list 1 2\n.tran 1 1\n");
  const Finished onto_folder = run_in(scratch, {"d.net", "--split"});
  CHECK(onto_folder.status == 3);
  CHECK_THAT(onto_folder.err, Contains("error[E-cannot-write]: run with V=2: d.2.csv: Is a directory"));
}

TEST_CASE("--split: a signal keeps the runs that are done and the rows of those that are not", "[unit]") {
  const Scratch scratch;
  // The second run has 1e9 periods.
  scratch.write("long.net",
                "long\nV1 a 0 PULSE(0 1 0 0 0 0.5n 1n)\nR1 a b 1k\nC1 b 0 1n\n.step param T list 2n 0.9\n.tran 1n {T} 0 uic\n.save v(a)\n");
  Spawned program({"long.net", "--split"}, {.folder = scratch.path().string()});
  REQUIRE(wait_until(30, [&] { return scratch.holds("long.1.csv") && scratch.holds("long.2.csv.partial"); }));
  pause(300);
  program.send(SIGINT);
  const Finished finished = program.finish();
  INFO(finished.err);
  CHECK(finished.status == 130);
  CHECK_THAT(finished.err,
             Contains("error[E-interrupted]: stopped by a signal after 1 of 2 runs; their files are listed in long.runs.csv"));
  CHECK(scratch.names() == Names{"long.1.csv", "long.2.csv", "long.net", "long.runs.csv"});
  CHECK(read_file(scratch / "long.1.csv") == "time,v(a)\n0,1\n1e-09,1\n2e-09,1\n");
  CHECK(read_file(scratch / "long.2.csv").rfind("time,v(a)\n0,1\n1e-09,1\n", 0) == 0);
  CHECK_THAT(read_file(scratch / "long.runs.csv"),
             Contains("T,file,rows,end,failure\n2e-09,long.1.csv,3,2e-09,\n0.9,long.2.csv,") && Contains("E-interrupted: "));
}
