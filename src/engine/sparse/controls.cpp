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

double WatchedControl::noise(double form_value, double largest_unknown) const {
  return std::max(tolerance::guard_sign * std::max({level_size(), largest, std::abs(form_value)}), rounding(largest_unknown));
}

bool WatchedControl::passes_with(const WatchedControl& other, const Position& on) const {
  const auto sign = [&](const WatchedControl& control) { return control.holds(on) ? 1.0 : -1.0; };
  const auto offset = [&](const WatchedControl& control) {
    return sign(control) * (control.value.constant - (control.holds(on) ? control.off_level : control.on_level));
  };
  const auto agree = [&](const std::vector<Form::IndexedTerm>& a, const std::vector<Form::IndexedTerm>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](const Form::IndexedTerm& x, const Form::IndexedTerm& y) {
      return x.index == y.index && sign(*this) * x.coefficient == sign(other) * y.coefficient;
    });
  };
  return agree(value.z, other.value.z) && agree(value.w, other.value.w) && offset(*this) == offset(other);
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
