#include "model/structure_errors.hpp"

#include <fmt/format.h>

#include "model/tolerances.hpp"

namespace pwlsim::model {

namespace {

/// Names of nodes or elements, and the place of the first.
struct Named {
  std::string names;
  SourceSpan span;

  void add(const Label& label, bool has_place = true) {
    if (!span.known() && has_place) span = label.span;
    names += (names.empty() ? "" : ", ") + label.name;
  }
};

}  // namespace

void report_impossible_coupling(const Network& network, Diagnostics& diagnostics) {
  diagnostics.error("E-coupling", network.couplings.front().label.span,
                    "the couplings of these inductors contradict each other: their inductance matrix is indefinite; "
                    "try smaller coefficients");
}

void report_improper(const Unknowns& unknowns, const linalg::WideMatrix& waves, Diagnostics& diagnostics) {
  std::string names, last;
  SourceSpan span;
  for (Eigen::Index j = 0; j < waves.cols(); ++j) {
    if (waves.col(j).cwiseAbs().maxCoeff() == 0.0) continue;
    const Label& label = unknowns.port_label(static_cast<int>(j));
    if (!span.known()) span = label.span;
    if (!last.empty() && last == label.name) continue;  // of an element with several ports
    last = label.name;
    names += (names.empty() ? "" : ", ") + label.name;
  }
  diagnostics.error("E-improper", span,
                    fmt::format("{}: the controlled sources around it differentiate its current or voltage, so no port model exists; "
                                "try a resistor or capacitor beside it",
                                names));
}

void report_open(const Network& network, const Unknowns& unknowns, const OpenEquations& open, Diagnostics& diagnostics) {
  const auto nodes = static_cast<Eigen::Index>(network.nodes.size());
  Named floating, elements;
  bool has_source = false;
  const auto is_in = [](const linalg::WideMatrix& vectors, Eigen::Index i) {
    return vectors.cols() > 0 && vectors.row(i).cwiseAbs().maxCoeff() > tolerance::null_vector_entry;
  };
  for (Eigen::Index i = 0; i < open.kernel.rows(); ++i) {
    if (i < nodes && (is_in(open.rows, i) || is_in(open.kernel, i))) floating.add(network.nodes[static_cast<std::size_t>(i)]);
    const auto column = static_cast<int>(i);
    const Label* const owner = unknowns.owner(column);
    if (owner == nullptr || owner->name.empty() || !is_in(open.kernel, i)) continue;
    const bool is_source = unknowns.is_branch(column);
    has_source |= is_source;
    elements.add(*owner, is_source || unknowns.is_resistor(column));
  }
  const bool is_loop_of_wires = !has_source && floating.names.empty() && !elements.names.empty();
  if (has_source || is_loop_of_wires) {
    diagnostics.error(
        "E-source-loop", elements.span,
        fmt::format("{} {} a loop {}without resistance{}; try a small resistor in series", elements.names,
                    elements.names.find(',') == std::string::npos ? "forms" : "form", has_source ? "of voltage sources " : "",
                    open.is_contradicted ? " whose voltages contradict each other" : ", so their currents are not determined"));
    return;
  }
  if (open.is_contradicted)
    diagnostics.error(
        "E-source-cutset", floating.span,
        fmt::format("current sources force a current into node {} that has no return path; try a resistor to ground", floating.names));
  else
    diagnostics.error("E-floating", floating.span,
                      fmt::format("the voltage of node {} is not determined; try a resistor to ground", floating.names));
}

}  // namespace pwlsim::model
