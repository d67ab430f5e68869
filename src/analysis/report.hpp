#pragma once
/// Reports of a run: the statistics file, the summary line, the operating point as text.

#include <span>
#include <string>
#include <vector>

#include "analysis/idealisation.hpp"
#include "circuit/circuit.hpp"
#include "engine/run.hpp"

namespace pwlsim::analysis {

/// Wall-clock seconds of the phases.
struct Seconds {
  double parse = 0.0;     ///< reading the deck into its syntax tree
  double flatten = 0.0;   ///< syntax tree to network
  double model = 0.0;     ///< network to state-space model
  double simulate = 0.0;  ///< model to the values of the rows
  double write = 0.0;     ///< formatting and writing rows
  double certificate = 0.0;
  double total = 0.0;  ///< since the process started
};

struct RunReport {
  std::string engine;
  std::uint64_t runs = 0, failed_runs = 0;  ///< of a deck with .step: the counts below are sums over them, residuals the worst
  engine::Statistics statistics;
  engine::Certificate certificate;
  Seconds seconds;
  std::vector<engine::Jump> jumps;
  std::vector<std::string> notes;  ///< the messages of the run, "warning[W-…]: …"
  std::vector<Idealisation> departures;
};

/// One JSON object with the keys of docs/reference/output.md, ended by a line feed. Values that are not finite are null.
[[nodiscard]] std::string statistics_json(const RunReport& report);

class JsonWriter;
/// The same as a value of a larger object.
void write_statistics(JsonWriter& json, const RunReport& report);
/// The member `certificate`.
void write_certificate(JsonWriter& json, const engine::Certificate& certificate);

/// "wrote out.csv: 501 rows, 1000 events to t = 5 ms in 420 µs; worst residuals: complementarity …, KCL/KVL …, energy …; passive".
[[nodiscard]] std::string summary(const RunReport& report, const std::string& output, double stop);

/// The lines that --verbose adds: phases and counts.
[[nodiscard]] std::string details(const RunReport& report);

/// One sentence per jump: "t = 0 s: D1 passes 2 C; v(C1) 3 V to 1 V, …; stored energy 4.5 J to 1.5 J". The first twenty; then how many more of `all`.
/// Elements of hidden parts are left out.
[[nodiscard]] std::vector<std::string> jump_texts(const std::vector<engine::Jump>& jumps, std::uint64_t all,
                                                  const circuit::HiddenParts& hidden = {});

/// `name = value` lines.
[[nodiscard]] std::string operating_point_text(std::span<const std::string> names, std::span<const double> values, int digits = 0);

}  // namespace pwlsim::analysis
