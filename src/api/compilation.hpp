#pragma once
/// Compiles a circuit of the library for an engine.

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <pwlsim/circuit.hpp>

#include "analysis/idealisation.hpp"
#include "analysis/prepared_engine.hpp"
#include "circuit/compile.hpp"
#include "netlist/ast.hpp"

namespace pwlsim {

namespace api {
[[nodiscard]] analysis::EngineChoice choice_of(Engine engine);
}

/// A parameter, or an element outside of subcircuits, and its value in one run of a sweep.
using GivenValue = std::pair<std::string, double>;

/// Throws Error as soon as one of the steps reports an error.
class Compilation {
 public:
  struct Wanted {
    bool analysis_required = false;
    bool keeps_circuit = false;           ///< also keeps the elements with their values
    std::string cards{};                  ///< further lines, called `options` in messages
    std::vector<std::string> replaced{};  ///< cards of the deck with these names are ignored: ".tran"
  };
  Compilation(const Circuit& circuit, const Options& options, const Wanted& wanted);
  /// The deck that `read` has read, with other values. Threads may call this at the same time.
  Compilation(const Compilation& read, const Options& options, const std::vector<GivenValue>& given);

  [[nodiscard]] const circuit::Compiled& compiled() const { return *compiled_; }
  [[nodiscard]] const netlist::Deck& deck() const { return deck_; }
  [[nodiscard]] const SourceStore& sources() const { return sources_; }
  [[nodiscard]] bool has_controllers() const { return !held_.empty(); }
  [[nodiscard]] circuit::Compiled take() { return std::move(*compiled_); }
  [[nodiscard]] std::vector<Message> messages() const;
  [[nodiscard]] std::vector<analysis::Idealisation> departures() const { return analysis::departures(diagnostics_, sources_); }

  /// Finds the tangents of diodes too, which changes what is compiled.
  [[nodiscard]] analysis::PreparedEngine engine(const Options& options);

 private:
  void check() const;
  void compile(const Options& options, const Wanted& wanted);
  void read(const Circuit& circuit, const Options& options);
  void hold_outputs(const std::vector<Controller>& controllers);
  void check_outputs() const;
  void warn_of_idle_outputs();
  void check_tangents() const;
  bool saves_inputs(const std::vector<Controller>& controllers);
  void load(const std::string& path);
  void append(netlist::Deck deck);
  void append_lines(std::string_view name, std::string_view lines);
  void set_transient(const Options& options);
  void give_value(const std::string& element, const std::string& value);

  SourceStore sources_;
  Diagnostics diagnostics_, of_reading_;
  netlist::Deck deck_;
  std::vector<std::string> held_;  ///< sources that controllers set, in the order of their outputs
  std::optional<circuit::Compiled> compiled_;
};

}  // namespace pwlsim
