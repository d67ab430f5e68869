#include "analysis/small_signal_columns.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pwlsim::analysis {
namespace {

using circuit::SmallSignalAnalysis;
using Complex = std::complex<double>;
using Column = SmallSignalAnalysis::Column;

/// "vm(out)" of "v(out)".
std::string named(const std::string& signal, char part) {
  const std::size_t open = std::min(signal.find('('), signal.size());
  return signal.substr(0, open) + part + signal.substr(open);
}

}  // namespace

double degrees(Complex value) { return std::arg(value) * 180.0 / std::numbers::pi; }

double part_of(Complex value, Column::ComplexPart part) {
  switch (part) {
    case Column::ComplexPart::magnitude:
      return std::abs(value);
    case Column::ComplexPart::phase:
      return degrees(value);
    case Column::ComplexPart::real:
      return value.real();
    case Column::ComplexPart::imaginary:
      return value.imag();
    case Column::ComplexPart::decibels:
      break;
  }
  return 20.0 * std::log10(std::abs(value));
}

std::vector<SelectedColumn> select_columns(const circuit::Compiled& compiled, const std::vector<std::string>& signals) {
  std::vector<SelectedColumn> selected;
  const SmallSignalAnalysis& card = *compiled.analyses.small_signal;
  for (const Column& column : card.columns)
    selected.push_back(
        {column.name, static_cast<std::size_t>(compiled.measurements.probe_signals[static_cast<std::size_t>(column.probe)]), column.part});
  for (std::size_t k = 0; k < signals.size() && card.columns.empty(); ++k) {
    selected.push_back({named(signals[k], 'm'), k, Column::ComplexPart::magnitude});
    selected.push_back({named(signals[k], 'p'), k, Column::ComplexPart::phase});
  }
  return selected;
}

std::vector<std::string> small_signal_columns(const circuit::Compiled& compiled) {
  std::vector<std::string> signals, names{"frequency"};
  for (std::size_t k = 0; k < compiled.saved_signals(); ++k) signals.push_back(compiled.network.signals[k].name);
  for (SelectedColumn& column : select_columns(compiled, signals)) names.push_back(std::move(column.name));
  return names;
}

}  // namespace pwlsim::analysis
