#include "cli/command_line.hpp"

#include <catch2/catch.hpp>

#include "base/source.hpp"

using namespace pwlsim;
using Words = std::vector<std::string>;

namespace {

cli::RunOptions accepted(const Words& arguments) {
  const cli::CommandLine command = cli::read_command_line(arguments, "1.2.3");
  REQUIRE(std::holds_alternative<cli::RunOptions>(command));
  return std::get<cli::RunOptions>(command);
}

std::string information(const Words& arguments) {
  const cli::CommandLine command = cli::read_command_line(arguments, "1.2.3");
  REQUIRE(std::holds_alternative<cli::Information>(command));
  return std::get<cli::Information>(command).text;
}

/// All complaints, each on a line of its own.
std::string complaints(const Words& arguments) {
  const cli::CommandLine command = cli::read_command_line(arguments, "1.2.3");
  REQUIRE(std::holds_alternative<cli::Refused>(command));
  std::string text;
  for (const Diagnostic& diagnostic : std::get<cli::Refused>(command).diagnostics.all()) text += render(diagnostic, {});
  return text;
}

}  // namespace

TEST_CASE("the rows go to the deck's name with .csv in the current directory", "[unit]") {
  CHECK(accepted({"circuit.net"}).output == "circuit.csv");
  CHECK(accepted({"some/where/circuit.net"}).output == "circuit.csv");
  CHECK(accepted({"circuit"}).output == "circuit.csv");
  CHECK(accepted({"a.b.cir"}).output == "a.b.csv");
}

TEST_CASE("flags may stand before or after the file", "[unit]") {
  const Words arguments = GENERATE(Words{"c.net", "-o", "x.csv", "--events", "--stats", "s.json", "--no-progress"},
                                   Words{"-o", "x.csv", "--events", "--stats=s.json", "--no-progress", "c.net"},
                                   Words{"--events", "-ox.csv", "c.net", "--no-progress", "--stats", "s.json"},
                                   Words{"--output=x.csv", "--events", "--no-progress", "--stats", "s.json", "--", "c.net"});
  const cli::RunOptions options = accepted(arguments);
  CHECK(options.deck == "c.net");
  CHECK(options.output == "x.csv");
  CHECK(options.stats == "s.json");
  CHECK(options.events);
  CHECK_FALSE(options.progress);
  CHECK_FALSE(options.quiet);
}

TEST_CASE("what is supported is accepted", "[unit]") {
  const std::string engine = GENERATE("auto", "exact");
  CHECK(accepted({"c.net", "--engine", engine, "--reltol", "1e-6", "--format", "csv"}).deck == "c.net");
  CHECK(accepted({"c.net", "-o", "-"}).output == "-");
  CHECK(accepted({"c.net", "--quiet"}).quiet);
  CHECK_FALSE(accepted({"c.net", "--quiet"}).progress);
  CHECK(accepted({"c.net", "--verbose"}).verbose);
}

TEST_CASE("the format names the file of rows", "[unit]") {
  CHECK(accepted({"c.net"}).format == analysis::RowFormat::csv);
  CHECK(accepted({"c.net", "--format", "csv"}).output == "c.csv");
  CHECK(accepted({"c.net", "--format", "raw"}).format == analysis::RowFormat::raw);
  CHECK(accepted({"a/c.net", "--format", "raw"}).output == "c.raw");
  CHECK(accepted({"c.net", "--format", "raw", "-o", "x.csv"}).output == "x.csv");
}

TEST_CASE("the engine and its tolerance are taken", "[unit]") {
  CHECK(accepted({"c.net"}).engine == cli::EngineChoice::automatic);
  CHECK(accepted({"c.net", "--engine", "auto"}).engine == cli::EngineChoice::automatic);
  CHECK(accepted({"c.net", "--engine", "exact"}).engine == cli::EngineChoice::exact);
  CHECK(accepted({"c.net", "--engine", "sparse"}).engine == cli::EngineChoice::sparse);
  CHECK_FALSE(accepted({"c.net"}).reltol);
  CHECK(accepted({"c.net", "--reltol", "1e-6"}).reltol == 1e-6);
}

TEST_CASE("a file named like a subcommand or an option is reached", "[unit]") {
  CHECK(accepted({"./inspect"}).deck == "./inspect");
  CHECK(accepted({"--", "compare"}).deck == "compare");
  CHECK(accepted({"--", "--events"}).deck == "--events");
  CHECK(accepted({"-o", "export", "c.net"}).output == "export");
}

TEST_CASE("export takes a deck, a name for its own and a sharpness", "[unit]") {
  const auto exported = [](const Words& arguments) {
    const cli::CommandLine command = cli::read_command_line(arguments, "1.2.3");
    REQUIRE(std::holds_alternative<cli::ExportOptions>(command));
    return std::get<cli::ExportOptions>(command);
  };
  CHECK(exported({"export", "c.net", "-o", "c.cir"}).deck == "c.net");
  CHECK(exported({"export", "c.net", "-o", "c.cir"}).output == "c.cir");
  CHECK(exported({"export", "c.net", "-o", "c.cir"}).sharpness == 1e-3);
  CHECK(exported({"export", "-o", "-", "--smooth", "1e-4", "c.net"}).sharpness == 1e-4);
  CHECK(exported({"--quiet", "export", "c.net", "-o", "c.cir"}).quiet);
  CHECK(complaints({"export", "c.net"}).find("error[E-option-value]: pwlsim export needs a name for the deck it writes; try -o out.cir") ==
        0);
  CHECK(complaints({"export", "-o", "c.cir"}).find("error[E-no-deck]") == 0);
  CHECK(complaints({"export", "c.net", "-o", "c.cir", "--smooth", "no"})
            .find("error[E-option-value]: `--smooth no` is not a number from 1e-09 to 1") == 0);
}

TEST_CASE("the help of export and compare, to the letter", "[unit]") {
  CHECK(information({"export", "--help"}) ==
        "Usage: pwlsim export circuit.net -o out.cir [--smooth X]\n"
        "\n"
        "  circuit.net         The deck: a SPICE-like netlist, or an LTspice schematic (.asc)\n"
        "\n"
        "Options:\n"
        "  -h,--help           Print this text and stop\n"
        "  -o,--output FILE    The ngspice deck; '-' is standard output\n"
        "  --smooth X          Sharpness: resistance of an ideal contact in ohm, width of a step, 1e-9 to 1 (default: 1e-3)\n"
        "  --quiet             Print only errors: no notes and warnings\n"
        "\n"
        "Writes a deck for stock ngspice in batch mode (ngspice -b -r out.raw out.cir): numbers\n"
        "expanded, ideal diodes and switches with resistances, steps and corners rounded.\n"
        "For a schematic, schematic.asc -o out.net writes its netlist instead.\n");
  CHECK(information({"compare", "-h"}) ==
        "Usage: pwlsim compare circuit.net [--budget S] [--verbose] [--smooth X] [--json] [--plot out.svg]\n"
        "\n"
        "  circuit.net         The deck: a SPICE-like netlist, or an LTspice schematic (.asc)\n"
        "\n"
        "Options:\n"
        "  -h,--help           Print this text and stop\n"
        "  --budget S          How long ngspice may run, in seconds (default: 10); a longer run is compared up to the time reached\n"
        "  --smooth X          First smoothing, 1e-9 to 1 (default: 1e-3)\n"
        "  --json              Print JSON, with all digits\n"
        "  --plot FILE.svg     Draw the waveforms of both programs in one picture\n"
        "  --verbose           Print the result of each signal and of each setting of ngspice\n"
        "  --no-progress       Show no progress bar\n"
        "  --quiet             Print only errors: no notes and warnings\n"
        "\n"
        "Runs the deck, and its smoothed equivalent in ngspice at ever finer steps and smoothing until\n"
        "the result converges; reports how far apart the two are and both run times. --verbose: for each\n"
        "signal, how much of the difference ngspice's own errors explain, and the error of its switching times.\n");
}

TEST_CASE("compare takes a deck, a picture, a sharpness, a budget, --json and --verbose", "[unit]") {
  const auto compared = [](const Words& arguments) {
    const cli::CommandLine command = cli::read_command_line(arguments, "1.2.3");
    REQUIRE(std::holds_alternative<cli::CompareOptions>(command));
    return std::get<cli::CompareOptions>(command);
  };
  CHECK(compared({"compare", "c.net"}).deck == "c.net");
  CHECK(compared({"compare", "c.net"}).plot.empty());
  CHECK(compared({"compare", "c.net", "--plot", "p.svg"}).plot == "p.svg");
  CHECK(compared({"compare", "c.net", "--json", "--smooth", "1e-2"}).json);
  CHECK(compared({"compare", "c.net", "--smooth", "1e-2"}).sharpness == 1e-2);
  CHECK(compared({"compare", "c.net"}).budget == 10.0);
  CHECK(compared({"compare", "c.net", "--budget", "2.5", "--verbose"}).budget == 2.5);
  CHECK(compared({"compare", "c.net", "--verbose"}).verbose);
  CHECK(complaints({"compare", "c.net", "--budget", "0"}).find("error[E-option-value]: `--budget 0` is not a time") == 0);
  CHECK(complaints({"compare"}).find("error[E-no-deck]") == 0);
  CHECK(complaints({"compare", "c.net", "--plot", "-"}).find("error[E-option-value]: `--plot -`") == 0);
}

TEST_CASE("inspect takes a deck, a mode and --json", "[unit]") {
  const auto inspect = [](const Words& arguments) {
    const cli::CommandLine command = cli::read_command_line(arguments, "1.2.3");
    REQUIRE(std::holds_alternative<cli::InspectOptions>(command));
    return std::get<cli::InspectOptions>(command);
  };
  CHECK(inspect({"inspect", "c.net"}).deck == "c.net");
  CHECK_FALSE(inspect({"inspect", "c.net"}).mode);
  CHECK_FALSE(inspect({"inspect", "c.net"}).json);
  const Words words = GENERATE(Words{"inspect", "c.net", "--mode", "D1=on,X1.D2=OFF", "--json", "--quiet"},
                               Words{"inspect", "--json", "--mode=D1=on,X1.D2=OFF", "--quiet", "c.net"},
                               Words{"--json", "--quiet", "inspect", "--mode", " D1 = on, X1.D2=OFF ", "--", "c.net"});
  const cli::InspectOptions options = inspect(words);
  CHECK(options.deck == "c.net");
  CHECK(options.json);
  CHECK(options.quiet);
  REQUIRE(options.mode);
  CHECK(*options.mode == std::vector<std::pair<std::string, bool>>{{"D1", true}, {"X1.D2", false}});
}

TEST_CASE("a mode that cannot be read is refused before the deck is", "[golden]") {
  const std::string text = GENERATE("", "D1", "D1=", "=on", " =on", "D1=maybe", "D1=on,", "D1=on;D2=off");
  CHECK(complaints({"inspect", "c.net", "--mode", text}).find("error[E-option-value]: `--mode` ") == 0);
  CHECK(complaints({"inspect"}).find("error[E-no-deck]") == 0);
  CHECK(complaints({"inspect", "c.net", "--jsn"}) == "error[E-unknown-argument]: `--jsn` is not an option of pwlsim; try `--json`\n");
  CHECK(
      complaints({"inspect", "c.net", "--mode", "D1=on", "--mode", "D2=on"}).find("error[E-repeated-option]: `--mode` is given 2 times") ==
      0);
}

TEST_CASE("wrong command lines are refused with a cure", "[golden]") {
  CHECK(complaints({}) == "error[E-no-deck]: no deck is given; try pwlsim circuit.net, or pwlsim --help\n");
  CHECK(complaints({"a.net", "b.net"}).find("error[E-too-many-files]: one deck is run at a time") == 0);
  CHECK(complaints({"c.net", "--evnts"}) == "error[E-unknown-argument]: `--evnts` is not an option of pwlsim; try `--events`\n");
  CHECK(complaints({"c.net", "--zzz=1"}) == "error[E-unknown-argument]: `--zzz` is not an option of pwlsim; try pwlsim --help\n");
  CHECK(complaints({"c.net", "-o"}) == "error[E-option-value]: `--output` needs a value; try pwlsim --help\n");
  CHECK(complaints({"-o", "--events", "c.net"}).find("error[E-option-value]: `--output` needs a value") == 0);
  CHECK(complaints({"c.net", "-o", ""}).find("error[E-option-value]") == 0);
  CHECK(complaints({"c.net", "-o", "a", "-o", "b"}).find("error[E-repeated-option]: `--output` is given 2 times") == 0);
  CHECK(complaints({"c.net", "--engine", "warp"}).find("error[E-option-value]: `--engine warp` does not name an engine") == 0);
  CHECK(complaints({"c.net", "--format", "xml"}).find("error[E-option-value]: `--format xml` names no format") == 0);
  CHECK(complaints({"c.net", "--quiet=banana"}).find("error[E-option-value]") == 0);
  CHECK(complaints({"c.net", "--quiet", "--verbose"}).find("error[E-option-conflict]") == 0);
}

TEST_CASE("--reltol is a positive number", "[unit]") {
  const std::string text = GENERATE("0", "-1", "abc", "1e-4x", "inf", "nan", "1e999");
  CHECK(complaints({"c.net", "--reltol", text}).find("error[E-option-value]: `--reltol " + text) == 0);
}

TEST_CASE("rows and statistics do not go to one file", "[unit]") {
  CHECK(complaints({"c.net", "--stats", "c.csv"}).find("error[E-option-conflict]") == 0);
  CHECK(complaints({"c.net", "--stats", "./c.csv"}).find("error[E-option-conflict]") == 0);
  CHECK(complaints({"c.net", "-o", "-", "--stats", "-"}).find("error[E-option-conflict]") == 0);
}

TEST_CASE("all complaints come in one go", "[unit]") {
  const std::string text = complaints({"--engine", "warp", "--format", "xml", "--reltol", "x"});
  CHECK(std::count(text.begin(), text.end(), '\n') == 4);  // the deck is missing too
}

TEST_CASE("help and version answer whatever else is given", "[unit]") {
  CHECK(information({"--version"}) == "pwlsim 1.2.3\n");
  CHECK(information({"c.net", "--version", "--quiet"}) == "pwlsim 1.2.3\n");
  for (const char* option :
       {"--output", "--events", "--engine", "--reltol", "--stats", "--format", "--quiet", "--verbose", "--no-progress"}) {
    CHECK(information({"--help"}).find(option) != std::string::npos);
  }
  CHECK(information({"--nonsense", "--help"}).find("Usage: pwlsim") != std::string::npos);
  for (const char* name : {"inspect", "export", "compare"}) {
    CHECK(information({name, "--help"}).find("Usage: pwlsim " + std::string(name)) == 0);
  }
}
