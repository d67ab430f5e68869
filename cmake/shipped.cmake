# The shipped library: every subcircuit lib/NAME.sub, `.subckt NAME` in its first line, as text within the program.
function(pwlsim_shipped_library output)
  file(GLOB files CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/lib/*.sub)
  list(SORT files)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${files})
  set(entries "")
  foreach(file IN LISTS files)
    get_filename_component(name ${file} NAME_WE)
    file(READ ${file} text)
    string(APPEND entries "    {\"${name}\", R\"sub(${text})sub\"},\n")
  endforeach()
  file(CONFIGURE OUTPUT ${output} @ONLY CONTENT [[// Made by cmake/shipped.cmake from the files of lib.
#include "circuit/shipped.hpp"

namespace pwlsim::circuit {
namespace {

constexpr ShippedSubcircuit subcircuits[] = {
@entries@};

}  // namespace

std::span<const ShippedSubcircuit> shipped_subcircuits() { return subcircuits; }

}  // namespace pwlsim::circuit
]])
endfunction()
