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

/// What stands where a file is meant; "" where there is nothing.
std::string kind_of(const std::string& path) {
  std::error_code error;
  switch (std::filesystem::status(path, error).type()) {
    case std::filesystem::file_type::none:
      return "cannot be examined (" + error.message() + ')';
    case std::filesystem::file_type::not_found:
      return std::filesystem::is_symlink(path, error) ? "is a symbolic link to a file that does not exist" : "";
    case std::filesystem::file_type::directory:
      return "is a directory";
    case std::filesystem::file_type::fifo:
      return "is a pipe, and only regular files can be included";
    default:
      return "is a device or socket, and only regular files can be included";
  }
}

/// The file of that folder whose name differs in case alone, the first by name; empty where there is none.
std::filesystem::path find_without_case(const std::filesystem::path& wanted) {
  const std::filesystem::path folder = wanted.has_parent_path() ? wanted.parent_path() : ".";
  std::filesystem::path result;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (!same_name(entry.path().filename().string(), wanted.filename().string()) || !exists_as_file(entry.path().string())) continue;
    if (result.empty() || entry.path() < result) result = entry.path();
  }
  return result;
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

FoundFile find_file(std::string_view name, const std::filesystem::path& directory) {
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
  if (found != candidates.end()) return {*found, {}};
  const std::string last = with_slashes.substr(with_slashes.find_last_of('/') + 1);
  for (const std::string& spelling : {with_slashes, last})
    if (const std::filesystem::path path = find_without_case(directory / spelling); !path.empty())
      return {path, {}, spelling != with_slashes};
  for (const std::string& candidate : candidates)
    if (const std::string kind = kind_of(candidate); !kind.empty()) return {{}, "it " + kind};
  return {{}, "no such file beside the file that names it, nor in the current directory"};
}

bool is_windows_path(std::string_view name) {
  const bool drive = name.size() > 2 && name[1] == ':' && (name[2] == '\\' || name[2] == '/');
  return drive || name.find('\\') != std::string_view::npos;
}

bool names_models(std::string_view name) {
  constexpr std::string_view endings[] = {".lib", ".sub", ".subckt", ".mod", ".mdl", ".model", ".txt", ".dio", ".bjt", ".mos", ".jft"};
  return std::any_of(std::begin(endings), std::end(endings), [&](std::string_view ending) {
    return name.size() > ending.size() && same_name(name.substr(name.size() - ending.size()), ending);
  });
}

bool is_standard_library(std::string_view name) {
  const std::string_view file = name.substr(name.find_last_of("/\\") + 1);
  constexpr std::array<std::string_view, 2> families{"standard.", "universalopamp"};
  constexpr std::array<std::string_view, 5> files{"opamp.sub", "ne555.sub", "ltc.lib", "nom.lib", "eval.lib"};
  const auto begins = [&](std::string_view prefix) {
    return file.size() > prefix.size() && same_name(file.substr(0, prefix.size()), prefix);
  };
  return std::any_of(families.begin(), families.end(), begins) ||
         std::any_of(files.begin(), files.end(), [&](std::string_view known) { return same_name(file, known); });
}

}  // namespace pwlsim::netlist
