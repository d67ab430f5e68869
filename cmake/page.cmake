# pwlsim_page(OUTPUT): the texts of the web page of --report as C++ strings. Those of third parties must have the checksums that their README names.
set(PWLSIM_PAGE_PARTS
  page_frame src/analysis/page/page.html
  page_style src/analysis/page/page.css
  page_solution_script src/analysis/page/solution.js
  page_traces_script src/analysis/page/traces.js
  page_script src/analysis/page/page.js
  page_plot_style third_party/uplot/uPlot.min.css
  page_plot_script third_party/uplot/uPlot.iife.min.js)

function(pwlsim_page output)
  file(READ ${PROJECT_SOURCE_DIR}/third_party/README.md readme)
  set(definitions "")
  set(parts ${PWLSIM_PAGE_PARTS})
  while(parts)
    list(POP_FRONT parts name file)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${file})
    if(file MATCHES "^third_party/")
      file(SHA256 ${PROJECT_SOURCE_DIR}/${file} checksum)
      if(NOT readme MATCHES "${checksum}")
        message(FATAL_ERROR "${file} is not the file that third_party/README.md names: its SHA-256 is ${checksum}")
      endif()
    endif()
    file(READ ${PROJECT_SOURCE_DIR}/${file} text)
    string(APPEND definitions "const std::string_view ${name} = R\"page_text(${text})page_text\";\n")
  endwhile()
  file(CONFIGURE OUTPUT ${output} @ONLY CONTENT "// Made by cmake/page.cmake.
#include \"analysis/page_parts.hpp\"

namespace pwlsim::analysis {

@definitions@
}  // namespace pwlsim::analysis
")
endfunction()
