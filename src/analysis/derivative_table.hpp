#pragma once
/// Derivatives of measurements to parameters, as `.sens` lists them.

#include <string>
#include <vector>

namespace pwlsim::analysis {

struct Derivative {
  std::string measurement, parameter;
  double measured = 0.0;           ///< m; NaN where the measurement failed, or nothing was measured
  double value = 0.0;              ///< dm/dp
  double normalised = 0.0;         ///< p/m·dm/dp; not finite where m is 0
  double left = 0.0, right = 0.0;  ///< towards smaller and larger p: differ at a kink
  std::string kink;                ///< why they differ; "" where they do not
  std::string failure;             ///< why there is none; "" where there is one
  bool is_kink = false;            ///< events meet here: it may be known beside
};

using DerivativeTable = std::vector<Derivative>;

}  // namespace pwlsim::analysis
