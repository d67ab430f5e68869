#include "elements/emission.hpp"
#include "elements/twin.hpp"

#include <fmt/format.h>

namespace pwlsim::elements::kinds::coupling {
namespace {

constexpr Parameter parameters[] = {
    {"k", "", 1.0, Range::minus_one_to_one, false, "Coupling coefficient; 1 and -1 are exact."},
};

bool has_inductance(Emission& emission, std::size_t k) {
  if (emission.referenced_result(k).inductor >= 0) return true;
  const Reference& reference = emission.instance().references[k];
  emission.diagnostics().error("E-coupling", reference.span,
                               fmt::format("{} has no inductance and cannot be coupled", emission.referenced(k).name));
  return false;
}

void couple(Emission& emission, std::size_t a, std::size_t b) {
  const int first = emission.referenced_result(a).inductor;
  const int second = emission.referenced_result(b).inductor;
  const auto& inductors = emission.builder().network().inductors;
  const double product = inductors[static_cast<std::size_t>(first)].inductance * inductors[static_cast<std::size_t>(second)].inductance;
  const SourceSpan span = emission.instance().references[b].span;
  if (first == second) {
    emission.diagnostics().error("E-coupling", span, emission.referenced(b).name + " cannot be coupled to itself");
  } else if (product < 0.0) {
    emission.diagnostics().error("E-coupling", span, "one inductance is negative and the other positive: sqrt(La Lb) is not real");
  } else {
    emission.builder().add(model::Coupling{emission.label(), first, second, emission.value("k")});
  }
}

void emit(Emission&) {}

void connect(Emission& emission) {
  const std::size_t count = emission.instance().references.size();
  bool all = true;
  for (std::size_t k = 0; k < count; ++k) all = has_inductance(emission, k) && all;
  if (!all) return;
  for (std::size_t a = 0; a < count; ++a) {
    for (std::size_t b = a + 1; b < count; ++b) couple(emission, a, b);
  }
}

void smooth_twin(Twin& twin) {
  const auto& coupled = twin.instance().references;
  for (std::size_t a = 0; a < coupled.size(); ++a)
    for (std::size_t b = a + 1; b < coupled.size(); ++b)
      twin.line(fmt::format("{} {} {} {}", twin.device('K', coupled.size() == 2 ? "" : fmt::format("{}_{}", a + 1, b + 1)),
                            twin.device_of('L', coupled[a]), twin.device_of('L', coupled[b]), twin.value("k")));
}

}  // namespace

Kind kind() {
  Kind kind;
  kind.name = "coupling";
  kind.letter = 'K';
  kind.usage = "K<name> L1 L2 [L3 ...] k";
  kind.text = "Magnetic coupling of two or more inductors, M = k sqrt(La Lb) for every pair.";
  kind.terminals = 0;
  kind.control = ControlSyntax::element_list;
  kind.parameters = parameters;
  kind.has_current = false;
  kind.controls_others = false;
  kind.joins_terminals = [](const Instance&) { return false; };
  kind.emit = emit;
  kind.connect = connect;
  kind.smooth_twin = smooth_twin;
  return kind;
}

}  // namespace pwlsim::elements::kinds::coupling
