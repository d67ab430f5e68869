#pragma once
/// Circuits: built in code, read from a deck, or both.

#include <atomic>
#include <cstddef>
#include <functional>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <pwlsim/controller.hpp>
#include <pwlsim/error.hpp>
#include <pwlsim/gradient.hpp>
#include <pwlsim/result.hpp>
#include <pwlsim/steady_state.hpp>
#include <pwlsim/value.hpp>

namespace pwlsim {

/// automatic: exact, unless a part of the circuit is too large for it (docs/reference/engines.md).
enum class Engine { automatic, exact, sparse };

struct Options {
  double stop = 0.0;                    ///< s; 0: use the deck's `.tran` and ignore the next three
  double step = 0.0;                    ///< s between rows; 0: a thousandth of the run. Not an integration step
  double start = 0.0;                   ///< s, of the first row; the run still begins at 0
  bool use_initial_conditions = false;  ///< start from `ic=` and `.ic`, zero elsewhere, instead of the operating point (uic)

  Engine engine = Engine::automatic;
  std::optional<double> reltol =
      {};  ///< for the sparse engine: bound on the local error of a step relative to each state's running maximum; default 1e-4
  bool rows_at_events = false;  ///< adds rows before and after every event
  bool events = true;           ///< keep a list of all events
  bool evaluable = true;        ///< the result keeps the model, for Result::at and Result::report
  std::size_t run = 0;          ///< number of the run of the deck's `.step`, from 0

  /// Called with the time (s) and the values of each row, in the order of the signals, in the thread of the run; the result then keeps no rows.
  /// For runs whose rows do not fit in memory. It must not throw.
  std::function<void(double time, const std::vector<double>& values)> row = {};
  /// Called from time to time with the time reached, s, in the thread of the run. It must not throw.
  std::function<void(double)> progress = {};
  /// Any thread may set it to a nonzero number, which ends the run soon.
  const std::atomic<int>* interrupt = nullptr;
};

/// Each function adds a card of the deck language (docs/reference/netlist.md) and returns the circuit. Nodes are names; "0" and "gnd" are ground.
/// The name of an element begins with the letter of its kind, given with each function. Names are not case-sensitive.
/// Throws Error (E-name) for a name that is not valid on a card. run checks everything else: unknown models, floating parts, values out of range.
///
/// Circuits share nothing: each thread may use its own, and several threads may run one circuit as long as nothing changes it.
class Circuit {
 public:
  explicit Circuit(std::string title = "circuit");
  /// The deck in a file; cards added in code count as written at its end. run reads the file.
  [[nodiscard]] static Circuit from_file(std::string path);
  /// A deck; the first line is the title. Included files are looked up from the current directory.
  [[nodiscard]] static Circuit from_text(std::string deck);

  /// R…, in ohm.
  Circuit& resistor(std::string_view name, std::string_view p, std::string_view n, const Value& resistance, const Parameters& more = {});
  /// C…, in farad; {"ic", v} among `more` is its initial voltage.
  Circuit& capacitor(std::string_view name, std::string_view p, std::string_view n, const Value& capacitance, const Parameters& more = {});
  /// L…, in henry; {"ic", i} among `more` is its initial current.
  Circuit& inductor(std::string_view name, std::string_view p, std::string_view n, const Value& inductance, const Parameters& more = {});
  /// K…: couples inductors by −1 ≤ coefficient ≤ 1; 1 is exact.
  Circuit& coupling(std::string_view name, const std::vector<std::string>& inductors, const Value& coefficient);
  /// V…
  Circuit& voltage_source(std::string_view name, std::string_view p, std::string_view n, const Waveform& voltage,
                          const Parameters& more = {});
  /// I…: the current flows from p through the source to n.
  Circuit& current_source(std::string_view name, std::string_view p, std::string_view n, const Waveform& current,
                          const Parameters& more = {});
  /// D…: ideal, or by a model of type D.
  Circuit& diode(std::string_view name, std::string_view anode, std::string_view cathode, std::string_view model = {},
                 const Parameters& more = {});
  /// S…: closed while v(cp,cn) is above the threshold of a model of type SW. `on`: the state at the start if that is within the hysteresis.
  Circuit& voltage_switch(std::string_view name, std::string_view p, std::string_view n, std::string_view cp, std::string_view cn,
                          std::string_view model, bool on = false);
  /// W…: closed while the current of an element is above the threshold of a model of type CSW.
  Circuit& current_switch(std::string_view name, std::string_view p, std::string_view n, std::string_view element, std::string_view model,
                          bool on = false);
  /// E…: v(p,n) = gain·v(cp,cn).
  Circuit& voltage_controlled_voltage(std::string_view name, std::string_view p, std::string_view n, std::string_view cp,
                                      std::string_view cn, const Value& gain);
  /// G…: a current of gain·v(cp,cn) from p through it to n.
  Circuit& voltage_controlled_current(std::string_view name, std::string_view p, std::string_view n, std::string_view cp,
                                      std::string_view cn, const Value& gain);
  /// H…: v(p,n) = gain·i(element).
  Circuit& current_controlled_voltage(std::string_view name, std::string_view p, std::string_view n, std::string_view element,
                                      const Value& gain);
  /// F…: a current of gain·i(element) from p through it to n.
  Circuit& current_controlled_current(std::string_view name, std::string_view p, std::string_view n, std::string_view element,
                                      const Value& gain);
  /// B…: v(p,n) = a piecewise-linear expression of voltages, currents and time: "max(v(a),2*i(R1))".
  Circuit& expression_voltage(std::string_view name, std::string_view p, std::string_view n, std::string_view expression);
  /// B…: a current of such an expression from p through it to n.
  Circuit& expression_current(std::string_view name, std::string_view p, std::string_view n, std::string_view expression);
  /// X…: a subcircuit of the deck, or of the library that is part of the program (docs/reference/library.md).
  Circuit& subcircuit(std::string_view name, const std::vector<std::string>& nodes, std::string_view definition,
                      const Parameters& more = {});

  /// `.model`: model("fast", "D", {{"Ron", 0.01}, {"Vfwd", 0.7}}).
  Circuit& model(std::string_view name, std::string_view type, const Parameters& parameters = {});
  /// `.param`: the last one of a name is used; it overrides those of the deck.
  Circuit& parameter(std::string_view name, const Value& value);
  /// `.options`.
  Circuit& option(std::string_view name, const Value& value);
  /// `.ic` of a node, V: forced in the operating point; the initial value with use_initial_conditions.
  Circuit& initial_voltage(std::string_view node, const Value& voltage);
  /// `.ic` of an inductor, A.
  Circuit& initial_current(std::string_view inductor, const Value& current);
  /// `.save`: signals "v(n)", "v(a,b)", "i(X)". Without any: all node voltages, and the currents of L, V, E, H, D, S.
  Circuit& save(const std::vector<std::string>& signals);
  /// `.meas tran name …`: measure("mean", "AVG v(out) FROM=1m") (docs/reference/measurements.md).
  Circuit& measure(std::string_view name, std::string_view what);
  /// Any lines of the deck language: subcircuits, blocks A, `.func`, …
  Circuit& cards(std::string_view lines);

  /// A sampled controller (controller.hpp). Throws Error (E-controller) if it has no function, no output, no positive `every`, a negative delay, or
  /// different numbers of initial values and outputs. run checks its inputs and outputs.
  Circuit& controller(Controller controller);

  /// Sets the value of an element of the deck or of the code, outside of subcircuits: of R, C, L (ohm, farad, henry), of V and I (a number or a waveform;
  /// AC stays), the gain of E, F, G, H, the coefficient of K. run throws E-unknown-element or E-no-value if there is none.
  Circuit& set_value(std::string_view element, const Waveform& value);
  /// That value, with parameters evaluated; also of elements in subcircuits ("X1:R1"). Throws as run does, and E-unknown-element, E-no-value (a waveform).
  [[nodiscard]] double value(std::string_view element) const;
  /// Names of all elements, those of subcircuits as "X1:R1". Throws as run does.
  [[nodiscard]] std::vector<std::string> elements() const;

  /// Runs the circuit. Throws Error if the circuit has mistakes, with all of them; RunError if the run failed.
  /// An interrupted run is returned; its result is not completed.
  [[nodiscard]] Result run(const Options& options = {}) const;
  /// Names and values (V, A) of the saved signals at the DC operating point. Throws as run does.
  [[nodiscard]] std::vector<std::pair<std::string, double>> operating_point(const Options& options = {}) const;
  /// The periodic steady state, by the deck's `.pss` or by `what` (docs/reference/steady-state.md). `stop`, `step` and `start` of `options` are not used.
  /// Throws as run does; RunError (E-pss-…) if no orbit was found.
  [[nodiscard]] SteadyState steady_state(const SteadyStateOptions& what = {}, const Options& options = {}) const;
  /// Small signals at these frequencies, Hz: around the steady state, or of a linear circuit. Throws as steady_state does.
  [[nodiscard]] Response small_signals(const std::vector<double>& frequencies, const SmallSignalOptions& what = {},
                                       const SteadyStateOptions& around = {}, const Options& options = {}) const;
  /// A measurement of `.meas tran` or `.meas pss` and its exact derivatives to parameters, as by `.sens` (docs/reference/steady-state.md): "R" of a `.param`,
  /// "R1", "X1:L1", "S1:Vt", "Vg:Ton", "ic(C1)". A measurement of `.meas pss` needs a card `.pss`. All parameters together cost little more than one.
  /// Throws as run and steady_state do; Error: E-sens-no-measurement, E-sens-unknown-parameter. If a single derivative does not exist, its `failure` gives
  /// the reason.
  [[nodiscard]] Gradient gradient(std::string_view measurement, const std::vector<std::string>& parameters,
                                  const Options& options = {}) const;
  /// The same for several measurements of one run; for all if `measurements` is empty.
  [[nodiscard]] std::vector<Gradient> gradients(const std::vector<std::string>& measurements, const std::vector<std::string>& parameters,
                                                const Options& options = {}) const;
  /// Number of runs of the deck's `.step`; 1 without `.step`. Throws as run does.
  [[nodiscard]] std::size_t runs() const;
  /// The cards added in code, below the title. Messages name this text `code`.
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  Circuit& add(char letter, std::string_view name, std::initializer_list<std::string_view> nodes, std::string_view rest,
               const Parameters& more = {});

  friend class Compilation;
  enum class Base { none, file, text };
  Base base_ = Base::none;
  std::string base_text_;                                    // path or deck
  std::string text_;                                         // title, then cards
  std::vector<std::pair<std::string, std::string>> values_;  // of set_value
  std::vector<Controller> controllers_;
  bool has_ideal_diode_ = false;
};

}  // namespace pwlsim
