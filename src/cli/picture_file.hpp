#pragma once
/// The file of --plot: SVG, or PNG through a converter.

#include <optional>
#include <string>

#include "cli/output.hpp"

namespace pwlsim::cli {

class PictureFile {
 public:
  /// The name decides the format: .svg or .png. Returns 0, or an exit status if it cannot be written.
  [[nodiscard]] int open(const std::string& name, const std::vector<std::string>& read, Messages& messages);
  [[nodiscard]] bool is_open() const { return file_.has_value(); }
  /// Writes the picture and commits it; returns an exit status.
  [[nodiscard]] int write(const std::string& svg, Messages& messages);
  [[nodiscard]] std::string name() const { return file_->name(); }

 private:
  std::optional<waveform::OutputFile> file_;
  std::optional<std::string> converter_;  ///< of a PNG
};

/// The ending of the name in lower case: ".svg", ".png", …
[[nodiscard]] std::string picture_kind(const std::string& name);

}  // namespace pwlsim::cli
