#pragma once
/// From a syntax tree to the network of the model, in one call: flatten, then assemble.

#include <optional>
#include <string>
#include <vector>

#include "base/diagnostic.hpp"
#include "base/source.hpp"
#include "circuit/analyses.hpp"
#include "circuit/circuit.hpp"
#include "model/network.hpp"
#include "netlist/ast.hpp"

namespace pwlsim::circuit {

struct CompileOptions {
  bool analysis_required = true;    ///< a deck without .tran and .op is an error (except for `inspect`)
  bool measure = false;             ///< compile .meas and .four; else only check them
  std::size_t run = 0;              ///< number of the run of .step
  bool keep_circuit = false;        ///< for users of elements instead of the network
  DrawnNames drawn{};               ///< for a picture; ignored for several runs
  std::vector<std::string> held{};  ///< sources of a constant value that the run sets (model::Held); their channels are their places here
};

/// An element whose model at hand has a rated average current.
struct RatedCurrent {
  std::string element;
  double amperes = 0.0;  ///< of all its devices
};

/// `network.signals` are the columns of the output after `time`, in order; the last `measured_signals` are drawn or measured only.
struct Compiled {
  std::string title;
  model::Network network;
  Analyses analyses;
  std::optional<FlatCircuit> circuit;                 ///< if requested
  Measurements measurements{}, orbit_measurements{};  ///< of .tran, of .pss
  std::size_t measured_signals = 0;
  std::size_t drawn_signals = 0;  ///< the first ones of these, for pictures
  bool draws_random = false;      ///< values differ from run to run of .step
  bool names_signals = false;     ///< the deck names the signals to save
  bool has_mosfets = false;
  bool has_machines = false;  ///< state machines, which may hold a value by reading it: here it is not determined then
  HiddenParts hidden{};
  std::vector<std::string> rated_ports{};  ///< diodes of the network that are the breakdown of a part of the models at hand
  std::vector<RatedCurrent> rated_currents{};

  [[nodiscard]] std::size_t saved_signals() const { return network.signals.size() - measured_signals; }
  /// The number of saved and drawn signals.
  [[nodiscard]] std::size_t recorded_signals() const { return saved_signals() + drawn_signals; }
};

/// Subcircuits shipped with the program that the deck calls are added to `sources`, for messages to quote.
/// All semantic errors go to `diagnostics`. The result is empty exactly if `diagnostics` has an error on return;
/// syntax errors already in it count, too, so that a deck with a syntax error also gets its other errors.
[[nodiscard]] std::optional<Compiled> compile(const netlist::Deck& deck, SourceStore& sources, Diagnostics& diagnostics,
                                              const CompileOptions& options = {});

}  // namespace pwlsim::circuit
