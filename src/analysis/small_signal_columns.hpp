#pragma once
/// The columns of `.ac`'s rows: which part of which signal each is.

#include <complex>
#include <vector>

#include "circuit/analyses.hpp"
#include "circuit/compile.hpp"

namespace pwlsim::analysis {

struct SmallSignalResult;

[[nodiscard]] double degrees(std::complex<double> value);
/// Of a response.
[[nodiscard]] double part_of(std::complex<double> value, circuit::SmallSignal::Column::Part part);

struct SelectedColumn {
  std::size_t signal = 0;
  circuit::SmallSignal::Column::Part part = circuit::SmallSignal::Column::Part::magnitude;
};
/// Those of .print ac, else magnitude and phase of all that are saved; their names in `result`.
[[nodiscard]] std::vector<SelectedColumn> select_columns(const circuit::Compiled& compiled, SmallSignalResult& result);

}  // namespace pwlsim::analysis
