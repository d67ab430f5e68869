#include "engine/left_out.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "model/certificate.hpp"
#include "model/extraction.hpp"

namespace pwlsim::engine {

bool must_run(const model::Island& island) {
  if (island.network.diodes.empty() && island.network.switches.empty()) return false;
  Diagnostics ignored;
  const auto extraction = model::extract(island, ignored);
  return extraction && !model::always_has_solution(extraction->system);
}

std::set<std::string> running_sources(const std::vector<model::Island>& islands) {
  std::set<std::string> running;
  for (const auto& island : islands) {
    if (!island.needed) continue;
    for (const auto& branch : island.network.branches) running.insert(branch.label.name);
    for (const auto& source : island.network.sources) {
      running.insert(source.label.name);
      if (!source.follows.empty()) running.insert(source.follows);
    }
  }
  return running;
}

std::optional<Remark> left_out(const model::Island& island, const std::set<std::string>& running) {
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
  if (names.empty()) return std::nullopt;
  return Remark{"N-left-out", fmt::format("left out, because no saved signal depends on it: {}", names)};
}

}  // namespace pwlsim::engine
