/// Blocks with states.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "elements/block.hpp"
#include "elements/complementarity.hpp"
#include "elements/dynamics.hpp"

namespace pwlsim::elements {
namespace {

using model::LinearForm;

/// max(form, least) and min(form, most), where these are finite.
LinearForm limited(Emission& emission, LinearForm form, double least, double most) {
  if (!std::isinf(least)) {
    form.push_back(model::constant(-least));
    form = add_positive_part(emission, form);
    form.push_back(model::constant(least));
  }
  if (std::isinf(most)) return form;
  LinearForm excess = form;
  excess.push_back(model::constant(-most));
  model::accumulate(form, add_positive_part(emission, excess), -1.0);
  return form;
}

LinearForm integrate(Emission& emission, const LinearForm& input) {
  const Values& v = emission.model().values;
  LinearForm rate = scaled(input, v.get("gain")).form;
  rate.push_back(model::constant(v.get("gain") * v.get("in_offset")));
  return add_integral(emission, {}, std::move(rate), integral_of(v));
}

LinearForm differentiate(Emission& emission, const LinearForm& input) {
  const Values& v = emission.model().values;
  LinearForm rate = scaled(add_derivative(emission, {}, input), v.get("gain")).form;
  rate.push_back(model::constant(v.get("out_offset")));
  return limited(emission, std::move(rate), v.get("out_lower_limit"), v.get("out_upper_limit"));
}

LinearForm transfer(Emission& emission, const LinearForm& input) {
  const Values& v = emission.model().values;
  LinearForm driven = scaled(input, v.get("gain")).form;
  driven.push_back(model::constant(v.get("gain") * v.get("in_offset")));
  LinearForm output = add_transfer(emission, {}, rational_function_of(v), v.get("denormalized_freq"), driven).form;
  output.push_back(model::constant(v.get("out_offset")));
  return output;
}

void check_limits(Model& model, const Settings&, Diagnostics& diagnostics) {
  const Values& v = model.values;
  if (v.get("out_lower_limit") > v.get("out_upper_limit"))
    diagnostics.error("E-range", model.span, fmt::format("out_lower_limit of {} exceeds out_upper_limit", model.name));
}

void without_leading_zeros(Values& values, std::string_view name) {
  std::vector<double> list = values.list(name);
  const auto first = std::find_if(list.begin(), list.end() - 1, [](double c) { return c != 0.0; });
  values.set_list(name, std::vector<double>(first, list.end()), values.span(name));
}

void complete_transfer(Model& model, const Settings&, Diagnostics& diagnostics) {
  Values& v = model.values;
  if (!v.has("num_coeff") || !v.has("den_coeff")) {
    diagnostics.error("E-missing-value", model.span, fmt::format("the model {} needs num_coeff and den_coeff", model.name));
    return;
  }
  without_leading_zeros(v, "num_coeff");
  without_leading_zeros(v, "den_coeff");
  if (v.list("den_coeff")[0] == 0.0) diagnostics.error("E-range", v.span("den_coeff"), "a denominator must not be zero");
  if (v.list("num_coeff").size() > v.list("den_coeff").size())
    diagnostics.error("E-range", v.span("num_coeff"),
                      fmt::format("the numerator of {} is of higher degree than its denominator; try a d_dt block in series", model.name));
  const std::vector<double> start = v.list("int_ic");
  if (std::any_of(start.begin(), start.end(), [](double x) { return x != 0.0; }))
    diagnostics.error("E-not-supported", v.span("int_ic"),
                      fmt::format("int_ic of {} other than zero is not supported; try int blocks", model.name));
}

constexpr Parameter input_gain{"gain", "", 1.0, Range::any, false, "Factor of the input."};
constexpr Parameter lower{"out_lower_limit", "", -infinite, Range::any, true, "Least output."};
constexpr Parameter upper{"out_upper_limit", "", infinite, Range::any, true, "Largest output."};

constexpr Parameter integrator_parameters[] = {
    input_gain,
    in_offset,
    {"out_lower_limit", "", -infinite, Range::any, true, "Least output: the integral stops there until the input reverses."},
    {"out_upper_limit", "", infinite, Range::any, true, "Largest output, likewise."},
    {"out_ic", "", 0.0, Range::any, false, "Output at the start, with and without uic."},
    limit_range,
};
constexpr Parameter derivative_parameters[] = {input_gain, out_offset, lower, upper, limit_range};
constexpr Parameter transfer_parameters[] = {
    {"num_coeff", "", 1.0, Range::any, false, "Numerator, highest power of s first.", Use::honoured, true},
    {"den_coeff", "", 1.0, Range::any, false, "Denominator, highest power of s first.", Use::honoured, true},
    input_gain,
    in_offset,
    out_offset,
    {"denormalized_freq", "rad/s", 1.0, Range::positive, false, "s counts in units of this rate."},
    {"int_ic", "", 0.0, Range::any, false, "Initial states; only zero.", Use::honoured, true},
};

constexpr BlockKind integrator_block{false, nullptr, integrate, smooth_integrator},
    derivative_block{false, nullptr, differentiate, smooth_derivative}, transfer_block{false, nullptr, transfer, smooth_transfer};

}  // namespace

Integral integral_of(const Values& values) { return {values.get("out_ic"), values.get("out_lower_limit"), values.get("out_upper_limit")}; }

RationalFunction rational_function_of(const Values& values) {
  const std::vector<double> num = values.list("num_coeff"), den = values.list("den_coeff");
  return {{num.begin(), num.end()}, {den.begin(), den.end()}};
}

const ModelKind integrator_model{"int", "integrator", integrator_parameters, check_limits, &integrator_block};
const ModelKind derivative_model{"d_dt", "derivative", derivative_parameters, check_limits, &derivative_block};
const ModelKind transfer_model{"s_xfer", "transfer function", transfer_parameters, complete_transfer, &transfer_block};

}  // namespace pwlsim::elements
