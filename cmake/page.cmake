# pwlsim_page(OUTPUT): the texts of the web page of --report as C++ strings. Those of third parties must have the checksums that their README names.
set(PWLSIM_PAGE_PARTS
  page_frame src/analysis/page/page.html
  page_style src/analysis/page/page.css
  page_plot_style third_party/uplot/uPlot.min.css
  page_plot_script third_party/uplot/uPlot.iife.min.js)
# One script of several files, in the order in which their names are needed.
set(PWLSIM_PAGE_SCRIPTS text expression panels solution view plots pointer trace_list timeline overview measurements chart fourier spectrum xy
  sweep_charts export address keys tables symbols lettering schematic_values schematic start)

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
  # A compiler need not take a longer literal than 64 KiB: a piece for each file, joined when the page is made.
  set(script "")
  foreach(name ${PWLSIM_PAGE_SCRIPTS})
    set(file ${PROJECT_SOURCE_DIR}/src/analysis/page/${name}.js)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
    file(READ ${file} text)
    string(APPEND script "      R\"page_text(${text}\n)page_text\",\n")
  endforeach()
  string(APPEND definitions "\nstd::string page_script() {
  constexpr std::string_view files[] = {
${script}  };
  std::string script;
  for (std::string_view file : files) script += file;
  return script;
}
")
  file(CONFIGURE OUTPUT ${output} @ONLY CONTENT "// Made by cmake/page.cmake.
#include \"analysis/page_parts.hpp\"

namespace pwlsim::analysis {

@definitions@
}  // namespace pwlsim::analysis
")
endfunction()
