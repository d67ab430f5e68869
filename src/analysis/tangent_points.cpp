#include "analysis/tangent_points.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pwlsim::analysis {
namespace {

using measure::ChargeSpectrum;
using Spectrum = std::vector<ChargeSpectrum::Bin>;

constexpr double rounding_of_voltage = 1e-12;  ///< of itself

struct Misfit {
  double mean = 0.0, deviation = 0.0;  ///< V
};

double voltage_of(const model::ExponentialLaw& law, double current) {
  return law.series * current + law.slope * std::log(current / law.saturation);
}
double voltage_of(const ChannelCurve& curve, double current) { return curve.voltage(current); }
double devices_of(const model::ExponentialLaw& law) { return law.parallel; }
double devices_of(const ChannelCurve&) { return 1.0; }

template <class Law>
class TangentFit {
 public:
  TangentFit(const Law& law, const Spectrum& spectrum) : law_(law), spectrum_(spectrum) {}

  [[nodiscard]] Misfit misfit(const std::vector<double>& currents) const {
    const std::vector<model::Tangent> tangents = at(currents);
    double charge = 0.0, sum = 0.0, square = 0.0;
    for (const ChargeSpectrum::Bin& bin : spectrum_) {
      const double excess = lowest(tangents, bin.current) - voltage_of(law_, bin.current);
      charge += bin.charge;
      sum += bin.charge * excess;
      square += bin.charge * excess * excess;
    }
    if (charge == 0.0) return {};
    const double mean = sum / charge;
    return {mean, std::sqrt(std::max(0.0, square / charge - mean * mean))};
  }

  /// The currents of the spectrum at which one more tangent, and then each of the others, leave the least deviation.
  [[nodiscard]] std::vector<double> with_one_more(std::vector<double> currents) const {
    currents.push_back(currents.back());
    constexpr int rounds = 4;
    for (int round = 0; round < rounds; ++round)
      for (std::size_t k = currents.size(); k-- > 0;) place(currents, k);
    std::sort(currents.begin(), currents.end());
    return currents;
  }

  [[nodiscard]] DiodeLines lines(std::vector<double> currents) const {
    constexpr double next_to_one_another = 1.1;  ///< a ratio
    const auto is_same = [&](double a, double b) { return b < next_to_one_another * a; };
    currents.erase(std::unique(currents.begin(), currents.end(), is_same), currents.end());
    DiodeLines result{currents, {}};
    const double mean = misfit(currents).mean;
    for (const double current : currents) {
      result.lines.push_back(law_.tangent(current));
      result.lines.back().drop = std::max(0.0, result.lines.back().drop - mean);
    }
    return result;
  }

 private:
  void place(std::vector<double>& currents, std::size_t k) const {
    double best = std::numeric_limits<double>::infinity(), at = currents[k];
    for (const ChargeSpectrum::Bin& bin : spectrum_) {
      currents[k] = bin.current;
      const double deviation = misfit(currents).deviation;
      if (deviation < best) {
        best = deviation;
        at = bin.current;
      }
    }
    currents[k] = at;
  }

  /// Of one diode.
  [[nodiscard]] std::vector<model::Tangent> at(const std::vector<double>& currents) const {
    std::vector<model::Tangent> list;
    for (const double current : currents) {
      list.push_back(law_.tangent(current));
      list.back().resistance *= devices_of(law_);
    }
    return list;
  }

  static double lowest(const std::vector<model::Tangent>& tangents, double current) {
    double least = std::numeric_limits<double>::infinity();
    for (const model::Tangent& tangent : tangents) least = std::min(least, tangent.drop + tangent.resistance * current);
    return least;
  }

  const Law& law_;
  const Spectrum& spectrum_;
};

template <class Law>
DiodeLines fewest_lines(const Law& law, const Spectrum& spectrum, double mean, double tolerance) {
  constexpr std::size_t most = 3;
  const TangentFit<Law> fit(law, spectrum);
  std::vector<double> currents{mean};
  while (currents.size() < most && fit.misfit(currents).deviation > tolerance) currents = fit.with_one_more(std::move(currents));
  return fit.lines(std::move(currents));
}

}  // namespace

double ChannelCurve::current(double voltage) const {
  const double x = law.series * law.gain * voltage;  // what the series resistance is by that of the channel
  constexpr double small = 1e-4;                     // below, two terms of the series are rounding
  if (x < small) return 0.5 * law.gain * voltage * voltage * (1.0 - 2.0 / 3.0 * x);
  return (x - std::log1p(x)) / (law.series * law.series * law.gain);
}

double ChannelCurve::voltage(double current) const {
  double voltage = std::sqrt(2.0 * current / law.gain) + law.series * current;  // no less than the answer: Newton's method falls to it
  constexpr int most = 30;
  for (int k = 0; k < most; ++k) {
    const double step = (this->current(voltage) - current) * law.resistance(voltage);
    if (!(step > rounding_of_voltage * voltage)) break;
    voltage -= step;
  }
  return voltage;
}

model::Tangent ChannelCurve::tangent(double current) const {
  const double at = voltage(current), resistance = std::max(law.resistance(at), model::least_channel_resistance);
  return {resistance, at - resistance * current};
}

DiodeLines fit_lines(const model::ExponentialLaw& law, const Spectrum& spectrum, double mean, double tolerance) {
  return fewest_lines(law, spectrum, mean, tolerance);
}

DiodeLines fit_lines(const ChannelCurve& curve, const Spectrum& spectrum, double mean, double tolerance) {
  return fewest_lines(curve, spectrum, mean, tolerance);
}

std::vector<model::Tangent> parallel_diodes(const std::vector<model::Tangent>& lines) {
  std::vector<model::Tangent> diodes{lines.front()};
  for (std::size_t k = 1; k < lines.size(); ++k) {
    const model::Tangent &before = lines[k - 1], &line = lines[k];
    const double corner = (line.drop - before.drop) / (before.resistance - line.resistance);
    diodes.push_back({1.0 / (1.0 / line.resistance - 1.0 / before.resistance), line.drop + line.resistance * corner});
  }
  return diodes;
}

}  // namespace pwlsim::analysis
