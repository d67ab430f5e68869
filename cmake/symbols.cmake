# The pins of LTspice's symbols, lib/ltspice.symbols, as text within the program.
function(pwlsim_symbols output)
  set(file ${PROJECT_SOURCE_DIR}/lib/ltspice.symbols)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
  file(READ ${file} text)
  file(CONFIGURE OUTPUT ${output} @ONLY CONTENT [[// Made by cmake/symbols.cmake from lib/ltspice.symbols.
#include "netlist/schematic/symbol.hpp"

namespace pwlsim::netlist {

std::string_view standard_symbols() { return R"symbols(@text@)symbols"; }

}  // namespace pwlsim::netlist
]])
endfunction()
