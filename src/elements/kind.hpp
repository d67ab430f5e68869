#pragma once
/// Element and model kinds as data. An element is a file in elements/kinds that fills one Kind: its letter, the shape of its card,
/// its parameters, and what it emits. Binding, reference tables and messages all read the same Kind.

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostic.hpp"
#include "base/source.hpp"
#include "elements/formula.hpp"
#include "elements/parameter.hpp"
#include "model/network.hpp"

namespace pwlsim::elements {

class Emission;
class Twin;
struct TwinEvent;
struct BlockKind;
struct Instance;
struct RawSystem;
struct Model;

/// Deck-wide numbers that elements depend on.
struct Settings {
  double tangent_current = 1.0;  ///< `.options i0=`, A: where exponential characteristics are replaced by their tangent
  bool finds_currents = true;    ///< `.options i0=` is not given: preliminary runs find each diode's current
  double gate_drive = 10.0;      ///< `.options vdrive=`, V: gate voltage at which the resistance of a channel is taken
  bool finds_drives = true;      ///< neither `.options vdrive=` nor `i0=` is given: preliminary runs find the gate voltage of each MOSFET
  bool written_by_ltspice = false;  ///< the deck has cards that LTspice adds by itself
  bool keeps_gates = false;         ///< `.options gatecap`: resistances and capacitances of gates stay, the latter linear
};

/// A `.model` type: "D", "SW", …
struct ModelKind {
  std::string_view type;  ///< as written after the model's name
  std::string_view text;  ///< what it is, for messages and tables
  ParameterTable parameters;
  /// Converts the written values to those that emit reads, and reports changes. May be null.
  void (*complete)(Model& model, const Settings& settings, Diagnostics& diagnostics) = nullptr;
  const BlockKind* block = nullptr;  ///< of an A element: the block between input and output
  bool is_idealised = false;         ///< its elements become something else: it is not read if nothing uses it
  std::span<const double> levels{};  ///< values of its parameter `level` that can be idealised; all if empty
  bool has_optional_nodes = true;    ///< else nodes after those that its element needs are not part of the circuit
};

/// Resistance and capacitances of a gate: ohm, F.
struct GateParts {
  double resistance = 0.0, to_source = 0.0, to_drain = 0.0;
};

struct Model {
  const ModelKind* kind = nullptr;
  std::string name;
  SourceSpan span;  ///< of the name, in its .model card
  Values values;
  std::vector<Written> written{};              ///< of its values, those that depend on varied parameters
  std::optional<model::ExponentialLaw> law{};  ///< of a diode whose tangent is at a current to be found
  std::optional<GateParts> gate{};             ///< of a transistor, with `.options gatecap`; of planar ones a metre of width
  bool finds_drive = false;                    ///< of a MOSFET: preliminary runs find the gate voltage at which its resistance is taken
};

/// The control of a card, between the terminals and the tail.
enum class ControlSyntax {
  none,
  node_pair,    ///< nc+ nc-; with Tail::gain also POLY(n) and n pairs
  element,      ///< the name of an element whose current controls; with Tail::gain also POLY(n) and n names
  element_list  ///< two or more names (K)
};

/// The tail of a card, after terminals and control.
enum class Tail {
  value,     ///< the first parameter of the table, with or without its name; then `name=value`
  gain,      ///< one gain, or the coefficients of POLY, or a formula behind value= or TABLE
  formula,   ///< V={…} or I={…}; then `name=value`
  block,     ///< no nodes before it: an input, or [inputs], an output, and the name of a model
  waveform,  ///< [DC] value, AC, SIN(…) and the like; then `name=value`
  model      ///< the name of a model, [area], on/off; then `name=value`
};

struct Kind {
  std::string_view name;   ///< "resistor"
  char letter = '?';       ///< first letter of its cards, upper case
  std::string_view usage;  ///< the card in one line
  std::string_view text;   ///< one sentence for the tables
  int terminals = 2;
  int optional_terminals = 0;             ///< that may follow before the model
  std::span<const int> tied_terminals{};  ///< of more than two terminals, those that tie potentials to one another
  ControlSyntax control = ControlSyntax::none;
  Tail tail = Tail::value;
  ParameterTable parameters;
  std::span<const ModelKind* const> models;  ///< the types Tail::model takes
  bool takes_flag = false;                   ///< on / off behind the model
  bool has_current = true;                   ///< i(X) may be saved
  bool controls_others = true;               ///< i(X) may control F, H and W: it is known when X has been emitted
  /// Whether this instance ties the potentials of its two terminals. Null: always.
  bool (*joins_terminals)(const Instance&) = nullptr;
  bool saved_by_default = false;  ///< i(X) is among the columns of a deck without .save
  void (*emit)(Emission&) = nullptr;
  /// Second pass, after every element has been emitted: forms that read the current of another. May be null.
  void (*connect)(Emission&) = nullptr;
  /// Writes its cards for ngspice, with rounded corners.
  void (*smooth_twin)(Twin&) = nullptr;
  /// Where these cards change sides. Null: they do not.
  std::optional<TwinEvent> (*twin_event)(const Twin&) = nullptr;
};

struct NodePair {
  model::NodeIndex p = model::ground, n = model::ground;
};

/// Another element, by its full name ("X1.V2"); `index` counts within the circuit once resolved.
struct Reference {
  std::string name;
  SourceSpan span;
  int index = -1;
};

/// An input of an A element: a voltage, the current through its own short circuit, or that of another element.
struct BlockInput {
  bool is_current = false;
  NodePair nodes;
  int reference = -1;  ///< within Instance::references
};

/// One element of a flat circuit.
struct Instance {
  const Kind* kind = nullptr;
  std::string name;  ///< full: "X1.D3"
  SourceSpan span;   ///< of the name on its card
  std::vector<model::NodeIndex> nodes;
  std::vector<NodePair> control_nodes;
  std::vector<Reference> references;
  Values values, waveform_values;
  std::vector<Written> written{};    ///< numbers of the card that depend on varied parameters
  std::vector<double> coefficients;  ///< Tail::gain: the constant part, then one number a control
  std::optional<Formula> formula;
  bool formula_is_current = false;  ///< also of the output of an A element
  std::vector<BlockInput> inputs;
  std::shared_ptr<const RawSystem> raw_system;
  std::optional<model::SourceFunction> waveform;
  std::vector<std::optional<model::SourceFunction>> waveform_moves{};  ///< of PWL: its derivative to each parameter of .sens that moves it
  std::complex<double> alternating = 0.0;                              ///< of a source: `AC`
  bool is_load = false;                                                ///< of a current source that is never negative: no current at v < 0
  double series_resistance = 0.0;                                      ///< ohm: of a voltage by formula, where it needs one
  int model = -1;                                                      ///< index within the circuit's models
  std::optional<bool> flag;                                            ///< on / off as written
  bool drive_is_apart =
      false;  ///< of a MOSFET or JFET: its gate is driven against a node other than its source, so that its current changes v(gate, source)
};

}  // namespace pwlsim::elements
