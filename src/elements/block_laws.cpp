/// Blocks without memory.
#include <fmt/format.h>

#include "elements/block.hpp"

namespace pwlsim::elements {
namespace {

using Inputs = std::vector<AffineSum>;

/// A list has one member for each input, or one for all.
Varied member(const std::vector<Varied>& list, std::size_t k) { return list.size() == 1 ? list[0] : list[k]; }

AffineSum gain_law(FormulaBuilder&, const VariedValues& v, const Inputs& in) {
  return v.get("gain") * (in[0] + constant_sum(v.get("in_offset"))) + constant_sum(v.get("out_offset"));
}

AffineSum summer_law(FormulaBuilder&, const VariedValues& v, const Inputs& in) {
  const std::vector<Varied> offsets = v.list("in_offset"), gains = v.list("in_gain");
  AffineSum sum;
  for (std::size_t k = 0; k < in.size(); ++k) sum = sum + member(gains, k) * (in[k] + constant_sum(member(offsets, k)));
  return v.get("out_gain") * sum + constant_sum(v.get("out_offset"));
}

AffineSum limit_law(FormulaBuilder& builder, const VariedValues& v, const Inputs& in) {
  const AffineSum free = v.get("gain") * (in[0] + constant_sum(v.get("in_offset")));
  return builder.limit(free, constant_sum(v.get("out_lower_limit")), constant_sum(v.get("out_upper_limit")));
}

/// From (low, lower) to (high, upper), both shifted by `shift`, constant beyond.
AffineSum ramp(FormulaBuilder& builder, const VariedValues& v, const AffineSum& x, const Varied& shift) {
  const Varied low = v.get("in_low") + shift, high = v.get("in_high") + shift;
  return builder.table(x, {{low, v.get("out_lower_limit")}, {high, v.get("out_upper_limit")}}, false);
}

AffineSum hyst_law(FormulaBuilder& builder, const VariedValues& v, const Inputs& in) {
  const Varied width = v.get("hyst");
  const Varied on = v.get("in_high") + width, off = v.get("in_low") - width;
  // A parameter that moves the two apart makes a ramp of the step.
  if (const Varied apart = v.get("in_high") - v.get("in_low"); apart.value == 0.0)
    return builder.hysteresis(in[0], on, off, constant_sum(unfollowed(v.get("out_upper_limit"), apart)),
                              constant_sum(v.get("out_lower_limit")));
  return builder.hysteresis(in[0], on, off, ramp(builder, v, in[0], -width), ramp(builder, v, in[0], width));
}

AffineSum pwl_law(FormulaBuilder& builder, const VariedValues& v, const Inputs& in) {
  const std::vector<Varied> x = v.list("x_array"), y = v.list("y_array");
  std::vector<TablePoint> points;
  for (std::size_t k = 0; k < x.size(); ++k) points.push_back({x[k], y[k]});
  return builder.table(in[0], points, true);
}

AffineSum relay_law(FormulaBuilder& builder, const VariedValues& v, const Inputs& in) { return v.get("level") * builder.sign(in[0]); }

AffineSum friction_law(FormulaBuilder& builder, const VariedValues& v, const Inputs& in) { return v.get("fc") * builder.sign(in[0]); }

AffineSum deadzone_law(FormulaBuilder& builder, const VariedValues& v, const Inputs& in) {
  const AffineSum d = constant_sum(v.get("d"));
  return v.get("level") * (builder.step(in[0] - d) - builder.step(-1.0 * in[0] - d));
}

void check_output_limits(Model& model, const Settings&, Diagnostics& diagnostics) {
  const Values& v = model.values;
  if (v.get("out_lower_limit") > v.get("out_upper_limit"))
    diagnostics.error("E-range", model.span, fmt::format("out_lower_limit of {} exceeds out_upper_limit", model.name));
}

void check_hyst(Model& model, const Settings&, Diagnostics& diagnostics) {
  if (model.values.get("in_low") > model.values.get("in_high"))
    diagnostics.error("E-range", model.span, fmt::format("in_low of {} exceeds in_high", model.name));
}

void check_pwl(Model& model, const Settings&, Diagnostics& diagnostics) {
  const std::vector<double> x = model.values.list("x_array");
  if (!model.values.has("x_array") || !model.values.has("y_array") || x.size() != model.values.list("y_array").size()) {
    diagnostics.error("E-missing-value", model.span, fmt::format("the model {} needs an x_array and a y_array of one length", model.name));
    return;
  }
  for (std::size_t k = 1; k < x.size(); ++k)
    if (x[k] < x[k - 1])
      diagnostics.error("E-table-order", model.values.span("x_array"),
                        fmt::format("the x of a table must not decrease: {} follows {}", x[k], x[k - 1]));
}

constexpr Parameter gain_after_offset{"gain", "", 1.0, Range::any, false, "Factor applied after the offset."};

constexpr Parameter gain_parameters[] = {gain_after_offset, in_offset, out_offset};
constexpr Parameter summer_parameters[] = {
    {"in_gain", "", 1.0, Range::any, false, "Factors of the inputs, one for each or one for all.", Use::honoured, true},
    {"in_offset", "", 0.0, Range::any, false, "Added to the inputs, one for each or one for all.", Use::honoured, true},
    {"out_gain", "", 1.0, Range::any, false, "Factor of the sum."},
    out_offset,
};
constexpr Parameter limit_parameters[] = {
    gain_after_offset,
    in_offset,
    {"out_lower_limit", "", 0.0, Range::any, true, "Least output."},
    {"out_upper_limit", "", 1.0, Range::any, true, "Largest output."},
    limit_range,
    range_is_relative,
};
constexpr Parameter hyst_parameters[] = {
    {"in_low", "", 0.0, Range::any, false, "Input where the output begins to rise, without hysteresis."},
    {"in_high", "", 1.0, Range::any, false, "Input where the output is fully up; equal to in_low it is a step."},
    {"hyst", "", 0.1, Range::not_negative, false, "Half width: both inputs lie this much higher on the way up, lower on the way down."},
    {"out_lower_limit", "", 0.0, Range::any, false, "Output below."},
    {"out_upper_limit", "", 1.0, Range::any, false, "Output above."},
    input_domain,
    range_is_relative,
};
constexpr Parameter pwl_parameters[] = {
    {"x_array", "", 0.0, Range::any, false, "Inputs of the points, not decreasing; equal ones are a vertical piece.", Use::honoured, true},
    {"y_array", "", 0.0, Range::any, false, "Outputs of the points; extrapolated beyond the ends.", Use::honoured, true},
    input_domain,
    range_is_relative,
};
constexpr Parameter relay_parameters[] = {
    {"level", "", 1.0, Range::any, false, "Output above zero; its negative below; any value between at zero."}};
constexpr Parameter deadzone_parameters[] = {
    {"d", "", 0.0, Range::not_negative, false, "No output for inputs between -d and d."},
    {"level", "", 1.0, Range::any, false, "Output above d; its negative below -d."},
};
constexpr Parameter friction_parameters[] = {{"fc", "", 1.0, Range::not_negative, false, "Friction force at any speed above zero."}};

constexpr BlockKind gain_block{false, gain_law}, summer_block{true, summer_law}, limit_block{false, limit_law}, hyst_block{false, hyst_law},
    pwl_block{false, pwl_law}, relay_block{false, relay_law}, deadzone_block{false, deadzone_law}, friction_block{false, friction_law};

}  // namespace

Varied VariedValues::get(std::string_view name) const {
  const Values::Given* given = model_.values.find(name);
  Varied number = model_.values.get(name);
  for (const Written& written : model_.written)
    if (given != nullptr && written.span.file == given->span.file && written.span.begin == given->span.begin &&
        written.span.end == given->span.end)
      number.gradient = written.gradient;
  return number;
}

std::vector<Varied> VariedValues::list(std::string_view name) const {
  std::vector<Varied> numbers;
  for (const double each : model_.values.list(name)) numbers.emplace_back(each);
  return numbers;
}

const ModelKind gain_model{"gain", "gain", gain_parameters, nullptr, &gain_block};
const ModelKind summer_model{"summer", "sum of inputs", summer_parameters, nullptr, &summer_block};
const ModelKind limit_model{"limit", "ideal saturation", limit_parameters, check_output_limits, &limit_block};
const ModelKind hyst_model{"hyst", "hysteresis", hyst_parameters, check_hyst, &hyst_block};
const ModelKind pwl_model{"pwl", "piecewise-linear characteristic", pwl_parameters, check_pwl, &pwl_block};
const ModelKind relay_model{"relay", "relay", relay_parameters, nullptr, &relay_block};
const ModelKind deadzone_model{"deadzone", "relay with dead zone", deadzone_parameters, nullptr, &deadzone_block};
const ModelKind friction_model{"friction", "Coulomb friction", friction_parameters, nullptr, &friction_block};

}  // namespace pwlsim::elements
