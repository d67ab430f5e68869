#include "netlist/file_card.hpp"

#include <algorithm>

#include "base/names.hpp"
#include "netlist/card_grammar.hpp"

namespace pwlsim::netlist {

namespace {

/// Splits `rest`; false where a quote is not closed, which is then the last argument.
bool split(std::string_view rest, std::vector<FileArgument>& arguments) {
  for (rest = trimmed(rest); !rest.empty(); rest = trimmed(rest)) {
    const char quote = rest.front();
    if (quote != '"' && quote != '\'') {
      const auto end = static_cast<std::size_t>(std::find_if(rest.begin(), rest.end(), is_blank) - rest.begin());
      arguments.push_back({rest.substr(0, end), rest.substr(0, end), false});
      rest.remove_prefix(end);
      continue;
    }
    const std::size_t end = rest.find(quote, 1);
    if (end == std::string_view::npos) {
      arguments.push_back({rest.substr(1), rest, true});
      return false;
    }
    arguments.push_back({rest.substr(1, end - 1), rest.substr(0, end + 1), true});
    rest.remove_prefix(end + 1);
  }
  return true;
}

bool is_bare_single(const std::vector<FileArgument>& arguments) { return arguments.size() == 1 && !arguments.front().quoted; }

}  // namespace

std::optional<std::vector<FileArgument>> file_arguments(const ParseContext& context, std::string_view name) {
  std::vector<FileArgument> arguments;
  const std::string_view line = context.line.text();
  if (split(line.substr(name.size()), arguments)) {
    return arguments;
  }
  const std::string_view quote = arguments.back().whole.substr(0, 1);
  context.report("E-syntax-unclosed", quote, "the quote is never closed");
  return std::nullopt;
}

bool opens_section(const std::vector<FileArgument>& arguments, LineReader ahead) {
  if (!is_bare_single(arguments)) {
    return false;
  }
  LogicalLine line;
  while (ahead.next(line)) {
    const std::string_view name = card_name(line.text());
    if (same_name(name, ".endl")) {
      return true;
    }
    if (same_name(name, ".lib")) {
      std::vector<FileArgument> other;
      split(line.text().substr(name.size()), other);
      if (is_bare_single(other)) {
        return false;
      }
    }
  }
  return false;
}

}  // namespace pwlsim::netlist
