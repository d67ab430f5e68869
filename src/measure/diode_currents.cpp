#include "measure/diode_currents.hpp"

#include <algorithm>

#include "linalg/legendre.hpp"

namespace pwlsim::measure {

using linalg::legendre_points;

void DiodeCurrents::take(const engine::Piece& piece) {
  if (!(piece.length > 0.0)) return;
  const auto& [point, weight] = linalg::gauss_legendre();
  const double lower = 2.0 * (piece.from - piece.begin) / piece.length - 1.0, upper = 2.0 * (piece.to - piece.begin) / piece.length - 1.0;
  const double scale = 0.5 * (piece.to - piece.from);
  for (std::size_t k = 0; k < diodes_.size(); ++k) {
    const linalg::LegendreSeries current = linalg::LegendreSeries(&piece.values[2 * k * legendre_points]).on(lower, upper);
    const linalg::LegendreSeries voltage = linalg::LegendreSeries(&piece.values[(2 * k + 1) * legendre_points]).on(lower, upper);
    for (std::size_t j = 0; j < legendre_points; ++j) {
      const double i = std::max(0.0, current(point[j]));
      diodes_[k].charge += scale * weight[j] * i;
      diodes_[k].square += scale * weight[j] * i * i;
      diodes_[k].voltage = std::max(diodes_[k].voltage, voltage(point[j]));
    }
  }
}

double DiodeCurrents::mean(std::size_t diode) const {
  const Sums& sums = diodes_[diode];
  return sums.charge > 0.0 ? sums.square / sums.charge : 0.0;
}

}  // namespace pwlsim::measure
