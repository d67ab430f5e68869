#pragma once
/// Messages about networks whose equations have no solution, or several.

#include "base/diagnostic.hpp"
#include "linalg/dense.hpp"
#include "model/network.hpp"
#include "model/tableau.hpp"

namespace pwlsim::model {

/// E-coupling at the first coupling.
void report_impossible_coupling(const Network& network, Diagnostics& diagnostics);

/// E-improper; the columns of `waves` that are not zero: ports whose wave would be differentiated.
void report_improper(const Unknowns& unknowns, const linalg::WideMatrix& waves, Diagnostics& diagnostics);

/// What the equations of a network leave open.
struct OpenEquations {
  linalg::WideMatrix rows;       ///< combinations of equations that are identically zero, columns
  linalg::WideMatrix kernel;     ///< combinations of unknowns that no equation determines, columns
  bool is_contradicted = false;  ///< sources have a part in these equations
};
/// E-source-loop, E-source-cutset or E-floating.
void report_open(const Network& network, const Unknowns& unknowns, const OpenEquations& open, Diagnostics& diagnostics);

}  // namespace pwlsim::model
