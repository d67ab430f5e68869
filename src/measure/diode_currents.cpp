#include "measure/diode_currents.hpp"

#include <algorithm>
#include <cmath>

#include "linalg/legendre.hpp"

namespace pwlsim::measure {

using linalg::legendre_points;

void ChargeSpectrum::add(double current, double charge) {
  if (!(current >= least && charge > 0.0 && std::isfinite(charge))) return;  // as in a run that ends beyond the range of numbers
  const double place = std::log10(current / least) * static_cast<double>(per_decade), last = static_cast<double>(sums_.size() - 1);
  Sum& sum = sums_[static_cast<std::size_t>(std::min(place, last))];
  sum.charge += charge;
  sum.square += charge * current;
}

void ChargeSpectrum::add(const ChargeSpectrum& other, double factor) {
  for (std::size_t k = 0; k < sums_.size(); ++k) {
    sums_[k].charge += factor * other.sums_[k].charge;
    sums_[k].square += factor * other.sums_[k].square;
  }
}

std::vector<ChargeSpectrum::Bin> ChargeSpectrum::bins() const {
  constexpr double least_share = 1e-4;
  double total = 0.0;
  for (const Sum& sum : sums_) total += sum.charge;
  std::vector<Bin> list;
  for (const Sum& sum : sums_)
    if (sum.charge > least_share * total) list.push_back({sum.charge, sum.square / sum.charge});
  return list;
}

void DiodeCurrents::take(const engine::Piece& piece) {
  if (!(piece.length > 0.0)) return;
  ++pieces_;
  const auto& [point, weight] = linalg::gauss_legendre();
  const double lower = piece.place(piece.from), upper = piece.place(piece.to), scale = 0.5 * (piece.to - piece.from);
  const double place = stop_ > 0.0 ? piece.from / stop_ * static_cast<double>(windows) : 0.0;
  const std::size_t at = std::min(static_cast<std::size_t>(std::max(place, 0.0)), windows - 1);
  for (std::size_t k = 0; k < diodes_.size(); ++k) {
    const linalg::LegendreSeries current(&piece.values[2 * k * legendre_points]), voltage(&piece.values[(2 * k + 1) * legendre_points]);
    Sums& sums = diodes_[k];
    Window& window = sums.windows[at];
    for (std::size_t j = 0; j < legendre_points; ++j) {
      const double x = lower + 0.5 * (point[j] + 1.0) * (upper - lower);
      const double i = std::max(0.0, current(x)), v = voltage(x), charge = scale * weight[j] * i;
      window.charge += charge;
      window.square += charge * i;
      window.spectrum.add(i, charge);
      sums.highest = std::max(sums.highest, v);
      sums.lowest = std::min(sums.lowest, v);
    }
  }
}

std::vector<const DiodeCurrents::Window*> DiodeCurrents::counted(std::size_t diode) const {
  constexpr double least_share = 1e-7;  // of the largest: below, it is rounding or a leak
  double largest = 0.0;
  for (const Window& window : diodes_[diode].windows)
    if (std::isfinite(window.charge)) largest = std::max(largest, window.charge);
  std::vector<const Window*> list;
  for (const Window& window : diodes_[diode].windows)
    if (window.charge > least_share * largest && std::isfinite(window.charge)) list.push_back(&window);
  return list;
}

double DiodeCurrents::mean(std::size_t diode) const {
  const std::vector<const Window*> list = counted(diode);
  double sum = 0.0;
  for (const Window* window : list) sum += window->square / window->charge;
  return list.empty() ? 0.0 : sum / static_cast<double>(list.size());
}

double DiodeCurrents::charge(std::size_t diode) const {
  double sum = 0.0;
  for (const Window* window : counted(diode)) sum += window->charge;
  return sum;
}

ChargeSpectrum DiodeCurrents::spectrum(std::size_t diode) const {
  ChargeSpectrum spectrum;
  for (const Window* window : counted(diode)) spectrum.add(window->spectrum, 1.0 / window->charge);
  return spectrum;
}

}  // namespace pwlsim::measure
