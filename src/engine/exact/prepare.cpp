#include <chrono>
#include <utility>

#include "engine/exact/exact.hpp"
#include "engine/exact/exact_model.hpp"
#include "engine/left_out.hpp"
#include "model/leaks.hpp"

namespace pwlsim::engine {

std::shared_ptr<const ExactModel> prepare(const model::Network& network, Diagnostics& diagnostics, Leaks leaks) {
  const auto start = std::chrono::steady_clock::now();
  auto result = std::make_shared<ExactModel>();
  for (const auto& s : network.switches) result->switches.push_back({s.label.name, s.initially_on, s.on_level, s.off_level, -1, -1});
  result->watched = watched_switches(network);
  for (const auto& s : network.signals) result->signal_names.push_back(s.name);
  const std::size_t errors_before = diagnostics.error_count();
  std::vector<model::Island> islands = model::split_islands(network, must_run);
  const std::set<std::string> running = running_sources(islands);
  for (auto& island : islands) {
    if (island.needed && leaks == Leaks::as_ports) model::put_ports_beside_leaks(island.network);
    auto extraction = model::extract(island, diagnostics);
    if (!extraction) continue;
    if (!island.needed) {
      if (auto remark = left_out(island, running)) result->remarks.push_back(std::move(*remark));
      result->left_out.push_back({std::move(island), std::move(*extraction)});
      continue;
    }
    const auto index = static_cast<int>(result->islands.size());
    for (std::size_t i = 0; i < island.switch_number.size(); ++i) {
      auto& info = result->switches[static_cast<std::size_t>(island.switch_number[i])];
      info.island = index;
      info.port = static_cast<int>(island.network.diodes.size() + island.network.complementarities.size() + i);
    }
    result->islands.push_back({std::move(island), std::move(*extraction)});
  }
  if (diagnostics.error_count() != errors_before) return nullptr;
  result->seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

std::shared_ptr<const ExactModel> with_held_values(const ExactModel& model, std::span<const double> values) {
  auto other = std::make_shared<ExactModel>(model);
  for (IslandModel& island : other->islands) {
    for (model::Source& source : island.island.network.sources)
      if (auto* const held = std::get_if<model::Held>(&source.function)) held->value = values[static_cast<std::size_t>(held->channel)];
    model::System& system = island.extraction.system;
    if (system.exosystem) system.exosystem = std::make_shared<const model::Exosystem>(system.exosystem->with_held(values));
  }
  return other;
}

}  // namespace pwlsim::engine
