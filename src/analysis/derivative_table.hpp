#pragma once
/// Derivatives of measurements to parameters, as `.sens` lists them.

#include <string>
#include <vector>

namespace pwlsim::analysis {

struct Derivative {
  std::string measurement, parameter;
  double measured = 0.0;           ///< m; NaN if the measurement failed, or nothing was measured
  double value = 0.0;              ///< dm/dp
  double normalised = 0.0;         ///< p/m·dm/dp; not finite if m is 0
  double left = 0.0, right = 0.0;  ///< towards smaller and larger p: differ at a kink
  std::string kink;                ///< why they differ; "" if they are equal
  std::string failure;             ///< why there is none; "" if there is one
  bool is_kink = false;            ///< events meet here: beside_kinks may find both sides
};

using DerivativeTable = std::vector<Derivative>;

/// The failure of derivatives that a signal came before.
inline constexpr const char* interrupted_derivative = "interrupted by a signal";

}  // namespace pwlsim::analysis
