#pragma once
/// Controllers that run beside a circuit: at instants of their own choice they see its signals, and set sources that hold their values in between.

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
  /// A run begins. One that begins again must be told the same again.
  virtual void begin() = 0;
  /// When it is to be asked next, s; it may be 0, never earlier than it was asked last, and infinite.
  [[nodiscard]] virtual double next() const = 0;
  /// At next() (`time`, to rounding) with all signals of the network as they are just before; at 0 right after the start. `settings` takes what changes now.
  /// False: the run ends as an interrupted one.
  virtual bool sample(double time, std::span<const double> signals, std::vector<Setting>& settings) = 0;
};

}  // namespace pwlsim::engine
