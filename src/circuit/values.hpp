#pragma once
/// `name=value` items read into the Values of an element, model or waveform.

#include <string_view>

#include "circuit/scope.hpp"
#include "elements/parameter.hpp"

namespace pwlsim::circuit {

/// Reads numbers and `name=value` items in one scope, and checks them against a parameter table.
class ValueReader {
 public:
  /// `owner` names what the values belong to in messages: "R1", "model DX".
  ValueReader(Scope& scope, Reporter& reporter, std::string_view owner) : scope_(scope), reporter_(reporter), owner_(owner) {}

  /// One `name=value`. Unknown names, values out of range and names given twice are errors; an ignored name gives a warning, once for each
  /// name in a deck, or is collected in `ignored` if that is given.
  void assignment(const netlist::Item& item, elements::Values& values, std::vector<std::string>* ignored = nullptr);
  /// From now on names that resemble none of the table are ignored, too: models of libraries have parameters that nothing reads (`MTBF=`, `ppPkg=`).
  void ignore_unknown() { ignores_unknown_ = true; }
  /// A value by position.
  void positional(const netlist::Item& item, const elements::Parameter& parameter, elements::Values& values);

 private:
  void report_unknown(const netlist::Item& item, elements::ParameterTable table, std::vector<std::string>* ignored);
  void refuse(const netlist::Item& item, const elements::Parameter& parameter);
  void store_list(const netlist::Item& values, const elements::Parameter& parameter, elements::Values& result);
  [[nodiscard]] std::optional<double> checked(const netlist::Item& value, const elements::Parameter& parameter);
  /// "1F" as a capacitance is a femtofarad.
  void warn_of_femto(const netlist::Item& value, const elements::Parameter& parameter);
  void store(const netlist::Item& value, const elements::Parameter& parameter, elements::Values& values);

  Scope& scope_;
  Reporter& reporter_;
  std::string_view owner_;
  bool ignores_unknown_ = false;
};

}  // namespace pwlsim::circuit
