#include "engine/sparse/start_unknowns.hpp"

#include <algorithm>
#include <cmath>

#include "engine/sparse/fastest.hpp"
#include "engine/sparse/tolerances.hpp"

namespace pwlsim::engine::sparse {

namespace {

constexpr double share_of_fastest = 0.25;  ///< of that time constant: in longer steps a decay might be taken for rounding
constexpr double shorter = 1.0 / 16.0;     ///< than a step that is too long
constexpr int most_steps = 3;

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
  double step = std::exp2(std::floor(std::log2(std::min(longest_, start.step))));  // so that factors serve again
  for (int tried = 0; tried < most_steps; ++tried, step *= shorter) {
    const Factor* const factor = factors_.at(1.0 / step, start.on);
    if (!factor || space_.begin(*factor, 1.0 / step, start.on, start.origin, start.size) != KrylovSpace::Begun::yes) return std::nullopt;
    if (auto found = space_.unknowns_at_start()) return has_signs_of(start.on, found->z, start.time) ? std::move(found) : std::nullopt;
  }
  return std::nullopt;
}

bool StartUnknowns::has_signs_of(const Position& on, const std::vector<double>& z, double time) const {
  std::vector<double> w;
  sources_.evaluate(time, w);
  const auto& ports = descriptor_.ports();
  double input = 0.0;
  for (const DescriptorPort& port : ports) input = std::max(input, std::abs(z[static_cast<std::size_t>(port.row)]));
  for (std::size_t i = 0; i < static_cast<std::size_t>(descriptor_.first_switch()); ++i) {
    const bool is_on = on[i] != 0;
    const double size = is_on ? input : ports[i].slack_size(z.data(), w.data());
    if (!ports[i].blocks(on) && ports[i].free_variable(is_on, z.data(), w.data()) < -tolerance::clear_sign * size) return false;
  }
  return true;
}

}  // namespace pwlsim::engine::sparse
