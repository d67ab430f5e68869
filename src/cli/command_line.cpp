#include "cli/command_line.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string_view>
#include <utility>

#include "base/names.hpp"
#include "cli/picture_file.hpp"
#include "cli/split_files.hpp"
#include "spice/deck.hpp"
#include "waveform/output_file.hpp"

namespace pwlsim::cli {
namespace {

struct Subcommand {
  std::string_view name;
  std::string_view arguments;
  std::string_view description;
};
constexpr std::string_view inspect_usage = "circuit.net [--mode D1=on,D2=off,…] [--json]";
constexpr std::string_view export_usage = "circuit.net -o out.cir [--smooth X]";
constexpr std::string_view compare_usage = "circuit.net [--budget S] [--verbose] [--smooth X] [--json] [--plot out.svg]";
constexpr std::array<Subcommand, 3> subcommands{{
    {"inspect", inspect_usage, "the model: islands, states, ports, (A,B,C,D) per switch position"},
    {"export", export_usage, "the smoothed equivalent as an ngspice deck"},
    {"compare", compare_usage, "run the deck in ngspice and report the difference and both times"},
}};

constexpr std::string_view help_footer =
    "Subcommands: inspect describes the model of a deck, export writes its smoothed equivalent\n"
    "for ngspice, compare runs both and compares them (see pwlsim inspect --help, and so on).\n"
    "\n"
    "Exit status: 0 done; 1 the run failed, the rows up to then are kept, or --check found a\n"
    "difference; 2 the deck or the command line is wrong; 3 a file cannot be read or written;\n"
    "130, 143 after SIGINT, SIGTERM, the rows up to then are kept; 141 after a closed pipe.";

class HelpText : public CLI::Formatter {
 public:
  explicit HelpText(std::string usage) : usage_(std::move(usage)) { column_width(22); }
  std::string make_usage(const CLI::App* app, std::string) const override {
    return fmt::format("{}Usage: pwlsim {}\n", app->get_description().empty() ? "" : "\n", usage_);
  }
  std::string make_positionals(const CLI::App*) const override {
    return "\n  circuit.net         The deck: a SPICE-like netlist, or an LTspice schematic (.asc)\n";
  }

 private:
  std::string usage_;
};

/// What CLI11 fills in; checked and turned into RunOptions afterwards, so that every complaint has our own form.
struct Raw {
  std::vector<std::string> files;
  std::string output, engine, reltol, stats, format, plot, report, mode, smooth, budget, jobs;
  bool events = false, quiet = false, verbose = false, no_progress = false, json = false, split = false, check = false, no_rows = false;
};

void add_options(CLI::App& app, Raw& raw, const std::string& version) {
  app.name("pwlsim");
  app.formatter(std::make_shared<HelpText>("circuit.net [options]"));
  app.footer(std::string(help_footer));
  app.allow_extras();
  app.set_help_flag("-h,--help", "Print this text and stop");
  app.set_version_flag("--version", "pwlsim " + version, "Print the version and stop");
  app.add_option("circuit", raw.files, "The deck: a SPICE-like netlist")->type_name("FILE");
  app.add_option("-o,--output", raw.output,
                 "The file of rows; '-' is standard output (default: the deck's name with .csv or .raw, in the current directory)")
      ->type_name("FILE");
  app.add_flag("--events", raw.events, "Add a row before and after every event");
  app.add_option("--engine", raw.engine, "auto, exact, modes, krylov or sparse (default: auto, by size)")->type_name("NAME");
  app.add_option("--reltol", raw.reltol,
                 "Bound on the local error of a step of the sparse engine (default: 1e-4); the exact engine needs none")
      ->type_name("X");
  app.add_option("--stats", raw.stats, "Write the statistics of the run as JSON; '-' is standard output")->type_name("FILE");
  app.add_option("--format", raw.format, "csv, or raw: SPICE's binary raw file (default: csv)")->type_name("NAME");
  app.add_flag("--split", raw.split, "Write one file for each run of .step, NAME.1.csv and so on, and a table of the runs, NAME.runs.csv");
  app.add_flag("--no-rows", raw.no_rows, "Write no rows, only measurements and statistics");
  app.add_option("--jobs", raw.jobs, "Number of .step runs at a time (default: one per core)")->type_name("N");
  app.add_option("--plot", raw.plot, "Draw the waveforms, events and modes, as SVG or PNG")->type_name("FILE.svg");
  app.add_option("--report", raw.report, "Write a web page with waveforms, measurements, events, certificate")->type_name("FILE.html");
  app.add_flag("--check", raw.check,
               "Run the other engine too, refine it, and report how far apart the two are; exit status 1 if they differ");
  app.add_flag("--json", raw.json, "Print a JSON summary of the run on standard output");
  app.add_flag("--quiet", raw.quiet, "Print only errors: no notes, warnings, summary or progress");
  app.add_flag("--verbose", raw.verbose, "Print run times, counts and what was not simulated as written");
  app.add_flag("--no-progress", raw.no_progress, "Show no progress bar");
}

/// What every subcommand has.
void add_common_options(CLI::App& app, Raw& raw, std::string_view name, std::string_view usage, std::string footer, std::string deck) {
  app.name(fmt::format("pwlsim {}", name));
  app.formatter(std::make_shared<HelpText>(fmt::format("{} {}", name, usage)));
  app.footer(std::move(footer));
  app.allow_extras();
  app.set_help_flag("-h,--help", "Print this text and stop");
  app.add_option("circuit", raw.files, std::move(deck))->type_name("FILE");
}

void add_quiet_option(CLI::App& app, Raw& raw) { app.add_flag("--quiet", raw.quiet, "Print only errors: no notes and warnings"); }

void add_inspect_options(CLI::App& app, Raw& raw) {
  add_common_options(app, raw, "inspect", inspect_usage,
                     "Describes the model of a deck: its islands, parts left out, states, ports, (A,B,C,D) per\n"
                     "switch position, the certificate of a unique solution, and the subspaces of a mode.",
                     "The deck; it needs no .tran");
  app.add_option("--mode", raw.mode, "Diodes and switches that are on or off, as D1=on,D2=off; all others are off")->type_name("LIST");
  app.add_flag("--json", raw.json, "Print JSON, with all digits");
  add_quiet_option(app, raw);
}

void add_export_options(CLI::App& app, Raw& raw) {
  add_common_options(app, raw, "export", export_usage,
                     "Writes a deck for stock ngspice in batch mode (ngspice -b -r out.raw out.cir): numbers\n"
                     "expanded, ideal diodes and switches with resistances, steps and corners rounded.\n"
                     "For a schematic, schematic.asc -o out.net writes its netlist instead.",
                     "The deck");
  app.add_option("-o,--output", raw.output, "The ngspice deck; '-' is standard output")->type_name("FILE");
  app.add_option("--smooth", raw.smooth, "Sharpness: resistance of an ideal contact in ohm, width of a step, 1e-9 to 1 (default: 1e-3)")
      ->type_name("X");
  add_quiet_option(app, raw);
}

void add_compare_options(CLI::App& app, Raw& raw) {
  add_common_options(app, raw, "compare", compare_usage,
                     "Runs the deck, and its smoothed equivalent in ngspice at ever finer steps and smoothing until\n"
                     "the result converges; reports how far apart the two are and both run times. --verbose: for each\n"
                     "signal, how much of the difference ngspice's own errors explain, and the error of its switching times.",
                     "The deck");
  app.add_option("--budget", raw.budget,
                 "How long ngspice may run, in seconds (default: 10); a longer run is compared up to the time reached")
      ->type_name("S");
  app.add_option("--smooth", raw.smooth, "First smoothing, 1e-9 to 1 (default: 1e-3)")->type_name("X");
  app.add_flag("--json", raw.json, "Print JSON, with all digits");
  app.add_option("--plot", raw.plot, "Draw the waveforms of both programs in one picture")->type_name("FILE.svg");
  app.add_flag("--verbose", raw.verbose, "Print the result of each signal and of each setting of ngspice");
  app.add_flag("--no-progress", raw.no_progress, "Show no progress bar");
  add_quiet_option(app, raw);
}

bool takes_value(const CLI::App& app, const std::string& name) {
  const CLI::Option* option = app.get_option_no_throw(name);
  return option != nullptr && option->get_items_expected_max() > 0;
}

/// The first argument that is neither an option nor the value of one; "" where `--` comes first or there is none.
std::string first_word(const CLI::App& app, const std::vector<std::string>& arguments) {
  for (std::size_t index = 0; index < arguments.size(); ++index) {
    const std::string& argument = arguments[index];
    if (argument == "--") return {};
    if (argument.size() < 2 || argument[0] != '-') return argument;
    if (takes_value(app, argument)) ++index;
  }
  return {};
}

class Complaints {
 public:
  void add(std::string id, std::string text) { diagnostics_.error(std::move(id), {}, std::move(text)); }
  [[nodiscard]] bool any() const { return diagnostics_.has_errors(); }
  Refused refused() { return {std::move(diagnostics_)}; }

 private:
  Diagnostics diagnostics_;
};

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

void complain_of_unknown(const CLI::App& app, Complaints& complaints) {
  for (const std::string& extra : app.remaining()) {
    if (extra == "--") continue;
    const std::string name = extra.substr(0, extra.find('='));
    const std::string near = nearest_name(name, option_names(app));
    complaints.add("E-unknown-argument",
                   fmt::format("`{}` is not an option of pwlsim; try {}", name, near.empty() ? "pwlsim --help" : '`' + near + '`'));
  }
}

/// CLI11 stops at the first option with too few or too many values.
void complain_of_parse_error(const CLI::App& app, const CLI::ParseError& error, Complaints& complaints) {
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_items_expected_max() == 1 && option->count() > 1) {
      complaints.add("E-repeated-option", fmt::format("`{}` is given {} times; try giving it once", option->get_name(), option->count()));
      return;
    }
  }
  const std::string text = error.what();
  const std::string name = text.substr(0, text.find(':'));
  if (app.get_option_no_throw(name) != nullptr && error.get_name() == "ArgumentMismatch") {
    complaints.add("E-option-value", fmt::format("`{}` needs a value; try pwlsim --help", name));
  } else {
    complaints.add("E-option-value", "an option has an invalid value; try pwlsim --help");
  }
}

void check_file_name(std::string_view option, const CLI::App& app, const std::string& value, Complaints& complaints) {
  if (app.count(std::string(option)) == 0) return;
  if (value.empty()) {
    complaints.add("E-option-value", fmt::format("`{}` needs a value; try {} out", option, option));
  } else if (value.size() > 1 && value[0] == '-') {
    complaints.add("E-option-value", fmt::format("`{}` needs a value: `{}` looks like an option; try `{} ./{}` if it is a file", option,
                                                 value, option, value));
  }
}

/// The kind of picture is told by its name.
void check_plot_name(const CLI::App& app, const std::string& value, Complaints& complaints) {
  check_file_name("--plot", app, value, complaints);
  const std::string kind = picture_kind(value);
  if (!value.empty() && kind != ".svg" && kind != ".png")
    complaints.add("E-option-value", fmt::format("`--plot {}` names no picture; try --plot out.svg or out.png", value));
}

EngineChoice engine_choice(const std::string& engine, Complaints& complaints) {
  if (engine == "sparse") return EngineChoice::sparse;
  if (engine == "exact") return EngineChoice::exact;
  if (engine == "krylov") return EngineChoice::krylov;
  if (engine == "modes") return EngineChoice::modes;
  if (!engine.empty() && engine != "auto")
    complaints.add("E-option-value", fmt::format("`--engine {}` does not name an engine; try auto, exact, modes, krylov or sparse", engine));
  return EngineChoice::automatic;
}

analysis::RowFormat row_format(const CLI::App& app, const std::string& format, Complaints& complaints) {
  if (format == "raw") return analysis::RowFormat::raw;
  if (app.count("--format") != 0 && format != "csv")
    complaints.add("E-option-value", fmt::format("`--format {}` names no format; try csv or raw", format));
  return analysis::RowFormat::csv;
}

/// 0 for what is none.
double positive_number(const std::string& text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool number = error == std::errc() && end == text.data() + text.size();
  return number && std::isfinite(value) && value > 0.0 ? value : 0.0;
}

std::optional<double> relative_tolerance(const std::string& text, Complaints& complaints) {
  const double value = positive_number(text);
  if (value == 0.0) {
    complaints.add("E-option-value", fmt::format("`--reltol {}` is not a positive number; try `--reltol 1e-4`", text));
  }
  return value;
}

std::size_t job_count(const std::string& text, Complaints& complaints) {
  constexpr std::size_t most_jobs = 1024;
  std::size_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < 1 || value > most_jobs)
    complaints.add("E-option-value", fmt::format("`--jobs {}` is not a number from 1 to {}; try `--jobs 2`", text, most_jobs));
  return value;
}

/// What needs the rows that `--no-rows` does without.
void check_no_rows(const CLI::App& app, const Raw& raw, Complaints& complaints) {
  if (!raw.no_rows) return;
  for (const char* option : {"--output", "--format", "--events", "--split", "--plot", "--report", "--check"})
    if (app.count(option) != 0)
      complaints.add("E-option-conflict", fmt::format("`--no-rows` and `{}` contradict each other; try one of them", option));
}

void check_files(const Raw& raw, Complaints& complaints) {
  if (raw.files.empty()) {
    complaints.add("E-no-deck", "no deck is given; try pwlsim circuit.net, or pwlsim --help");
  } else if (raw.files.size() > 1) {
    complaints.add("E-too-many-files",
                   fmt::format("one deck is run at a time, but {} are given, the second is `{}`; try one", raw.files.size(), raw.files[1]));
  }
}

std::filesystem::path resolved(const std::string& name) {
  std::error_code unresolved;
  const auto absolute = std::filesystem::absolute(waveform::final_target(name), unresolved);
  const auto canonical = std::filesystem::weakly_canonical(absolute, unresolved);
  return unresolved ? absolute : canonical;
}

bool one_target(const std::string& a, const std::string& b) { return !a.empty() && !b.empty() && (a == b || resolved(a) == resolved(b)); }

struct Target {
  std::string_view what;
  const std::string& name;
};

void check_targets(const std::vector<Target>& targets, Complaints& complaints) {
  for (auto first = targets.begin(); first != targets.end(); ++first)
    for (auto second = first + 1; second != targets.end(); ++second)
      if (one_target(first->name, second->name))
        complaints.add("E-option-conflict", fmt::format("{} and {} would both go to {}; try two files", first->what, second->what,
                                                        first->name == "-" ? "standard output" : '`' + second->name + '`'));
}

/// What `--split` writes stands beside `output`, and is none of the other files.
void check_split(const RunOptions& options, const std::vector<Target>& others, Complaints& complaints) {
  std::error_code unknown;
  const std::filesystem::path output(options.output);
  if (options.output == "-") {
    complaints.add("E-option-conflict", "`--split` writes several files, which standard output cannot take; try -o out.csv");
  } else if (!output.has_filename() || (exists(output, unknown) && !is_regular_file(output, unknown))) {
    complaints.add("E-option-conflict",
                   fmt::format("`--split` makes the names of its files of `{}`, which is not a file; try -o out.csv", options.output));
  }
  for (const Target& other : others)
    if (is_split_file(options.output, other.name))
      complaints.add("E-option-conflict", fmt::format("`--split` and {} would both write `{}`; try another name", other.what, other.name));
}

RunOptions run_options(const Raw& raw) {
  RunOptions options;
  options.deck = raw.files[0];
  options.stats = raw.stats;
  options.report = raw.report;
  options.plot = raw.plot;
  options.check = raw.check;
  options.no_rows = raw.no_rows;
  options.json = raw.json;
  options.events = raw.events;
  options.split = raw.split;
  options.quiet = raw.quiet;
  options.verbose = raw.verbose;
  options.progress = !raw.no_progress && !raw.quiet;
  return options;
}

CommandLine checked(const CLI::App& app, const Raw& raw, Complaints& complaints) {
  check_file_name("--output", app, raw.output, complaints);
  check_file_name("--stats", app, raw.stats, complaints);
  const EngineChoice engine = engine_choice(raw.engine, complaints);
  const analysis::RowFormat format = row_format(app, raw.format, complaints);
  std::optional<double> reltol;
  if (app.count("--reltol") != 0) reltol = relative_tolerance(raw.reltol, complaints);
  check_plot_name(app, raw.plot, complaints);
  check_file_name("--report", app, raw.report, complaints);
  if (raw.report == "-") complaints.add("E-option-value", "`--report -` would mix the page with other results; try --report out.html");
  if (raw.quiet && raw.verbose) complaints.add("E-option-conflict", "`--quiet` and `--verbose` contradict each other; try one of them");
  check_files(raw, complaints);
  check_no_rows(app, raw, complaints);
  const std::size_t jobs = app.count("--jobs") != 0 ? job_count(raw.jobs, complaints) : 0;
  if (complaints.any()) return complaints.refused();
  RunOptions options = run_options(raw);
  options.jobs = jobs;
  options.engine = engine;
  options.format = format;
  options.output = raw.no_rows ? "/dev/null" : raw.output.empty() ? default_output(options.deck, format) : raw.output;
  options.reltol = reltol;
  // As if it were the name of a file: standard output is one.
  const std::string json = options.json ? "-" : "";
  const std::string rows = options.split ? "" : options.output;
  const std::vector<Target> targets{
      {"the rows", rows}, {"`--stats`", options.stats}, {"`--plot`", options.plot}, {"`--report`", options.report}, {"`--json`", json}};
  if (options.split) check_split(options, targets, complaints);
  check_targets(targets, complaints);
  if (complaints.any()) return complaints.refused();
  return options;
}

std::string_view without_blanks(std::string_view text) {
  const std::size_t first = text.find_first_not_of(' ');
  return first == std::string_view::npos ? "" : text.substr(first, text.find_last_not_of(' ') + 1 - first);
}

/// `D1=on,D2=off`
std::vector<std::pair<std::string, bool>> read_mode(std::string_view text, Complaints& complaints) {
  std::vector<std::pair<std::string, bool>> mode;
  while (true) {
    const std::string_view item = text.substr(0, text.find(','));
    const std::size_t equals = item.find('=');
    const std::string_view name = without_blanks(item.substr(0, equals));
    const std::string_view state = equals == std::string_view::npos ? "" : without_blanks(item.substr(equals + 1));
    if (name.empty() || !(same_name(state, "on") || same_name(state, "off"))) {
      complaints.add("E-option-value",
                     fmt::format("`--mode` contains `{}`, which is not a port with its state; try D1=on or D1=off", item));
    } else {
      mode.emplace_back(name, same_name(state, "on"));
    }
    if (item.size() == text.size()) return mode;
    text.remove_prefix(item.size() + 1);
  }
}

CommandLine checked_inspect(const CLI::App& app, const Raw& raw, Complaints& complaints) {
  InspectOptions options;
  check_files(raw, complaints);
  if (app.count("--mode") != 0) options.mode = read_mode(raw.mode, complaints);
  if (complaints.any()) return complaints.refused();
  options.deck = raw.files[0];
  options.json = raw.json;
  options.quiet = raw.quiet;
  return options;
}

double read_sharpness(const CLI::App& app, const std::string& text, Complaints& complaints) {
  if (app.count("--smooth") == 0) return spice::default_sharpness;
  const double value = positive_number(text);
  if (value < spice::least_sharpness || value > spice::largest_sharpness)
    complaints.add("E-option-value", fmt::format("`--smooth {}` is not a number from {} to {}; try `--smooth {}`", text,
                                                 spice::least_sharpness, spice::largest_sharpness, spice::default_sharpness));
  return value;
}

CommandLine checked_export(const CLI::App& app, const Raw& raw, Complaints& complaints) {
  ExportOptions options;
  check_files(raw, complaints);
  check_file_name("--output", app, raw.output, complaints);
  if (app.count("--output") == 0) complaints.add("E-option-value", "pwlsim export needs a name for the deck it writes; try -o out.cir");
  options.sharpness = read_sharpness(app, raw.smooth, complaints);
  if (complaints.any()) return complaints.refused();
  options.deck = raw.files[0];
  options.output = raw.output;
  options.quiet = raw.quiet;
  return options;
}

double read_budget(const CLI::App& app, const std::string& text, Complaints& complaints) {
  constexpr double usual = 10.0, least = 0.1, most = 1e5;
  if (app.count("--budget") == 0) return usual;
  const double value = positive_number(text);
  if (value < least || value > most)
    complaints.add("E-option-value",
                   fmt::format("`--budget {}` is not a time from {} to {} seconds; try `--budget {}`", text, least, most, usual));
  return value;
}

CommandLine checked_compare(const CLI::App& app, const Raw& raw, Complaints& complaints) {
  CompareOptions options;
  check_files(raw, complaints);
  check_plot_name(app, raw.plot, complaints);
  options.sharpness = read_sharpness(app, raw.smooth, complaints);
  options.budget = read_budget(app, raw.budget, complaints);
  if (complaints.any()) return complaints.refused();
  options.deck = raw.files[0];
  options.plot = raw.plot;
  options.json = raw.json;
  options.quiet = raw.quiet;
  options.verbose = raw.verbose;
  options.progress = !raw.no_progress && !raw.quiet;
  return options;
}

/// Parses with `app`; what it filled in is then turned into the answer by `check`.
template <class Check>
CommandLine parsed(CLI::App& app, const std::vector<std::string>& arguments, const Check& check) {
  Complaints complaints;
  try {
    app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
  } catch (const CLI::CallForHelp&) {
    return Information{app.help()};
  } catch (const CLI::CallForVersion& call) {
    return Information{std::string(call.what()) + '\n'};
  } catch (const CLI::ParseError& error) {
    complain_of_parse_error(app, error, complaints);
    return complaints.refused();
  }
  complain_of_unknown(app, complaints);
  if (complaints.any()) return complaints.refused();
  return check(complaints);
}

/// `arguments` without the word itself.
template <class AddOptions, class Check>
CommandLine read_with(const std::vector<std::string>& arguments, const AddOptions& add_options_of, const Check& check) {
  Raw raw;
  CLI::App app;
  add_options_of(app, raw);
  return parsed(app, arguments, [&](Complaints& complaints) { return check(app, raw, complaints); });
}

CommandLine read_subcommand(const Subcommand& subcommand, std::vector<std::string> arguments) {
  arguments.erase(std::find(arguments.begin(), arguments.end(), subcommand.name));
  if (subcommand.name == "inspect") return read_with(arguments, add_inspect_options, checked_inspect);
  if (subcommand.name == "export") return read_with(arguments, add_export_options, checked_export);
  return read_with(arguments, add_compare_options, checked_compare);
}

}  // namespace

std::string default_output(const std::string& deck, analysis::RowFormat format) {
  return std::filesystem::path(deck).stem().string() + (format == analysis::RowFormat::raw ? ".raw" : ".csv");
}

CommandLine read_command_line(const std::vector<std::string>& arguments, const std::string& version) {
  Raw raw;
  CLI::App app("Exact simulation of piecewise-linear circuits: runs the analyses in a deck and writes the waveforms as CSV.");
  add_options(app, raw, version);

  const std::string word = first_word(app, arguments);
  const auto* subcommand = std::find_if(subcommands.begin(), subcommands.end(), [&](const Subcommand& s) { return s.name == word; });
  if (subcommand != subcommands.end()) return read_subcommand(*subcommand, arguments);

  return parsed(app, arguments, [&](Complaints& complaints) { return checked(app, raw, complaints); });
}

}  // namespace pwlsim::cli
