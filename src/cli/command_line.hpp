#pragma once
/// The command line as data.

#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "analysis/prepared_engine.hpp"
#include "base/diagnostic.hpp"

namespace pwlsim::cli {

using analysis::EngineChoice;

/// `pwlsim circuit.net …`: run the analyses of a deck.
struct RunOptions {
  std::string deck;
  std::string output;  ///< never empty; "-" is standard output
  std::string stats;   ///< empty: none; "-" is standard output
  std::string plot;    ///< empty: none; a file .svg or .png
  std::string report;  ///< empty: none
  analysis::RowFormat format = analysis::RowFormat::csv;
  EngineChoice engine = EngineChoice::automatic;
  std::optional<double> reltol;  ///< --reltol
  std::size_t jobs = 0;          ///< threads of a sweep; 0: one per core
  bool no_rows = false;          ///< `output` is then /dev/null
  bool check = false;            ///< the other engine runs too: analysis/check.hpp
  bool json = false;
  bool events = false;
  bool split = false;  ///< a file for each run of .step: split_files.hpp
  bool quiet = false;
  bool verbose = false;
  bool progress = true;
};

/// `pwlsim inspect circuit.net …`: describe the model of a deck.
struct InspectOptions {
  std::string deck;
  std::optional<std::vector<std::pair<std::string, bool>>> mode;  ///< ports of --mode, on or off
  bool json = false;
  bool quiet = false;
};

/// `pwlsim export circuit.net -o out.cir …`: the smoothed equivalent as an ngspice deck.
struct ExportOptions {
  std::string deck;
  std::string output;       ///< never empty; "-" is standard output
  double sharpness = 1e-3;  ///< --smooth
  bool quiet = false;
};

/// `pwlsim compare circuit.net …`: run that deck in ngspice and report the difference.
struct CompareOptions {
  std::string deck;
  std::string plot;         ///< empty: none
  double sharpness = 1e-3;  ///< --smooth
  double budget = 10.0;     ///< --budget: s that ngspice may take in all
  bool json = false;
  bool quiet = false;
  bool verbose = false;
  bool progress = true;
};

/// Text asked for by --help or --version.
struct Information {
  std::string text;
};

/// The mistakes of the command line, in `diagnostics`.
struct Refused {
  Diagnostics diagnostics;
};

using CommandLine = std::variant<RunOptions, InspectOptions, ExportOptions, CompareOptions, Information, Refused>;

/// `arguments` without the program's name. Flags may precede or follow the file; words after `--` are not flags. The first word that is not a
/// flag is a subcommand if it names one; write a file of that name as `./inspect` or after `--`.
[[nodiscard]] CommandLine read_command_line(const std::vector<std::string>& arguments, const std::string& version);

/// circuit.csv, or circuit.raw, for any/path/circuit.net.
[[nodiscard]] std::string default_output(const std::string& deck, analysis::RowFormat format = analysis::RowFormat::csv);

}  // namespace pwlsim::cli
