#include "regression/deck_run.hpp"

#include <algorithm>
#include <optional>

#include "analysis/row_grid.hpp"
#include "circuit/compile.hpp"
#include "engine/exact/exact.hpp"
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

void simulate(const circuit::Compiled& compiled, const engine::ExactModel& model, bool events, DeckRun& run) {
  engine::Request request;
  request.stop = run.stop = compiled.analyses.transient->stop.seconds;
  request.grid = analysis::row_grid(*compiled.analyses.transient);
  request.events = request.jumps = events;
  request.use_initial_conditions = compiled.analyses.transient->use_initial_conditions;
  request.non_unique = non_unique(compiled.analyses.non_unique);
  Rows rows(run.rows);
  run.answer = engine::run(model, request, rows);
}

DeckRun run_parsed(const netlist::Deck& deck, const SourceStore& sources, Diagnostics& diagnostics, bool events) {
  DeckRun run;
  const std::optional<circuit::Compiled> compiled = circuit::compile(deck, sources, diagnostics);
  if (compiled && compiled->analyses.transient) {
    for (const auto& signal : compiled->network.signals) run.signals.push_back(signal.name);
    if (const auto model = engine::prepare(compiled->network, diagnostics)) simulate(*compiled, *model, events, run);
  }
  run.messages = errors_of(diagnostics, sources);
  return run;
}

}  // namespace

const std::vector<double>* DeckRun::row_at(double time) const {
  const auto found = std::lower_bound(rows.begin(), rows.end(), time, [](const auto& row, double t) { return row[0] < t; });
  return found != rows.end() && (*found)[0] == time ? &*found : nullptr;
}

DeckRun run_deck(const std::filesystem::path& path, bool events) {
  SourceStore sources;
  Diagnostics diagnostics;
  const netlist::Loaded loaded = netlist::load(path.string(), sources, diagnostics);
  if (!loaded.readable) return {"cannot read " + path.string(), {}, {}, 0.0, {}};
  return run_parsed(loaded.deck, sources, diagnostics, events);
}

DeckRun run_text(const std::string& text, bool events) {
  SourceStore sources;
  Diagnostics diagnostics;
  const netlist::Deck deck = netlist::parse("deck", text, sources, diagnostics);
  return run_parsed(deck, sources, diagnostics, events);
}

}  // namespace pwlsim::test
