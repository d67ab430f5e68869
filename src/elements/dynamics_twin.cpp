/// The twins for ngspice: states as voltages of 1 F that B sources drive.
#include <cmath>

#include <fmt/format.h>

#include "elements/dynamics.hpp"

namespace pwlsim::elements {
namespace {

std::string voltage_of(const std::string& node) { return fmt::format("v({})", node); }

/// An inner node with 1 F to ground.
std::string add_state(Twin& twin, const std::string& part, double start) {
  const std::string node = twin.inner(part);
  twin.capacitor(part, {node, "0"}, 1.0);
  twin.start_voltage(node, start);
  return node;
}

/// A diode that lets the state past `bound` by its voltage drop only; sign 1: a lower bound.
void add_stop(Twin& twin, const std::string& part, const std::string& state, double bound, double sign) {
  if (std::isinf(bound)) return;
  const std::string at = twin.inner(part);
  twin.source(part, {at, "0"}, false, model::Dc{bound});
  twin.diode(part, sign > 0.0 ? TwinEnds{at, state} : TwinEnds{state, at}, {});
}

}  // namespace

std::string twin_integral(Twin& twin, std::string_view part, std::string_view input, const Integral& integral) {
  const std::string begin(part);
  const std::string state = add_state(twin, begin + "state", integral.start.value);
  twin.behaviour(begin + "rate", {"0", state}, true, input);
  add_stop(twin, begin + "least", state, integral.least, 1.0);
  add_stop(twin, begin + "most", state, integral.most, -1.0);
  return voltage_of(state);
}

std::string twin_derivative(Twin& twin, std::string_view part, std::string_view input) {
  const std::string begin(part);
  const std::string node = twin.inner(begin + "input"), foot = twin.inner(begin + "foot");
  twin.behaviour(begin + "input", {node, "0"}, false, input);
  twin.capacitor(begin + "state", {node, foot}, 1.0);
  twin.short_circuit(begin + "rate", {foot, "0"});
  return current_text(twin.device('V', begin + "rate"));
}

/// The states of add_transfer: x_k' = rate·x_{k+1}, x_n' = rate·(u − Σ a_k x_{k+1}).
std::string twin_transfer(Twin& twin, std::string_view part, const RationalFunction& fraction, double unit, std::string_view input) {
  const std::string begin(part);
  const auto [rate, num, den] = canonical_form(fraction);
  const std::size_t order = den.size() - 1;
  std::vector<std::string> state;
  for (std::size_t k = 0; k < order; ++k) state.push_back(add_state(twin, fmt::format("{}state{}", begin, k + 1), 0.0));
  std::string highest = fmt::format("{}*({})", 1.0 / den[order].value, input);
  for (std::size_t k = 0; k < order; ++k) highest += term_text(-den[k].value / den[order].value, voltage_of(state[k]));
  const std::string top = twin.inner(begin + "highest");
  twin.behaviour(begin + "highest", {top, "0"}, false, highest);
  state.push_back(top);
  std::string output = "0";
  for (std::size_t k = 0; k <= order; ++k) {
    if (k < order)
      twin.behaviour(fmt::format("{}rate{}", begin, k + 1), {"0", state[k]}, true,
                     fmt::format("{}*{}", rate * unit, voltage_of(state[k + 1])));
    output += term_text(num[k].value, voltage_of(state[k]));
  }
  return output;
}

}  // namespace pwlsim::elements
