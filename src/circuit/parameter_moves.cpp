#include "circuit/parameter_moves.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/names.hpp"
#include "elements/conduction.hpp"
#include "elements/emission.hpp"

namespace pwlsim::circuit {
namespace {

using elements::Instance;
using elements::Model;
using elements::Values;
using model::NetworkMove;
using model::NetworkMoves;
using Moved = NetworkMove::Item;

/// The parts of the network that one element has become.
class Parts {
 public:
  Parts(const model::Network& network, const Instance& instance) : network_(network), name_(instance.name) {}

  [[nodiscard]] const model::Network& network() const { return network_; }
  [[nodiscard]] std::string part(std::string_view suffix) const { return suffix.empty() ? name_ : fmt::format("{} ({})", name_, suffix); }

  template <class List>
  [[nodiscard]] int find(const List& list, std::string_view suffix) const {
    const std::string label = part(suffix);
    const auto found = std::find_if(list.begin(), list.end(), [&](const auto& item) { return item.label.name == label; });
    return found == list.end() ? -1 : static_cast<int>(found - list.begin());
  }
  /// Those of the element itself and of its parts.
  template <class List, class Take>
  void each(const List& list, const Take& take) const {
    const std::string prefix = name_ + " (";
    for (std::size_t k = 0; k < list.size(); ++k)
      if (const std::string& label = list[k].label.name; label == name_ || label.starts_with(prefix)) take(static_cast<int>(k));
  }

 private:
  const model::Network& network_;
  std::string name_;
};

/// Adds what a change of one value of an element moves. False: that is not known.
class Slots {
 public:
  Slots(const model::Network& network, const Circuit& circuit, const Instance& instance)
      : parts_(network, instance),
        network_(network),
        instance_(instance),
        model_(instance.model >= 0 ? &circuit.models[static_cast<std::size_t>(instance.model)] : nullptr) {}

  bool element_value(std::string_view name, double p, NetworkMoves& moves) const {
    if (same_name(name, "m")) return multiplicity(p, moves);
    switch (instance_.kind->letter) {
      case 'R':
        return same_name(name, "R") ? resistor("", "R", p, moves) : series_or_parallel(name, p, moves);
      case 'L':
        if (same_name(name, "ic")) return initial(Moved::initial_current, parts_.find(network_.inductors, ""), p, moves);
        return same_name(name, "L") ? inductor("", "L", p, moves) : series_or_parallel(name, p, moves);
      case 'C':
        if (same_name(name, "ic")) return initial(Moved::initial_voltage, parts_.find(network_.capacitors, ""), p, moves);
        return same_name(name, "C") ? capacitor("", "C", p, moves) : series_or_parallel(name, p, moves);
      case 'K':
        parts_.each(network_.couplings, [&](int k) { moves.push_back({Moved::coupling, k, 0, p, {}}); });
        return same_name(name, "k");
      case 'V':
        return same_name(name, "Rser") ? branch_resistance(p, moves) : same_name(name, "Cpar") && capacitor("Cpar", "Cpar", p, moves);
      default:
        return false;
    }
  }

  bool model_value(std::string_view name, double p, NetworkMoves& moves) const {
    if (model_ == nullptr || model_->kind == nullptr) return false;
    const std::string_view type = model_->kind->type;
    if (type == "D") return diode_value(name, p, moves);
    if (type == "SW" || type == "CSW" || type == "VSWITCH" || type == "ISWITCH") return switch_value(name, p, moves);
    if (type == "NMOS" || type == "PMOS" || type == "VDMOS") return mosfet_value(name, p, moves);
    return false;
  }

  /// ": its tangents follow …", where the element has an exponential characteristic.
  [[nodiscard]] std::string tangent_note() const {
    std::string note;
    parts_.each(network_.diodes, [&](int k) {
      if (is_tangent(k)) note = ": its tangent follows an exponential model";
    });
    return note;
  }

  bool waveform_value(std::string_view name, double p, NetworkMoves& moves) const {
    if (!instance_.waveform) return false;
    std::optional<model::SourceFunction> d;
    if (const auto* pulse = std::get_if<model::Pulse>(&*instance_.waveform)) d = pulse_value(*pulse, name, p);
    if (std::holds_alternative<model::Sin>(*instance_.waveform)) d = sine_value(name, p);
    return d && add_source(*d, moves);
  }

  /// The value of a source without a waveform.
  bool constant_value(double p, NetworkMoves& moves) const {
    return instance_.waveform && std::holds_alternative<model::Dc>(*instance_.waveform) && add_source(model::Dc{p}, moves);
  }

  /// Its whole waveform, by the derivatives of all its numbers.
  bool source_moves(const model::SourceFunction& derivative, NetworkMoves& moves) const { return add_source(derivative, moves); }

  /// A sum of signals whose constant and coefficients move so. Each must have a term of its own in the law.
  bool formula(const elements::AffineSum& moved, NetworkMoves& moves) const {
    const bool is_current = instance_.formula_is_current;
    const int k = is_current ? parts_.find(network_.injections, "") : parts_.find(network_.branches, "");
    if (k < 0) return false;
    const model::LinearForm& law =
        is_current ? network_.injections[static_cast<std::size_t>(k)].current : network_.branches[static_cast<std::size_t>(k)].voltage;
    const auto add = [&](double derivative, double coefficient, const auto& is_own) {
      if (derivative == 0.0) return true;
      const auto found = std::find_if(law.begin(), law.end(), is_own);
      if (found == law.end() || coefficient == 0.0) return false;
      moves.push_back({is_current ? Moved::injection_term : Moved::branch_term,
                       k,
                       static_cast<int>(found - law.begin()),
                       derivative * found->coefficient / coefficient,
                       {}});
      return true;
    };
    const double constant = instance_.formula->value.constant;
    if (moved.constant != 0.0 && constant == 0.0) {  // its term is there all the same
      const auto found = std::find_if(law.begin(), law.end(), [](const model::Term& t) { return t.kind == model::Term::Kind::one; });
      if (found == law.end() || found->coefficient != 0.0) return false;
      moves.push_back(
          {is_current ? Moved::injection_term : Moved::branch_term, k, static_cast<int>(found - law.begin()), moved.constant, {}});
    } else if (!add(moved.constant, constant, [](const model::Term& t) { return t.kind == model::Term::Kind::one; })) {
      return false;
    }
    return std::all_of(moved.terms.begin(), moved.terms.end(), [&](const auto& term) {
      const auto& written = instance_.formula->value.terms;
      const auto own = std::find_if(written.begin(), written.end(), [&](const auto& other) { return other.first == term.first; });
      return own != written.end() && add(term.second, own->second, [&](const model::Term& t) { return is_part(term.first, t); });
    });
  }

  /// A gain, the only coefficient.
  bool gain(double p, NetworkMoves& moves) const {
    const auto& c = instance_.coefficients;
    if (c.size() != 2 || c[0] != 0.0 || c[1] == 0.0 || instance_.formula) return false;
    const char letter = instance_.kind->letter;
    const auto add = [&](Moved item, const auto& list, auto form) {
      const int k = parts_.find(list, "");
      if (k < 0) return false;
      const model::LinearForm& terms = list[static_cast<std::size_t>(k)].*form;
      for (std::size_t t = 0; t < terms.size(); ++t) moves.push_back({item, k, static_cast<int>(t), p * terms[t].coefficient / c[1], {}});
      return true;
    };
    if (letter == 'E' || letter == 'H') return add(Moved::branch_term, network_.branches, &model::Branch::voltage);
    return (letter == 'G' || letter == 'F') && add(Moved::injection_term, network_.injections, &model::Injection::current);
  }

 private:
  [[nodiscard]] double value(std::string_view name) const { return instance_.values.get(name); }

  /// Whether the term is that of a part of the formula.
  [[nodiscard]] bool is_part(int number, const model::Term& term) const {
    const elements::FormulaPart& part = instance_.formula->parts[static_cast<std::size_t>(number)];
    const auto index = static_cast<std::size_t>(part.index);
    if (part.kind == elements::FormulaPart::Kind::voltage)
      return term.kind == model::Term::Kind::node_voltage && term.index == instance_.control_nodes[index].p;
    const std::string& name = instance_.references[index].name;
    const auto is_named = [&](const auto& list) { return same_name(list[static_cast<std::size_t>(term.index)].label.name, name); };
    switch (term.kind) {
      case model::Term::Kind::branch_current:
        return is_named(network_.branches);
      case model::Term::Kind::inductor_current:
        return is_named(network_.inductors);
      case model::Term::Kind::capacitor_current:
        return is_named(network_.capacitors);
      case model::Term::Kind::resistor_current:
        return is_named(network_.resistors);
      default:
        return false;
    }
  }

  /// A number of the network that is proportional to a value of the card.
  template <class List, class Member>
  bool proportional(Moved item, const List& list, Member member, std::string_view part, double written, double p,
                    NetworkMoves& moves) const {
    const int k = parts_.find(list, part);
    if (k < 0 || written == 0.0) return false;
    moves.push_back({item, k, 0, p * list[static_cast<std::size_t>(k)].*member / written, {}});
    return true;
  }

  bool resistor(std::string_view part, std::string_view name, double p, NetworkMoves& moves) const {
    if (value(name) != 0.0)
      return proportional(Moved::resistance, network_.resistors, &model::Resistor::resistance, part, value(name), p, moves);
    const int k = parts_.find(network_.resistors, part);
    if (k >= 0) moves.push_back({Moved::resistance, k, 0, p / value("m"), {}});
    return k >= 0;
  }
  bool inductor(std::string_view part, std::string_view name, double p, NetworkMoves& moves) const {
    return proportional(Moved::inductance, network_.inductors, &model::Inductor::inductance, part, value(name), p, moves);
  }
  bool capacitor(std::string_view part, std::string_view name, double p, NetworkMoves& moves) const {
    return proportional(Moved::capacitance, network_.capacitors, &model::Capacitor::capacitance, part, value(name), p, moves);
  }

  bool series_or_parallel(std::string_view name, double p, NetworkMoves& moves) const {
    for (const std::string_view r : {"Rser", "Rpar"})
      if (same_name(name, r)) return resistor(r, r, p, moves);
    if (same_name(name, "Lser")) return inductor("Lser", "Lser", p, moves);
    return same_name(name, "Cpar") && capacitor("Cpar", "Cpar", p, moves);
  }

  /// So many in parallel.
  bool multiplicity(double p, NetworkMoves& moves) const {
    const char letter = instance_.kind->letter;
    if (letter != 'R' && letter != 'L' && letter != 'C' && letter != 'D') return false;
    const double share = p / value("m");
    parts_.each(network_.resistors, [&](int k) {
      moves.push_back({Moved::resistance, k, 0, -share * network_.resistors[static_cast<std::size_t>(k)].resistance, {}});
    });
    parts_.each(network_.inductors, [&](int k) {
      moves.push_back({Moved::inductance, k, 0, -share * network_.inductors[static_cast<std::size_t>(k)].inductance, {}});
    });
    parts_.each(network_.capacitors, [&](int k) {
      moves.push_back({Moved::capacitance, k, 0, share * network_.capacitors[static_cast<std::size_t>(k)].capacitance, {}});
    });
    parts_.each(network_.diodes, [&](int k) {
      moves.push_back({Moved::diode_resistance, k, 0, -share * network_.diodes[static_cast<std::size_t>(k)].resistance, {}});
    });
    bool is_whole = true;
    parts_.each(network_.injections, [&](int) { is_whole = false; });
    parts_.each(network_.diodes, [&](int k) { is_whole &= !is_tangent(k); });
    return is_whole;
  }

  static bool initial(Moved item, int index, double p, NetworkMoves& moves) {
    if (index >= 0) moves.push_back({item, index, 0, p, {}});
    return index >= 0;
  }

  bool branch_resistance(double p, NetworkMoves& moves) const {
    const int k = parts_.find(network_.branches, "");
    if (k < 0) return false;
    const model::LinearForm& form = network_.branches[static_cast<std::size_t>(k)].voltage;
    for (std::size_t t = 0; t < form.size(); ++t)
      if (form[t].kind == model::Term::Kind::branch_current && form[t].index == k) {
        moves.push_back({Moved::branch_term, k, static_cast<int>(t), p, {}});
        return true;
      }
    return false;
  }

  /// on·off/(off − on), in parallel with the leak `off`, is `on`.
  static double to_on(double on, double off) { return std::isinf(off) ? 1.0 : off / (off - on) * (off / (off - on)); }
  static double to_off(double on, double off) { return std::isinf(off) ? 0.0 : -on / (off - on) * (on / (off - on)); }

  bool contact(Moved item, int index, double p, NetworkMoves& moves) const {
    if ((item == Moved::diode_resistance || item == Moved::diode_drop) && index >= 0 && is_tangent(index)) return false;
    if (index >= 0 && p != 0.0) moves.push_back({item, index, 0, p, {}});
    return index >= 0;
  }

  /// Of an exponential characteristic, whose current decides where it is taken.
  [[nodiscard]] bool is_tangent(int diode) const { return network_.diodes[static_cast<std::size_t>(diode)].law.has_value(); }

  bool leak(double p, NetworkMoves& moves) const {
    const int k = parts_.find(network_.resistors, "Roff");
    if (k >= 0) moves.push_back({Moved::resistance, k, 0, p, {}});
    return k >= 0;
  }

  bool diode_value(std::string_view name, double p, NetworkMoves& moves) const {
    const Values& v = model_->values;
    const double m = value("m"), off = v.get("Roff");
    const int forward = parts_.find(network_.diodes, ""), reverse = parts_.find(network_.diodes, "reverse");
    if (instance_.nodes.size() > 2 || !std::isinf(v.get("Ilimit")) || !std::isinf(v.get("Revilimit"))) return false;
    if (same_name(name, "Ron")) return contact(Moved::diode_resistance, forward, p * to_on(v.get("Ron"), off) / m, moves);
    if (same_name(name, "Rrev")) return reverse < 0 || contact(Moved::diode_resistance, reverse, p * to_on(v.get("Rrev"), off) / m, moves);
    if (same_name(name, "Vfwd")) return contact(Moved::diode_drop, forward, p, moves);
    if (same_name(name, "Vrev")) return contact(Moved::diode_drop, reverse, p, moves);
    if (!same_name(name, "Roff") || !leak(p / m, moves)) return false;
    (void)contact(Moved::diode_resistance, forward, p * to_off(v.get("Ron"), off) / m, moves);
    (void)contact(Moved::diode_resistance, reverse, p * to_off(v.get("Rrev"), off) / m, moves);
    return true;
  }

  bool levels(double on, double off, NetworkMoves& moves) const {
    const int k = parts_.find(network_.switches, "");
    if (k < 0) return false;
    if (on != 0.0) moves.push_back({Moved::on_level, k, 0, on, {}});
    if (off != 0.0) moves.push_back({Moved::off_level, k, 0, off, {}});
    return true;
  }

  bool switch_value(std::string_view name, double p, NetworkMoves& moves) const {
    const Values& v = model_->values;
    const std::string_view type = model_->kind->type;
    const int contact_index = parts_.find(network_.switches, "");
    if (same_name(name, "Vser")) return drop(contact_index, p, moves);
    if (same_name(name, "Lser")) {
      const int k = parts_.find(network_.inductors, "Lser");
      if (k >= 0) moves.push_back({Moved::inductance, k, 0, p, {}});
      return k >= 0;
    }
    const bool is_swapped = v.get("Ron") > v.get("Roff");
    const double low = std::min(v.get("Ron"), v.get("Roff")), high = std::max(v.get("Ron"), v.get("Roff"));
    if (same_name(name, is_swapped ? "Roff" : "Ron")) return contact(Moved::switch_resistance, contact_index, p * to_on(low, high), moves);
    if (same_name(name, is_swapped ? "Ron" : "Roff"))
      return leak(p, moves) && (contact(Moved::switch_resistance, contact_index, p * to_off(low, high), moves) || true);
    const bool is_around =
        type == "SW" || type == "CSW" || (type == "VSWITCH" && (v.has("Vt") || (v.has("Vh") && !v.has("Von") && !v.has("Voff"))));
    if (is_around && (same_name(name, "Vt") || same_name(name, "It"))) return levels(p, p, moves);
    if (is_around && (same_name(name, "Vh") || same_name(name, "Ih"))) return levels(p, -p, moves);
    if (is_around) return false;
    const bool is_voltage = type == "VSWITCH";
    const bool is_on = same_name(name, is_voltage ? "Von" : "Ion"), is_off = same_name(name, is_voltage ? "Voff" : "Ioff");
    if (!is_on && !is_off) return false;
    const bool is_upright = is_voltage ? v.get("Von") >= v.get("Voff") : v.get("Ion") >= v.get("Ioff");
    const double scale = is_upright ? p : -p;
    return levels(is_on ? scale : 0.0, is_off ? scale : 0.0, moves);
  }

  /// Its Ron and its threshold where it is a switch, and its body diodes.
  bool mosfet_value(std::string_view name, double p, NetworkMoves& moves) const {
    const Values& v = model_->values;
    const int channel = parts_.find(network_.switches, "");
    const double m = value("m");
    const bool is_drop = same_name(name, "Vfwd");
    if (is_drop || same_name(name, "Rfwd")) {
      bool any = false;
      for (const std::string_view part : {"body diode", "bulk diode"})
        if (const int k = parts_.find(network_.diodes, part); k >= 0)
          any = contact(is_drop ? Moved::diode_drop : Moved::diode_resistance, k, is_drop ? p : p / m, moves) || any;
      return any;
    }
    if (instance_.drive_is_apart || channel < 0) return false;
    if (same_name(name, "Ron") && v.has("Ron")) return contact(Moved::switch_resistance, channel, p / m, moves);
    const bool is_p_type = model_->kind->type == "PMOS" || (model_->kind->type == "VDMOS" && v.has("pchan"));
    return same_name(name, "Vto") && v.has("Ron") && levels(is_p_type ? -p : p, is_p_type ? -p : p, moves);
  }

  bool drop(int contact_index, double p, NetworkMoves& moves) const {
    if (std::isinf(std::max(model_->values.get("Ron"), model_->values.get("Roff"))))
      return contact(Moved::switch_drop, contact_index, p, moves);
    const int k = parts_.find(network_.branches, "Vser");
    if (k >= 0) moves.push_back({Moved::branch_term, k, 0, p, {}});
    return k >= 0;
  }

  bool add_source(const model::SourceFunction& derivative, NetworkMoves& moves) const {
    const int k = parts_.find(network_.sources, "");
    if (k >= 0) moves.push_back({Moved::source, k, 0, 0.0, derivative});
    return k >= 0;
  }

  static std::optional<model::SourceFunction> pulse_value(const model::Pulse& f, std::string_view name, double p) {
    model::Pulse d{0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
    if (same_name(name, "V1"))
      d.initial = p;
    else if (same_name(name, "V2"))
      d.pulsed = p;
    else if (same_name(name, "Td"))
      d.delay = p;
    else if (same_name(name, "Tr") && f.rise > 0.0)
      d.rise = p;
    else if (same_name(name, "Tf") && f.fall > 0.0)
      d.fall = p;
    else if (same_name(name, "Ton") && !std::isinf(f.width))
      d.width = p;
    else if (same_name(name, "Tper") && !std::isinf(f.period))
      d.period = p;
    else
      return std::nullopt;
    return d;
  }

  static std::optional<model::SourceFunction> sine_value(std::string_view name, double p) {
    model::Sin d{0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
    if (same_name(name, "Voff"))
      d.offset = p;
    else if (same_name(name, "Vamp"))
      d.amplitude = p;
    else if (same_name(name, "Freq"))
      d.frequency = p;
    else if (same_name(name, "Td"))
      d.delay = p;
    else if (same_name(name, "Theta"))
      d.damping = p;
    else if (same_name(name, "Phi"))
      d.phase = p * (std::acos(-1.0) / 180.0);
    else
      return std::nullopt;
    return d;
  }

  Parts parts_;
  const model::Network& network_;
  const Instance& instance_;
  const Model* model_;
};

/// "S1" and "Vt" of "S1:Vt", "C1" and "ic" of "ic(C1)".
struct SlotName {
  std::string element, value;
};

SlotName slot_name(const std::string& name) {
  const std::size_t open = name.find('(');
  if (open != std::string::npos && name.back() == ')') return {name.substr(open + 1, name.size() - open - 2), name.substr(0, open)};
  const std::size_t colon = name.rfind(':');
  if (colon != std::string::npos) return {name.substr(0, colon), name.substr(colon + 1)};
  return {name, ""};
}

class Follower {
 public:
  Follower(Circuit& circuit, const model::Network& network, Reporter& reporter)
      : circuit_(circuit), network_(network), reporter_(reporter), card_(*circuit.analyses.sensitivities) {}

  void run() {
    for (Sensitivities::Parameter& parameter : card_.parameters)
      if (parameter.number < 0) follow_element(parameter);
    for (const Instance& instance : circuit_.instances) follow_numbers(instance);
    for (const InitialCondition& condition : circuit_.conditions) follow_condition(condition);
    for (const elements::Written& number : circuit_.unfollowed) give_up(number.gradient, reporter_.text(number.span), "");
  }

 private:
  [[nodiscard]] const Instance* find(const std::string& name) const {
    const auto same = [&](const Instance& i) {
      return i.name.size() == name.size() && std::equal(name.begin(), name.end(), i.name.begin(), [](char a, char b) {
               const auto plain = [](char c) { return c == ':' ? '.' : c; };
               return same_name({&a, 1}, {&b, 1}) || plain(a) == plain(b);
             });
    };
    const auto found = std::find_if(circuit_.instances.begin(), circuit_.instances.end(), same);
    return found == circuit_.instances.end() ? nullptr : &*found;
  }

  void unknown(const Sensitivities::Parameter& parameter, std::string_view why) {
    reporter_.error("E-sens-unknown-parameter", parameter.span, fmt::format("{}", why));
  }

  void follow_element(Sensitivities::Parameter& parameter) {
    // An element within a subcircuit may be written X1:R1.
    const Instance* instance = find(parameter.name);
    const SlotName slot = instance != nullptr ? SlotName{parameter.name, ""} : slot_name(parameter.name);
    if (instance == nullptr) instance = find(slot.element);
    if (instance == nullptr || instance->kind == nullptr) return unknown_name(parameter, slot);
    if (slot.value.empty()) return follow_main(parameter, *instance);
    follow_value(parameter, *instance, slot.value);
  }

  void unknown_name(const Sensitivities::Parameter& parameter, const SlotName& slot) {
    std::vector<std::string> names;
    for (const Instance& instance : circuit_.instances) names.push_back(instance.name);
    for (const std::string& name : circuit_.parameter_names) names.push_back(name);
    std::string cure = suggestion(slot.element, names);
    constexpr std::size_t most_named = 8;
    if (cure.empty() && names.size() <= most_named) cure = fmt::format("; try {}", fmt::join(names, ", "));
    unknown(parameter, fmt::format("'{}' is neither a parameter nor an element{}", slot.element, cure));
  }

  void follow_main(Sensitivities::Parameter& parameter, const Instance& instance) {
    const Slots slots(network_, circuit_, instance);
    const char letter = instance.kind->letter;
    bool done = false;
    if (letter == 'V' || letter == 'I') {
      if (const auto* dc = instance.waveform ? std::get_if<model::Dc>(&*instance.waveform) : nullptr) parameter.value = dc->value;
      done = slots.constant_value(1.0, parameter.moves);
    } else if (letter == 'E' || letter == 'F' || letter == 'G' || letter == 'H') {
      if (instance.coefficients.size() == 2) parameter.value = instance.coefficients[1];
      done = slots.gain(1.0, parameter.moves);
    } else if ((letter == 'R' || letter == 'L' || letter == 'C' || letter == 'K') && !instance.values.table().empty()) {
      const std::string_view name = instance.values.table().front().name;
      parameter.value = instance.values.get(name);
      done = slots.element_value(name, 1.0, parameter.moves);
    }
    if (!done) unknown(parameter, fmt::format("{} has no single value to vary{}", instance.name, values_of(instance)));
  }

  /// "; try S1:Ron, S1:Vt"
  [[nodiscard]] std::string values_of(const Instance& instance) const {
    std::vector<std::string> names;
    const Slots slots(network_, circuit_, instance);
    NetworkMoves scratch;
    const auto add = [&](elements::ParameterTable table, auto accepts) {
      for (const elements::Parameter& value : table)
        if (accepts(value.name)) names.push_back(fmt::format("{}:{}", instance.name, value.name));
    };
    add(instance.waveform_values.table(), [&](std::string_view name) { return slots.waveform_value(name, 1.0, scratch); });
    if (instance.model >= 0)
      add(circuit_.models[static_cast<std::size_t>(instance.model)].values.table(),
          [&](std::string_view name) { return slots.model_value(name, 1.0, scratch); });
    add(instance.values.table(), [&](std::string_view name) { return slots.element_value(name, 1.0, scratch); });
    return names.empty() ? std::string() : fmt::format("; try {}", fmt::join(names, ", "));
  }

  void follow_value(Sensitivities::Parameter& parameter, const Instance& instance, const std::string& name) {
    const Slots slots(network_, circuit_, instance);
    const auto known = [&](const Values& values) { return elements::find_parameter(values.table(), name) != nullptr; };
    if (same_name(name, "dc") && slots.constant_value(1.0, parameter.moves)) {
      parameter.value = std::get<model::Dc>(*instance.waveform).value;
      return;
    }
    if (known(instance.waveform_values) && slots.waveform_value(name, 1.0, parameter.moves)) {
      parameter.value = instance.waveform_values.get(name);
      return;
    }
    const Model* model = instance.model >= 0 ? &circuit_.models[static_cast<std::size_t>(instance.model)] : nullptr;
    if (model != nullptr && known(model->values) && slots.model_value(name, 1.0, parameter.moves)) {
      parameter.value = model->values.get(name);
      return;
    }
    if (known(instance.values) && slots.element_value(name, 1.0, parameter.moves)) {
      parameter.value = instance.values.get(name);
      return;
    }
    unknown(parameter,
            fmt::format("{} has no value '{}' that can be varied{}{}", instance.name, name, slots.tangent_note(), values_of(instance)));
  }

  void give_up(const std::vector<double>& gradient, std::string_view text, const std::string& element) {
    for (Sensitivities::Parameter& parameter : card_.parameters) {
      if (parameter.number < 0 || static_cast<std::size_t>(parameter.number) >= gradient.size()) continue;
      if (gradient[static_cast<std::size_t>(parameter.number)] == 0.0 || !parameter.failure.empty()) continue;
      const std::string where = element.empty() ? fmt::format("'{}'", text)
                                : text.empty()  ? element
                                                : fmt::format("'{}' of {}", text, element);
      parameter.failure = fmt::format("{} depends on it in a way that is not followed", where);
    }
  }

  /// Numbers of the card, and of its model.
  void follow_numbers(const Instance& instance) {
    if (instance.kind == nullptr) return;
    const Slots slots(network_, circuit_, instance);
    for (Sensitivities::Parameter& parameter : card_.parameters) {
      if (parameter.number < 0 || static_cast<std::size_t>(parameter.number) >= instance.waveform_moves.size()) continue;
      const auto& moved = instance.waveform_moves[static_cast<std::size_t>(parameter.number)];
      if (moved && parameter.failure.empty()) (void)slots.source_moves(*moved, parameter.moves);
    }
    for (Sensitivities::Parameter& parameter : card_.parameters) {
      if (parameter.number < 0 || static_cast<std::size_t>(parameter.number) >= instance.formula_moves.size()) continue;
      const elements::AffineSum& moved = instance.formula_moves[static_cast<std::size_t>(parameter.number)];
      if (parameter.failure.empty() && !slots.formula(moved, parameter.moves))
        parameter.failure = fmt::format("{} depends on it, which is not followed", instance.name);
    }
    for (const elements::Written& number : instance.written) {
      const auto name = name_of(number, instance.values), waveform = name_of(number, instance.waveform_values);
      distribute(instance, number, [&](double p, NetworkMoves& moves) {
        if (!name.empty()) return slots.element_value(name, p, moves);
        if (!waveform.empty()) return slots.waveform_value(waveform, p, moves);
        if (!number.span.known() || instance.written.size() != 1) return false;
        const char letter = instance.kind->letter;
        return letter == 'V' || letter == 'I' ? slots.constant_value(p, moves) : slots.gain(p, moves);
      });
    }
    if (instance.model < 0) return;
    const Model& model = circuit_.models[static_cast<std::size_t>(instance.model)];
    for (const elements::Written& number : model.written) {
      const auto name = name_of(number, model.values);
      distribute(instance, number, [&](double p, NetworkMoves& moves) { return !name.empty() && slots.model_value(name, p, moves); });
    }
  }

  static std::string name_of(const elements::Written& number, const Values& values) {
    if (!number.span.known()) return "";
    for (const Values::Given& given : values.all())
      if (given.span.file == number.span.file && given.span.begin == number.span.begin && given.span.end == number.span.end &&
          given.list.size() == 1)
        return std::string(given.parameter->name);
    return "";
  }

  template <class Add>
  void distribute(const Instance& instance, const elements::Written& number, const Add& add) {
    for (Sensitivities::Parameter& parameter : card_.parameters) {
      if (parameter.number < 0 || static_cast<std::size_t>(parameter.number) >= number.gradient.size()) continue;
      const double p = number.gradient[static_cast<std::size_t>(parameter.number)];
      if (p == 0.0 || !parameter.failure.empty()) continue;
      if (!std::isfinite(p))
        parameter.failure = fmt::format("'{}' of {} has no derivative to it", reporter_.text(number.span), instance.name);
      else if (!add(p, parameter.moves))
        give_up(number.gradient, number.span.known() ? reporter_.text(number.span) : std::string_view(), instance.name);
    }
  }

  /// Of several for one node or inductor the network has the last.
  void follow_condition(const InitialCondition& condition) {
    const auto add = [&](const auto& list, Moved item) {
      for (std::size_t i = 0; i < list.size(); ++i) {
        const SourceSpan& span = list[i].label.span;
        if (span.file != condition.span.file || span.begin != condition.span.begin) continue;
        for (Sensitivities::Parameter& parameter : card_.parameters) {
          if (parameter.number < 0 || static_cast<std::size_t>(parameter.number) >= condition.gradient.size()) continue;
          const double p = condition.gradient[static_cast<std::size_t>(parameter.number)];
          if (p != 0.0) parameter.moves.push_back({item, static_cast<int>(i), 0, p, {}});
        }
      }
    };
    if (condition.is_current)
      add(network_.current_conditions, Moved::current_condition);
    else
      add(network_.node_conditions, Moved::node_condition);
  }

  Circuit& circuit_;
  const model::Network& network_;
  Reporter& reporter_;
  Sensitivities& card_;
};

}  // namespace

void follow_parameters(Circuit& circuit, const model::Network& network, Reporter& reporter) {
  if (circuit.analyses.sensitivities) Follower(circuit, network, reporter).run();
}

}  // namespace pwlsim::circuit
