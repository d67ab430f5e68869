#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <set>

#include "engine/exact/exact_model.hpp"
#include "model/certificate.hpp"

namespace pwlsim::engine {

namespace {

/// Names of an island's elements; sources that run as a rail of another island (`running`) are not among them.
std::string elements_of(const model::Island& island, const std::set<std::string>& running) {
  const model::Network& n = island.network;
  std::string names;
  const auto add = [&](const auto& list) {
    for (const auto& element : list)
      if (!running.contains(element.label.name)) names += (names.empty() ? "" : ", ") + element.label.name;
  };
  add(n.resistors);
  add(n.capacitors);
  add(n.inductors);
  std::vector<model::Branch> own;
  for (std::size_t i = 0; i < n.branches.size(); ++i)
    if (std::find(island.copied_branches.begin(), island.copied_branches.end(), static_cast<int>(i)) == island.copied_branches.end())
      own.push_back(n.branches[i]);
  add(own);
  add(n.injections);
  add(n.diodes);
  add(n.switches);
  return names;
}

/// What has no solution is an error even where nobody looks at it.
bool must_run(const model::Island& island) {
  if (island.network.diodes.empty() && island.network.switches.empty()) return false;
  Diagnostics ignored;
  const auto extraction = model::extract(island, ignored);
  return extraction && !model::always_has_solution(extraction->system);
}

}  // namespace

std::shared_ptr<const ExactModel> prepare(const model::Network& network, Diagnostics& diagnostics) {
  const auto start = std::chrono::steady_clock::now();
  auto result = std::make_shared<ExactModel>();
  for (const auto& s : network.switches) result->switches.push_back({s.label.name, s.initially_on, s.on_level, s.off_level, -1, -1});
  for (const auto& s : network.signals) result->signal_names.push_back(s.name);
  const std::size_t errors_before = diagnostics.error_count();
  std::vector<model::Island> islands = model::split_islands(network, must_run);
  std::set<std::string> running;
  for (const auto& island : islands)
    if (island.needed)
      for (const auto& branch : island.network.branches) running.insert(branch.label.name);
  for (auto& island : islands) {
    auto extraction = model::extract(island, diagnostics);
    if (!extraction) continue;
    if (!island.needed) {
      const std::string names = elements_of(island, running);
      if (!names.empty())
        result->remarks.push_back({"N-left-out", fmt::format("left out, because no saved signal depends on it: {}", names)});
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

}  // namespace pwlsim::engine
