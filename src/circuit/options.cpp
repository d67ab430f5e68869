#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/names.hpp"
#include "circuit/commands.hpp"
#include "elements/parameter.hpp"
#include "netlist/number.hpp"

namespace pwlsim::circuit {
namespace {

using elements::Range;
using netlist::Item;
using ItemKind = Item::Kind;

constexpr double deepest_calls = 1000, largest_value = 1e15;

/// Options that are read here, and those of other simulators that are accepted: tolerances and methods of engines that step.
constexpr std::string_view honoured[] = {
    "reltol", "seed", "i0", "vdrive", "gatecap", "nonunique", "max_rows", "max_elements", "max_subcircuit_depth"};
constexpr std::string_view silent[] = {"abstol", "method", "max_include_depth", "max_parentheses"};  // the last two: read with the deck
constexpr std::string_view ignored[] = {
    "vntol",        "chgtol",       "trtol",      "gmin",         "gminsteps", "srcsteps", "sourcesteps",   "itl1",     "itl2",
    "itl3",         "itl4",         "itl5",       "itl6",         "pivrel",    "pivtol",   "maxord",        "maxstep",  "mindeltagmin",
    "numdgt",       "plotwinsize",  "measdgt",    "temp",         "tnom",      "acct",     "noacct",        "list",     "nomod",
    "nopage",       "node",         "opts",       "noopiter",     "noopac",    "defl",     "defw",          "defad",    "defas",
    "cshunt",       "rshunt",       "interp",     "trytocompact", "bypass",    "sparse",   "klu",           "xmu",      "autostop",
    "savecurrents", "keepopinfo",   "post",       "probe",        "ingold",    "brief",    "captab",        "ramptime", "convstep",
    "convabsstep",  "auto_bridge",  "fastaccess", "flagloads",    "ptrantau",  "ptranmax", "topologycheck", "nomarch",  "meascplxfmt",
    "startclk",     "baudrate",     "delim",      "accurate",     "absv",      "lvltim",   "limpts",        "cptime",   "limtim",
    "advconv",      "autoconverge", "pseudotran", "distribution", "library",   "nobias",   "noecho",        "noprbmsg", "noreuse",
    "preorder",     "skiptopo",     "solver",     "threads",      "reltolc",   "advance",  "stepgmin",      "expand",   "ascii",
    "thev_induc",   "minclk",       "maxclk",
};

class OptionReader {
 public:
  OptionReader(Scope& scope, Reporter& reporter, Analyses& analyses) : scope_(scope), reporter_(reporter), analyses_(analyses) {}

  void read(const Item& item) {
    if (is_one_of(honoured, item.text)) {
      honour(item);
    } else if (is_one_of(ignored, item.text)) {
      if (reporter_.first_time("option")) {
        reporter_.warning("W-ignored-option", item.text_span.known() ? item.text_span : item.span,
                          fmt::format("the option {} has no effect here, like others of its kind", item.text));
      }
    } else if (!is_one_of(silent, item.text)) {
      std::vector<std::string> names;
      for (std::string_view name : honoured) names.emplace_back(name);
      for (std::string_view name : silent) names.emplace_back(name);
      reporter_.warning("W-unknown-option", item.text_span.known() ? item.text_span : item.span,
                        fmt::format("the unknown option '{}' is ignored{}", item.text, suggestion(item.text, names)));
    }
  }

  Options options;
  bool says_nonunique = false;

 private:
  void honour(const Item& item) {
    if (same_name(item.text, "gatecap") && (item.kind == ItemKind::word || item.items.empty())) {
      options.settings.keeps_gates = true;
    } else if (item.kind != ItemKind::assignment || item.items.empty()) {
      reporter_.error("E-missing-value", item.span, fmt::format("the option {} has no value", item.text));
    } else if (same_name(item.text, "nonunique")) {
      choose(item.items[0]);
    } else {
      set(item);
    }
  }

  void choose(const Item& word) {
    says_nonunique = true;
    if (same_name(word.text, "error")) {
      analyses_.non_unique = NonUniqueChoice::error;
    } else if (same_name(word.text, "first")) {
      analyses_.non_unique = NonUniqueChoice::first;
    } else if (same_name(word.text, "stay")) {
      analyses_.non_unique = NonUniqueChoice::stay;
    } else {
      reporter_.error("E-range", word.span, "nonunique is error, first or stay");
    }
  }

  void set(const Item& item) {
    const std::optional<Number> number = scope_.number(item.items[0]);
    if (!number) return;
    const double value = number->value;
    if (same_name(item.text, "gatecap")) {
      options.settings.keeps_gates = value != 0.0;
      return;
    }
    const bool whole = without_case(item.text).starts_with("max_");
    const bool is_seed = same_name(item.text, "seed");
    const elements::Parameter parameter{item.text, "", 0.0, is_seed ? Range::not_negative : whole ? Range::whole_positive : Range::positive,
                                        false,     ""};
    if (is_seed && value != std::floor(value)) {
      reporter_.error("E-range", item.items[0].span, fmt::format("the option seed must be a whole number, not {}", value));
      return;
    }
    const bool deep = same_name(item.text, "max_subcircuit_depth") && value > deepest_calls;
    if (!elements::in_range(parameter, value) || value > largest_value || deep) {
      const std::string limit =
          deep ? fmt::format("must not exceed {}", deepest_calls) : std::string(elements::range_words(parameter.range));
      reporter_.error("E-range", item.items[0].span, fmt::format("the option {} {}, not {}", item.text, limit, value));
      return;
    }
    if (same_name(item.text, "reltol")) analyses_.relative_tolerance = value;
    if (is_seed) options.seed = static_cast<std::uint64_t>(value);
    if (same_name(item.text, "i0")) {
      options.settings.tangent_current = value;
      options.settings.finds_currents = false;
    }
    if (same_name(item.text, "vdrive")) options.settings.gate_drive = value;
    if (same_name(item.text, "i0") || same_name(item.text, "vdrive")) options.settings.finds_drives = false;
    if (same_name(item.text, "max_rows")) analyses_.row_limit = static_cast<std::uint64_t>(value);
    if (same_name(item.text, "max_elements")) options.limits.elements = value;
    if (same_name(item.text, "max_subcircuit_depth")) options.limits.depth = value;
  }

  Scope& scope_;
  Reporter& reporter_;
  Analyses& analyses_;
};

/// Two bipolar transistors may hold one another on or off, as those of a thyristor do: they keep their position until it has no solution.
bool has_latch(const Definitions& definitions) {
  std::size_t transistors = 0;
  for (const auto& definition : definitions.all)
    for (const netlist::Card* card : definition->elements) transistors += static_cast<std::size_t>(lower_letter(card->name.front()) == 'q');
  return transistors > 1;
}

}  // namespace

std::uint64_t written_seed(const Definitions& definitions) {
  std::uint64_t seed = 0;
  for (const netlist::Card* card : definitions.options) {
    for (const Item& item : card->items) {
      if (item.kind != ItemKind::assignment || item.items.empty() || !same_name(item.text, "seed")) continue;
      const netlist::NumberText number = netlist::read_number(item.items[0].text);
      if (number.valid && number.value >= 0.0 && number.value <= largest_value) seed = static_cast<std::uint64_t>(number.value);
    }
  }
  return seed;
}

Options read_options(const Definitions& definitions, Scope& scope, Reporter& reporter, Analyses& analyses) {
  OptionReader reader(scope, reporter, analyses);
  reader.options.settings.written_by_ltspice = definitions.written_by_ltspice;
  for (const netlist::Card* card : definitions.options) {
    for (const Item& item : card->items) reader.read(item);
  }
  if (!reader.says_nonunique && has_latch(definitions)) analyses.non_unique = NonUniqueChoice::stay;
  return reader.options;
}

}  // namespace pwlsim::circuit
