#include "analysis/idealisation.hpp"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "analysis/json.hpp"

namespace pwlsim::analysis {
namespace {

constexpr std::string_view replaced = "replaced", ignored = "ignored", read_otherwise = "read otherwise";

struct Told {
  std::string_view id;
  std::string_view kind;
};
constexpr Told told[] = {
    {"N-diode-tangent", replaced},    {"N-idealised", replaced},
    {"N-model-at-hand", replaced},    {"N-zero-capacitance", replaced},
    {"N-zero-inductance", replaced},  {"N-source-resistance", read_otherwise},
    {"W-ignored-card", ignored},      {"W-ignored-option", ignored},
    {"W-ignored-parameter", ignored}, {"W-lib-skipped", ignored},
    {"N-control-skipped", ignored},   {"W-ic-unused", ignored},
    {"W-startup", read_otherwise},    {"N-negative-hysteresis", read_otherwise},
    {"W-second-model", ignored},      {"W-femto", read_otherwise},
    {"N-dc-value", read_otherwise},   {"W-unknown-option", ignored},
    {"W-ignored-output", ignored},    {"W-no-model", ignored},
    {"W-floating", read_otherwise},
};

/// On one line.
std::string subject_of(const SourceSpan& span, const SourceStore& sources) {
  const std::string_view text = span.known() ? sources.text(span) : "";
  return std::string(text.substr(0, text.find('\n')));
}

std::size_t count_of(std::span<const Idealisation> list, std::string_view kind) {
  return static_cast<std::size_t>(std::count_if(list.begin(), list.end(), [&](const Idealisation& d) { return d.kind == kind; }));
}

std::size_t widest(std::span<const Idealisation> list, std::string Idealisation::*column) {
  std::size_t width = 0;
  for (const Idealisation& departure : list) width = std::max(width, (departure.*column).size());
  return width;
}

}  // namespace

std::string_view departure_kind(std::string_view id) {
  const auto* found = std::find_if(std::begin(told), std::end(told), [&](const Told& t) { return t.id == id; });
  return found == std::end(told) ? std::string_view{} : found->kind;
}

std::vector<Idealisation> departures(const Diagnostics& diagnostics, const SourceStore& sources) {
  std::vector<Idealisation> list;
  for (const Diagnostic& diagnostic : diagnostics.all()) {
    const std::string_view kind = departure_kind(diagnostic.id);
    if (kind.empty()) continue;
    const SourceSpan& span = diagnostic.span;
    std::string place;
    if (span.known()) {
      const SourcePlace at = sources.place(span.file, span.begin);
      place = fmt::format("{}:{}", at.name, at.position.line);
    }
    list.push_back({kind, subject_of(span, sources), std::move(place), diagnostic.text});
  }
  return list;
}

std::string departures_line(std::span<const Idealisation> list) {
  std::string counts;
  for (std::string_view kind : {replaced, ignored, read_otherwise}) {
    const std::size_t count = count_of(list, kind);
    if (count != 0) counts += fmt::format("{}{} {}", counts.empty() ? "" : ", ", count, kind);
  }
  return counts.empty() ? "" : fmt::format("not as written: {} (--verbose lists them)\n", counts);
}

std::string departures_table(std::span<const Idealisation> list) {
  if (list.empty()) return "";
  const std::size_t places = widest(list, &Idealisation::place), subjects = widest(list, &Idealisation::subject);
  std::string text = "not as written:\n";
  for (const Idealisation& d : list)
    text += fmt::format("  {:<14}  {:<{}}  {:<{}}  {}\n", d.kind, d.place, places, d.subject, subjects, d.text);
  return text;
}

std::string departures_json(std::span<const Idealisation> list) {
  std::vector<std::string> members;
  for (const Idealisation& d : list)
    members.push_back(json_line({{"kind", json_string(d.kind)},
                                 {"subject", json_string(d.subject)},
                                 {"place", json_string(d.place)},
                                 {"text", json_string(d.text)}}));
  return json_line(members);
}

}  // namespace pwlsim::analysis
