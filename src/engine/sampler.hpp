#pragma once
/// Controllers of a circuit: at instants of their own choice they read its signals, and set sources that hold their values in between.

#include <span>
#include <vector>

namespace pwlsim::engine {

class Sampler {
 public:
  virtual ~Sampler() = default;
  /// The sources of a channel (model::Held) have this value from now on.
  struct Setting {
    int channel = 0;
    double value = 0.0;
  };
  /// A run begins. A repeated run must give the same values again.
  virtual void begin() = 0;
  /// The next sampling instant, s; it may be 0 or infinite, and never decreases.
  [[nodiscard]] virtual double next() const = 0;
  /// Called at next() (`time`, to rounding) with all signals of the network as they are just before; at 0 right after the start. `settings` receives the changes.
  /// False: the run ends as an interrupted one.
  virtual bool sample(double time, std::span<const double> signals, std::vector<Setting>& settings) = 0;
};

}  // namespace pwlsim::engine
