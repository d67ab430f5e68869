#pragma once
/// The result of a run.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <pwlsim/error.hpp>

namespace pwlsim {

/// The changes at one instant in (0, stop].
struct Event {
  double time = 0.0;                               ///< s
  bool source_edge = false;                        ///< a source jumps or has a corner
  bool mode_change = false;                        ///< diodes or switches change state
  bool jump = false;                               ///< states jump
  std::vector<std::string> turned_on, turned_off;  ///< diodes and switches: "D1", "X1.S1"; "D1 (2)" is the second port of D1
};

/// A measurement of a `.meas` card.
struct Measurement {
  std::string name;
  double value = 0.0;      ///< valid if there is no failure
  std::string unit;        ///< "V", "W", "s", …; "" if it has none or it is not known
  std::string failure;     ///< why there is no value; "" if there is one
  std::string left_out{};  ///< impulses that the value excludes, and why; "" if none
};

/// A `.four` card's Fourier analysis of one signal: y = Σ magnitude_k·sin(2π·frequency_k·t + phase_k), number 0 the mean.
struct Fourier {
  struct Harmonic {
    double frequency = 0.0, magnitude = 0.0, phase = 0.0;  ///< Hz, the signal's unit, degrees
  };
  std::string signal;
  std::string failure;  ///< "" if there are harmonics
  std::vector<Harmonic> harmonics;
  double distortion = 0.0;  ///< of all harmonics, relative to the first: 0.1 is ten percent; infinite if there are impulses
};

/// How well the run satisfies the circuit's laws: the largest relative residuals over all points checked. Values near 1e-15 are rounding.
struct Certificate {
  double complementarity = 0.0;  ///< no diode conducts with a voltage, none blocks with a current, no sign is wrong
  double kcl_kvl = 0.0;          ///< Kirchhoff's laws
  double energy = 0.0;           ///< energy delivered minus dissipated minus stored
  std::optional<bool> passive;   ///< the circuit without its sources cannot deliver energy; empty if not known
};

/// Counts of a run.
struct Statistics {
  std::string engine;  ///< "exact" or "sparse"
  std::uint64_t states = 0, ports = 0, switches = 0;
  std::uint64_t modes_visited = 0, events = 0, jumps = 0;
  double seconds = 0.0;  ///< s, for all work from the model to the values of the rows
};

/// A finished run. Cheap to copy and immutable: threads may share one.
class Result {
 public:
  /// Whether the run reached its end; false if it was interrupted, and in RunError.
  [[nodiscard]] bool completed() const;
  /// The time reached, s.
  [[nodiscard]] double end() const;

  /// The times of the rows, s, not decreasing; two equal times are the two sides of a jump (Options::rows_at_events).
  [[nodiscard]] const std::vector<double>& time() const;
  /// Names of the signals as saved: "v(out)", "v(a,b)", "i(L1)". i(X) flows into the first node of X.
  [[nodiscard]] const std::vector<std::string>& signals() const;
  /// The values of one signal, V or A, as many as there are times. Names are not case-sensitive. Throws Error (E-unknown-signal).
  [[nodiscard]] const std::vector<double>& signal(std::string_view name) const;
  [[nodiscard]] bool has_signal(std::string_view name) const;
  /// The values of one signal at any times in [0, end()], s, in any order, from the closed form between events; at a jump, the value after it. Each call
  /// repeats the run with the model that the result kept: ask for many times at once. Throws Error: E-unknown-signal, E-range, E-not-kept
  /// (Options::evaluable = false).
  [[nodiscard]] std::vector<double> at(std::string_view name, const std::vector<double>& times) const;
  /// The run as one web page that needs no network, as `--report` writes it. Throws Error: E-not-kept.
  [[nodiscard]] std::string report() const;

  /// All events, in order; none with Options::events = false.
  [[nodiscard]] const std::vector<Event>& events() const;
  /// Diodes and switches that conduct right after t = 0; none with Options::events = false.
  [[nodiscard]] const std::vector<std::string>& on_at_start() const;

  /// In the order of the cards.
  [[nodiscard]] const std::vector<Measurement>& measurements() const;
  /// The value of one measurement. Throws Error: E-unknown-signal if no measurement has that name, W-measurement-failed if it has no value.
  [[nodiscard]] double measurement(std::string_view name) const;
  [[nodiscard]] const std::vector<Fourier>& fourier() const;

  [[nodiscard]] const Certificate& certificate() const;
  [[nodiscard]] const Statistics& statistics() const;
  /// Warnings and notes; in RunError also the error that ended the run.
  [[nodiscard]] const std::vector<Message>& messages() const;
  /// Names and values of the parameters that `.step` varies, in this run.
  [[nodiscard]] const std::vector<std::pair<std::string, double>>& stepped() const;

  struct Data;
  explicit Result(std::shared_ptr<const Data> data) : data_(std::move(data)) {}

 private:
  std::shared_ptr<const Data> data_;
};

/// The run reached a time from which it could not continue: no solution (E-no-solution), more than one (E-not-unique), an accumulation of events,
/// a value out of range.
class RunError : public Error {
 public:
  explicit RunError(Result result) : Error(result.messages()), result_(std::move(result)) {}
  /// The rows up to then.
  [[nodiscard]] const Result& result() const noexcept { return result_; }

 private:
  Result result_;
};

}  // namespace pwlsim
