#include "regression/deck_run.hpp"

#include <algorithm>
#include <functional>
#include <optional>

#include "analysis/row_grid.hpp"
#include "circuit/compile.hpp"
#include "engine/exact/exact.hpp"
#include "engine/sparse/sparse.hpp"
#include "netlist/load.hpp"

namespace pwlsim::test {
namespace {

class Rows : public engine::RowSink {
 public:
  explicit Rows(std::vector<std::vector<double>>& rows) : rows_(rows) {}

  bool write(std::span<const double> values, std::size_t count) override {
    const std::size_t width = values.size() / count;
    for (std::size_t i = 0; i < count; ++i) {
      const auto row = values.subspan(i * width, width);
      rows_.emplace_back(row.begin(), row.end());
    }
    return true;
  }

 private:
  std::vector<std::vector<double>>& rows_;
};

std::string errors_of(const Diagnostics& diagnostics, const SourceStore& sources) {
  std::string text;
  for (const Diagnostic& diagnostic : diagnostics.all())
    if (diagnostic.severity == Severity::error) text += render(diagnostic, sources) + "\n";
  return text;
}

engine::NonUnique non_unique(circuit::NonUniqueChoice choice) {
  if (choice == circuit::NonUniqueChoice::first) return engine::NonUnique::first;
  return choice == circuit::NonUniqueChoice::stay ? engine::NonUnique::stay : engine::NonUnique::error;
}

engine::Request request_of(const circuit::Compiled& compiled, bool events, DeckRun& run) {
  engine::Request request;
  request.stop = run.stop = compiled.analyses.transient->stop.seconds;
  request.grid = analysis::row_grid(*compiled.analyses.transient);
  request.events = request.jumps = events;
  request.use_initial_conditions = compiled.analyses.transient->use_initial_conditions;
  request.non_unique = non_unique(compiled.analyses.non_unique);
  return request;
}

/// Runs a compiled deck into a sink; false where the network has errors of structure, which are among the diagnostics then.
using Simulate = std::function<bool(const circuit::Compiled&, DeckRun&, Diagnostics&)>;

Simulate by_modes(bool events, const engine::Request::Faults& faults = {}, engine::Leaks leaks = engine::Leaks::as_ports) {
  return [events, faults, leaks](const circuit::Compiled& compiled, DeckRun& run, Diagnostics& diagnostics) {
    const auto model = engine::prepare(compiled.network, diagnostics, leaks);
    Rows rows(run.rows);
    engine::Request request = request_of(compiled, events, run);
    request.faults = faults;
    if (model) run.answer = engine::run(*model, request, rows);
    return model != nullptr;
  };
}

Simulate sparse(double reltol, bool events) {
  return [reltol, events](const circuit::Compiled& compiled, DeckRun& run, Diagnostics& diagnostics) {
    const auto model = engine::sparse::prepare(compiled.network, diagnostics);
    Rows rows(run.rows);
    if (model) run.answer = engine::sparse::run(*model, request_of(compiled, events, run), reltol, rows);
    return model != nullptr;
  };
}

Simulate by_segments(bool events) {
  return [events](const circuit::Compiled& compiled, DeckRun& run, Diagnostics& diagnostics) {
    const auto model = engine::sparse::prepare(compiled.network, diagnostics);
    Rows rows(run.rows);
    if (model)
      run.answer = engine::sparse::run_segments(*model, request_of(compiled, events, run), engine::sparse::segment_tolerance, rows);
    return model != nullptr;
  };
}

DeckRun run_parsed(const netlist::Deck& deck, SourceStore& sources, Diagnostics& diagnostics, const Simulate& simulate) {
  DeckRun run;
  const std::optional<circuit::Compiled> compiled = circuit::compile(deck, sources, diagnostics);
  if (compiled && compiled->analyses.transient) {
    for (const auto& signal : compiled->network.signals) run.signals.push_back(signal.name);
    simulate(*compiled, run, diagnostics);
  }
  run.messages = errors_of(diagnostics, sources);
  return run;
}

DeckRun run_file(const std::filesystem::path& path, const Simulate& simulate) {
  SourceStore sources;
  Diagnostics diagnostics;
  const netlist::Loaded loaded = netlist::load(path.string(), sources, diagnostics);
  if (!loaded.readable) return {"cannot read " + path.string(), {}, {}, 0.0, {}};
  return run_parsed(loaded.deck, sources, diagnostics, simulate);
}

DeckRun run_memory(const std::string& text, const Simulate& simulate) {
  SourceStore sources;
  Diagnostics diagnostics;
  const netlist::Deck deck = netlist::parse("deck", text, sources, diagnostics);
  return run_parsed(deck, sources, diagnostics, simulate);
}

}  // namespace

const std::vector<double>* DeckRun::row_at(double time) const {
  const auto found = std::lower_bound(rows.begin(), rows.end(), time, [](const auto& row, double t) { return row[0] < t; });
  return found != rows.end() && (*found)[0] == time ? &*found : nullptr;
}

DeckRun run_deck(const std::filesystem::path& path, bool events) { return run_file(path, by_modes(events)); }

DeckRun run_deck_with_faults(const std::filesystem::path& path, const engine::Request::Faults& faults) {
  return run_file(path, by_modes(false, faults));
}

DeckRun run_deck_sparse(const std::filesystem::path& path, double reltol, bool events) { return run_file(path, sparse(reltol, events)); }

DeckRun run_deck_segments(const std::filesystem::path& path) { return run_file(path, by_segments(false)); }

DeckRun run_text_with_leaks_as_written(const std::string& text) { return run_memory(text, by_modes(false, {}, engine::Leaks::as_written)); }

DeckRun run_text(const std::string& text, bool events) { return run_memory(text, by_modes(events)); }

DeckRun run_text_segments(const std::string& text, bool events) { return run_memory(text, by_segments(events)); }

DeckRun run_text_sparse(const std::string& text, double reltol, bool events) { return run_memory(text, sparse(reltol, events)); }

}  // namespace pwlsim::test
