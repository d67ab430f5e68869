#pragma once
/// Texts built into the program (cmake/page.cmake).

#include <string>
#include <string_view>

namespace pwlsim::analysis {

extern const std::string_view page_frame, page_style;
[[nodiscard]] std::string page_script();
/// Of uPlot (third_party/uplot).
extern const std::string_view page_plot_style, page_plot_script;

}  // namespace pwlsim::analysis
