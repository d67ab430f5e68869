#pragma once
/// Cards of a deck and of all files that it includes, in the order in which they take effect.

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "netlist/card_grammar.hpp"
#include "netlist/decode.hpp"
#include "netlist/file_card.hpp"
#include "netlist/lines.hpp"
#include "netlist/load.hpp"
#include "netlist/section_filter.hpp"
#include "netlist/syntax_errors.hpp"

namespace pwlsim::netlist {

class Loader {
 public:
  Loader(SourceStore& sources, Diagnostics& diagnostics, const LoadLimits& limits)
      : sources_(sources), errors_(diagnostics), limits_(limits) {}

  /// The whole deck; `bytes` are those of the top file, `directory` is the first place for its includes.
  Deck read_deck(const std::string& name, std::string bytes, const std::filesystem::path& directory);
  /// The netlist of the schematic with these bytes; empty if it is not text.
  std::string write_netlist(const std::string& name, std::string bytes, const std::filesystem::path& directory);
  /// For the drawing of a schematic; call it first.
  void keep_drawing(Drawing* drawing) { drawing_ = drawing; }
  /// The files read besides the top file.
  [[nodiscard]] std::vector<std::string> files() const;

 private:
  struct File {
    FileIndex index = no_file;
    std::filesystem::path directory;
    bool is_text = true;
  };
  /// An `.include` or `.lib` card that names a file.
  struct Request {
    std::string_view file;
    std::string_view section;  ///< empty: the whole file
    SourceSpan file_span;
    SourceSpan section_span;
    bool is_library = false;
  };
  /// The files being read, to detect recursion and depth.
  struct Visit {
    FileIndex file;
    std::string section;
  };

  /// The text to read: the file itself, or the netlist of a schematic.
  File add_top(const std::string& name, std::string bytes, const std::filesystem::path& directory);
  File add_text(const std::string& name, std::string bytes, const std::filesystem::path& directory);
  void report_text_problems(File& file, const DecodedText& decoded);
  std::size_t take_title(const File& file);
  void read_cards(const File& file, std::size_t begin, SectionFilter& filter);
  bool read_dot_card(const File& file, LineReader& reader, const LogicalLine& line, std::string_view name, SectionFilter& filter);
  void add_raw_system(const File& from, const ParseContext& context, std::string_view name);
  void add_card(const LogicalLine& line);
  void read_rows(const File& from, Card& card);
  void take_limits(const Card& options);

  void skip_control(LineReader& reader, const SourceSpan& control);
  void take_control_tran();
  [[nodiscard]] bool has_card(std::string_view name) const;

  [[nodiscard]] static bool is_one_name(const File& from, const std::vector<FileArgument>& arguments);
  void request_file(const File& from, const ParseContext& context, std::string_view name, const std::vector<FileArgument>& arguments);
  void read_request(const File& from, const Request& request);
  const File* open_file(const File& from, const Request& request);
  bool may_visit(const Visit& visit, const Request& request);
  bool may_read_again(const File& file, const Request& request);

  SourceStore& sources_;
  SyntaxErrors errors_;
  LoadLimits limits_;
  Deck deck_;
  std::map<std::string, File> files_;      ///< by canonical path
  std::vector<std::string> symbol_files_;  ///< of a schematic
  Drawing* drawing_ = nullptr;             ///< null: not wanted
  std::set<FileIndex> reads_;
  std::vector<Visit> visits_;
  std::size_t repeated_files_ = 0;
  std::size_t repeated_bytes_ = 0;
  bool exhausted_ = false;  ///< includes multiply without limit: no more are followed
  SourceSpan first_control_;
  std::optional<LineReader> control_tran_;  ///< at the first `tran` line of a .control block
};

}  // namespace pwlsim::netlist
