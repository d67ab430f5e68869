#include "engine/sparse/start_unknowns.hpp"

#include <algorithm>
#include <cmath>

#include "engine/sparse/fastest.hpp"
#include "engine/sparse/tolerances.hpp"

namespace pwlsim::engine::sparse {

namespace {

constexpr double share_of_fastest = 0.25;  ///< of that time constant: in longer steps a decay might be taken for rounding
constexpr double shorter = 1.0 / 16.0;     ///< than a step that is too long
constexpr int most_steps = 3, rounds_of_signs = 4;

}  // namespace

StartUnknowns::StartUnknowns(const Descriptor& descriptor, const Sources& sources, double stop)
    : descriptor_(descriptor),
      sources_(sources),
      factors_(descriptor.network(), descriptor),
      space_(descriptor, sources.exosystem(), stop),
      longest_(std::min(share_of_fastest * fastest_time(descriptor.network()), stop)) {
  factors_.keep_digits();
}

std::optional<KrylovSpace::Beginning> StartUnknowns::find(const Start& start) {
  Position on = start.on;
  std::vector<Position> seen;
  for (int round = 0; round < rounds_of_signs; ++round) {
    auto found = find_in(on, start);
    if (!found) return std::nullopt;
    const std::vector<std::size_t> wrong = ports_on_wrong_side(on, found->z, start.time);
    const bool jumps = space_.distance(start.origin.z, found->z) > tolerance::same_jump * start.size;
    if (wrong.empty() && (round == 0 || !jumps)) return found;
    if (jumps) return std::nullopt;  // it has the position of the segment
    seen.push_back(on);
    for (const std::size_t port : wrong) on[port] ^= 1;
    descriptor_.hold_blocked(on);
    if (std::find(seen.begin(), seen.end(), on) != seen.end()) return std::nullopt;
  }
  return std::nullopt;
}

std::optional<KrylovSpace::Beginning> StartUnknowns::find_in(const Position& on, const Start& start) {
  double step = std::exp2(std::floor(std::log2(std::min(longest_, start.step))));  // so that factors serve again
  for (int tried = 0; tried < most_steps; ++tried, step *= shorter) {
    const Factor* const factor = factors_.at(1.0 / step, on);
    if (!factor || space_.begin(*factor, 1.0 / step, on, start.origin, start.size) != KrylovSpace::Begun::yes) return std::nullopt;
    if (auto found = space_.unknowns_at_start()) return found;
  }
  return std::nullopt;
}

std::vector<std::size_t> StartUnknowns::ports_on_wrong_side(const Position& on, const std::vector<double>& z, double time) const {
  std::vector<double> w;
  sources_.evaluate(time, w);
  const auto& ports = descriptor_.ports();
  double input = 0.0;
  for (const DescriptorPort& port : ports) input = std::max(input, std::abs(z[static_cast<std::size_t>(port.row)]));
  std::vector<std::size_t> wrong;
  for (std::size_t i = 0; i < static_cast<std::size_t>(descriptor_.first_switch()); ++i) {
    const bool is_on = on[i] != 0;
    const double size = is_on ? input : ports[i].slack_size(z.data(), w.data());
    if (!ports[i].blocks(on) && ports[i].free_variable(is_on, z.data(), w.data()) < -tolerance::clear_sign * size) wrong.push_back(i);
  }
  return wrong;
}

}  // namespace pwlsim::engine::sparse
