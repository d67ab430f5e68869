#pragma once
/// Derivatives of measurements to parameters.

#include <string>
#include <vector>

#include <pwlsim/error.hpp>

namespace pwlsim {

/// The derivative of one measurement to one parameter.
struct Derivative {
  std::string parameter;           ///< as requested
  double value = 0.0;              ///< dm/dp, in units of the measurement per unit of the parameter; NaN if there is none
  double normalised = 0.0;         ///< p/m·dm/dp; NaN if m is 0
  double left = 0.0, right = 0.0;  ///< towards smaller and larger values of the parameter: they differ at a kink; `value` is `right`
  std::string kink;                ///< why they differ; "" if they are equal
  std::string failure;             ///< why there is no derivative; "" if there is one
};

/// A measurement with its derivatives, in the order of the parameters.
struct Gradient {
  std::string measurement;
  double measured = 0.0;  ///< its value; NaN if it failed
  std::vector<Derivative> derivatives;
  std::vector<Message> messages;  ///< warnings and notes of the run
};

}  // namespace pwlsim
