#pragma once
/// SVG pictures as PNG, through rsvg-convert (Debian: librsvg2-bin).

#include <optional>
#include <string>

namespace pwlsim::waveform {

/// The path of the converter; empty if it is not installed.
[[nodiscard]] std::optional<std::string> find_png_converter();

/// The bytes of the PNG file, two pixels for each unit of the picture; empty if that fails, and `problem` says why.
[[nodiscard]] std::optional<std::string> png_of_svg(const std::string& converter, const std::string& svg, std::string& problem);

}  // namespace pwlsim::waveform
