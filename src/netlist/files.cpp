#include "netlist/files.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <system_error>
#include <vector>

#include "base/names.hpp"

namespace pwlsim::netlist {

namespace {

// Offsets into a text are 32 bits wide; a deck of ten million elements stays far below.
constexpr std::size_t largest_file = std::size_t{1} << 30U;

struct FileCloser {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

bool exists_as_file(const std::string& path) {
  std::error_code error;
  return std::filesystem::is_regular_file(path, error);
}

}  // namespace

FileBytes read_file(const std::filesystem::path& path) {
  FileBytes result;
  const std::unique_ptr<std::FILE, FileCloser> file(std::fopen(path.c_str(), "rb"));
  if (!file) {
    result.reason = std::strerror(errno);
    return result;
  }
  std::array<char, 65536> buffer{};
  std::size_t count = 0;
  while ((count = std::fread(buffer.data(), 1, buffer.size(), file.get())) != 0) {
    result.bytes.append(buffer.data(), count);
    if (result.bytes.size() > largest_file) {
      result.bytes.clear();
      result.reason = "larger than 1 GiB";
      return result;
    }
  }
  if (std::ferror(file.get()) != 0) {
    result.bytes.clear();
    result.reason = std::strerror(errno);
    return result;
  }
  result.readable = true;
  return result;
}

std::optional<std::filesystem::path> find_file(std::string_view name, const std::filesystem::path& directory) {
  std::string with_slashes(name);
  std::replace(with_slashes.begin(), with_slashes.end(), '\\', '/');
  std::vector<std::string> candidates;
  for (const std::string& spelling : {std::string(name), with_slashes}) {
    for (const auto& candidate : {(directory / spelling).string(), spelling}) {
      if (std::find(candidates.begin(), candidates.end(), candidate) == candidates.end()) {
        candidates.push_back(candidate);
      }
    }
  }
  const auto found = std::find_if(candidates.begin(), candidates.end(), exists_as_file);
  return found == candidates.end() ? std::nullopt : std::optional<std::filesystem::path>(*found);
}

bool is_windows_path(std::string_view name) {
  const bool drive = name.size() > 2 && name[1] == ':' && (name[2] == '\\' || name[2] == '/');
  return drive || name.find('\\') != std::string_view::npos;
}

bool is_standard_library(std::string_view name) {
  const std::string_view file = name.substr(name.find_last_of("/\\") + 1);
  constexpr std::array<std::string_view, 2> families{"standard.", "universalopamp"};
  constexpr std::array<std::string_view, 4> files{"opamp.sub", "ltc.lib", "nom.lib", "eval.lib"};
  const auto begins = [&](std::string_view prefix) {
    return file.size() > prefix.size() && same_name(file.substr(0, prefix.size()), prefix);
  };
  return std::any_of(families.begin(), families.end(), begins) ||
         std::any_of(files.begin(), files.end(), [&](std::string_view known) { return same_name(file, known); });
}

}  // namespace pwlsim::netlist
