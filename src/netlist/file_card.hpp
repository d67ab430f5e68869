#pragma once
/// The arguments of `.include` and `.lib`, which are file names and so follow rules of their own.

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

/// What stands behind the card's name: words parted by blanks, or "…", or '…'. Nothing, with an error reported where a quote is
/// not closed.
[[nodiscard]] std::optional<std::vector<FileArgument>> file_arguments(const ParseContext& context, std::string_view name);

/// Where the line opens a library section, `.lib name` with a `.endl` further on and no other `.lib name` before it.
[[nodiscard]] bool opens_section(const std::vector<FileArgument>& arguments, LineReader ahead);

}  // namespace pwlsim::netlist
