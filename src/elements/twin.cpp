#include "elements/twin.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/names.hpp"
#include "elements/conduction.hpp"

namespace pwlsim::elements {
namespace {

constexpr double unreachable = 1e12;          // V, where a drop is infinite
constexpr double off_resistance_scale = 1e5;  // ohm, over the sharpness

/// Letters, digits, '_' and '.' stay: all that ngspice takes in names and in expressions alike.
std::string plain(std::string_view name) {
  std::string result(name);
  const auto keeps = [](char c) {
    return (c >= '0' && c <= '9') || (lower_letter(c) >= 'a' && lower_letter(c) <= 'z') || c == '_' || c == '.';
  };
  std::replace_if(
      result.begin(), result.end(), [&](char c) { return !keeps(c); }, '_');
  return result;
}

std::string unique(std::string name, std::unordered_set<std::string>& taken) {
  const std::string base = name;
  for (int k = 2; !taken.insert(without_case(name)).second; ++k) name = fmt::format("{}_{}", base, k);
  return name;
}

}  // namespace

TwinNames::TwinNames(const std::vector<std::string>& nodes, const std::vector<Instance>& instances) {
  taken_ = {"0", "gnd"};
  for (const std::string& node : nodes) nodes_.push_back(unique(plain(node), taken_));
  std::unordered_set<std::string> taken_by_elements;
  for (const Instance& instance : instances) instances_.push_back(unique(plain(instance.name), taken_by_elements));
}

const std::string& TwinNames::node(model::NodeIndex index) const {
  static const std::string ground = "0";
  return index == model::ground ? ground : nodes_[static_cast<std::size_t>(index)];
}

std::string TwinNames::inner(std::size_t instance, std::string_view part) const {
  std::string name = fmt::format("{}.{}", instances_[instance], part);
  while (taken_.contains(without_case(name))) name += '_';
  return name;
}

std::string TwinNames::device(char letter, std::size_t instance, std::string_view part) const {
  std::string name = instances_[instance];
  if (lower_letter(name[0]) != lower_letter(letter)) name = fmt::format("{}.{}", letter, name);
  return part.empty() ? name : fmt::format("{}.{}", name, part);
}

Twin::Twin(const std::vector<Instance>& instances, const std::vector<Model>& models, const TwinNames& names, std::vector<char> observed,
           const TwinSettings& settings, Diagnostics& diagnostics)
    : instances_(instances),
      models_(models),
      names_(names),
      observed_(std::move(observed)),
      settings_(settings),
      diagnostics_(diagnostics) {
  for (const Instance& instance : instances) {
    if (instance.kind->control != ControlSyntax::element_list)  // K names its inductors, it does not read them
      for (const Reference& reference : instance.references) observed_[static_cast<std::size_t>(reference.index)] = 1;
    if (instance.kind->letter == 'V' && instance.nodes[1] == model::ground && instance.values.get("Rser") == 0.0)
      held_.insert(instance.nodes[0]);
  }
}

bool Twin::is_held(const NodePair& pair) const {
  const auto known = [&](model::NodeIndex node) { return node == model::ground || held_.contains(node); };
  return known(pair.p) && known(pair.n);
}

bool Twin::has_meter(std::size_t instance) const {
  const Instance& i = instances_[instance];
  const auto* sine = i.waveform ? std::get_if<model::Sin>(&*i.waveform) : nullptr;
  const bool is_card = sine == nullptr || std::isinf(sine->cycles);  // a V card, not a B card in its place
  const bool carries_own = i.kind->letter == 'V' && is_card && i.values.get("Cpar") == 0.0;
  return observed_[instance] != 0 && !carries_own && i.kind->has_current;
}

std::string Twin::meter_of(std::size_t instance) const { return names_.device('V', instance, has_meter(instance) ? "i" : ""); }

void Twin::select(std::size_t index) {
  index_ = index;
  if (!has_meter(index)) return;
  const std::string inside = inner("i");
  line(fmt::format("{} {} {} 0", meter_of(index), node(instance().nodes[0]), inside));
}

std::optional<double> Twin::initial_current() const {
  const auto found = initial_currents_.find(index_);
  if (found == initial_currents_.end()) return std::nullopt;
  return found->second;
}

TwinEnds Twin::ends() const { return {has_meter(index_) ? inner("i") : node(instance().nodes[0]), node(instance().nodes[1])}; }

void Twin::resistor(std::string_view part, const TwinEnds& ends, double resistance) {
  if (resistance == 0.0) return short_circuit(part.empty() ? "r" : part, ends);
  line(fmt::format("{} {} {} {}", device('R', part), ends.p, ends.n, resistance));
}

void Twin::capacitor(std::string_view part, const TwinEnds& ends, double capacitance, const double* initial) {
  const std::string start = initial != nullptr ? fmt::format(" ic={}", *initial) : "";
  line(fmt::format("{} {} {} {}{}", device('C', part), ends.p, ends.n, capacitance, start));
}

void Twin::inductor(std::string_view part, const TwinEnds& ends, double inductance, const double* initial) {
  const std::string start = initial != nullptr ? fmt::format(" ic={}", *initial) : "";
  line(fmt::format("{} {} {} {}{}", device('L', part), ends.p, ends.n, inductance, start));
}

void Twin::short_circuit(std::string_view part, const TwinEnds& ends) {
  line(fmt::format("{} {} {} 0", device('V', part), ends.p, ends.n));
}

void Twin::behaviour(std::string_view part, const TwinEnds& ends, bool is_current, std::string_view expression) {
  if (expression.starts_with('+')) expression.remove_prefix(1);
  line(fmt::format("{} {} {} {}={}", device('B', part), ends.p, ends.n, is_current ? 'I' : 'V', expression.empty() ? "0" : expression));
}

void Twin::diode(std::string_view part, const TwinEnds& ends, const TwinDiode& diode) {
  const double on = diode.on == 0.0 ? sharpness() : diode.on;
  const double off = std::isinf(diode.off) ? std::max(on, off_resistance_scale / sharpness()) : diode.off;
  const std::string name = device('A', part);
  std::string parameters = fmt::format("Ron={} Roff={} Vfwd={}", on, off, std::min(diode.drop, unreachable));
  if (!std::isinf(diode.reverse_drop))
    parameters += fmt::format(" Vrev={} Rrev={}", diode.reverse_drop, diode.reverse_on == 0.0 ? sharpness() : diode.reverse_on);
  line(fmt::format("{} {} {} {}.model", name, ends.p, ends.n, name));
  line(fmt::format(".model {}.model sidiode({})", name, parameters));
}

void Twin::contact(std::string_view part, const TwinEnds& ends, const TwinEnds& control, const Contact& contact) {
  const double on = contact.on_resistance == 0.0 ? sharpness() : contact.on_resistance;
  const double off = std::isinf(contact.off_resistance) ? std::max(on, off_resistance_scale / sharpness()) : contact.off_resistance;
  const std::string name = device('S', part);
  line(fmt::format("{} {} {} {} {} {}.model{}", name, ends.p, ends.n, control.p, control.n, name, contact.starts_on ? " on" : ""));
  line(fmt::format(".model {}.model sw(Ron={} Roff={} Vt={} Vh={})", name, on, off, 0.5 * (contact.on_level + contact.off_level),
                   0.5 * (contact.on_level - contact.off_level)));
}

void Twin::start_voltage(const std::string& node, double voltage) { line(fmt::format(".ic v({})={}", node, voltage)); }

std::string Twin::positive(std::string_view part, std::string_view x) {
  const std::string node = inner(part), argument = inner(fmt::format("{}.x", part)), e = fmt::format("{}", 4.0 * sharpness() * sharpness());
  behaviour(fmt::format("{}.x", part), {argument, "0"}, false, x);
  behaviour(part, {node, "0"}, false, fmt::format("0.5*(v({0})+sqrt(v({0})*v({0})+{1}))", argument, e));
  return fmt::format("v({})", node);
}

std::string Twin::step(std::string_view part, std::string_view x) {
  const std::string node = inner(part);
  behaviour(part, {node, "0"}, false, fmt::format("0.5*(1+tanh(({})/{}))", x, sharpness()));
  return fmt::format("v({})", node);
}

void Twin::refuse(std::string_view what, SourceSpan span) {
  diagnostics_.error("E-no-twin", span.known() ? span : instance().span,
                     fmt::format("{} has no equivalent in ngspice: {}", instance().name, what));
}

std::string voltage_text(const TwinEnds& ends) {
  if (ends.p == ends.n) return "0";
  if (ends.n == "0") return fmt::format("v({})", ends.p);
  if (ends.p == "0") return fmt::format("(-v({}))", ends.n);
  return fmt::format("v({},{})", ends.p, ends.n);
}

std::string current_text(std::string_view meter) { return fmt::format("i({})", meter); }

std::string term_text(double coefficient, std::string_view x) {
  if (coefficient == 0.0) return "";
  if (coefficient == 1.0) return fmt::format("+{}", x);
  return fmt::format("{}{}*{}", coefficient < 0.0 ? "" : "+", coefficient, x);
}

}  // namespace pwlsim::elements
