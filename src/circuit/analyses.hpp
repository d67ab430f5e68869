#pragma once
/// The analyses of a deck, without syntax.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/source.hpp"
#include "model/network_move.hpp"

namespace pwlsim::circuit {

/// A time in seconds. `decimal` is its plain decimal text ("12.5e-6", suffix folded into the exponent) if the deck has a
/// plain number, so that row times can be computed from it exactly; "" if it is the value of an expression.
struct TimeValue {
  double seconds = 0.0;
  std::string decimal = "0";
  std::vector<double> gradient{};  ///< to the parameters of `.sens`; empty where it does not depend on them
};

/// `.tran`. Guaranteed: 0 ≤ start < stop, all finite, step ≥ 0. step.seconds = 0 means omitted: 1000 equal steps from start to stop.
/// A largest step (Tmax) is read, checked and ignored: the engines need none.
struct TransientAnalysis {
  TimeValue step, stop, start;
  bool use_initial_conditions = false;  ///< uic
  SourceSpan span;

  /// s; a thousandth of the run if none is given.
  [[nodiscard]] double row_step() const { return step.seconds > 0.0 ? step.seconds : (stop.seconds - start.seconds) / 1000.0; }
};

/// `.pss`: the periodic steady state.
struct SteadyStateAnalysis {
  enum class Trigger { none, closes, opens, crosses };
  std::optional<double> period, longest_period;  ///< s
  bool is_hint = false;                          ///< the period is only a guess
  int multiple = 1;                              ///< k: periods of the sources in one period of the orbit
  Trigger trigger = Trigger::none;               ///< the event that begins the period of a self-timed circuit
  std::string element;                           ///< the switch or diode of the trigger, or the signal that crosses
  SourceSpan element_span;
  int probe = -1;  ///< of that signal
  double level = 0.0;
  bool level_is_mean = false;  ///< of the signal, in place of `level`
  bool is_falling = false;
  std::optional<double> settling_time;  ///< tstab, s
  int points = 1000;                    ///< row intervals per period
  std::optional<int> periods_before;    ///< likewise, of the sources (`.pop`)
  std::optional<int> most_iterations, most_periods;
  double tolerance = 0.0;  ///< of the residual; 0: rounding
  bool is_free = false;    ///< self-timed, although there are sources
  bool use_initial_conditions = false;
  SourceSpan span;
};

/// `.ac`: small signals around the steady state.
struct SmallSignalAnalysis {
  std::vector<double> frequencies;  ///< Hz, in order
  enum class Input { marked, source, frequency, duty };
  Input input = Input::marked;       ///< all sources with AC values; one source with amplitude 1; timing of sources
  std::vector<std::string> sources;  ///< named after from=
  std::string loop;                  ///< the source of a loop gain; "" if not requested
  std::string loop_current;          ///< a current source at a node of `loop`, for injection of both kinds; "" if there is none
  SourceSpan input_span;
  int harmonic = 0;
  std::optional<double> sample;  ///< s: the sampled response at that time of the period
  /// `.print ac`: what part of a signal is a column.
  struct Column {
    enum class ComplexPart { magnitude, phase, real, imaginary, decibels };
    std::string name;  ///< as written: "vdb(out)"
    ComplexPart part = ComplexPart::magnitude;
    int probe = 0;  ///< of FlatCircuit::probes
  };
  std::vector<Column> columns;  ///< none: magnitude and phase of every saved signal
  SourceSpan span;
};

/// `.sens`: derivatives of measurements to parameters.
struct SensitivityAnalysis {
  struct Parameter {
    std::string name;  ///< as written
    SourceSpan span;
    double value = 0.0;
    int number = -1;  ///< of a `.param`: its place in gradients; −1: it is not one
    model::NetworkMoves moves{};
    std::string failure{};  ///< why there are no derivatives to it; "" if there are
  };
  enum class Method { automatic, forward, adjoint };
  std::vector<Parameter> parameters;
  std::vector<std::string> measurements;  ///< names; empty: all
  Method method = Method::automatic;
  SourceSpan span;

  [[nodiscard]] bool wants(std::string_view measurement) const;
};

/// `.options nonunique=error|first|stay`
enum class NonUniqueChoice { error, first, stay };

/// One `.step`: the values that a parameter of the deck or of a model, a source without a waveform, a resistor, a capacitor or an inductor takes.
struct Sweep {
  std::string name;  ///< as written; for a model the result of stepped_model_name
  bool is_parameter = false;
  std::vector<double> values;
  SourceSpan span;

  [[nodiscard]] bool is_source() const;
};

/// `model(parameter)`: a parameter of the deck with a name that no expression can read.
[[nodiscard]] std::string stepped_model_name(std::string_view model, std::string_view parameter);

/// All of them; the first changes fastest.
struct Sweeps {
  std::vector<Sweep> list;

  [[nodiscard]] std::size_t runs() const;  ///< 0: nothing is stepped
  /// The values of run number `run`, in the order of the list.
  [[nodiscard]] std::vector<double> point(std::size_t run) const;
};

struct Analyses {
  std::optional<TransientAnalysis> transient;
  std::optional<SteadyStateAnalysis> steady_state;
  std::optional<SmallSignalAnalysis> small_signal;
  std::optional<SensitivityAnalysis> sensitivities;
  Sweeps sweeps;
  bool operating_point = false;  ///< `.op`
  NonUniqueChoice non_unique = NonUniqueChoice::error;
  std::optional<double> relative_tolerance;  ///< `.options reltol=`; the command line overrides it
  std::uint64_t row_limit = 1'000'000'000;   ///< `.options max_rows=`; a .tran with more rows has already been refused
};

}  // namespace pwlsim::circuit
