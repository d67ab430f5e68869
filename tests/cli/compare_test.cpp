// pwlsim export and pwlsim compare as a user meets them.

#include <algorithm>
#include <catch2/catch.hpp>
#include <chrono>
#include <cstdlib>

#include "cli/run_in.hpp"
#include "spice/comparison.hpp"
#include "support/json.hpp"

using namespace pwlsim;
using namespace pwlsim::test;
using Catch::Matchers::Contains;
using Names = std::vector<std::string>;

namespace {

const std::string half_wave =
    "half wave\n"
    "V1 a 0 SIN(0 1 50)\n"
    "D1 a b D\n"
    "R1 b 0 1\n"
    ".model D D\n"
    ".save v(b) i(D1)\n"
    ".tran 1m 40m\n"
    ".end\n";

Finished run_beside_ngspice(const Scratch& scratch, const Names& arguments) {
  SpawnOptions options;
  options.limit_memory = false;  // ngspice is its child
  options.seconds = 110.0;
  return run_in(scratch, arguments, options);
}

/// PATH for the programs started meanwhile.
class Path {
 public:
  explicit Path(const std::string& value) : before_(std::getenv("PATH")) { ::setenv("PATH", value.c_str(), 1); }
  Path(const Path&) = delete;
  Path& operator=(const Path&) = delete;
  ~Path() { ::setenv("PATH", before_.c_str(), 1); }

 private:
  std::string before_;
};

bool has_ngspice() {
  if (spice::find_ngspice()) return true;
  WARN("ngspice is not installed: this test is skipped");
  return false;
}

std::string netlist_path(const std::string& name) { return std::string(PWLSIM_SOURCE_DIR) + "/netlists/" + name + ".net"; }

}  // namespace

TEST_CASE("export writes the deck it is told to, and nothing else", "[unit]") {
  const Scratch scratch;
  scratch.write("c.net", half_wave);
  const Finished finished = run_in(scratch, {"export", "c.net", "-o", "c.cir"});
  CHECK(finished.status == 0);
  CHECK(finished.out.empty());
  CHECK(scratch.names() == Names{"c.cir", "c.net"});
  CHECK(read_file(scratch / "c.cir") ==
        "* half wave\n"
        "V1 a 0 SIN(0 1 50 0 0 0)\n"
        "V.D1.i a D1.i 0\n"
        "A.D1 D1.i b A.D1.model\n"
        ".model A.D1.model sidiode(Ron=0.001 Roff=100000000 Vfwd=0)\n"
        "R1 b 0 1\n"
        ".save v(b)\n"
        ".save i(v.d1.i)\n"
        ".options reltol=0.0001 abstol=1e-9 vntol=1e-6 rshunt=1000000000000 method=trap\n"
        ".tran 0.001 0.04 0 4e-05\n"
        ".end\n");
  CHECK(run_in(scratch, {"export", "-o", "-", "c.net"}).out == read_file(scratch / "c.cir"));
  CHECK_THAT(run_in(scratch, {"export", "c.net", "-o", "-", "--smooth", "0.01"}).out, Contains("Ron=0.01 Roff=10000000 "));
}

TEST_CASE("export leaves nothing behind where the deck or the command line is wrong", "[unit]") {
  const Scratch scratch;
  scratch.write("c.net", half_wave);
  scratch.write("bad.net", "t\nR1 a 0 1\nX1 a 0 nothing\n.tran 1 2\n");
  const Names words =
      GENERATE(Names{"export", "c.net"}, Names{"export", "-o", "c.cir"}, Names{"export", "c.net", "-o", "c.net"},
               Names{"export", "bad.net", "-o", "c.cir"}, Names{"export", "c.net", "-o", "c.cir", "--smooth", "0"},
               Names{"export", "c.net", "-o", "c.cir", "--smooth", "2"}, Names{"export", "c.net", "-o", "c.cir", "--events"});
  const Finished finished = run_in(scratch, words);
  CHECK(finished.status == 2);
  CHECK_THAT(finished.err, Contains("error[E-"));
  CHECK(scratch.names() == Names{"bad.net", "c.net"});
  CHECK(read_file(scratch / "c.net") == half_wave);
}

TEST_CASE("export has status 3 where a file cannot be read or written", "[unit]") {
  const Scratch scratch;
  scratch.write("c.net", half_wave);
  CHECK(run_in(scratch, {"export", "missing.net", "-o", "c.cir"}).status == 3);
  CHECK(run_in(scratch, {"export", "c.net", "-o", "no/folder/c.cir"}).status == 3);
}

TEST_CASE("compare without ngspice says so and is done", "[unit]") {
  const Scratch scratch;
  scratch.write("c.net", half_wave);
  const Path path(scratch.path().string());
  const Finished text = run_beside_ngspice(scratch, {"compare", "c.net", "--plot", "c.svg"});
  CHECK(text.status == 0);
  CHECK(text.out.empty());
  CHECK_THAT(text.err, Contains("note[N-no-ngspice]") && Contains("apt install ngspice"));
  CHECK(scratch.names() == Names{"c.net"});
  const Finished json = run_beside_ngspice(scratch, {"compare", "c.net", "--json"});
  CHECK(json.status == 0);
  CHECK_THAT(json.out, Contains("\"skipped\": \"ngspice is not installed"));
}

TEST_CASE("compare refuses a deck without waveforms, and a wrong one", "[unit]") {
  const Scratch scratch;
  scratch.write("op.net", "t\nV1 a 0 1\nR1 a 0 1\n.op\n");
  const Finished finished = run_beside_ngspice(scratch, {"compare", "op.net"});
  CHECK(finished.status == 2);
  CHECK_THAT(finished.err, Contains("error[E-no-transient]"));
  CHECK(run_beside_ngspice(scratch, {"compare", "missing.net"}).status == 3);
  CHECK(run_beside_ngspice(scratch, {"compare", "op.net", "--mode", "x"}).status == 2);
}

TEST_CASE("a run that has no solution ends a comparison with status 1", "[unit]") {
  if (!has_ngspice()) return;
  const Scratch scratch;
  const Finished finished = run_beside_ngspice(scratch, {"compare", netlist_path("paper/relay_wrong")});
  CHECK(finished.status == 1);
  CHECK_THAT(finished.err, Contains("error[E-not-unique]"));
}

TEST_CASE("ngspice's own errors explain how far it is from the exact run", "[unit]") {
  if (!has_ngspice()) return;
  const std::string name = GENERATE("halfwave", "buck", "buck_dcm", "boost", "six_pulse", "diode_bridge", "fullwave_centre_tap",
                                    "flyback_ideal", "freewheel", "rlcd", "paper/saturation", "paper/optimal_control");
  INFO(name);
  const Scratch scratch;
  const Finished finished = run_beside_ngspice(scratch, {"compare", netlist_path(name), "--json", "--quiet", "--budget", "60"});
  REQUIRE(finished.status == 0);
  const Json report = JsonReader(finished.out).read();
  REQUIRE(report["signals"].array.size() != 0);
  for (std::size_t k = 0; k < report["signals"].array.size(); ++k) {
    const Json& signal = report["signals"][k];
    INFO(signal["name"].string);
    CHECK(signal["settled"].truth);
    CHECK(signal["explained"].truth);
    CHECK(signal["difference"].number <= spice::safety * (signal["discretisation"].number + signal["smoothing"].number) + 1e-9);
    CHECK(signal["difference"].number < 1e-3);
  }
}

TEST_CASE("an inelastic stop, which a smoothed diode turns into a spring, is not explained", "[unit]") {
  if (!has_ngspice()) return;
  const Scratch scratch;
  const Finished finished = run_beside_ngspice(scratch, {"compare", netlist_path("carts"), "--verbose", "--budget", "60"});
  CHECK(finished.status == 0);
  CHECK_THAT(finished.out, Contains("carts.net: differs by ") && Contains("; ngspice ") && Contains("NOT explained"));
}

TEST_CASE("compare reports in words, with the levels and the switching times, and draws both waveforms", "[unit]") {
  if (!has_ngspice()) return;
  const Scratch scratch;
  scratch.write("c.net", half_wave);
  const Finished finished = run_beside_ngspice(scratch, {"compare", "c.net", "--plot", "c.svg", "--verbose"});
  REQUIRE(finished.status == 0);
  CHECK_THAT(finished.out,
             Contains("signal") && Contains("discretisation") && Contains("smoothing") && Contains("v(b)") && Contains("i(D1)"));
  CHECK_THAT(finished.out, Contains("ngspice solves a smoothed circuit") && Contains("changes ngspice") && Contains("CPU"));
  CHECK(scratch.names() == Names{"c.net", "c.svg"});
  const std::string picture = read_file(scratch / "c.svg");
  CHECK_THAT(picture, Contains(">pwlsim<") && Contains(">ngspice<") && Contains(">v(b)<") && Contains("time (ms)"));
}

TEST_CASE("compare says in one line that both agree, and what they took", "[unit]") {
  if (!has_ngspice()) return;
  const Scratch scratch;
  scratch.write("c.net", half_wave);
  const Finished finished = run_beside_ngspice(scratch, {"compare", "c.net"});
  REQUIRE(finished.status == 0);
  CHECK(std::count(finished.out.begin(), finished.out.end(), '\n') == 1);
  CHECK_THAT(finished.out, Catch::Matchers::Matches("c\\.net: agrees to [-0-9.e]+ %: ngspice .* m?s, pwlsim .*s\n"));
}

TEST_CASE(
    "compare of a converter that ngspice does not run as it stands: small R-C across its contacts, within the budget, without rows of "
    "noise",
    "[unit]") {
  if (!has_ngspice()) return;
  const Scratch scratch;
  // A SEPIC whose diode and transistor are 1e8 ohm when they are off: without capacitance ngspice makes no progress in either method.
  scratch.write(
      "sepic.net",
      "SEPIC\nVin in 0 12\nL1 in a 22u\nM1 a g 0 0 NM\nVg g 0 PULSE(0 10 0 20n 20n 4u 10u)\nC1 a b 4.7u\nL2 b 0 22u\nD1 b out DS\n"
      "C2 out 0 100u\nR1 out 0 8\n.model NM VDMOS(Ron=10m Vto=3)\n.model DS D(Ron=10m Roff=1e8 Vfwd=0.4)\n.tran 1u 5m\n"
      ".save v(out) i(L1) i(Vg)\n");
  constexpr double budget = 6.0, start_of_programs = 6.0;  // where the machine is busy
  const auto begin = std::chrono::steady_clock::now();
  const Finished finished = run_beside_ngspice(scratch, {"compare", "sepic.net", "--json", "--quiet", "--budget", "6"});
  CHECK(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() < budget + start_of_programs);
  REQUIRE(finished.status == 0);
  const Json report = JsonReader(finished.out).read();
  CHECK_THAT(report["verdict"].string, Contains("agrees to ") && Contains("(the first ") && Contains(" of 5 ms)"));
  CHECK(report["until"].number < 5e-3);
  REQUIRE(report["signals"].array.size() == 2);  // a gate without current has no line
  for (const Json& signal : report["signals"].array) CHECK(signal["difference"].number < 5e-2);
  const auto& levels = report["levels"].array;
  CHECK(std::any_of(levels.begin(), levels.end(), [](const Json& level) { return level["method"].string == "trap+rc"; }));
}

TEST_CASE("compare leaves out what is below ngspice's own tolerance", "[unit]") {
  if (!has_ngspice()) return;
  const Scratch scratch;
  // A picoampere is what 1 V drives through 1 TΩ; ngspice's shunts from each node to ground are of that size.
  scratch.write("c.net", "divider\nV1 a 0 SIN(0 1 50)\nR1 a b 1k\nR2 b 0 1k\nV2 c 0 1\nR3 c 0 1t\n.tran 1m 20m\n.save v(b) i(R1) i(V2)\n");
  const Finished finished = run_beside_ngspice(scratch, {"compare", "c.net", "--json", "--quiet"});
  REQUIRE(finished.status == 0);
  const Json report = JsonReader(finished.out).read();
  CHECK(report["signals"].array.size() == 2);
  CHECK_THAT(report["verdict"].string, Contains("agrees to "));
}
