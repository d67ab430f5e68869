#pragma once
/// What the analyses of one run share: the deck, its engine, files, and what there is to say of it at the end.

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

/// Of a deck with .step: what stands beside the rows, a table for all runs each.
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
  analysis::OrbitSearch orbit_search;  ///< of a deck with nothing but `.pss` and what goes around it; else empty
  double reltol = 0.0;
  std::optional<waveform::OutputFile> rows_file, report_file;
  SweepFiles sweep_files;
  PictureFile plot_file;
  std::optional<analysis::RunRecorder> recorder;  ///< of the rows that --plot and --report show
  measure::Record measured_run, measured_orbit;   ///< of .tran and of .pss, for .sens
  double seconds_search = 0.0;                    ///< of what .pss simulates on its way to the orbit
  analysis::RunReport report;
  analysis::RunOutcome outcome;

  [[nodiscard]] const circuit::Analyses& analyses() const { return compiled->analyses; }
  [[nodiscard]] bool is_stepped() const { return analyses().sweeps.runs() > 0; }
  [[nodiscard]] bool has_pictures() const { return plot_file.is_open() || report_file.has_value(); }
  /// The name of the file of rows, or of the table of a split sweep.
  [[nodiscard]] std::string rows_name() const;
  /// Where tables go: not between rows.
  [[nodiscard]] Stream table_stream() const { return options.output == "-" ? Stream::error : Stream::output; }
  [[nodiscard]] double seconds() const;

  int fail(Status status, std::string id, std::string text) { return cli::fail(messages, status, std::move(id), std::move(text)); }
  /// An output file beside those that were read.
  [[nodiscard]] int open(const std::string& name, std::optional<waveform::OutputFile>& file) {
    return open_output(name, files, messages, file);
  }
  /// Remarks, jumps and sums of a run.
  void take_remarks(const engine::Answer& answer);
  /// Measurements that failed do not make the run one that failed. The answer is the exit status of printing them.
  int report_measurements(const measure::Results& results, bool is_complete);
  void note_rows(bool write_failed, bool complete, double end);
  /// What a run of rows ends with; `file` holds them.
  int conclude(const analysis::TransientRun& run, const waveform::OutputFile& file);
  /// What stands behind the summary.
  void tell_details();

 private:
  [[nodiscard]] bool concerns_nobody(const engine::Remark& remark) const;
  void report_failures(const measure::Results& results, bool is_complete);
};

}  // namespace pwlsim::cli
