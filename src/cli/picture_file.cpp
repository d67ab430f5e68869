#include "cli/picture_file.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "base/names.hpp"
#include "waveform/png.hpp"

namespace pwlsim::cli {

std::string picture_kind(const std::string& name) { return without_case(std::filesystem::path(name).extension().string()); }

int PictureFile::open(const std::string& name, const std::vector<std::string>& read, Messages& messages) {
  if (picture_kind(name) == ".png") {
    converter_ = waveform::find_png_converter();
    if (!converter_)
      return fail(
          messages, Status::file_error, "E-no-png",
          fmt::format("{}: a PNG picture needs rsvg-convert, and no program of that name is in PATH; try apt install librsvg2-bin, or a "
                      "name that ends in .svg",
                      name));
  }
  return open_output(name, read, messages, file_);
}

int PictureFile::write(const std::string& svg, Messages& messages) {
  if (!converter_) return write_whole(*file_, svg, messages);
  std::string problem;
  const auto png = waveform::png_of_svg(*converter_, svg, problem);
  if (!png)
    return fail(messages, Status::file_error, "E-cannot-write", fmt::format("{}: {}; try a name that ends in .svg", name(), problem));
  return write_whole(*file_, *png, messages);
}

}  // namespace pwlsim::cli
