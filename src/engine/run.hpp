#pragma once
/// Request and answer of an engine; the same for every engine.

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace pwlsim::engine {

class Sampler;

/// Times of the output rows. time(k) for k < rows is exact from the deck's decimal text; the last row is at `stop`.
struct RowGrid {
  std::function<double(std::uint64_t)> time;
  std::uint64_t rows = 0;
};

/// Receives rows in order. The receiver formats and writes blocks; the engine's clock stops meanwhile.
class RowSink {
 public:
  virtual ~RowSink() = default;
  /// `count` rows, each `1 + saved signals` values: time, then the signals. Returns false to stop the run (closed pipe, full disk).
  virtual bool write(std::span<const double> values, std::size_t count) = 0;
};

/// An instant of an event in (0, stop], or within rounding of 0.
struct Event {
  double time = 0.0;  ///< s
  bool source_edge = false, mode_change = false, jump = false;
};

/// Receives events as they happen, besides the rows.
class EventWatcher {
 public:
  virtual ~EventWatcher() = default;
  /// Just after t = 0: the elements whose ports the engine runs, one per port, and which ports conduct (a switch: is closed).
  virtual void begin(std::span<const std::string> elements, std::span<const char> on) = 0;
  /// Which ports conduct after the event. Events come in the order of their times.
  virtual void happened(const Event& event, std::span<const char> on) = 0;
};

/// An interval of the run without an event, on which the probed signals are polynomials: to rounding (exact engine), or as its rows (sparse).
struct Piece {
  double from = 0.0, to = 0.0;       ///< the interval, s
  double begin = 0.0, length = 0.0;  ///< interval of its points, s: [begin, begin + length] contains [from, to] and may be longer
  std::span<const double> values;    ///< probe by probe, at the sixteen Gauss–Legendre points (linalg/legendre.hpp)
  /// The place of a time in the interval −1 … 1 of its points.
  [[nodiscard]] double place(double time) const { return 2.0 * (time - begin) / length - 1.0; }
  std::span<const double> noise{};  ///< of each probe: smaller values may be rounding; empty if the values themselves show it
};

/// Receives the pieces between events, in order and without gaps.
class PieceSink {
 public:
  virtual ~PieceSink() = default;
  /// The probes just before t = 0, where the run starts from an operating point.
  virtual void before_start(std::span<const double> values) = 0;
  virtual void take(const Piece& piece) = 0;
  /// ∫ dt of each probe over an instant, between the pieces before and after it; NaN if impulses of higher order acted. The sparse engine has none.
  virtual void impulse(double /*time*/, std::span<const double> /*values*/) {}
};

/// Signals that are followed between the rows. Nothing is computed for them outside of [from, to], or without a sink.
struct Probes {
  std::vector<int> signals;  ///< numbers of Network::signals
  double from = 0.0, to = 0.0;
  PieceSink* sink = nullptr;
};

enum class NonUnique { error, first, stay };

struct Request {
  double stop = 0.0;  ///< seconds
  RowGrid grid;
  bool events = false;                  ///< a row before and after every event
  bool jumps = false;                   ///< keep the jumps (Answer::jumps)
  bool use_initial_conditions = false;  ///< uic
  NonUnique non_unique = NonUnique::error;
  EventWatcher* watcher = nullptr;  ///< may be null
  std::size_t unsaved_signals = 0;  ///< this many last signals have no columns in rows: they are probes
  Probes probes;
  Sampler* sampler = nullptr;                   ///< sets held sources; may be null. The exact engine only
  std::function<void(double)> progress;         ///< called from time to time with the time reached; may be empty
  const std::atomic<int>* interrupt = nullptr;  ///< nonzero: stop at once
  /// For tests of the certificate: deliberate faults, in each part.
  struct Faults {
    std::uint64_t dropped_event = 0;      ///< this event of a port (from 1) is skipped, as if it had been missed
    std::uint64_t disturbed_segment = 0;  ///< this segment (from 1) begins with a state that is `disturbance` of itself too large
    double disturbance = 0.0;
  } faults;
};

enum class Outcome { completed, no_solution, not_unique, accumulation, interrupted, sink_stopped };

struct Certificate {
  double complementarity = 0.0;  ///< worst relative residual over the points checked
  double kcl_kvl = 0.0;
  double energy = 0.0;
  /// Of segments in Krylov spaces, where the run keeps its jumps: √energy of the difference of its states from those of the circuit, of the largest √energy, at most.
  std::optional<double> error_bound{};
  /// False: it has jumps, parts that are not passive, or sources that the vectors do not hold, whose errors are not in the bound.
  bool error_holds = true;
  bool has_passivity = false;  ///< whether `passive` is known
  bool passive = false;
  std::uint64_t points_checked = 0;
};

/// A remark of the run, already a stable id and a sentence ("N-left-out", "W-start-projected").
struct Remark {
  std::string id;
  std::string text;
  std::vector<std::string> signals{};  ///< only these signals are concerned; empty: the whole run
};

struct Statistics {
  std::uint64_t islands = 0, states = 0, ports = 0, switches = 0;
  std::uint64_t modes_visited = 0, events = 0, jumps = 0, lcp_pivots = 0, accumulations = 0;
  std::uint64_t klu_factorizations = 0, klu_solves = 0, steps = 0, rows = 0;
  double seconds_model = 0.0, seconds_simulate = 0.0, seconds_certificate = 0.0;
};

/// A jump of states in one part of the circuit at one instant.
struct Jump {
  struct PortImpulse {
    std::string element;
    std::string unit;  ///< "C": a charge through it; "Vs": a flux across it; "s": of a multiplier that has no unit
    double value = 0.0;
  };
  struct State {
    std::string name;  ///< "v(C1)" in V, "i(L1)" in A, "flux(L1)" in Vs; "x(s,1)" of a raw system, without unit
    double before = 0.0, after = 0.0;
  };
  double time = 0.0;                               ///< s
  std::vector<PortImpulse> impulses;               ///< of first order
  bool higher_order = false;                       ///< derivatives of impulses acted too
  std::vector<State> states;                       ///< those that changed
  double energy_before = 0.0, energy_after = 0.0;  ///< stored, J
};

struct Answer {
  Outcome outcome = Outcome::completed;
  std::string engine;   ///< that gave the answer, where it is another one than was asked
  double time = 0.0;    ///< reached, seconds
  double probed = 0.0;  ///< time up to which the probes were served: less if the run was interrupted
  std::string message;  ///< why it stopped, with time and element names; empty when completed
  std::string id;       ///< "E-no-solution", …
  std::vector<std::string> elements;
  std::string mode;  ///< of a run that stopped early: which ports conducted last, "D1 on, S1 off"; empty if none
  Statistics statistics;
  Certificate certificate;
  std::vector<Remark> remarks;
  std::vector<Jump> jumps;  ///< the first thousand, if requested
};

/// The DC operating point: the values of all signals, in the order of Network::signals. `answer` gives the reason if there is none.
struct OperatingPoint {
  Answer answer;
  std::vector<double> values;
};

}  // namespace pwlsim::engine
