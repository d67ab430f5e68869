/// Runs that begin on an orbit: those of `.tran`, and the one over the period that writes rows and measures.
#include <algorithm>
#include <utility>

#include "analysis/steady_state.hpp"
#include "engine/exact/exact_model.hpp"
#include "waveform/csv.hpp"

namespace pwlsim::analysis {

using circuit::Compiled;

std::optional<engine::RunState> state_in(const engine::ExactModel& model, const SteadyState& state) {
  const engine::RunState& begin = state.orbit.begin;
  engine::RunState there;
  there.on = begin.on;
  there.on.resize(model.switches.size());
  for (const engine::IslandModel& island : model.islands) {
    const auto& known = state.model->islands;
    const auto same = std::find_if(known.begin(), known.end(), [&](const engine::IslandModel& other) {
      return other.island.name == island.island.name && other.extraction.system.n == island.extraction.system.n &&
             other.extraction.system.ports == island.extraction.system.ports;
    });
    if (same == known.end()) return std::nullopt;
    const auto at = static_cast<std::size_t>(same - known.begin());
    there.xi.push_back(begin.xi[at]);
    there.active.push_back(begin.active[at]);
    const bool is_read_alike = !begin.signals.empty() && island.extraction.system.output_signal == same->extraction.system.output_signal;
    if (is_read_alike) there.signals.push_back(begin.signals[at]);
  }
  if (there.signals.size() != there.xi.size()) there.signals.clear();
  return there;
}

namespace {

constexpr const char* parts_differ =
    "the parts of the circuit differ between the run and the orbit; try .pss and .tran in decks of their own";

/// The start of the deck's own run on Krylov segments, with parts matched by name. Empty if one has no match.
std::optional<engine::sparse::PeriodMap::State> state_in(const engine::sparse::SparseModel& model, const SteadyState& state) {
  const auto& known = state.map->model().parts;
  engine::sparse::PeriodMap::State there;
  for (const auto& part : model.parts) {
    const auto same = std::find_if(known.begin(), known.end(), [&](const auto& other) {
      return other->island.name == part->island.name && other->descriptor.size() == part->descriptor.size() &&
             other->descriptor.ports().size() == part->descriptor.ports().size();
    });
    if (same == known.end()) return std::nullopt;
    there.push_back(state.begin[static_cast<std::size_t>(same - known.begin())]);
    if ((*same)->island.signal_number != part->island.signal_number) return std::nullopt;
  }
  return there;
}

Simulate from_segment_orbit(const Compiled& compiled, const SteadyState& state, Diagnostics& diagnostics) {
  const auto model = engine::sparse::prepare(compiled.network, diagnostics);
  if (!model) return {};
  const auto from = state_in(*model, state);
  if (!from) {
    diagnostics.error("E-pss-not-converged", {}, parts_differ);
    return {};
  }
  const auto map = std::make_shared<const engine::sparse::PeriodMap>(model);
  return [map, from = *from](const engine::Request& request, engine::RowSink& sink) { return map->run(from, request, sink); };
}

}  // namespace

Simulate from_orbit(const Compiled& compiled, const SteadyState& state, Diagnostics& diagnostics) {
  if (state.map) return from_segment_orbit(compiled, state, diagnostics);
  std::shared_ptr<const engine::ExactModel> model = engine::prepare(compiled.network, diagnostics);
  if (!model) return {};
  std::optional<engine::RunState> from = state_in(*model, state);
  if (!from) {
    diagnostics.error("E-pss-not-converged", {}, parts_differ);
    return {};
  }
  return [model, from = std::move(*from)](const engine::Request& request, engine::RowSink& sink) {
    engine::March march(*model, {request.non_unique, request.interrupt});
    return march.run(from, request, sink);
  };
}

measure::Results orbit_measurements(const SteadyState& state, const std::atomic<int>& interrupt) {
  return orbit_rows(state, "", nullptr, false, interrupt);
}

measure::Results orbit_rows(const SteadyState& state, const std::string& prefix, std::string* text, bool with_events,
                            const std::atomic<int>& interrupt) {
  class Lines : public waveform::RowWriter {
   public:
    Lines(const std::string& prefix, std::size_t columns, std::string* text) : prefix_(prefix), columns_(columns), text_(text) {}
    bool write(std::span<const double> values) override {
      for (std::size_t at = 0; text_ != nullptr && at < values.size(); at += columns_)
        waveform::append_csv_row(*text_, prefix_, values.subspan(at, columns_));
      return true;
    }
    bool flush() override { return true; }

   private:
    const std::string& prefix_;
    std::size_t columns_;
    std::string* text_;
  } lines(prefix, 1 + state.compiled.saved_signals(), text);
  RunControl control;
  control.events = with_events && text != nullptr;
  control.interrupt = &interrupt;
  control.longest_window = most_periods_measured * state.orbit.period;
  return run_rows(state.compiled, state.simulate, lines, control).measurements;
}

}  // namespace pwlsim::analysis
