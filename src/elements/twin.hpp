#pragma once
/// Writes the smoothed twin of an element: cards that stock ngspice reads, with numbers expanded and every ideal corner rounded.
///
/// `sharpness` X is the deviation from ideal: a contact without Ron has X ohm, one without Roff 1e5/X ohm, a step or a corner is X wide in the
/// unit of its argument, and a true jump of a source lasts 1e-3·√X of the shortest piece of its waveform. The error of contacts and corners is of first order in X.
/// A current that is read flows through a meter: a source of 0 V in series with the element.

#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "base/diagnostic.hpp"
#include "elements/kind.hpp"

namespace pwlsim::elements {

struct TwinSettings {
  double sharpness = 1e-3;
  double stop = 0.0;                    ///< s; the end of written-out repeated waveforms. 0 without a run
  bool use_initial_conditions = false;  ///< uic: a source that jumps at t = 0 starts after its jump
};

/// Names that ngspice accepts, for each node of a circuit and each element.
class TwinNames {
 public:
  TwinNames(const std::vector<std::string>& nodes, const std::vector<Instance>& instances);

  [[nodiscard]] const std::string& node(model::NodeIndex index) const;
  /// A node inside an element.
  [[nodiscard]] std::string inner(std::size_t instance, std::string_view part) const;
  /// The device of kind `letter` that represents the element or a part of it.
  [[nodiscard]] std::string device(char letter, std::size_t instance, std::string_view part = {}) const;

 private:
  std::vector<std::string> nodes_, instances_;
  std::unordered_set<std::string> taken_;
};

/// Two ends of a part, by name.
struct TwinEnds {
  std::string p, n;
};

struct TwinDiode {
  double on = 0.0, off = infinite, drop = 0.0;
  double reverse_on = 0.0, reverse_drop = infinite;
};

class Twin {
 public:
  /// `observed`: one entry per instance, whether its current is read from outside. All lists outlive the Twin.
  Twin(const std::vector<Instance>& instances, const std::vector<Model>& models, const TwinNames& names, std::vector<char> observed,
       const TwinSettings& settings, Diagnostics& diagnostics);

  /// Writes the element's meter, if it has one; the following cards belong to the element.
  void select(std::size_t index);
  /// Selects without writing.
  void look_at(std::size_t index) { index_ = index; }

  [[nodiscard]] const Instance& instance() const { return instances_[index_]; }
  [[nodiscard]] const Model& model() const { return models_[static_cast<std::size_t>(instance().model)]; }
  [[nodiscard]] double value(std::string_view parameter) const { return instance().values.get(parameter); }
  [[nodiscard]] bool has(std::string_view parameter) const { return instance().values.has(parameter); }
  [[nodiscard]] const TwinSettings& settings() const { return settings_; }
  [[nodiscard]] double sharpness() const { return settings_.sharpness; }

  /// The nodes of the element: its terminals, or those after its meter.
  [[nodiscard]] TwinEnds ends() const;
  [[nodiscard]] const std::string& node(model::NodeIndex index) const { return names_.node(index); }
  [[nodiscard]] std::string inner(std::string_view part) const { return names_.inner(index_, part); }
  [[nodiscard]] std::string device(char letter, std::string_view part = {}) const { return names_.device(letter, index_, part); }
  [[nodiscard]] std::string device_of(char letter, const Reference& reference) const {
    return names_.device(letter, static_cast<std::size_t>(reference.index));
  }
  /// `.ic I(L)=` for this element.
  [[nodiscard]] std::optional<double> initial_current() const;
  void set_initial_current(std::size_t instance, double current) { initial_currents_[instance] = current; }
  /// The V device whose current is that of an element.
  [[nodiscard]] std::string meter_of(std::size_t instance) const;
  [[nodiscard]] std::string meter_of(const Reference& reference) const { return meter_of(static_cast<std::size_t>(reference.index)); }
  /// Whether a single V card determines the node's potential.
  [[nodiscard]] bool is_held(const NodePair& pair) const;

  void line(std::string text) { lines_.push_back(std::move(text)); }
  void resistor(std::string_view part, const TwinEnds& ends, double resistance);
  void capacitor(std::string_view part, const TwinEnds& ends, double capacitance, const double* initial = nullptr);
  void inductor(std::string_view part, const TwinEnds& ends, double inductance, const double* initial = nullptr);
  /// 0 V between the ends.
  void short_circuit(std::string_view part, const TwinEnds& ends);
  void behaviour(std::string_view part, const TwinEnds& ends, bool is_current, std::string_view expression);
  /// A V or I card that follows `function`, or an equivalent if SPICE has no such card.
  void source(std::string_view part, const TwinEnds& ends, bool is_current, const model::SourceFunction& function);
  /// From p to n; `sharpness` replaces a resistance of 0 or infinity.
  void diode(std::string_view part, const TwinEnds& ends, const TwinDiode& diode);
  struct Contact {
    double on_resistance = 0.0, off_resistance = infinite;
    double on_level = 0.0, off_level = 0.0;
    bool starts_on = false;
  };
  void contact(std::string_view part, const TwinEnds& ends, const TwinEnds& control, const Contact& contact);
  /// `.ic` of an inner node.
  void start_voltage(const std::string& node, double voltage);

  /// max(x, 0) and a step from 0 to 1 at x = 0, each at an inner node of its own.
  [[nodiscard]] std::string positive(std::string_view part, std::string_view x);
  [[nodiscard]] std::string step(std::string_view part, std::string_view x);

  /// Reports an element without an equivalent in ngspice.
  void refuse(std::string_view what, SourceSpan span = {});

  [[nodiscard]] std::vector<std::string> take_lines() { return std::move(lines_); }

 private:
  [[nodiscard]] bool has_meter(std::size_t instance) const;

  const std::vector<Instance>& instances_;
  const std::vector<Model>& models_;
  const TwinNames& names_;
  std::vector<char> observed_;
  std::unordered_map<std::size_t, double> initial_currents_;
  std::unordered_set<model::NodeIndex> held_;
  TwinSettings settings_;
  Diagnostics& diagnostics_;
  std::vector<std::string> lines_;
  std::size_t index_ = 0;
};

/// "v(a,b)", "v(a)", "-v(b)"; "0" for ground against itself.
[[nodiscard]] std::string voltage_text(const TwinEnds& ends);
/// "i(V1)"
[[nodiscard]] std::string current_text(std::string_view meter);
/// "+2*(x)", or "" for a coefficient of zero.
[[nodiscard]] std::string term_text(double coefficient, std::string_view x);

/// Where the twin of a diode or a switch changes sides: on after v(control) has risen above on_level until it falls below off_level.
struct TwinEvent {
  TwinEnds control;
  double on_level = 0.0, off_level = 0.0;
};

/// Twins of more than one kind.
[[nodiscard]] TwinEnds twin_of_series_parts(Twin& twin);
void twin_of_parallel_parts(Twin& twin);
/// `control` as an expression.
void twin_of_switch(Twin& twin, const std::string& control);
[[nodiscard]] std::optional<TwinEvent> event_of_switch(const Twin& twin);
/// The amplification of a switch's control.
[[nodiscard]] double twin_control_gain(const Twin& twin);
void twin_of_controlled(Twin& twin, bool is_current);
void twin_of_formula(Twin& twin, bool is_current);
void twin_of_block(Twin& twin);

/// The value of a formula as an expression, its parts written before it; one text for each voltage or current it reads.
[[nodiscard]] std::string formula_text(Twin& twin, const Formula& formula, const std::vector<std::string>& voltages,
                                       const std::vector<std::string>& currents);

}  // namespace pwlsim::elements
