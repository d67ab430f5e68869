#include "model/exponential_law.hpp"

#include <cmath>

namespace pwlsim::model {

Tangent ExponentialLaw::tangent(double current) const {
  return {(series + slope / current) / parallel, slope * (std::log(current / saturation) - 1.0)};
}

double ExponentialLaw::current(double voltage) const { return saturation * std::exp(voltage / slope); }

}  // namespace pwlsim::model
