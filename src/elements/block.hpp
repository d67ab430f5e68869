#pragma once
/// Blocks of A elements: several inputs, one output.

#include <string>
#include <vector>

#include "elements/dynamics.hpp"
#include "elements/emission.hpp"
#include "elements/twin.hpp"

namespace pwlsim::elements {

/// Values of a model with their derivatives to the parameters of `.sens`.
class VariedValues {
 public:
  explicit VariedValues(const Model& model) : model_(model) {}

  [[nodiscard]] Varied get(std::string_view name) const;
  /// Of a list nobody follows them.
  [[nodiscard]] std::vector<Varied> list(std::string_view name) const;

 private:
  const Model& model_;
};

struct BlockKind {
  bool takes_vector = false;  ///< any number of inputs
  /// For a block without memory: its output as a formula of its inputs. Else null.
  AffineSum (*law)(FormulaBuilder& builder, const VariedValues& values, const std::vector<AffineSum>& inputs) = nullptr;
  /// For a block with states: adds them and returns its output.
  model::LinearForm (*dynamics)(Emission& emission, const model::LinearForm& input) = nullptr;
  /// The same for ngspice: returns its output as an expression.
  std::string (*smooth_dynamics)(Twin& twin, const std::string& input) = nullptr;
};

/// The integrals and fractions described by models of type int and s_xfer.
[[nodiscard]] Integral integral_of(const Values& values);
[[nodiscard]] RationalFunction rational_function_of(const Values& values);

[[nodiscard]] std::string smooth_integrator(Twin& twin, const std::string& input);
[[nodiscard]] std::string smooth_derivative(Twin& twin, const std::string& input);
[[nodiscard]] std::string smooth_transfer(Twin& twin, const std::string& input);

extern const ModelKind gain_model, summer_model, limit_model, hyst_model, pwl_model, relay_model, deadzone_model, friction_model;
extern const ModelKind integrator_model, transfer_model, derivative_model;

inline constexpr Parameter in_offset{"in_offset", "", 0.0, Range::any, false, "Added to the input."};
inline constexpr Parameter out_offset{"out_offset", "", 0.0, Range::any, false, "Added to the output."};
/// Parameters of other simulators for rounded corners; here corners are sharp.
inline constexpr Parameter limit_range{"limit_range", "", 1e-6, Range::any, false, "Width of rounded corners.", Use::ignored};
inline constexpr Parameter range_is_relative{"fraction", "", 0.0, Range::any, false, "Whether that width is relative.", Use::ignored};
inline constexpr Parameter input_domain{"input_domain", "", 0.01, Range::any, false, "Width of rounded corners.", Use::ignored};

}  // namespace pwlsim::elements
