#include "engine/sparse/forecast.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "engine/sparse/tolerances.hpp"

namespace pwlsim::engine::sparse {

namespace {

constexpr int most_rounds = 4;

}  // namespace

bool Forecast::find(double time, const std::vector<double>& z, Position& on) {
  Position next = on;
  for (int round = 0; round < most_rounds; ++round) {
    const std::optional<Factors::Rough> rough = factors_.rough(next);
    if (!rough) return false;
    sources_.evaluate(time + 1.0 / rough->shift, w_);
    right_.resize(z.size());
    descriptor_.rates(z.data(), w_.data(), right_.data());
    for (std::size_t i = 0; i < next.size(); ++i) {
      const DescriptorPort& port = descriptor_.ports()[i];
      right_[static_cast<std::size_t>(port.row)] = -port.free_variable(next[i] == 0, z.data(), w_.data());
    }
    rough->factor.solve(right_);
    z_.resize(z.size());
    for (std::size_t i = 0; i < z.size(); ++i) z_[i] = z[i] + right_[i];
    const std::vector<std::size_t> ports = wrong(next);
    if (ports.empty()) return std::exchange(on, next) != next;
    for (const std::size_t port : ports) next[port] ^= 1;
    descriptor_.hold_blocked(next);
  }
  return false;
}

/// Diodes that are visibly on the wrong side after the step.
std::vector<std::size_t> Forecast::wrong(const Position& on) {
  const auto& ports = descriptor_.ports();
  const auto count = static_cast<std::size_t>(descriptor_.first_switch());
  double input = least_;
  for (std::size_t i = 0; i < count; ++i) input = std::max(input, std::abs(z_[static_cast<std::size_t>(ports[i].row)]));
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < count; ++i) {
    const double value = ports[i].free_variable(on[i] != 0, z_.data(), w_.data());
    if (value >= 0.0 || ports[i].blocks(on)) continue;
    const double size = on[i] != 0 ? input : std::max(least_, ports[i].slack_size(z_.data(), w_.data()));
    if (value < -tolerance::clear_sign * size) found.push_back(i);
  }
  return found;
}

}  // namespace pwlsim::engine::sparse
