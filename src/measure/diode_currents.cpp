#include "measure/diode_currents.hpp"

#include <algorithm>

#include "linalg/legendre.hpp"

namespace pwlsim::measure {

using linalg::legendre_points;

void DiodeCurrents::take(const engine::Piece& piece) {
  if (!(piece.length > 0.0)) return;
  const auto& [point, weight] = linalg::gauss_legendre();
  const double lower = piece.place(piece.from), upper = piece.place(piece.to), scale = 0.5 * (piece.to - piece.from);
  for (std::size_t k = 0; k < diodes_.size(); ++k) {
    const linalg::LegendreSeries current(&piece.values[2 * k * legendre_points]), voltage(&piece.values[(2 * k + 1) * legendre_points]);
    for (std::size_t j = 0; j < legendre_points; ++j) {
      const double x = lower + 0.5 * (point[j] + 1.0) * (upper - lower);
      const double i = std::max(0.0, current(x));
      diodes_[k].charge += scale * weight[j] * i;
      diodes_[k].square += scale * weight[j] * i * i;
      diodes_[k].voltage = std::max(diodes_[k].voltage, voltage(x));
    }
  }
}

double DiodeCurrents::mean(std::size_t diode) const {
  const Sums& sums = diodes_[diode];
  return sums.charge > 0.0 ? sums.square / sums.charge : 0.0;
}

}  // namespace pwlsim::measure
