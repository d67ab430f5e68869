#include "engine/sparse/controls.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace pwlsim::engine::sparse {

namespace {

using model::ground;
using model::Term;

/// Voltage of every node that a source to ground holds, as a form of sources.
std::unordered_map<int, Form> held_nodes(const model::Network& network) {
  std::unordered_map<int, Form> held;
  for (const auto& b : network.branches) {
    if ((b.p == ground) == (b.n == ground)) continue;
    const double sign = b.n == ground ? 1.0 : -1.0;
    if (!model::is_independent(b.voltage)) continue;
    Form form;
    for (const Term& term : b.voltage) {
      if (term.kind == Term::Kind::one) form.constant += sign * term.coefficient;
      if (term.kind == Term::Kind::source) form.w.push_back({term.index, sign * term.coefficient});
    }
    held.emplace(b.p == ground ? b.n : b.p, std::move(form));
  }
  return held;
}

bool by_sources(const model::LinearForm& terms, const std::unordered_map<int, Form>& held, Form& form) {
  for (const Term& term : terms) {
    if (term.kind == Term::Kind::one) {
      form.constant += term.coefficient;
    } else if (term.kind == Term::Kind::source) {
      form.w.push_back({term.index, term.coefficient});
    } else if (term.kind == Term::Kind::node_voltage) {
      if (term.index == ground) continue;
      const auto found = held.find(term.index);
      if (found == held.end()) return false;
      form.constant += term.coefficient * found->second.constant;
      for (const auto& part : found->second.w) form.w.push_back({part.index, term.coefficient * part.coefficient});
    } else {
      return false;
    }
  }
  return true;
}

}  // namespace

double Control::level_size() const { return std::max({std::abs(on_level), std::abs(off_level), on_level - off_level}); }

std::vector<Control> controls_of(const model::Network& network, const Descriptor& descriptor) {
  const auto held = held_nodes(network);
  std::vector<Control> controls;
  for (std::size_t i = 0; i < network.switches.size(); ++i) {
    const auto& s = network.switches[i];
    Control control{static_cast<std::size_t>(descriptor.first_switch()) + i,
                    descriptor.form(s.control),
                    {},
                    false,
                    s.on_level,
                    s.off_level,
                    s.inverted};
    control.by_sources = by_sources(s.control, held, control.of_sources);
    controls.push_back(std::move(control));
  }
  return controls;
}

Position first_position(const model::Network& network, const Descriptor& descriptor) {
  Position on(descriptor.ports().size(), 0);
  for (std::size_t i = 0; i < network.switches.size(); ++i)
    on[static_cast<std::size_t>(descriptor.first_switch()) + i] = network.switches[i].initially_on != network.switches[i].inverted;
  return on;
}

}  // namespace pwlsim::engine::sparse
