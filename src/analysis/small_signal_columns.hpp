#pragma once
/// The columns of `.ac`'s rows: which part of which signal each is.

#include <complex>
#include <string>
#include <vector>

#include "circuit/analyses.hpp"
#include "circuit/compile.hpp"

namespace pwlsim::analysis {

[[nodiscard]] double degrees(std::complex<double> value);
/// Of a response.
[[nodiscard]] double part_of(std::complex<double> value, circuit::SmallSignalAnalysis::Column::ComplexPart part);

struct SelectedColumn {
  std::string name;
  std::size_t signal = 0;
  circuit::SmallSignalAnalysis::Column::ComplexPart part = circuit::SmallSignalAnalysis::Column::ComplexPart::magnitude;
};
/// Those of .print ac, else magnitude and phase of all that are saved. `signals`: the names of these.
[[nodiscard]] std::vector<SelectedColumn> select_columns(const circuit::Compiled& compiled, const std::vector<std::string>& signals);
/// Names of the columns, the frequency first.
[[nodiscard]] std::vector<std::string> small_signal_columns(const circuit::Compiled& compiled);

}  // namespace pwlsim::analysis
