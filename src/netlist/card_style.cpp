#include "netlist/card_style.hpp"

#include <array>

#include "base/names.hpp"

namespace pwlsim::netlist {

CardStyle::CardStyle(std::string_view name) {
  const char letter = lower_letter(name.front());
  dot_ = letter == '.';
  function_ = same_name(name, ".func");
  rule_ = same_name(name, ".rule");
  machine_output_ = same_name(name, ".output");
  condition_ = same_name(name, ".if") || same_name(name, ".elseif");
  model_ = same_name(name, ".model");
  measurement_ = same_name(name, ".meas") || same_name(name, ".measure");
  takes_params_ = letter == 'x' || same_name(name, ".subckt");
  static constexpr std::array<std::string_view, 3> parameter_cards{".param", ".params", ".global_param"};
  parameters_ = takes_params_ || is_one_of(parameter_cards, name);
  source_values_ = std::string_view("befgh").find(letter) != std::string_view::npos;
  is_resistor_ = letter == 'r';
}

bool is_measurement_keyword(std::string_view word) {
  static constexpr std::array<std::string_view, 30> keywords{"avg",    "min",        "max",  "pp",    "rms",  "integ", "integral", "find",
                                                             "deriv",  "derivative", "when", "at",    "from", "to",    "trig",     "targ",
                                                             "val",    "rise",       "fall", "cross", "td",   "last",  "param",    "min_at",
                                                             "max_at", "err",        "err1", "err2",  "err3", "period"};
  return is_one_of(keywords, word);
}

bool is_analysis_name(std::string_view word) {
  static constexpr std::array<std::string_view, 9> names{"tran", "pss", "ac", "dc", "op", "noise", "tf", "sp", "four"};
  return is_one_of(names, word);
}

bool CardStyle::open_expression(std::string_view left) const {
  static constexpr std::array<std::string_view, 6> source_values{"v", "i", "value", "vol", "cur", "laplace"};
  return parameters_ || (source_values_ && is_one_of(source_values, left)) || (is_resistor_ && same_name(left, "r"));
}

bool CardStyle::joins_parenthesis(std::string_view word) const {
  static constexpr std::array<std::string_view, 8> waveforms{"sin", "sine", "pulse", "pwl", "exp", "sffm", "am", "poly"};
  return dot_ || is_one_of(waveforms, word);
}

}  // namespace pwlsim::netlist
