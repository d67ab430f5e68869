#pragma once
/// The measurements of .meas and .four, without syntax.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/source.hpp"
#include "circuit/functions.hpp"

namespace pwlsim::circuit {

/// What a step of a measured expression puts in place of its operands.
enum class StepKind {
  number,     ///< `number`
  signal,     ///< `index`: of FlatCircuit::probes
  result,     ///< `index`: of Measurements::list
  time,       ///< s
  negate,     ///< one operand
  invert,     ///< logical not; one operand
  operation,  ///< two operands; `operation` as the deck writes it
  function,   ///< `index` operands; `function`
  choose      ///< condition, value where it is not 0, and else
};

/// An expression of signals, time and results of measurements, in postfix order.
struct MeasuredExpression {
  struct Step {
    StepKind kind = StepKind::number;
    double number = 0.0;
    int index = 0;
    std::string operation{};
    const BuiltinFunction* function = nullptr;
    std::vector<double> gradient{};  ///< of a number: to the parameters of `.sens`; empty where it does not depend on them
  };
  std::vector<Step> steps;
  std::string text;  ///< as the deck spells it
  SourceSpan span;
};

enum class Edge { any, rise, fall };

/// The `count`-th time, or the last, at which left − right crosses zero in the sense of `edge`.
struct Crossing {
  MeasuredExpression left, right;
  Edge edge = Edge::any;
  std::uint64_t count = 1;
  bool last = false;
  std::optional<MeasuredExpression> delay;  ///< TD=: earlier crossings do not count
};

struct Measurement {
  enum class Kind {
    average,
    minimum,
    maximum,
    peak_to_peak,
    rms,
    integral,
    time_of_minimum,
    time_of_maximum,
    value,       ///< of the expression, `at` a time or `when` a crossing occurs
    derivative,  ///< likewise
    time,        ///< `when`
    period,      ///< of the steady state
    parameter    ///< of the expression, which reads no signal
  };
  Kind kind = Kind::average;
  std::string name;
  SourceSpan span;
  MeasuredExpression expression;
  std::optional<MeasuredExpression> from, to;  ///< by default Tstart and Tstop
  /// LAST=n PERIODS OF source: the window ends with the run; `from` and `to` are filled in when the source is known.
  struct LastPeriods {
    double count = 1.0;
    std::string source;
    SourceSpan span;
  };
  std::optional<LastPeriods> last_periods;
  std::optional<MeasuredExpression> at;
  std::optional<Crossing> when;
  bool shown = true;  ///< false: a part of another measurement
};

/// `.four`
struct FourierAnalysis {
  double frequency = 1.0;        ///< Hz
  std::uint64_t harmonics = 10;  ///< with the mean, which is number 0
  double periods = 1.0;          ///< the last ones; 0: as many as the run contains
  struct Signal {
    std::string column;
    int probe = 0;
  };
  std::vector<Signal> signals;
  SourceSpan span;
};

/// The quantity of a probe.
enum class Quantity { voltage, current, other };

struct Measurements {
  std::vector<Measurement> list;
  std::vector<FourierAnalysis> fourier;
  /// Of each probe: the signal of the network behind it; filled in by assemble.
  std::vector<int> probe_signals;
  std::vector<Quantity> probe_quantities;

  [[nodiscard]] bool empty() const { return list.empty() && fourier.empty(); }
};

/// Measurements whose results this one needs.
[[nodiscard]] std::vector<int> results_read(const Measurement& measurement);

}  // namespace pwlsim::circuit
