#include "circuit/foreign_device.hpp"

#include <fmt/format.h>

#include "base/names.hpp"

namespace pwlsim::circuit {
namespace {

using Nodes = std::vector<std::string>;
constexpr std::size_t inputs = 5, complement = 5, output = 6, common = 7;

bool is_ground(const std::string& node) { return node == "0" || same_name(node, "gnd"); }

/// Unused terminals are tied to the common.
bool is_used(const Nodes& nodes, std::size_t place) {
  return !same_name(nodes[place], nodes[common]) && !(is_ground(nodes[place]) && is_ground(nodes[common]));
}

Nodes input_voltages(const Nodes& nodes) {
  Nodes result;
  for (std::size_t k = 0; k < inputs; ++k)
    if (is_used(nodes, k))
      result.push_back(is_ground(nodes[common]) ? fmt::format("v({})", nodes[k]) : fmt::format("v({},{})", nodes[k], nodes[common]));
  return result;
}

/// What is above ½ where the gate's output is high; "" of other devices, and of gates with other numbers of inputs.
std::string level(const std::string& type, const Nodes& from) {
  const bool is_and = same_name(type, "AND");
  if (same_name(type, "XOR") && from.size() == 2) return fmt::format("abs({}-{})", from[0], from[1]);
  if ((same_name(type, "BUF") || same_name(type, "INV")) && from.size() == 1) return from[0];
  if (!(is_and || same_name(type, "OR")) || from.size() < 2) return "";
  std::string text = from[0];
  for (std::size_t k = 1; k < from.size(); ++k) text = fmt::format("{}({},{})", is_and ? "min" : "max", text, from[k]);
  return text;
}

}  // namespace

std::string instead_of_device(const std::string& type, const Nodes& nodes) {
  const bool is_complement = !is_used(nodes, output);
  const std::string& to = nodes[is_complement ? complement : output];
  if (const std::string above = level(type, input_voltages(nodes)); !above.empty())
    return fmt::format("a source B with levels of 0 and 1 V: B1 {} {} V={{u({})}}", to, nodes[common],
                       is_complement != same_name(type, "INV") ? "0.5-" + above : above + "-0.5");
  if (same_name(type, "SCHMITT")) return "a block of .model … hyst, or a switch with Vt and Vh";
  if (same_name(type, "SRFLOP") && !is_complement)
    return fmt::format("a switch, which keeps its position: S1 high {} {} {} latch, .model latch SW(Vt=0 Vh=0.5), and a resistor at {}", to,
                       nodes[0], nodes[1], to);
  return "a subcircuit of sources B with u() and if(), and of switches with hysteresis, which keep their positions";
}

}  // namespace pwlsim::circuit
