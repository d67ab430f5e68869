#include "random_decks/deck_cards.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace pwlsim::test {

void DeckCards::parameters(DeckScope& scope) {
  for (int count = random_.whole(0, 3); count > 0; --count) {
    const std::string name = fmt::format("p{}", ++count_);
    const std::string value = random_.chance(0.5) ? values_.factor() : fmt::format("{{{}}}", formulas_.of_parameters(scope, 2));
    scope.lines.push_back(fmt::format(".param {}{}={}", name, random_.chance(0.2) ? " " : "", value));
    scope.parameters.push_back(name);
  }
  if (!random_.chance(0.2)) return;
  const std::string name = fmt::format("f{}", ++count_);
  DeckScope inner;
  inner.parameters = {"x"};
  scope.lines.push_back(fmt::format(".func {}(x) {{{}}}", name, formulas_.of_parameters(inner, 1)));
  scope.functions.push_back(name);
}

void DeckCards::circuit(DeckScope& scope, int more) {
  for (std::size_t i = 1; i < scope.nodes.size(); ++i)
    elements_.add_connection(scope, scope.nodes[i], scope.nodes[static_cast<std::size_t>(random_.whole(0, static_cast<int>(i) - 1))]);
  static constexpr std::string_view letters = "RRRRRRCCCCLLLVVIKEGFHBBDDDDSSWAAMJQX";
  for (; more > 0; --more) elements_.add(scope, random_.one_of(letters));
}

void DeckCards::subcircuit(DeckScope& scope, int depth) {
  const std::string name = fmt::format("sub{}", ++count_);
  DeckScope inner;
  inner.functions = scope.functions;
  inner.parameters = scope.parameters;
  const int ports = random_.whole(1, 3);
  std::string header = ".subckt " + name;
  for (int i = 0; i < ports; ++i) {
    inner.nodes.push_back(fmt::format("t{}", i));
    header += " " + inner.nodes.back();
  }
  const bool has_parameter = random_.chance(0.5);
  if (has_parameter) {
    header += fmt::format(" {}w=1", random_.chance(0.5) ? "params: " : "");
    inner.parameters.push_back("w");
  }
  inner.nodes.push_back("0");
  if (random_.chance(0.6)) inner.nodes.push_back("m");
  if (random_.chance(0.2)) parameters(inner);
  circuit(inner, random_.whole(0, 3));
  if (depth > 0 && random_.chance(0.4)) subcircuit(inner, depth - 1);

  scope.lines.push_back(std::move(header));
  scope.lines.insert(scope.lines.end(), inner.lines.begin(), inner.lines.end());
  scope.lines.push_back(random_.chance(0.7) ? ".ends" : ".ends " + name);
  for (int calls = random_.whole(1, 2); calls > 0; --calls) {
    std::string call = fmt::format("X{}", ++count_ + 1000);
    for (int i = 0; i < ports; ++i) call += " " + formulas_.node(scope);
    call += " " + name;
    if (has_parameter && random_.chance(0.5)) call += fmt::format(" w={{{}}}", formulas_.of_parameters(scope, 1));
    scope.lines.push_back(std::move(call));
  }
}

void DeckCards::analyses(DeckScope& scope) {
  const std::string stop = values_.time(3.0, 15.0), step = values_.time(0.02, 0.5);
  const double form = random_.unit();
  std::string card;
  if (form < 0.45) {
    card = fmt::format(".tran {} {}", step, stop);
  } else if (form < 0.7) {
    card = fmt::format(".tran {} {} uic", step, stop);
  } else if (form < 0.8) {
    card = fmt::format(".tran {} {} {} {}", step, stop, values_.time(0.0, 2.0), step);
  } else if (form < 0.9) {
    card = fmt::format(".tran {}{}", stop, random_.chance(0.5) ? " uic" : "");
  } else {
    card = fmt::format(".tran 0 {} {}", stop, random_.one_of(std::array{"startup", "uic", "skipbp", "0 uic", "uic", "startup", "steady"}));
  }
  if (!random_.chance(0.02)) scope.lines.push_back(std::move(card));
  if (random_.chance(0.1)) scope.lines.emplace_back(".op");
  scope.lines.emplace_back(".options max_rows=3000");
}

void DeckCards::signals(DeckScope& scope) {
  if (random_.chance(0.5)) return;
  std::string card = random_.one_of(std::array<std::string, 5>{".save", ".probe", ".print tran", ".save", ".plot"});
  for (int count = random_.whole(1, 4); count > 0; --count) card += " " + formulas_.signal(scope);
  if (random_.chance(0.1)) card += random_.one_of(std::array{" all", " v(*)", " v(x1001.m)", " i(X1001.R1)", " @r1[i]", " Id(M1)"});
  scope.lines.push_back(std::move(card));
}

void DeckCards::conditions(DeckScope& scope) {
  if (random_.chance(0.75)) return;
  std::string card = random_.one_of(std::array<std::string, 4>{".ic", ".ic", ".ic", ".nodeset"});
  for (int count = random_.whole(1, 2); count > 0; --count)
    card += fmt::format(" V({})={}", random_.chance(0.1) ? formulas_.node(scope) : scope.nodes.back(), values_.volts());
  if (!scope.inductors.empty() && random_.chance(0.4)) card += fmt::format(" I({})={}", random_.one_of(scope.inductors), values_.amperes());
  scope.lines.push_back(std::move(card));
}

std::string DeckCards::window() {
  if (random_.chance(0.4)) return "";
  return random_.chance(0.5) ? fmt::format(" FROM={} TO={}", values_.time(0.0, 2.0), values_.time(2.0, 15.0))
                             : fmt::format(" FROM {}", values_.time(0.0, 3.0));
}

std::string DeckCards::passage(const DeckScope& scope) {
  const std::string count = random_.chance(0.4) ? ""
                                                : fmt::format(" {}={}", random_.one_of(std::array{"RISE", "FALL", "CROSS"}),
                                                              random_.one_of(std::array{"1", "2", "LAST", "7"}));
  return fmt::format("{}={}{}{}", formulas_.measured(scope, 1), values_.volts(), count,
                     random_.chance(0.1) ? " TD=" + values_.time(0.0, 3.0) : "");
}

std::string DeckCards::measurement(const DeckScope& scope) {
  const std::string expression = formulas_.measured(scope, 2);
  switch (random_.whole(0, 6)) {
    case 0:
      return fmt::format("FIND {} AT={}", expression, values_.time(0.0, 5.0));
    case 1:
      return fmt::format("FIND {} WHEN {}", expression, passage(scope));
    case 2:
      return "WHEN " + passage(scope);
    case 3:
      return fmt::format("TRIG {} TARG {}", passage(scope), passage(scope));
    case 4:
      return fmt::format("PARAM {}", count_ > 1 ? fmt::format("2*r{}+1", random_.whole(1, count_)) : "1");
    case 5:
      return fmt::format("DERIV {} AT={}", expression, values_.time(0.0, 5.0));
    default:
      return fmt::format("{} {}{}", random_.one_of(std::array{"AVG", "MIN", "MAX", "PP", "RMS", "INTEG", "MIN_AT", "MAX_AT"}), expression,
                         window());
  }
}

void DeckCards::measurements(DeckScope& scope) {
  if (random_.chance(0.7)) return;
  for (int count = random_.whole(1, 3); count > 0; --count) {
    const std::string what = measurement(scope);
    scope.lines.push_back(fmt::format(".meas {}r{} {}", random_.chance(0.5) ? "tran " : "", ++count_, what));
  }
  if (random_.chance(0.2)) scope.lines.push_back(fmt::format(".four {} {}", values_.frequency(0.3, 1.0), formulas_.signal(scope)));
}

void DeckCards::sweep(DeckScope& scope) {
  if (random_.chance(0.94)) return;
  const std::string name = scope.parameters.empty() ? "nix" : random_.one_of(scope.parameters);
  const char* form = random_.one_of(std::array{".step param {} list 1 2 0.5", ".step param {} 1 3 1", ".step param {} dec 1 10 2",
                                               ".step param {} list 1 0 -1", ".step {} list 1 2", ".step oct param {} 1 4 1"});
  scope.lines.push_back(fmt::format(fmt::runtime(form), name));
}

void DeckCards::options(DeckScope& scope) {
  if (random_.chance(0.3)) scope.lines.emplace_back(".options nonunique=first");
  if (random_.chance(0.05)) scope.lines.emplace_back(".options nonunique=stay");
  if (random_.chance(0.1))
    scope.lines.emplace_back(
        random_.one_of(std::array{".options reltol=1e-6", ".options i0=1m", ".options vdrive=5", ".options seed=3", ".options method=gear",
                                  ".options max_parentheses=2000", ".option abstol=1e-12 gmin=1e-12", ".options max_subcircuit_depth=2"}));
}

void DeckCards::oddities(DeckScope& scope) {
  if (random_.chance(0.8)) return;
  static const std::vector<std::string> cards{".temp 27",
                                              ".width out=80",
                                              ".backanno",
                                              ".ac dec 10 1 1k",
                                              ".noise v(a) V1",
                                              ".tf v(a) V1",
                                              ".global vcc",
                                              ".control\nrun\nplot v(a)\n.endc",
                                              ".title other",
                                              ".csparam a=1",
                                              ".lib standard.dio",
                                              ".include nowhere.inc",
                                              "* a comment",
                                              ".model unused NMOS(level=54)",
                                              ".dc V1 0 1 0.1",
                                              ".print dc v(a)",
                                              ".foo",
                                              ";"};
  scope.lines.push_back(random_.one_of(cards));
}

void DeckCards::raw_system(DeckScope& scope, std::map<std::string, std::string>& files) {
  const int states = random_.whole(1, 3), ports = random_.whole(1, 2);
  const auto matrix = [&](const char* keyword, int rows, int columns) {
    std::string text = std::string(keyword) + "\n";
    for (int i = 0; i < rows; ++i) {
      for (int j = 0; j < columns; ++j) text += fmt::format("{} ", random_.chance(0.3) ? 0.0 : random_.whole(-4, 4) * 0.5);
      text += "\n";
    }
    return text;
  };
  std::string text = "# random\n" + matrix("A", states, states) + matrix("B", states, ports) + matrix("C", ports, states);
  if (random_.chance(0.7)) text += matrix("D", ports, ports);
  if (random_.chance(0.5)) text += matrix("E", states, 1) + matrix("F", ports, 1) + "w\n" + elements_.waveform({}, false) + "\n";
  if (random_.chance(0.6)) text += matrix("x0", 1, states);
  files["raw.lcs"] = text;
  scope.lines.emplace_back(".lcs s \"raw.lcs\"");
  if (random_.chance(0.3)) scope.lines.emplace_back(".save x(s,1) u(s,1) y(s,1)");
}

void DeckCards::include(DeckScope& scope, std::map<std::string, std::string>& files) {
  const auto is_model = [](const std::string& line) { return line.starts_with(".model"); };
  std::string moved;
  for (const std::string& line : scope.lines)
    if (is_model(line)) moved += line + "\n";
  scope.lines.erase(std::remove_if(scope.lines.begin(), scope.lines.end(), is_model), scope.lines.end());
  if (random_.chance(0.5)) {
    files["models.inc"] = moved;
    scope.lines.emplace_back(".include \"models.inc\"");
  } else {
    files["models.lib"] = ".lib typ\n" + moved + ".endl\n.lib other\n.include nowhere.inc\n.endl other\n";
    scope.lines.emplace_back(".lib models.lib typ");
  }
}

}  // namespace pwlsim::test
