#include "analysis/tangent_points.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pwlsim::analysis {
namespace {

using measure::ChargeSpectrum;
using Spectrum = std::vector<ChargeSpectrum::Bin>;

struct Misfit {
  double mean = 0.0, deviation = 0.0;  ///< V
};

class Fit {
 public:
  Fit(const model::ExponentialLaw& law, const Spectrum& spectrum) : law_(law), spectrum_(spectrum) {}

  [[nodiscard]] Misfit misfit(const std::vector<double>& currents) const {
    const std::vector<model::Tangent> tangents = at(currents);
    double charge = 0.0, sum = 0.0, square = 0.0;
    for (const ChargeSpectrum::Bin& bin : spectrum_) {
      const double excess = lowest(tangents, bin.current) - voltage(bin.current);
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

  [[nodiscard]] double voltage(double current) const {
    return law_.series * current + law_.slope * std::log(current / law_.saturation);
  }

  /// Of one diode.
  [[nodiscard]] std::vector<model::Tangent> at(const std::vector<double>& currents) const {
    std::vector<model::Tangent> list;
    for (const double current : currents) {
      list.push_back(law_.tangent(current));
      list.back().resistance *= law_.parallel;
    }
    return list;
  }

  static double lowest(const std::vector<model::Tangent>& tangents, double current) {
    double least = std::numeric_limits<double>::infinity();
    for (const model::Tangent& tangent : tangents) least = std::min(least, tangent.drop + tangent.resistance * current);
    return least;
  }

  const model::ExponentialLaw& law_;
  const Spectrum& spectrum_;
};

}  // namespace

DiodeLines fit_lines(const model::ExponentialLaw& law, const Spectrum& spectrum, double mean, double tolerance) {
  constexpr std::size_t most = 3;
  const Fit fit(law, spectrum);
  std::vector<double> currents{mean};
  while (currents.size() < most && fit.misfit(currents).deviation > tolerance) currents = fit.with_one_more(std::move(currents));
  return fit.lines(std::move(currents));
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
