# The catalogue of elements: an explicit list of calls, one for each file src/elements/kinds/NAME.cpp, which defines `Kind kind()` in the
# namespace elements::kinds::NAME: what is private to a kind has the same names in all of them. Order: by file name. An element is added by adding its file.
function(pwlsim_catalogue output)
  file(GLOB files CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/elements/kinds/*.cpp)
  list(SORT files)
  set(declarations "")
  set(calls "")
  foreach(file IN LISTS files)
    get_filename_component(name ${file} NAME_WE)
    string(APPEND declarations "namespace kinds::${name} {\nKind kind();\n}\n")
    string(APPEND calls "      kinds::${name}::kind(),\n")
  endforeach()
  file(CONFIGURE OUTPUT ${output} @ONLY CONTENT [[// Made by cmake/catalogue.cmake from the files of src/elements/kinds.
#include "elements/catalogue.hpp"

namespace pwlsim::elements {

@declarations@
const std::vector<Kind>& catalogue() {
  static const std::vector<Kind> list = {
@calls@  };
  return list;
}

}  // namespace pwlsim::elements
]])
endfunction()
