#include "elements/reference.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "base/names.hpp"
#include "elements/catalogue.hpp"
#include "elements/waveform.hpp"

namespace pwlsim::elements {
namespace {

std::string in_cell(std::string_view text) {
  std::string cell;
  for (char c : text) {
    if (c == '|') cell += '\\';
    cell += c;
  }
  return cell;
}

std::string range_cell(const Parameter& parameter) {
  const std::string limit = parameter.infinity_allowed ? ", or inf" : "";
  switch (parameter.range) {
    case Range::any:
      return "any" + limit;
    case Range::not_negative:
      return "0 or more" + limit;
    case Range::positive:
      return "above 0" + limit;
    case Range::whole_positive:
      return "1, 2, 3 ..." + limit;
    case Range::minus_one_to_one:
      return "-1 to 1";
  }
  return "";
}

std::string default_cell(const Parameter& parameter, bool required) {
  if (required) return "";
  return std::isinf(parameter.fallback) ? "inf" : fmt::format("{}", parameter.fallback);
}

std::string names_with(ParameterTable table, Use use) {
  std::string names;
  for (const Parameter& parameter : table) {
    if (parameter.use == use) names += fmt::format("{}`{}`", names.empty() ? "" : " ", parameter.name);
  }
  return names;
}

/// The first `required` parameters must be given, so that they have no default.
std::string table_of(ParameterTable table, std::size_t required) {
  std::string rows;
  for (std::size_t k = 0; k < table.size(); ++k) {
    const Parameter& p = table[k];
    if (p.use != Use::honoured) continue;
    rows += fmt::format("| `{}` | {} | {} | {} | {} |\n", p.name, p.unit, default_cell(p, k < required), range_cell(p), in_cell(p.text));
  }
  std::string text;
  if (!rows.empty()) text += "| parameter | unit | default | range | meaning |\n| --- | --- | --- | --- | --- |\n" + rows + "\n";
  if (const std::string names = names_with(table, Use::ignored); !names.empty())
    text += fmt::format("Ignored with a warning: {}.\n\n", names);
  if (const std::string names = names_with(table, Use::refused); !names.empty()) text += fmt::format("Not supported: {}.\n\n", names);
  return text;
}

std::string heading_of(const Kind& kind) { return fmt::format("{}: {}", kind.letter, kind.name); }

/// The fragment by which a page of Markdown is entered at a heading.
std::string anchor_of(std::string_view heading) {
  std::string anchor;
  for (const char c : heading)
    if (c == ' ' || c == '-' || std::isalnum(static_cast<unsigned char>(c)) != 0) anchor += c == ' ' ? '-' : lower_letter(c);
  return anchor;
}

std::string overview(const std::vector<const Kind*>& kinds) {
  std::string text = "| element | what it is | types of `.model` |\n| --- | --- | --- |\n";
  for (const Kind* kind : kinds) {
    std::vector<std::string> types;
    for (const ModelKind* model : kind->models) types.push_back(fmt::format("`{}`", model->type));
    text += fmt::format("| [{}](#{}) | {} | {} |\n", heading_of(*kind), anchor_of(heading_of(*kind)), in_cell(kind->text),
                        fmt::join(types, " "));
  }
  return text + "\n";
}

std::string section_of(const Kind& kind) {
  const bool value = kind.tail == Tail::value;
  std::string text = fmt::format("## {}\n\n    {}\n\n{}\n\n", heading_of(kind), kind.usage, kind.text);
  text += table_of(kind.parameters, value ? 1 : 0);
  for (const ModelKind* model : kind.models) {
    text += fmt::format("### `.model` name {}\n\n{}", model->type, table_of(model->parameters, 0));
  }
  return text;
}

}  // namespace

std::string reference_tables() {
  std::vector<const Kind*> kinds;
  for (const Kind& kind : catalogue()) kinds.push_back(&kind);
  std::sort(kinds.begin(), kinds.end(), [](const Kind* a, const Kind* b) { return a->letter < b->letter; });
  std::string text =
      "# Elements and their parameters\n\nMade from the catalogue in src/elements by `ninja -C build reference`; a test compares.\n"
      "[netlist.md](netlist.md) describes the cards.\n\n";
  text += overview(kinds);
  for (const Kind* kind : kinds) text += section_of(*kind);
  text += "## Waveforms of V and I\n\n";
  for (const WaveformKind& kind : waveform_kinds()) {
    text += fmt::format("### {}\n\n    {}\n\n{}", kind.name, kind.usage, table_of(kind.parameters, kind.required));
  }
  text += fmt::format("### PWL\n\n    {}\n", pwl_usage);
  return text;
}

}  // namespace pwlsim::elements
