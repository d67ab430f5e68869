#pragma once
/// The start of a run: the DC operating point, or the initial values of the deck.

#include <string>
#include <unordered_map>

#include "engine/exact/exact_model.hpp"
#include "engine/exact/run_state.hpp"
#include "engine/missing_rest.hpp"
#include "engine/run.hpp"

namespace pwlsim::engine {

/// Signals are known only for an operating point.
struct RunStart : RunState {
  Answer answer;        ///< outcome and remarks
  MissingRest missing;  ///< operating point only: parts that have none start from `.ic` values, and zero elsewhere
};

/// Sources at their value just before t = 0, capacitors open, inductors short, complementarity satisfied, `.ic` values forced.
[[nodiscard]] RunStart start_from_operating_point(const ExactModel& model);

/// `ic=` and `.ic` values, zero elsewhere.
[[nodiscard]] RunStart start_from_initial_values(const ExactModel& model);

/// Of stores, by the names of their elements. What is not there is zero.
struct GivenStores {
  std::unordered_map<std::string, double> voltages;  ///< of capacitors, V
  std::unordered_map<std::string, double> currents;  ///< of inductors, A
};

/// At these values, as found by another engine: to its tolerance they may contradict the circuit, without a remark.
[[nodiscard]] RunStart start_from(const ExactModel& model, const GivenStores& values);

}  // namespace pwlsim::engine
