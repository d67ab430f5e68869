#include "cli/split_files.hpp"

#include <algorithm>
#include <filesystem>
#include <string_view>

namespace pwlsim::cli {
namespace {

using std::filesystem::path;

std::string renamed(const std::string& output, const std::string& mark, const std::string& extension) {
  path name(output);
  return name.replace_filename(name.stem().string() + mark + extension).string();
}

path folder_of(const std::string& name) {
  std::error_code unresolved;
  return std::filesystem::weakly_canonical(std::filesystem::absolute(path(name), unresolved).parent_path(), unresolved);
}

}  // namespace

bool takes_one_table(const std::string& output) {
  std::error_code unknown;
  return output == "-" || std::filesystem::is_other(output, unknown);
}

std::string table_name(const std::string& output) { return output == "-" ? "standard output" : output; }

std::string split_file(const std::string& output, std::size_t run) {
  return renamed(output, '.' + std::to_string(run + 1), path(output).extension().string());
}

std::string orbit_file_name(const std::string& output) {
  return takes_one_table(output) ? output : renamed(output, ".pss", path(output).extension().string());
}

std::string small_signal_file_name(const std::string& output) { return takes_one_table(output) ? output : renamed(output, ".ac", ".csv"); }

std::string sensitivity_file_name(const std::string& output) { return renamed(output, ".sens", ".csv"); }

std::string bode_file_name(const std::string& plot) { return renamed(plot, ".ac", path(plot).extension().string()); }

std::string split_table(const std::string& output) { return renamed(output, ".runs", ".csv"); }

bool is_split_file(const std::string& output, const std::string& name) {
  if (name.empty() || folder_of(output) != folder_of(name)) return false;
  const std::string file = path(name).filename().string();
  if (file == path(split_table(output)).filename()) return true;
  const std::string begin = path(output).stem().string() + '.', end = path(output).extension().string();
  if (file.size() <= begin.size() + end.size() || !file.starts_with(begin) || !file.ends_with(end)) return false;
  const std::string_view number = std::string_view(file).substr(begin.size(), file.size() - begin.size() - end.size());
  return std::all_of(number.begin(), number.end(), [](char c) { return c >= '0' && c <= '9'; });
}

}  // namespace pwlsim::cli
