#include "random_decks/deck_elements.hpp"

#include <fmt/format.h>

#include <array>

namespace pwlsim::test {
namespace {

bool can_control(char letter) { return letter != 'F' && letter != 'K' && letter != 'X' && letter != 'A'; }

}  // namespace

std::string DeckElements::name(DeckScope& scope, char letter) {
  const std::string result = fmt::format("{}{}", letter, ++count_);
  if (letter == 'L') scope.inductors.push_back(result);
  if (can_control(letter)) scope.measurable.push_back(result);
  scope.elements.push_back(result);
  return result;
}

std::pair<std::string, std::string> DeckElements::two_nodes(const DeckScope& scope) {
  const std::string p = formulas_.node(scope);
  std::string n = formulas_.node(scope);
  for (int tries = 0; tries < 5 && n == p; ++tries) n = formulas_.node(scope);
  return {p, n};
}

void DeckElements::add_connection(DeckScope& scope, const std::string& from, const std::string& to, std::string_view letters) {
  const std::string nodes = random_.chance(0.5) ? fmt::format("{} {}", from, to) : fmt::format("{} {}", to, from);
  const char letter = random_.one_of(letters);
  if (letter == 'D') return diode(scope, nodes);
  if (letter != 'V') return two_terminal(scope, letter, nodes);
  const std::string card = name(scope, 'V');
  scope.lines.push_back(
      fmt::format("{} {} {}{}", card, nodes, waveform(scope, false), random_.chance(0.5) ? " Rser=" + values_.resistance({}) : ""));
}

void DeckElements::add(DeckScope& scope, char letter) {
  const auto [p, n] = two_nodes(scope);
  const std::string nodes = fmt::format("{} {}", p, n);
  switch (letter) {
    case 'R':
    case 'C':
    case 'L':
      return two_terminal(scope, letter, nodes);
    case 'V':
    case 'I':
      return source(scope, letter);
    case 'K':
      return coupling(scope);
    case 'E':
    case 'G':
    case 'F':
    case 'H':
      return controlled(scope, letter);
    case 'B':
      return formula(scope);
    case 'D':
      return diode(scope, nodes);
    case 'S':
    case 'W':
      return controlled_switch(scope, letter);
    case 'A':
      return block(scope);
    case 'X':
      return library_part(scope);
    default:
      return transistor(scope, letter);
  }
}

std::string DeckElements::some_of(std::string_view parameters, double chance) {
  std::string result;
  while (!parameters.empty()) {
    const std::size_t end = std::min(parameters.find('|'), parameters.size());
    if (random_.chance(chance)) result += fmt::format(" {}", parameters.substr(0, end));
    parameters.remove_prefix(std::min(end + 1, parameters.size()));
  }
  return result;
}

void DeckElements::two_terminal(DeckScope& scope, char letter, const std::string& nodes) {
  const std::string card = name(scope, letter);
  const auto& known = scope.parameters;
  const std::string value = letter == 'R'   ? values_.resistance(known)
                            : letter == 'C' ? values_.capacitance(known)
                                            : values_.inductance(known);
  std::string text = fmt::format("{} {} ", card, nodes);
  if (random_.chance(0.04)) {
    const std::string type = letter == 'R' ? "RES" : letter == 'C' ? "CAP" : "IND";
    const std::string used = model(scope, type);
    text += random_.chance(0.5) ? fmt::format("{} {}", used, value) : fmt::format("{} {}", value, used);
  } else {
    text += random_.chance(0.1) ? fmt::format("{}={}", letter, value) : value;
  }
  if (letter != 'R' && random_.chance(0.3)) text += fmt::format(" ic={}", letter == 'C' ? values_.volts() : values_.amperes());
  if (random_.chance(0.1))
    text += some_of(fmt::format("Rser={}|Rpar={}|Cpar={}|Lser={}|m=2|tc1=1m|temp=50", values_.resistance({}), values_.resistance({}),
                                values_.capacitance({}), values_.inductance({})),
                    0.3);
  scope.lines.push_back(std::move(text));
}

std::string DeckElements::pwl() {
  std::string points = "(0 " + values_.volts();
  double time = 0.0;
  for (int count = random_.whole(1, 5); count > 0; --count) {
    if (!random_.chance(0.15)) time += random_.between(0.3, 5.0);
    points += fmt::format(" {} {}", values_.time(time, time), values_.volts());
  }
  points += ")";
  if (random_.chance(0.2)) return fmt::format("PWL REPEAT FOREVER {} ENDREPEAT", points);
  if (random_.chance(0.1)) return fmt::format("PWL REPEAT FOR {} {} ENDREPEAT", random_.whole(1, 4), points);
  return "PWL" + points + (random_.chance(0.2) ? " r=0" : "") + (random_.chance(0.1) ? " td=" + values_.time(0.0, 3.0) : "");
}

std::string DeckElements::waveform(const DeckScope& scope, bool current) {
  const auto level = [&] { return current ? values_.current(scope.parameters) : values_.voltage(scope.parameters); };
  switch (random_.whole(0, 7)) {
    case 0:
      return "DC " + level();
    case 1:
      return level();
    case 2:
    case 3:
      return fmt::format("SIN({} {} {}{})", random_.chance(0.7) ? "0" : level(), level(), values_.frequency(0.05, 1.0),
                         random_.chance(0.3) ? fmt::format(" {} {} {} {}", values_.time(0.0, 3.0), values_.frequency(0.0, 0.2),
                                                           random_.whole(-180, 180), random_.whole(0, 5))
                                             : "");
    case 4:
      return pwl();
    case 5:
      return fmt::format("EXP({} {} {} {}{})", level(), level(), values_.time(0.0, 2.0), values_.time(0.1, 5.0),
                         random_.chance(0.5) ? fmt::format(" {} {}", values_.time(2.0, 9.0), values_.time(0.1, 5.0)) : "");
    default:
      return fmt::format("PULSE({} {} {} {} {} {} {}{})", random_.chance(0.7) ? "0" : level(), level(),
                         random_.chance(0.5) ? "0" : values_.time(0.0, 3.0), random_.chance(0.6) ? "0" : values_.time(0.01, 0.3),
                         random_.chance(0.6) ? "0" : values_.time(0.01, 0.3), values_.time(0.3, 3.0),
                         random_.chance(0.1) ? "0" : values_.time(2.0, 6.0), random_.chance(0.1) ? " 3" : "");
  }
}

void DeckElements::source(DeckScope& scope, char letter) {
  const auto [p, n] = two_nodes(scope);
  const std::string card = name(scope, letter);
  std::string text = fmt::format("{} {} {} ", card, p, n);
  if (random_.chance(0.1)) text += "DC " + values_.volts() + " ";
  if (random_.chance(0.05)) text += "AC 1 ";
  text += waveform(scope, letter == 'I');
  if (letter == 'V' && random_.chance(0.8)) text += " Rser=" + values_.resistance({});
  scope.lines.push_back(std::move(text));
}

void DeckElements::coupling(DeckScope& scope) {
  while (scope.inductors.size() < 2) add(scope, 'L');
  const std::string a = random_.one_of(scope.inductors);
  std::string b = random_.one_of(scope.inductors);
  for (int tries = 0; tries < 5 && a == b; ++tries) b = random_.one_of(scope.inductors);
  const std::string k = random_.one_of(std::array<std::string, 6>{"1", "-1", "0.999", "0.5", "0", "-0.3"});
  scope.lines.push_back(fmt::format("{} {} {} {}", name(scope, 'K'), a, b, k));
}

std::pair<std::string, std::string> DeckElements::output_nodes(DeckScope& scope, bool voltage) {
  if (!voltage || random_.chance(0.2)) return two_nodes(scope);
  const std::string node = fmt::format("o{}", ++count_);
  add_connection(scope, node, formulas_.node(scope), "RRRRRLD");
  scope.nodes.push_back(node);
  return {node, scope.nodes.front()};
}

void DeckElements::controlled(DeckScope& scope, char letter) {
  const auto [p, n] = output_nodes(scope, letter == 'E' || letter == 'H');
  const bool by_voltage = letter == 'E' || letter == 'G';
  if (!by_voltage && scope.measurable.empty()) add(scope, 'V');
  const auto control = [&] { return by_voltage ? fmt::format("{} {}", formulas_.node(scope), formulas_.node(scope)) : element(scope); };
  const std::string begin = fmt::format("{} {} ", p, n);
  std::string rest;
  const double form = random_.unit();
  if (form < 0.7) {
    rest = fmt::format("{} {}", control(), values_.gain(scope.parameters));
  } else if (form < 0.8) {
    rest = fmt::format("POLY(2) {} {} {} {} {}", control(), control(), values_.factor(), values_.factor(), values_.factor());
  } else if (form < 0.9) {
    rest = fmt::format("value={{{}}}", formulas_.of_signals(scope, 2));
  } else {
    rest = fmt::format("TABLE {{{}}} = (-1,{}) (0,{}) (2,{})", formulas_.of_signals(scope, 1), values_.factor(), values_.factor(),
                       values_.volts());
  }
  scope.lines.push_back(fmt::format("{} {}{}", name(scope, letter), begin, rest));
}

void DeckElements::formula(DeckScope& scope) {
  const bool voltage = random_.chance(0.6);
  const auto [p, n] = output_nodes(scope, voltage);
  const std::string expression = formulas_.of_signals(scope, random_.whole(1, 3));
  scope.lines.push_back(fmt::format("{} {} {} {}={{{}}}", name(scope, 'B'), p, n, voltage ? "V" : "I", expression));
}

void DeckElements::diode(DeckScope& scope, const std::string& nodes) {
  const std::string type = model(scope, "D");
  scope.lines.push_back(fmt::format("{} {} {}{}", name(scope, 'D'), nodes, type, some_of("m=2|area=3|off", 0.04)));
}

void DeckElements::controlled_switch(DeckScope& scope, char letter) {
  const auto [p, n] = two_nodes(scope);
  if (letter == 'W' && scope.measurable.empty()) add(scope, 'V');
  const std::string control = letter == 'S' ? fmt::format("{} {}", formulas_.node(scope), formulas_.node(scope)) : element(scope);
  const std::string type = model(scope, letter == 'S' ? random_.one_of(std::array<std::string, 2>{"SW", "VSWITCH"})
                                                      : random_.one_of(std::array<std::string, 2>{"CSW", "ISWITCH"}));
  scope.lines.push_back(fmt::format("{} {} {} {} {}{}", name(scope, letter), p, n, control, type,
                                    random_.chance(0.2) ? random_.one_of(std::array{" on", " off", " ON"}) : ""));
}

void DeckElements::transistor(DeckScope& scope, char letter) {
  const auto [p, n] = two_nodes(scope);
  const std::string gate = formulas_.node(scope);
  const std::string type = letter == 'M'   ? random_.one_of(std::array<std::string, 3>{"VDMOS", "NMOS", "PMOS"})
                           : letter == 'J' ? random_.one_of(std::array<std::string, 2>{"NJF", "PJF"})
                                           : random_.one_of(std::array<std::string, 2>{"NPN", "PNP"});
  const std::string used = model(scope, type);
  const std::string bulk = letter == 'M' && random_.chance(0.4) ? " " + formulas_.node(scope) : "";
  scope.lines.push_back(fmt::format("{} {} {} {}{} {}{}", name(scope, letter), p, gate, n, bulk, used,
                                    letter == 'M' && type != "VDMOS" ? some_of("W=10u|L=1u|m=2|AD=1p", 0.2) : ""));
}

void DeckElements::block(DeckScope& scope) {
  static const std::vector<std::string> types{"gain",     "summer",   "limit", "hyst",   "pwl", "relay",
                                              "deadzone", "friction", "int",   "s_xfer", "d_dt"};
  const std::string type = random_.one_of(types);
  const auto port = [&]() -> std::string {
    switch (random_.whole(0, 8)) {
      case 0:
        return fmt::format("%vd({},{})", formulas_.node(scope), formulas_.node(scope));
      case 1:
        return "%i " + formulas_.node(scope);
      case 2:
        return fmt::format("%id({},{})", formulas_.node(scope), formulas_.node(scope));
      case 3:
        return "%v " + formulas_.node(scope);
      default:
        return formulas_.node(scope);
    }
  };
  std::string input = type == "summer" ? fmt::format("[{} {}]", formulas_.node(scope), formulas_.node(scope)) : port();
  if (type != "summer" && !scope.measurable.empty() && random_.chance(0.1)) input = "%vnam " + element(scope);
  const std::string used = model(scope, type);
  const std::string output = random_.chance(0.2) ? port() : output_nodes(scope, true).first;
  scope.lines.push_back(fmt::format("{} {} {} {}", name(scope, 'A'), input, output, used));
}

void DeckElements::library_part(DeckScope& scope) {
  struct DrawnElement {
    const char* name;
    int nodes;
    const char* parameters;
  };
  static const std::vector<DrawnElement> parts{{"mosfet", 3, "ron=10m|vth=1|vh=0.1|vf=0.7|rd=1m"},
                                               {"igbt", 3, "ron=10m|vce=0.7|vth=5|vf=1|rd=10m"},
                                               {"thyristor", 3, "ron=1m|vf=0.8|vgt=1|ih=10m"},
                                               {"opamp", 3, "aol=1e5|gbw=1Meg|vmax=15|vmin=-15"},
                                               {"opamp5", 5, "aol=1e4|gbw=10k"},
                                               {"xfmr", 4, "n=3"}};
  const DrawnElement& part = random_.one_of(parts);
  std::string text = name(scope, 'X');
  // The last node is the output of an amplifier.
  for (int count = part.nodes; count > 0; --count) text += " " + (count == 1 ? output_nodes(scope, true).first : formulas_.node(scope));
  scope.lines.push_back(fmt::format("{} {}{}", text, part.name, some_of(part.parameters, 0.35)));
}

std::string DeckElements::model(DeckScope& scope, const std::string& type) {
  std::vector<std::string>& known = scope.models[type];
  if (!known.empty() && random_.chance(0.6)) return random_.one_of(known);
  const std::string result = fmt::format("m{}{}", type, ++count_);
  const std::string parameters = model_parameters(scope, type);
  const std::string base = !known.empty() && random_.chance(0.1) ? "ako:" + known.front() + " " : "";
  scope.lines.push_back(random_.chance(0.8) ? fmt::format(".model {} {}{}({} )", result, base, type, parameters)
                                            : fmt::format(".model {} {}{}{}", result, base, type, parameters));
  known.push_back(result);
  return result;
}

std::string DeckElements::switch_parameters(const DeckScope& scope, std::string_view type) {
  const std::string resistances = fmt::format("Ron={}|Roff={}|Lser={}|Vser={}", values_.factor(), values_.resistance(scope.parameters),
                                              values_.inductance({}), values_.volts());
  const bool by_levels = type == "VSWITCH" || type == "ISWITCH";
  const char quantity = type == "SW" || type == "VSWITCH" ? 'V' : 'I';
  const std::string levels = by_levels ? fmt::format("{0}on={1}|{0}off={2}", quantity, values_.volts(), values_.volts())
                                       : fmt::format("{0}t={1}|{0}h={2}", quantity, values_.volts(), values_.factor());
  return some_of(resistances, 0.2) + some_of(levels, 0.6);
}

std::string DeckElements::block_parameters(std::string_view type) {
  const std::string a = values_.factor(), b = values_.factor();
  if (type == "gain") return some_of(fmt::format("gain={}|in_offset={}|out_offset={}", values_.gain({}), a, b), 0.5);
  if (type == "summer") return some_of(fmt::format("in_gain=[{} -{}]|out_gain={}|in_offset=[0 1]|out_offset=1", a, b, a), 0.4);
  if (type == "limit")
    return some_of(fmt::format("gain={}|out_lower_limit=-{}|out_upper_limit={}|in_offset=1", values_.gain({}), a, b), 0.5);
  if (type == "hyst") return some_of(fmt::format("in_low=-{}|in_high={}|hyst={}|out_lower_limit=-1|out_upper_limit=2", a, b, a), 0.5);
  if (type == "pwl") return fmt::format(" x_array=[-1 0 {}] y_array=[-{} 0 {}]", a, b, a);
  if (type == "relay") return some_of(fmt::format("level={}", a), 0.5);
  if (type == "deadzone") return some_of(fmt::format("d={}|level={}", a, b), 0.5);
  if (type == "friction") return some_of(fmt::format("fc={}", a), 0.5);
  if (type == "int")
    return some_of(fmt::format("gain={}|out_lower_limit=-{}|out_upper_limit={}|out_ic=0.1", values_.frequency(0.1, 1.0), a, b), 0.6);
  if (type == "s_xfer")
    return fmt::format(" num_coeff=[{}] den_coeff=[1 {} {}] denormalized_freq={}", a, b, a, values_.frequency(0.1, 1.0));
  return fmt::format(" gain={}", values_.time(0.1, 1.0));
}

std::string DeckElements::model_parameters(const DeckScope& scope, std::string_view type) {
  if (type == "SW" || type == "CSW" || type == "VSWITCH" || type == "ISWITCH") return switch_parameters(scope, type);
  if (type == "RES") return fmt::format(" R={}", values_.factor());
  if (type == "CAP") return fmt::format(" C={}", values_.factor());
  if (type == "IND") return fmt::format(" L={}", values_.factor());
  if (type == "D") {
    if (random_.chance(0.45)) return "";
    if (random_.chance(0.3)) return some_of("IS=1e-14|N=1.8|RS=0.1|BV=100|CJO=10p|TT=1n|M=0.5", 0.5);
    return some_of(fmt::format("Ron={}|Roff={}|Vfwd={}|Vrev={}|Rrev={}", values_.factor(), values_.resistance(scope.parameters),
                               values_.factor(), values_.factor(), values_.factor()),
                   0.35);
  }
  if (type == "VDMOS") return some_of("Vto=3|Kp=20|Rd=10m|Rs=5m|Ron=20m|Is=1e-12|Rb=5m|BV=60|pchan|Cgs=1n", 0.4);
  if (type == "NMOS" || type == "PMOS") return some_of("level=1|Vto=1|Kp=50u|tox=20n|Rd=1|Is=1p|W=10u|L=1u|lambda=0.01", 0.4);
  if (type == "NJF" || type == "PJF") return some_of("Vto=-2|Beta=1m|Rd=1|Is=1e-14|N=1.1|I0=1m", 0.4);
  if (type == "NPN" || type == "PNP") return some_of("IS=1e-15|BF=80|BR=2|RB=10|RC=1|RE=0.1|VAF=100|I0=1m", 0.4);
  return block_parameters(type);
}

}  // namespace pwlsim::test
