#pragma once
/// A parameter of the network as small inputs: sources of value zero, added to the model, and what each of them is for a unit of the parameter.
///
///     v = (R + p)·i            a voltage p·i in series
///     q = (C + p)·v            a voltage −(p/C)·v in series: the charge, which is the state, keeps its equation, and its jumps
///     λ = (M + P)·i            currents −(M⁻¹P i) in parallel, likewise
///     v = drop + …, a gain, a level of a source: a voltage or a current of its own
///
/// Thresholds of switches move no equation, but the time at which they are passed.

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "model/network.hpp"
#include "model/network_move.hpp"

namespace pwlsim::steady {

/// w of `input` += weight·(signal of the network, or what a store holds).
struct Drive {
  int input = 0, signal = -1;
  double weight = 0.0;
  std::string store{};  ///< "v(C1)", in place of a signal
  /// In place of both: a voltage that sources hold, whatever part of the circuit it is read in.
  struct Held {
    std::vector<std::pair<std::string, double>> sources;  ///< name and coefficient
    double constant = 0.0;
  };
  std::optional<Held> held{};
};

/// w of `input` += derivative of a function of time, whose numbers move by `derivative`.
struct Wave {
  int input = 0;
  model::SourceFunction function, derivative;
  int source = -1;  ///< of the network; −1: none, the function is a constant
  std::string name{};
};

/// The threshold of a switch moves by so much.
struct LevelMove {
  int number = 0;  ///< of the switch
  double on = 0.0, off = 0.0;
};

/// The start of a run with uic moves: voltage of a capacitor or current of an inductor.
struct StartMove {
  bool is_capacitor = true;
  std::string name;
  double value = 0.0;
};

/// What `.ic` says moves: the voltage of a node, or the current of an inductor.
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
  std::string failure;  ///< why the parameter cannot be followed; "" where it can
  double value = 0.0;   ///< of the parameter, for what counts as rounding; 0: not known
};

/// The inputs of all parameters in one network.
struct SensitivityInputs {
  std::vector<std::string> names;  ///< of the inputs in the network
  std::vector<ParameterInputs> parameters;
  std::size_t signals = 0;  ///< added to the network, behind its own
};

[[nodiscard]] SensitivityInputs add_parameter_inputs(model::Network& network, const std::vector<model::NetworkMoves>& parameters);

}  // namespace pwlsim::steady
