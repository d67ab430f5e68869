# Tables of lib/ as texts within the program: pins of LTspice's symbols, models at hand. TABLE ROOM HEADER FUNCTION.
function(pwlsim_table output table room header function)
  set(file ${PROJECT_SOURCE_DIR}/lib/${table})
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
  file(READ ${file} text)
  # A compiler need not take a longer literal than 64 KiB: pieces of whole lines, joined when the table is asked for first.
  string(REGEX REPLACE "\n# [A-Z][^|\n]*\n" ")table\",\nR\"table(\\0" text "${text}")
  file(CONFIGURE OUTPUT ${output} @ONLY CONTENT [[// Made by cmake/tables.cmake from lib/@table@.
#include "@header@"

#include <string>

namespace pwlsim::@room@ {

std::string_view @function@() {
  static const std::string text = [] {
    constexpr std::string_view pieces[] = {R"table(@text@)table"};
    std::string joined;
    for (std::string_view piece : pieces) joined += piece;
    return joined;
  }();
  return text;
}

}  // namespace pwlsim::@room@
]])
endfunction()
