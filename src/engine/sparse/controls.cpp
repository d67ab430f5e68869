#include "engine/sparse/controls.hpp"
#include "engine/sparse/tolerances.hpp"

#include <algorithm>
#include <cmath>

namespace pwlsim::engine::sparse {

double WatchedControl::level_size() const { return std::max({std::abs(on_level), std::abs(off_level), on_level - off_level}); }

double WatchedControl::rounding(double largest_unknown) const {
  double gain = 0.0;
  for (const Form::IndexedTerm& part : value.z) gain = std::max(gain, std::abs(part.coefficient));
  return tolerance::voltage_rounding * gain * largest_unknown;
}

std::vector<WatchedControl> controls_of(const model::Network& network, const Descriptor& descriptor) {
  std::vector<WatchedControl> controls;
  for (std::size_t i = 0; i < network.switches.size(); ++i) {
    const auto& s = network.switches[i];
    controls.push_back(
        {static_cast<std::size_t>(descriptor.first_switch()) + i, descriptor.form(s.control), s.on_level, s.off_level, s.inverted});
  }
  return controls;
}

Position first_position(const model::Network& network, const Descriptor& descriptor) {
  Position on(descriptor.ports().size(), 0);
  for (std::size_t i = 0; i < network.switches.size(); ++i)
    on[static_cast<std::size_t>(descriptor.first_switch()) + i] = network.switches[i].initially_on != network.switches[i].inverted;
  return on;
}

}  // namespace pwlsim::engine::sparse
