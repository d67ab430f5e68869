#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/inspection.hpp"
#include "analysis/quantity.hpp"

namespace pwlsim::analysis {
namespace {

using model::Matrix;

constexpr Eigen::Index widest_matrix = 16;  ///< wider ones are left to --json

std::string number(double value) { return fmt::format("{:.6g}", value == 0.0 ? 0.0 : value); }

std::string list_of(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

/// Under a head line: its columns numbered behind `column`, its rows named.
std::string matrix_text(std::string_view head, const Matrix& m, std::string_view row, std::string_view row_mark, std::string_view column) {
  if (m.rows() == 0 || m.cols() == 0) return {};
  if (m.rows() > widest_matrix || m.cols() > widest_matrix) return fmt::format("    {}: {} x {}, see --json\n", head, m.rows(), m.cols());
  std::size_t width = 4;
  for (Eigen::Index i = 0; i < m.size(); ++i) width = std::max(width, number(m.data()[i]).size());
  std::string text = fmt::format("    {:<6}", head);
  for (Eigen::Index j = 0; j < m.cols(); ++j) text += fmt::format("  {:>{}}", fmt::format("{}{}", column, j + 1), width);
  text += '\n';
  for (Eigen::Index i = 0; i < m.rows(); ++i) {
    text += fmt::format("    {:<6}", fmt::format("{}{}{}", row, i + 1, row_mark));
    for (Eigen::Index j = 0; j < m.cols(); ++j) text += fmt::format("  {:>{}}", number(m(i, j)), width);
    text += '\n';
  }
  return text;
}

std::string states_text(const std::vector<model::EnergyState>& states) {
  if (states.empty()) return "    no states\n";
  std::string text;
  for (std::size_t i = 0; i < states.size(); ++i) {
    const auto& terms = states[i].terms;
    text += fmt::format("    x{} =", i + 1);
    for (std::size_t k = 0; k < terms.size(); ++k) {
      const auto& term = terms[k];
      const std::string_view sign = term.coefficient < 0.0 ? (k == 0 ? " -" : " - ") : (k == 0 ? " " : " + ");
      text += fmt::format("{}{} {}({})", sign, number(std::abs(term.coefficient)), term.is_voltage ? "v" : "i", term.element);
    }
    text += '\n';
  }
  return text;
}

std::string ports_text(const std::vector<PortView>& ports) {
  if (ports.empty()) return "    no ports\n";
  std::string text;
  for (std::size_t i = 0; i < ports.size(); ++i) {
    const PortView& port = ports[i];
    const std::string_view current = port.is_diode ? "current" : "multiplier";
    const std::string_view voltage = port.is_diode ? "blocking voltage" : "slack";
    text += fmt::format("    port {}, {}: u{} its {}, y{} its {}\n", i + 1, port.name, i + 1, port.input_is_current ? current : voltage,
                        i + 1, port.input_is_current ? voltage : current);
  }
  return text;
}

std::string pairs_text(const std::vector<std::vector<int>>& degree) {
  if (degree.size() == 1) return "    no relative degree: y1 does not depend on u1\n";
  std::string text = "    relative degree of y (row) in u (column), - for none:\n";
  if (degree.size() > static_cast<std::size_t>(widest_matrix))
    return fmt::format("    relative degree: {} x {} pairs, see --json\n", degree.size(), degree.size());
  for (const auto& row : degree) {
    text += "     ";
    for (const int order : row) text += fmt::format(" {:>2}", order < 0 ? "-" : std::to_string(order));
    text += '\n';
  }
  return text;
}

std::string markov_text(const model::Markov& markov) {
  std::string text =
      markov.uniform_degree >= 0 ? fmt::format("    relative degree {} (uniform)\n", markov.uniform_degree) : pairs_text(markov.degree);
  for (std::size_t order = 0; order < markov.parameters.size(); ++order) {
    const Matrix& m = markov.parameters[order];
    const std::string name = fmt::format("M{}", order);
    if (m.cwiseAbs().maxCoeff() == 0.0) {
      text += fmt::format("    {} = 0\n", name);
    } else if (m.size() == 1) {
      text += fmt::format("    {} = {}\n", name, number(m(0, 0)));
    } else {
      text += matrix_text(name, m, "y", "", "u");
    }
  }
  return text;
}

std::string certificate_text(const CertificateView& certificate) {
  const std::string residual = fmt::format("KYP residual {:.1e}", certificate.kyp_residual == 0.0 ? 0.0 : certificate.kyp_residual);
  switch (certificate.kind) {
    case CertificateKind::no_ports:
      return "a linear differential equation: one solution from every state";
    case CertificateKind::passive:
      return certificate.always_solvable ? fmt::format("passive ({}): one solution from every state", residual)
                                         : fmt::format("passive ({}): where a solution exists, its states are unique", residual);
    case CertificateKind::principal_minors:
      return fmt::format(
          "positive principal minors ({}, not passive): one solution of the rational complementarity problem from every state", residual);
    case CertificateKind::none:
      break;
  }
  return fmt::format(
      "not certified ({}, not passive; {})", residual,
      certificate.too_many_ports ? "too many ports for principal minors" : "the leading principal minors are not all positive");
}

std::string position_name(const std::vector<std::string>& switches, const PositionView& position) {
  std::string text;
  for (std::size_t i = 0; i < switches.size(); ++i)
    text += fmt::format("{}{}={}", i == 0 ? "" : ",", switches[i], position.on[i] != 0 ? "on" : "off");
  return text + (position.of_start ? " (the flags of the start)" : "");
}

std::string position_text(const IslandView& island, const PositionView& position) {
  std::string text = "\n";
  if (!island.switches.empty()) text += fmt::format("  Switches {}\n", position_name(island.switches, position));
  if (!position.problem.empty()) return text + fmt::format("    no (A, B, C, D) of its own: {}\n", position.problem);
  text += states_text(position.space.states) + ports_text(position.ports);
  text += matrix_text("A", position.space.a, "x", "'", "x") + matrix_text("B", position.space.b, "x", "'", "u");
  text += matrix_text("C", position.space.c, "y", "", "x") + matrix_text("D", position.space.d, "y", "", "u");
  if (!position.ports.empty()) text += markov_text(position.markov);
  return text + fmt::format("    certificate: {}\n", certificate_text(position.certificate));
}

std::string mode_text(const ModeView& mode) {
  std::string text = fmt::format("\n  Mode {}\n", mode.on.empty() ? "with everything off" : list_of(mode.on) + " on, the rest off");
  text += fmt::format("    consistent subspace V: dimension {} of {}; jump subspace T: dimension {}\n", mode.consistent, mode.states,
                      mode.jump);
  if (mode.well_posed) {
    text += "    well-posed: V and T together are the whole space\n";
  } else {
    text += mode.complementary ? "    not well-posed: the sources contradict it\n"
                               : "    not well-posed: V and T together are not the whole space\n";
  }
  if (!mode.indeterminate.empty()) text += fmt::format("    indeterminate: currents or voltages of {}\n", list_of(mode.indeterminate));
  return text;
}

std::string island_text(const IslandView& island, std::size_t index) {
  std::string text = fmt::format("\nIsland {} ({}): {}\n", index + 1, island.name, list_of(island.elements));
  if (island.states == 0 && island.ports == 0 && island.switches.empty()) return text + "  no states, no ports\n";
  text += fmt::format("  {}, {}, {}\n", counted(island.states, "state"), counted(island.ports, "port"),
                      counted(island.switches.size(), "switch"));
  if (static_cast<double>(island.positions.size()) < island.positions_in_all)
    text += fmt::format("  {:.6g} switch positions in all; shown: that of the start and that of --mode\n", island.positions_in_all);
  for (const PositionView& position : island.positions) text += position_text(island, position);
  if (island.mode) text += mode_text(*island.mode);
  return text;
}

}  // namespace

std::string inspection_text(const Inspection& inspection) {
  std::string text = inspection.title + "\n\n";
  text +=
      "x' = A x + B u, y = C x + D u, 0 <= u, y >= 0, u.y = 0, with the sources at zero. States in square roots of joule: half the sum of\n"
      "their squares is the stored energy. Ports in volts and amperes, time in seconds.\n";
  for (std::size_t i = 0; i < inspection.islands.size(); ++i) text += island_text(inspection.islands[i], i);
  text += inspection.left_out.empty() ? "\nNothing is left out.\n" : "\n";
  for (const auto& names : inspection.left_out)
    text += fmt::format("Left out, because no saved signal depends on it: {}\n", list_of(names));
  return text;
}

}  // namespace pwlsim::analysis
