#include "waveform/png.hpp"

#include <fstream>

#include "base/process.hpp"

namespace pwlsim::waveform {

std::optional<std::string> find_png_converter() { return find_program("rsvg-convert"); }

std::optional<std::string> png_of_svg(const std::string& converter, const std::string& svg, std::string& problem) {
  const TemporaryFolder folder;
  problem = "there is no space for temporary files";
  if (!folder.made()) return std::nullopt;
  const std::string source = folder.file("picture.svg"), result = folder.file("picture.png"), log = folder.file("log");
  std::ofstream file(source, std::ios::binary);
  file << svg;
  file.close();
  if (!file) return std::nullopt;
  const ProcessEnd end = run_process({converter, "--zoom=2", "--format=png", "--output=" + result, source}, log, {});
  if (end.succeeded) return read_bytes(result);
  const std::string words = read_bytes(log);
  problem = "rsvg-convert fails" + (words.empty() ? "" : ": " + words.substr(0, words.find('\n')));
  return std::nullopt;
}

}  // namespace pwlsim::waveform
