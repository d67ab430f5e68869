#pragma once
/// A parameter of the network as small inputs: sources of value zero, added to the model, and the value of each per unit of the parameter.
///
///     v = (R + p)·i            a voltage p·i in series
///     q = (C + p)·v            a voltage −(p/C)·v in series: the charge, which is the state, keeps its equation, and its jumps
///     λ = (M + P)·i            currents −(M⁻¹P i) in parallel, likewise
///     v = drop + …, a gain, a level of a source: a separate voltage or current
///
/// Thresholds of switches change no equation, but the times of crossings.

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "model/network.hpp"
#include "model/network_move.hpp"

namespace pwlsim::steady {

/// w of `input` += weight·(signal of the network, or voltage or current of a store).
struct Drive {
  int input = 0, signal = -1;
  double weight = 0.0;
  std::string store{};  ///< "v(C1)", in place of a signal
  /// In place of both: a voltage that sources hold, in any part of the circuit.
  struct HeldVoltage {
    std::vector<std::pair<std::string, double>> sources;  ///< name and coefficient
    double constant = 0.0;
  };
  std::optional<HeldVoltage> held{};
};

/// w of `input` += derivative of a function of time, whose numbers change by `derivative`.
struct Wave {
  int input = 0;
  model::SourceFunction function, derivative;
  int source = -1;  ///< of the network; −1: none, the function is a constant
  std::string name{};
};

/// The change of a switch's threshold.
struct LevelMove {
  int number = 0;  ///< of the switch
  double on = 0.0, off = 0.0;
};

/// The change of a start with uic: voltage of a capacitor or current of an inductor.
struct StartMove {
  bool is_capacitor = true;
  std::string name;
  double value = 0.0;
};

/// The change of an `.ic` value: the voltage of a node, or the current of an inductor.
struct ConditionMove {
  bool is_current = false;
  std::string name;
  double value = 0.0;
};

struct ParameterInputs {
  std::vector<Drive> drives;
  std::vector<Wave> waves;
  std::vector<LevelMove> levels;
  std::vector<StartMove> starts;
  std::vector<ConditionMove> conditions;
  std::string failure;  ///< why the parameter cannot be followed; "" if it can
  double value = 0.0;   ///< of the parameter, to judge rounding; 0: not known
};

/// The inputs of all parameters in one network.
struct SensitivityInputs {
  std::vector<std::string> names;  ///< of the inputs in the network
  std::vector<ParameterInputs> parameters;
  std::size_t signals = 0;  ///< added to the network, after its own
};

[[nodiscard]] SensitivityInputs add_parameter_inputs(model::Network& network, const std::vector<model::NetworkMoves>& parameters);

}  // namespace pwlsim::steady
