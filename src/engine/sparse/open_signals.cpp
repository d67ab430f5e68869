#include "engine/sparse/open_signals.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "model/tolerances.hpp"

namespace pwlsim::engine::sparse {

namespace {

constexpr std::size_t most_noted = 4096, most_noted_bytes = 16u << 20;  ///< of positions that are looked at

}  // namespace

void OpenSignals::note(const Position& on, const std::vector<int>& idle, const std::vector<int>& free, double shift) {
  add(on, shift);
  if (!idle.empty()) {
    Position fewest = on;
    for (const int port : idle) fewest[static_cast<std::size_t>(port)] = 0;
    add(std::move(fewest), shift);
  }
  if (free.empty()) return;
  Position most = on;
  for (const int port : free) most[static_cast<std::size_t>(port)] = 1;
  descriptor_.hold_blocked(most);
  add(std::move(most), shift);
}

void OpenSignals::add(Position on, double shift) {
  if (noted_.size() < std::min(most_noted, most_noted_bytes / std::max<std::size_t>(on.size(), 1)))
    noted_.try_emplace(std::move(on), shift);
}

std::vector<std::size_t> OpenSignals::find(const std::vector<Form>& signals) const {
  if (signals.empty()) return {};
  const OpenParts parts(descriptor_.network());
  std::vector<char> is_open(signals.size(), 0);
  std::optional<Factors> factors;  // most positions leave nothing open
  for (const auto& [on, shift] : noted_) {
    if (parts.ties(on).empty()) continue;
    if (!factors) factors.emplace(descriptor_.network(), descriptor_);
    const Factor* factor = factors->at(shift, on);
    if (factor == nullptr) continue;
    for (const std::vector<double>& direction : factor->open())
      for (std::size_t i = 0; i < signals.size(); ++i) {
        const double moved = std::abs(Form::sum(signals[i].z, direction.data())), size = Form::size_of(signals[i].z, direction.data());
        if (moved > model::tolerance::open_signal * size && moved > model::tolerance::open_signal) is_open[i] = 1;
      }
  }
  std::vector<std::size_t> numbers;
  for (std::size_t i = 0; i < signals.size(); ++i)
    if (is_open[i] != 0) numbers.push_back(i);
  return numbers;
}

}  // namespace pwlsim::engine::sparse
