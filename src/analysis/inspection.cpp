#include "analysis/inspection.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "model/build_mode.hpp"
#include "model/certificate.hpp"
#include "model/subspaces.hpp"
#include "model/switch_position.hpp"

namespace pwlsim::analysis {
namespace {

using engine::IslandModel;

CertificateView certificate_of(const model::System& system, const model::Markov& markov) {
  CertificateView view;
  view.kyp_residual = system.kyp_residual;
  view.too_many_ports = system.ports > model::most_ports_for_minors;
  if (system.ports == 0) {
    view.kind = CertificateKind::no_ports;
    view.always_solvable = true;
  } else if (system.passive) {
    view.kind = CertificateKind::passive;
    view.always_solvable = model::always_has_solution(system);
  } else if (!view.too_many_ports && model::has_positive_leading_minors(markov)) {
    view.kind = CertificateKind::principal_minors;
    view.always_solvable = true;
  }
  return view;
}

std::string first_sentence(const Diagnostics& diagnostics) {
  for (const Diagnostic& diagnostic : diagnostics.all())
    if (diagnostic.severity == Severity::error) return diagnostic.text.substr(0, diagnostic.text.find("; try "));
  return "its equations are singular";
}

class IslandInspector {
 public:
  IslandInspector(const IslandModel& model, const IslandPorts& ports, const ModeChoice::OfIsland* mode)
      : model_(model), ports_(ports), mode_(mode) {}

  IslandView run() {
    const model::System& system = model_.extraction.system;
    IslandView view;
    view.name = model_.island.name;
    view.elements = element_names(model_.island);
    for (const SwitchGroup& group : ports_.switches) view.switches.push_back(group.name);
    view.states = static_cast<std::size_t>(system.n);
    view.ports = static_cast<std::size_t>(system.diodes);
    view.positions_in_all = std::exp2(static_cast<double>(ports_.switches.size()));
    for (const std::vector<char>& on : positions_to_show()) view.positions.push_back(position(on));
    if (mode_ != nullptr) view.mode = mode();
    return view;
  }

 private:
  [[nodiscard]] std::vector<char> position_of_start() const {
    std::vector<char> on;
    for (const SwitchGroup& group : ports_.switches) on.push_back(group.on_at_start ? 1 : 0);
    return on;
  }

  [[nodiscard]] std::vector<std::vector<char>> positions_to_show() const {
    const std::size_t count = ports_.switches.size();
    std::vector<std::vector<char>> positions;
    if (std::exp2(static_cast<double>(count)) <= static_cast<double>(most_positions)) {
      for (std::size_t bits = 0; bits < (std::size_t{1} << count); ++bits) {
        std::vector<char>& on = positions.emplace_back(count);
        for (std::size_t i = 0; i < count; ++i) on[i] = static_cast<char>((bits >> i) & 1U);
      }
      return positions;
    }
    positions.push_back(position_of_start());
    if (mode_ != nullptr && mode_->switches != positions.front()) positions.push_back(mode_->switches);
    return positions;
  }

  /// Of each contact of the network.
  [[nodiscard]] std::vector<char> closed_contacts(const std::vector<char>& on) const {
    const auto& contacts = model_.island.network.switches;
    std::vector<char> closed(contacts.size());
    for (std::size_t group = 0; group < on.size(); ++group)
      for (const int contact : ports_.switches[group].contacts) {
        const auto index = static_cast<std::size_t>(contact);
        closed[index] = (on[group] != 0) != contacts[index].inverted ? 1 : 0;
      }
    return closed;
  }

  [[nodiscard]] PositionView position(const std::vector<char>& on) const {
    PositionView view;
    view.on = on;
    view.of_start = on == position_of_start();
    if (on.empty()) {
      describe(model_.island, model_.extraction, view);
      return view;
    }
    Diagnostics diagnostics;
    const model::Island island = model::in_position(model_.island, closed_contacts(on));
    if (const auto extraction = model::extract(island, diagnostics)) {
      describe(island, *extraction, view);
    } else {
      view.problem = first_sentence(diagnostics);
    }
    return view;
  }

  void describe(const model::Island& island, const model::Extraction& extraction, PositionView& view) const {
    const model::System& system = extraction.system;
    view.space = model::in_energy_coordinates(island, extraction);
    for (int i = 0; i < system.ports; ++i)
      view.ports.push_back({ports_.names[static_cast<std::size_t>(i)], i < static_cast<int>(island.network.diodes.size()),
                            system.port[static_cast<std::size_t>(i)].input_is_current});
    view.markov = model::markov_parameters(view.space.a, view.space.b, view.space.c, view.space.d);
    view.certificate = certificate_of(system, view.markov);
  }

  /// Whether a current flows freely in port i: its voltage, or its slack, is then zero.
  [[nodiscard]] std::vector<char> conducting() const {
    std::vector<char> result = mode_->ports;
    const std::vector<char> closed = closed_contacts(mode_->switches);
    result.insert(result.end(), closed.begin(), closed.end());
    return result;
  }

  [[nodiscard]] ModeView mode() const {
    const model::System& system = model_.extraction.system;
    const std::vector<char> current = conducting();
    model::IndexSet active(system.ports);
    for (int i = 0; i < system.ports; ++i)
      active.set(i, (current[static_cast<std::size_t>(i)] != 0) == system.port[static_cast<std::size_t>(i)].input_is_current);
    ModeView view;
    view.states = system.n;
    const model::Subspaces subspaces = model::subspaces_without_sources(system, active);
    view.consistent = subspaces.dim_v;
    view.jump = subspaces.dim_t;
    view.complementary = subspaces.regular;
    const auto built = model::build_mode(system, active);
    view.well_posed = built->regular;
    view.on = names_on();
    if (built->regular) view.indeterminate = indeterminate_ports(*built);
    return view;
  }

  [[nodiscard]] std::vector<std::string> names_on() const {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < mode_->ports.size(); ++i)
      if (mode_->ports[i] != 0) names.push_back(ports_.names[i]);
    for (std::size_t i = 0; i < mode_->switches.size(); ++i)
      if (mode_->switches[i] != 0) names.push_back(ports_.switches[i].name);
    return names;
  }

  [[nodiscard]] std::vector<std::string> indeterminate_ports(const model::Mode& mode) const {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < ports_.names.size(); ++i)
      if (mode.input_unique[i] == 0 && std::find(names.begin(), names.end(), ports_.names[i]) == names.end())
        names.push_back(ports_.names[i]);
    return names;
  }

  const IslandModel& model_;
  const IslandPorts& ports_;
  const ModeChoice::OfIsland* mode_;
};

/// Elements of the parts left out that no other part holds.
std::vector<std::vector<std::string>> left_out_elements(const engine::ExactModel& model) {
  std::set<std::string> running;
  for (const IslandModel& island : model.islands)
    for (std::string& name : element_names(island.island)) running.insert(std::move(name));
  std::vector<std::vector<std::string>> parts;
  for (const IslandModel& island : model.left_out) {
    std::vector<std::string> names = element_names(island.island);
    std::erase_if(names, [&](const std::string& name) { return running.contains(name); });
    if (!names.empty()) parts.push_back(std::move(names));
  }
  return parts;
}

}  // namespace

std::optional<Inspection> inspect(const circuit::Compiled& compiled, const engine::ExactModel& model,
                                  const std::optional<ModeRequest>& request, Diagnostics& diagnostics) {
  const PortTable ports(model);
  std::optional<ModeChoice> choice;
  if (request) {
    choice = ports.choose(*request, diagnostics);
    if (!choice) return std::nullopt;
  }
  Inspection inspection;
  inspection.title = compiled.title;
  for (std::size_t i = 0; i < model.islands.size(); ++i)
    inspection.islands.push_back(IslandInspector(model.islands[i], ports.island(i), choice ? &choice->islands[i] : nullptr).run());
  inspection.left_out = left_out_elements(model);
  return inspection;
}

}  // namespace pwlsim::analysis
