#pragma once
/// Sampled controllers: digital control; the circuit is solved exactly between samples.

#include <functional>
#include <string>
#include <vector>

namespace pwlsim {

/// At t = k·every, k = 0, 1, …, `function` receives the inputs as they are just before (at t = 0: right after the start) and sets the outputs, which hold
/// from t + delay until the next ones. The function keeps the state of the controller; reset it between runs. The exact engine only;
/// docs/reference/controllers.md.
struct Controller {
  /// Signals: "v(out)", "v(a,b)", "i(L1)". They are saved even if the deck does not save them.
  std::vector<std::string> inputs = {};
  /// Names of V and I sources of constant value, whose value (V or A) is set. Any other name is a node: the controller adds a source that sets its voltage
  /// against ground (V).
  std::vector<std::string> outputs = {};
  double every = 0.0;  ///< s, positive
  double delay = 0.0;  ///< s, from the sample to the new outputs; may be longer than `every`
  std::vector<double> initial =
      {};  ///< outputs until the first ones are set, and at the operating point; if empty, the value of the source, or 0 V
  /// `time`: k·every, s. `inputs`: in V and A, in the order above. `outputs`: the values set last; overwrite them. An exception ends the run
  /// (E-controller): Circuit::run then throws a RunError with the rows up to then, in which that exception is nested.
  std::function<void(double time, const std::vector<double>& inputs, std::vector<double>& outputs)> function = {};
};

}  // namespace pwlsim
