#pragma once
/// One transient run: deck and engine in, completed file of rows out.

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "circuit/compile.hpp"
#include "engine/run.hpp"
#include "measure/measuring.hpp"
#include "waveform/output_file.hpp"
#include "waveform/raw_file.hpp"
#include "waveform/row_writer.hpp"

namespace pwlsim::analysis {

class RunRecorder;

/// The engine, prepared for one network.
using Simulate = std::function<engine::Answer(const engine::Request&, engine::RowSink&)>;

/// For a run without rows.
class NoRows : public engine::RowSink {
 public:
  bool write(std::span<const double>, std::size_t) override { return true; }
};

struct RunControl {
  bool events = false;                          ///< a row before and after every event
  bool jumps = false;                           ///< keep the jumps
  std::function<void(double)> progress;         ///< called from time to time with the time reached; may be empty
  const std::atomic<int>* interrupt = nullptr;  ///< nonzero: stop at once
  RunRecorder* recorder = nullptr;              ///< receives rows and events; may be null
  engine::EventWatcher* watcher = nullptr;      ///< receives events if there is no recorder; may be null
  engine::Sampler* sampler = nullptr;           ///< sets held sources; may be null
  double longest_window = 0.0;                  ///< s: how far windows of measurements may extend beyond Tstop, if the run supports it
};

enum class Ending {
  completed,
  failed,       ///< no solution, or not a unique one, …: the rows up to then are in the completed file
  interrupted,  ///< likewise
  closed_pipe,  ///< the reader of the output has closed it
  write_failed  ///< the rows that were written are in the partial file
};

struct TransientRun {
  Ending ending = Ending::completed;
  std::string id;       ///< "E-no-solution", … if it did not complete
  std::string message;  ///< why, with the time reached; empty when completed
  engine::Answer answer;
  std::uint64_t rows = 0;  ///< passed to the file
  double last_row = 0.0;   ///< time of the last of them, s
  bool is_written = true;  ///< the writer accepted all
  double seconds_write = 0.0;
  measure::Results measurements;
  measure::Record measured;  ///< the same, for derivatives
};

/// The request of the deck to an engine, on its own grid.
[[nodiscard]] engine::Request request_of(const circuit::Analyses& analyses, const RunControl& control);

/// The column heads: `time` and the signals.
[[nodiscard]] std::vector<std::string> column_names(const circuit::Compiled& compiled);

/// A warning or a note, by its id.
[[nodiscard]] Diagnostic message_of(const engine::Remark& remark);

enum class RowFormat { csv, raw };

/// The columns as vectors of a raw file.
[[nodiscard]] std::vector<waveform::RawVector> raw_vectors(const circuit::Compiled& compiled);

/// Writes the rows of `compiled` into `file`, which must outlive it.
[[nodiscard]] std::unique_ptr<waveform::RowWriter> row_writer(RowFormat format, const circuit::Compiled& compiled,
                                                              waveform::OutputFile& file);

/// The same through `writer` alone, which is flushed; no file is committed. If writing fails the run ends as failed.
[[nodiscard]] TransientRun run_rows(const circuit::Compiled& compiled, const Simulate& simulate, waveform::RowWriter& writer,
                                    const RunControl& control);

/// Runs `compiled.analyses.transient`, which must exist, through `writer` into `file`, and commits it unless writing fails.
/// Measures during the run; if a measurement needs results of others, the run is repeated without rows.
/// A value that is not finite ends the run as failed before its row is written; so does lack of memory.
[[nodiscard]] TransientRun run_transient(const circuit::Compiled& compiled, const Simulate& simulate, waveform::OutputFile& file,
                                         waveform::RowWriter& writer, const RunControl& control);

}  // namespace pwlsim::analysis
