# Tables of lib/ as texts within the program: pins of LTspice's symbols, models at hand. TABLE ROOM HEADER FUNCTION.
function(pwlsim_table output table room header function)
  set(file ${PROJECT_SOURCE_DIR}/lib/${table})
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
  file(READ ${file} text)
  # A compiler need not take a longer literal than 64 KiB: pieces of whole lines.
  string(REGEX REPLACE "\n# [A-Z][^|\n]*\n" ")table\"\nR\"table(\\0" text "${text}")
  file(CONFIGURE OUTPUT ${output} @ONLY CONTENT [[// Made by cmake/tables.cmake from lib/@table@.
#include "@header@"

namespace pwlsim::@room@ {

std::string_view @function@() { return R"table(@text@)table"; }

}  // namespace pwlsim::@room@
]])
endfunction()
