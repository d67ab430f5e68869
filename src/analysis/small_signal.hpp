#pragma once
/// `.ac`: small signals around the periodic steady state, or around the operating point of a linear circuit.

#include <atomic>
#include <complex>
#include <optional>
#include <string>
#include <vector>

#include "analysis/small_signal_inputs.hpp"
#include "circuit/compile.hpp"
#include "engine/exact/march.hpp"
#include "engine/sparse/sparse.hpp"
#include "steady/orbit.hpp"

namespace pwlsim::analysis {

/// A loop gain T(f) and where it crosses. With a voltage source alone T = T_v = −v(n−)/v(n+). With a current source at one of its nodes, too,
/// T = (T_v T_i − 1)/(T_v + T_i + 2), T_i the ratio of the currents into the driving and the receiving side: correct for any impedances.
/// R. D. Middlebrook, Measurement of loop gain in feedback systems, Int. J. Electronics 38 (1975), eq. (31).
struct LoopGain {
  std::string source;
  std::vector<std::complex<double>> values;
  struct Crossover {
    double frequency = 0.0, phase_margin = 0.0;  ///< Hz, degrees
  };
  struct GainMargin {
    double frequency = 0.0, decibels = 0.0;
  };
  std::vector<Crossover> crossovers;
  std::vector<GainMargin> gain_margins;
};

struct SmallSignalResult {
  std::vector<std::string> signals;
  std::vector<double> frequencies;                        ///< Hz
  std::vector<std::vector<std::complex<double>>> values;  ///< by frequency, then signal; not finite where the response is infinite
  /// A column of the rows.
  struct Column {
    std::string name;
    std::vector<double> values;  ///< by frequency
  };
  std::vector<Column> columns;
  std::optional<LoopGain> loop;
  std::vector<double> singular;        ///< frequencies of an infinite response
  bool is_beyond_derivatives = false;  ///< something follows further derivatives of an input than are known: no value is right
  std::vector<int> unknown_impulses;   ///< signals whose impulses have no linear form
  std::vector<std::string> impulsive;  ///< signals without a response: they have impulses on the orbit that the input changes
};

/// Around an orbit of a model with these inputs, in `network`. `interrupt` may be null; once it is nonzero no further frequency is begun, and those found so far are the result.
[[nodiscard]] SmallSignalResult small_signals(const circuit::Compiled& compiled, const SmallSignalInputs& inputs,
                                              const model::Network& network, const engine::ExactModel& model, const steady::Trace& trace,
                                              double period, bool is_driven, const std::atomic<int>* interrupt);
/// For a linear circuit: prepares its sparse equations, and checks whether it has a response before that is computed.
class LinearSmallSignals {
 public:
  /// `compiled` must outlive it.
  explicit LinearSmallSignals(const circuit::Compiled& compiled);
  /// E-ac-needs-pss if something switches, or an error of the circuit's structure; "": there is a response.
  [[nodiscard]] const std::string& id() const { return id_; }
  [[nodiscard]] const std::string& message() const { return message_; }
  /// `interrupt` as above.
  [[nodiscard]] SmallSignalResult result(const std::atomic<int>* interrupt = nullptr) const;

 private:
  void fail(std::string id, std::string message);

  const circuit::Compiled* compiled_;
  model::Network network_;
  SmallSignalInputs inputs_;
  std::shared_ptr<const engine::sparse::SparseModel> equations_;
  std::string id_, message_;
};

/// E-ac-no-derivative of such a result.
inline constexpr const char* beyond_derivatives =
    "something follows the seventh derivative of an input, or a further one; try a small resistance where it is differentiated";

/// Leaves out the responses of these signals of the network.
void leave_out_impulsive(const circuit::Compiled& compiled, const std::vector<int>& signals, SmallSignalResult& result);
/// W-ac-impulse; `where`: " in the run with …".
[[nodiscard]] std::string impulsive_text(const std::vector<std::string>& signals, const std::string& where = "");

}  // namespace pwlsim::analysis
