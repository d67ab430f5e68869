#include "circuit/flatten.hpp"

#include <algorithm>

#include "circuit/census.hpp"
#include "circuit/commands.hpp"
#include "circuit/control_switches.hpp"
#include "circuit/definitions.hpp"
#include "circuit/devices.hpp"
#include "circuit/evaluation.hpp"
#include "circuit/expand.hpp"
#include "circuit/logic_device.hpp"
#include "circuit/measured_powers.hpp"
#include "circuit/raw_system_reader.hpp"
#include "circuit/sections.hpp"
#include "circuit/shipped.hpp"
#include "circuit/state_machine.hpp"
#include "circuit/unused_subcircuits.hpp"
#include "circuit/xspice_logic.hpp"

namespace pwlsim::circuit {

namespace {

/// Puts other cards for those that stand for several elements. `unreadable`: cards that could not be read, of which one may be missing.
void replace_cards(Definitions& definitions, std::size_t unreadable, Reporter& reporter, FlatCircuit& circuit) {
  make_state_machines(definitions, reporter);
  circuit.has_machines =
      std::any_of(definitions.all.begin(), definitions.all.end(), [](const auto& each) { return !each->machines.empty(); });
  circuit.has_gaps = unreadable > soften_unused_subcircuits(definitions, reporter);
  circuit.written_by_ltspice = definitions.written_by_ltspice;
  circuit.prints = definitions.prints;
  measure_powers(definitions);
  replace_control_switches(definitions);
  replace_xspice_logic(definitions, reporter);
  replace_logic_devices(definitions, reporter);
}

/// Steps and options for this run: all runs have the same steps, each has random numbers of its own.
Options begin_run(const Definitions& definitions, std::size_t run, Scope& top, Session& session, Reporter& reporter, Analyses& analyses) {
  const std::uint64_t seed = written_seed(definitions);
  session.random = Random(seed, 0);  // all runs have the same steps
  read_sweeps(definitions, top, reporter, analyses.sweeps);
  give_stepped_parameters(analyses.sweeps, run, top);
  session.random = Random(seed, run);
  Options options = read_options(definitions, top, reporter, analyses);
  if (options.seed != seed) session.random = Random(options.seed, run);
  return options;
}

}  // namespace

Flattened flatten(const netlist::Deck& written, SourceStore& sources, Reporter& reporter, bool analysis_required, std::size_t run,
                  const std::string& ground) {
  Flattened result;
  FlatCircuit& circuit = result.circuit;
  const std::optional<netlist::Deck> chosen = with_chosen_sections(written, run, reporter);
  const netlist::Deck& deck = chosen ? *chosen : written;
  circuit.title = deck.title;
  circuit.stands_for_ground = ground;
  const std::size_t unreadable = reporter.error_count();
  Definitions definitions = read_definitions(deck, reporter);
  replace_cards(definitions, unreadable, reporter, circuit);
  const std::vector<netlist::Deck> shipped = add_shipped_subcircuits(definitions, sources, reporter);
  const DeviceModels devices = add_device_models(definitions, sources, reporter);
  const ExpressionEvaluation evaluation;
  Session session(reporter, evaluation);
  Scope top(*definitions.all.front(), nullptr, session);
  const Options options = begin_run(definitions, run, top, session, reporter, circuit.analyses);
  read_sensitivities(definitions, top, reporter, circuit);
  top.evaluate_all();
  read_analyses(definitions, deck.title_span, top, reporter, analysis_required, circuit);
  read_saves(definitions, reporter, circuit);
  read_measurements(definitions, top, reporter, circuit);
  check_sensitivities(reporter, circuit);
  if (!check_expansion(definitions, options.limits, reporter)) return result;
  Models models(circuit, options.settings, reporter, &devices.sources);
  Binder binder(circuit, definitions, models, reporter);
  Place place{top, "", {}};
  Expander(circuit, binder, session).expand(place);
  set_stepped_elements(circuit.analyses.sweeps, run, reporter, circuit);
  read_raw_systems(definitions.raw_systems, top, reporter, circuit);
  check_trigger(reporter, circuit);
  models.check_unused(top, deck.title_span.file);
  take_parameter_values(top, circuit);
  circuit.draws_random = session.draws_random;
  result.expanded = true;
  return result;
}

}  // namespace pwlsim::circuit
