#include <algorithm>
#include <cmath>
#include <ctime>

#include "converters/integrator.hpp"

namespace pwlsim::test::converters {
namespace {

/// A signal's size is at least this part of the largest of its kind, a voltage's of the sources, too …
constexpr double negligible = 1e-6;
/// … a current's at least this times the largest voltage: what Roff = inf becomes here (Equations) leaks a 1e-8th of it …
constexpr double leak_conductance = 1e-9;
/// … and in row 0 so many times what leaks through the least Roff, ten of them in parallel: beside an inductor it begins within 1e-14 s.
constexpr double leaks_at_start = 1e7;

}  // namespace

Difference largest_difference(const Waveforms& reference, const std::vector<std::vector<double>>& other, const Converter& converter) {
  std::vector<bool> is_voltage;
  for (const Branch& branch : converter.branches)
    if (branch.kind == Branch::Kind::capacitor || branch.kind == Branch::Kind::inductor)
      is_voltage.push_back(branch.kind == Branch::Kind::capacitor);
  const std::vector<Real>& largest = reference.scales;
  double volts = 0.0, amperes = 0.0;
  for (std::size_t k = 0; k < largest.size(); ++k) {
    double& kind = is_voltage[k] ? volts : amperes;
    kind = std::max(kind, static_cast<double>(largest[k]));
  }
  for (const Branch& branch : converter.branches)
    if (branch.kind == Branch::Kind::source) volts = std::max(volts, branch.wave.largest());
  double start_conductance = leak_conductance;
  for (const Contact& model : converter.models) start_conductance = std::max(start_conductance, leaks_at_start / model.off);
  Difference result;
  for (std::size_t r = 0; r < std::min(reference.rows.size(), other.size()); ++r)
    for (std::size_t k = 0; k < largest.size(); ++k) {
      const double least =
          is_voltage[k] ? negligible * volts : std::max(negligible * amperes, (r == 0 ? start_conductance : leak_conductance) * volts);
      const double size = std::max({static_cast<double>(largest[k]), least, 1e-300});
      const double difference = std::abs(reference.rows[r][k] - other[r][k]) / size;
      if (difference > result.size || std::isnan(difference)) result = {std::isnan(difference) ? infinity : difference, k, r};
    }
  return result;
}

Resolved resolve(const Converter& converter, double target, double patience) {
  Resolved result;
  Settings settings;
  const std::clock_t begin = std::clock();
  const auto rest = [&] { return patience - static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC; };
  settings.patience = patience;
  result.waveforms = integrate(converter, settings);
  for (int round = 0; round < 3 && result.waveforms.trouble.empty(); ++round) {
    settings.scales = result.waveforms.scales;
    settings.tolerance /= 8;
    settings.first_step /= 32;
    settings.patience = rest();
    Waveforms finer = integrate(converter, settings);
    if (!finer.trouble.empty()) {
      result.waveforms.trouble = finer.trouble;
      break;
    }
    result.where = largest_difference(finer, result.waveforms.rows, converter);
    result.error = result.where.size;
    result.waveforms = std::move(finer);
    if (result.error < target) break;
  }
  return result;
}

}  // namespace pwlsim::test::converters
