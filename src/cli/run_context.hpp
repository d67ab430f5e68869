#pragma once
/// The data that the analyses of one run share: the deck, its engine, files, and the texts at its end.

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "analysis/prepared_engine.hpp"
#include "analysis/run_json.hpp"
#include "analysis/run_recorder.hpp"
#include "analysis/transient.hpp"
#include "circuit/compile.hpp"
#include "cli/command_line.hpp"
#include "cli/messages.hpp"
#include "cli/output.hpp"
#include "cli/picture_file.hpp"
#include "waveform/output_file.hpp"

namespace pwlsim::cli {

/// For a deck with .step: the tables beside the rows, each with all runs.
struct SweepFiles {
  std::optional<waveform::OutputFile> orbit, response, derivatives;
};

struct RunContext {
  explicit RunContext(const RunOptions& run_options) : options(run_options), messages(run_options.quiet) {}

  const RunOptions& options;
  const std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
  Messages messages;
  SourceStore sources;
  std::vector<std::string> files;  ///< that were read
  std::optional<circuit::Compiled> compiled;
  analysis::PreparedEngine engine;
  analysis::OrbitSearch orbit_search;  ///< for a deck with only `.pss` and analyses around its orbit; else empty
  double reltol = 0.0;
  std::optional<waveform::OutputFile> rows_file, report_file;
  SweepFiles sweep_files;
  PictureFile plot_file;
  std::optional<analysis::RunRecorder> recorder;  ///< of the run that --plot and --report show
  measure::Record measured_run, measured_orbit;   ///< of .tran and of .pss, for .sens
  double seconds_search = 0.0;                    ///< for the simulations of .pss before the orbit
  analysis::RunReport report;
  analysis::RunOutcome outcome;

  [[nodiscard]] const circuit::Analyses& analyses() const { return compiled->analyses; }
  [[nodiscard]] bool is_stepped() const { return analyses().sweeps.runs() > 0; }
  [[nodiscard]] bool has_pictures() const { return plot_file.is_open() || report_file.has_value(); }
  /// The name of the file of rows, or of the table of a split sweep.
  [[nodiscard]] std::string rows_name() const;
  /// The stream for tables, so that they do not mix with rows.
  [[nodiscard]] Stream table_stream() const { return options.output == "-" ? Stream::error : Stream::output; }
  [[nodiscard]] double seconds() const;

  int fail(Status status, std::string id, std::string text) { return cli::fail(messages, status, std::move(id), std::move(text)); }
  /// An output file, which must not be one of those read.
  [[nodiscard]] int open(const std::string& name, std::optional<waveform::OutputFile>& file) {
    return open_output(name, files, messages, file);
  }
  /// Remarks, jumps and sums of a run.
  void take_remarks(const engine::Answer& answer);
  /// A failed measurement does not fail the run. Returns the exit status of printing them.
  int report_measurements(const measure::Results& results, bool is_complete);
  void note_rows(bool write_failed, bool complete, double end);
  /// Ends a run of rows, which are in `file`.
  int conclude(const analysis::TransientRun& run, const waveform::OutputFile& file);
  /// Prints the lines after the summary.
  void tell_details();

 private:
  [[nodiscard]] bool concerns_nobody(const engine::Remark& remark) const;
  void report_failures(const measure::Results& results, bool is_complete);
};

}  // namespace pwlsim::cli
