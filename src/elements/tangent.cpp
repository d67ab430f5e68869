#include "elements/tangent.hpp"

namespace pwlsim::elements {
namespace {

/// Boltzmann constant over elementary charge (SI 2019, exact) at 300.15 K.
constexpr double thermal_voltage = 1.380649e-23 / 1.602176634e-19 * 300.15;

}  // namespace

model::ExponentialLaw exponential_law(double saturation, double emission, double series) {
  return {saturation, emission * thermal_voltage, series};
}

model::Tangent tangent(double saturation, double emission, double series, double current) {
  return exponential_law(saturation, emission, series).tangent(current);
}

std::string written(const Model& model, std::span<const std::string_view> names) {
  std::string list;
  for (std::string_view name : names) {
    if (!model.values.has(name)) continue;
    if (!list.empty()) list += ", ";
    list += name;
  }
  return list;
}

}  // namespace pwlsim::elements
