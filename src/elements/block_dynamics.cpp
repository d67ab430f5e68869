/// Blocks with states: voltages of 1 F at inner nodes, driven by injections.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "elements/block.hpp"
#include "elements/complementarity.hpp"

namespace pwlsim::elements {
namespace {

using model::LinearForm;

LinearForm scaled(const LinearForm& form, double factor) {
  LinearForm result;
  model::accumulate(result, form, factor);
  return result;
}

/// An inner node with 1 F to ground: its voltage is a state, whose derivative is what is injected.
model::NodeIndex add_state(Emission& emission, std::string_view part) {
  const model::NodeIndex node = emission.inner_node(part);
  emission.builder().add(model::Capacitor{emission.label(), node, model::ground, 1.0, false, 0.0});
  return node;
}

void inject(Emission& emission, model::NodeIndex node, LinearForm current) {
  emission.builder().add(model::Injection{emission.label(), model::ground, node, std::move(current)});
}

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

/// A stop for the state: an input u ≥ 0 pushes while sign·(state − bound) is 0.
void add_stop(Emission& emission, LinearForm& rate, model::NodeIndex state, double bound, double sign) {
  if (std::isinf(bound)) return;
  LinearForm slack = model::voltage_between(state, model::ground, sign);
  slack.push_back(model::constant(-sign * bound));
  const int index = emission.builder().add(model::Complementarity{emission.label(), std::move(slack)});
  rate.push_back({Quantity::slack_input, index, sign});
}

LinearForm integrate(Emission& emission, const LinearForm& input) {
  const Values& v = emission.model().values;
  const model::NodeIndex state = add_state(emission, "output");
  model::Capacitor& capacitor = emission.builder().network().capacitors.back();
  capacitor.has_initial = true;
  capacitor.initial_voltage = v.get("out_ic");
  emission.builder().add(model::NodeCondition{emission.label(), state, v.get("out_ic")});
  LinearForm rate = scaled(input, v.get("gain"));
  rate.push_back(model::constant(v.get("gain") * v.get("in_offset")));
  add_stop(emission, rate, state, v.get("out_lower_limit"), 1.0);
  add_stop(emission, rate, state, v.get("out_upper_limit"), -1.0);
  inject(emission, state, std::move(rate));
  return model::voltage_between(state, model::ground);
}

LinearForm differentiate(Emission& emission, const LinearForm& input) {
  const Values& v = emission.model().values;
  const model::NodeIndex node = emission.inner_node("input");
  emission.builder().add(model::Branch{emission.label(), node, model::ground, input});
  const int capacitor = emission.builder().add(model::Capacitor{emission.label(), node, model::ground, 1.0, false, 0.0});
  LinearForm rate{{Quantity::capacitor_current, capacitor, v.get("gain")}, model::constant(v.get("out_offset"))};
  return limited(emission, std::move(rate), v.get("out_lower_limit"), v.get("out_upper_limit"));
}

/// Ascending powers of s, in units of `rate`.
std::vector<double> ascending(std::vector<double> list, double rate) {
  std::reverse(list.begin(), list.end());
  double power = 1.0;
  for (double& coefficient : list) {
    coefficient *= power;
    power *= rate;
  }
  return list;
}

/// The rate that makes the largest coefficient of the monic denominator one.
double rate_of(const std::vector<double>& descending) {
  double rate = 0.0;
  for (std::size_t k = 1; k < descending.size(); ++k)
    rate = std::max(rate, std::pow(std::abs(descending[k] / descending[0]), 1.0 / static_cast<double>(k)));
  return rate > 0.0 ? rate : 1.0;
}

/// Controllable canonical form in p = s/rate:  x_k' = rate·x_{k+1},  x_n' = rate·(u − Σ a_k x_{k+1}),  y = Σ b_k x_{k+1} + b_n·(…).
LinearForm transfer(Emission& emission, const LinearForm& input) {
  const Values& v = emission.model().values;
  const double unit = v.get("denormalized_freq");
  const auto [rate, num, den] = canonical_form(v);
  const std::size_t order = den.size() - 1;
  LinearForm highest = scaled(input, v.get("gain") / den[order]);
  highest.push_back(model::constant(v.get("gain") * v.get("in_offset") / den[order]));
  std::vector<LinearForm> state;
  std::vector<model::NodeIndex> node;
  for (std::size_t k = 0; k < order; ++k) {
    node.push_back(add_state(emission, fmt::format("state {}", k + 1)));
    state.push_back(model::voltage_between(node[k], model::ground));
    if (den[k] != 0.0) model::accumulate(highest, state[k], -den[k] / den[order]);
  }
  state.push_back(highest);
  LinearForm output{model::constant(v.get("out_offset"))};
  for (std::size_t k = 0; k <= order; ++k) {
    if (k < order) inject(emission, node[k], scaled(state[k + 1], rate * unit));
    if (num[k] != 0.0) model::accumulate(output, state[k], num[k]);
  }
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

constexpr Parameter in_offset{"in_offset", "", 0.0, Range::any, false, "Added to the input."};
constexpr Parameter gain{"gain", "", 1.0, Range::any, false, "Factor of the input."};
constexpr Parameter out_offset{"out_offset", "", 0.0, Range::any, false, "Added to the output."};
constexpr Parameter lower{"out_lower_limit", "", -infinite, Range::any, true, "Least output."};
constexpr Parameter upper{"out_upper_limit", "", infinite, Range::any, true, "Largest output."};

constexpr Parameter integrator_parameters[] = {
    gain,
    in_offset,
    {"out_lower_limit", "", -infinite, Range::any, true, "Least output: the integral stops there until the input turns."},
    {"out_upper_limit", "", infinite, Range::any, true, "Largest output, likewise."},
    {"out_ic", "", 0.0, Range::any, false, "Output at the start, with and without uic."},
    limit_range,
};
constexpr Parameter derivative_parameters[] = {gain, out_offset, lower, upper, limit_range};
constexpr Parameter transfer_parameters[] = {
    {"num_coeff", "", 1.0, Range::any, false, "Numerator, highest power of s first.", Use::honoured, true},
    {"den_coeff", "", 1.0, Range::any, false, "Denominator, highest power of s first.", Use::honoured, true},
    gain,
    in_offset,
    out_offset,
    {"denormalized_freq", "rad/s", 1.0, Range::positive, false, "s counts in units of this rate."},
    {"int_ic", "", 0.0, Range::any, false, "Start of the states; only zero.", Use::honoured, true},
};

constexpr Block integrator_block{false, nullptr, integrate, smooth_integrator},
    derivative_block{false, nullptr, differentiate, smooth_derivative}, transfer_block{false, nullptr, transfer, smooth_transfer};

}  // namespace

CanonicalForm canonical_form(const Values& values) {
  const std::vector<double> written = values.list("den_coeff");
  const double rate = rate_of(written);
  CanonicalForm form{rate, ascending(values.list("num_coeff"), rate), ascending(written, rate)};
  form.num.resize(form.den.size(), 0.0);
  return form;
}

const ModelKind integrator_model{"int", "integrator", integrator_parameters, check_limits, &integrator_block};
const ModelKind derivative_model{"d_dt", "derivative", derivative_parameters, check_limits, &derivative_block};
const ModelKind transfer_model{"s_xfer", "transfer function", transfer_parameters, complete_transfer, &transfer_block};

}  // namespace pwlsim::elements
