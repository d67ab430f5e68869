#pragma once
/// Sampled controllers: digital control as it is built, exact between samples.

#include <functional>
#include <string>
#include <vector>

namespace pwlsim {

/// At t = k·every, k = 0, 1, …, `function` gets the inputs as they are just before (at t = 0: right after the start) and sets the outputs, which hold from
/// t + delay on until the next ones. The function keeps whatever state the controller has. Every run calls it anew: reset that state between runs. The
/// exact engine only; docs/reference/controllers.md.
struct Controller {
  /// Signals: "v(out)", "v(a,b)", "i(L1)". They are saved even if the deck does not save them.
  std::vector<std::string> inputs = {};
  /// Names of V and I sources of constant value, whose value (V or A) is then set; any other name is a node, whose voltage against ground (V) a source of the
  /// controller's own sets.
  std::vector<std::string> outputs = {};
  double every = 0.0;  ///< s, positive
  double delay = 0.0;  ///< s, from the sample to the new outputs; may be longer than `every`
  std::vector<double> initial =
      {};  ///< outputs before the first are set, and at the operating point; if empty, the value of the source, or 0 V
  /// `time`: k·every, s. `inputs`: in V and A, in the order above. `outputs`: what was set last, to be overwritten. What it throws ends the run
  /// (E-controller): Circuit::run then throws a RunError with the rows up to there, in which that exception is nested.
  std::function<void(double time, const std::vector<double>& inputs, std::vector<double>& outputs)> function = {};
};

}  // namespace pwlsim
