#pragma once
/// The arguments of `.include` and `.lib`: file names, which have their own rules.

#include <optional>
#include <string_view>
#include <vector>

#include "netlist/context.hpp"

namespace pwlsim::netlist {

struct FileArgument {
  std::string_view text;   ///< without quotes
  std::string_view whole;  ///< with them
  bool quoted = false;
};

/// The arguments after the card's name: words separated by blanks, or "…", or '…'. Empty, with an error reported, if a quote is
/// not closed.
[[nodiscard]] std::optional<std::vector<FileArgument>> file_arguments(const ParseContext& context, std::string_view name);

/// Whether the line opens a library section: `.lib name` with a later `.endl` and no other `.lib name` before that.
[[nodiscard]] bool opens_section(const std::vector<FileArgument>& arguments, LineReader ahead);

}  // namespace pwlsim::netlist
