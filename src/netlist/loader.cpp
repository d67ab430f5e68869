#include "netlist/loader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>
#include <utility>

#include "base/names.hpp"
#include "netlist/decode.hpp"
#include "netlist/file_card.hpp"
#include "netlist/files.hpp"
#include "netlist/number.hpp"
#include "netlist/schematic/netlister.hpp"

namespace pwlsim::netlist {

namespace {

/// Where the deck's `.end` begins, or the end of the text: problems behind it are nobody's concern.
std::size_t end_of_deck(FileIndex file, std::string_view text) {
  LineReader reader(file, text);
  LogicalLine line;
  while (reader.next(line)) {
    if (same_name(card_name(line.text()), ".end")) {
      return line.span(line.text()).begin;
    }
  }
  return text.size();
}

std::string describe(const TextProblem& problem, std::string_view text) {
  if (problem.kind == TextProblem::Kind::encoding) {
    return "a byte that is neither UTF-8 nor Latin-1; try saving the file as UTF-8";
  }
  const auto last = static_cast<unsigned char>(text[problem.offset + problem.size - 1]);
  return fmt::format("the control character U+{:04X} is not allowed in a deck", static_cast<unsigned>(last));
}

/// What a file that is no deck says of itself in its first line: netlists of boards, of KiCad and ExpressPCB, and schematics of other programs have the
/// ending of a deck. "" for a deck.
std::string_view other_than_deck(std::string_view title) {
  struct Mark {
    std::string_view begin, what;
  };
  constexpr std::string_view board = "the netlist of a printed circuit board";
  constexpr Mark marks[] = {{"(export", board},
                            {"\"ExpressPCB", board},
                            {"(kicad_sch", "a schematic of KiCad"},
                            {"EESchema Schematic", "a schematic of KiCad"},
                            {"[Main]", "a schematic of Micro-Cap"},
                            {"v {xschem", "a schematic of xschem"},
                            {"<Qucs Schematic", "a schematic of Qucs"},
                            {"*version 9", "a schematic of PSpice"}};
  for (const Mark& mark : marks)
    if (title.starts_with(mark.begin)) return mark.what;
  return "";
}

bool looks_like_card(std::string_view title) {
  return title.size() > 1 && title[0] == '.' && lower_letter(title[1]) >= 'a' && lower_letter(title[1]) <= 'z' &&
         !same_name(card_name(title), ".title");
}

}  // namespace

Deck Loader::read_deck(const std::string& name, std::string bytes, const std::filesystem::path& directory) {
  const File file = add_top(name, std::move(bytes), directory);
  if (file.is_text) {
    const std::size_t errors_before = errors_.count();
    const std::size_t begin = take_title(file);
    if (const std::string_view what = other_than_deck(deck_.title); !what.empty()) {
      deck_.is_board = true;
      errors_.report("E-board-netlist", deck_.title_span,
                     fmt::format("this is {}, not a SPICE deck; try the export of a netlist for SPICE in the schematic editor", what));
      errors_.finish();
      return std::move(deck_);
    }
    visits_.push_back({file.index, {}});
    SectionFilter everything{{}};
    read_cards(file, begin, everything);
    take_control_tran();
    if (deck_.cards.empty() && errors_.count() == errors_before) {
      errors_.report("E-syntax-empty", deck_.title_span, "the deck has no cards; its first line is always the title");
    }
  }
  errors_.finish();
  return std::move(deck_);
}

Loader::File Loader::add_top(const std::string& name, std::string bytes, const std::filesystem::path& directory) {
  File file = add_text(name, std::move(bytes), directory);
  if (!is_schematic(name) || !file.is_text) return file;
  SchematicNetlist netlist = netlist_of(file.index, directory, sources_, errors_.diagnostics(), drawing_);
  symbol_files_ = std::move(netlist.files);
  file.index = sources_.add("netlist of " + name, std::move(netlist.text), std::move(netlist.origins));
  return file;
}

std::string Loader::write_netlist(const std::string& name, std::string bytes, const std::filesystem::path& directory) {
  const File file = add_top(name, std::move(bytes), directory);
  errors_.finish();
  return file.is_text ? std::string(sources_.text(file.index)) : "";
}

Loader::File Loader::add_text(const std::string& name, std::string bytes, const std::filesystem::path& directory) {
  DecodedText decoded = decode(std::move(bytes));
  File file{sources_.add(name, std::move(decoded.text)), directory, true};
  if (!decoded.problems.empty()) {
    report_text_problems(file, decoded);
  }
  return file;
}

void Loader::report_text_problems(File& file, const DecodedText& decoded) {
  const std::string_view text = sources_.text(file.index);
  const std::size_t end = end_of_deck(file.index, text);
  const auto span_of = [&](const TextProblem& p) { return SourceSpan{file.index, p.offset, p.offset + p.size}; };
  for (const auto& problem : decoded.problems) {
    if (problem.kind == TextProblem::Kind::null && problem.offset < end) {
      errors_.report("E-syntax-binary", span_of(problem), "a zero byte: this is not a text file; try saving the deck as UTF-8");
      file.is_text = false;
      return;
    }
  }
  for (const auto& problem : decoded.problems) {
    if (problem.offset < end) {
      errors_.report("E-syntax-control-character", span_of(problem), describe(problem, text));
    }
  }
}

std::size_t Loader::take_title(const File& file) {
  const std::string_view text = sources_.text(file.index);
  const std::size_t end = std::min(text.find('\n'), text.size());
  const std::string_view title = trimmed(text.substr(0, end));
  const auto begin = static_cast<std::uint32_t>(title.empty() ? 0 : title.data() - text.data());
  deck_.title.assign(title);
  deck_.title_span = {file.index, begin, begin + static_cast<std::uint32_t>(title.size())};
  if (looks_like_card(title)) {
    errors_.diagnostics().warning("W-title-card", deck_.title_span,
                                  "the first line is the title, so this card has no effect; try a title above it");
  }
  return std::min(end + 1, text.size());
}

void Loader::read_cards(const File& file, std::size_t begin, SectionFilter& filter) {
  LineReader reader(file.index, sources_.text(file.index), begin);
  LogicalLine line;
  while (reader.next(line)) {
    const std::string_view name = card_name(line.text());
    if (line.orphan()) {
      errors_.report("E-syntax-continuation", line.span(line.text()), "'+' continues a card, but there is no card before it");
    } else if (name.starts_with('.')) {
      if (!read_dot_card(file, reader, line, name, filter)) {
        return;
      }
    } else if (filter.wants_cards()) {
      add_card(line);
    }
  }
}

/// False at `.end`.
bool Loader::read_dot_card(const File& file, LineReader& reader, const LogicalLine& line, std::string_view name, SectionFilter& filter) {
  const ParseContext context{line, errors_, limits_.parentheses};
  if (same_name(name, ".end")) {
    return false;
  }
  if (same_name(name, ".endl")) {
    if (!filter.end()) {
      context.report("E-syntax-lib", name, "'.endl' without a '.lib' section");
    }
    return true;
  }
  const bool library = same_name(name, ".lib");
  if (library || same_name(name, ".include") || same_name(name, ".inc")) {
    const auto arguments = file_arguments(context, name);
    if (arguments && library && opens_section(*arguments, reader)) {
      filter.begin(arguments->front().text);
    } else if (arguments && filter.wants_cards()) {
      request_file(file, context, name, *arguments);
    }
    return true;
  }
  if (!filter.wants_cards()) {
    return true;
  }
  if (same_name(name, ".control")) {
    skip_control(reader, line.span(name));
  } else if (same_name(name, ".endc")) {
    context.report("E-syntax-control", name, "'.endc' without '.control'");
  } else {
    same_name(name, ".lcs") ? add_raw_system(file, context, name) : add_card(line);
  }
  return true;
}

void Loader::add_card(const LogicalLine& line) {
  Card card;
  const std::string_view name = card_name(line.text());
  if (same_name(name, ".title")) {
    // Free text, which no grammar should judge.
    deck_.cards.push_back({std::string(name), line.span(name), {}, line.span(line.text()), false});
  } else if (parse_card({line, errors_, limits_.parentheses}, card)) {
    if (same_name(name, ".options") || same_name(name, ".option")) {
      take_limits(card);
    }
    deck_.cards.push_back(std::move(card));
  }
}

/// The file's name stands in either kind of quotes, as on `.include`.
void Loader::add_raw_system(const File& from, const ParseContext& context, std::string_view name) {
  const LogicalLine& line = context.line;
  std::optional<std::vector<FileArgument>> arguments;
  if (line.text().find('\'') != std::string_view::npos) {
    arguments = file_arguments(context, name);
    if (!arguments) return;
  }
  const std::size_t before = deck_.cards.size();
  if (arguments && arguments->size() == 2 && !arguments->front().quoted && arguments->back().quoted) {
    Card& card = deck_.cards.emplace_back();
    card.name = name;
    card.name_span = line.span(name);
    card.span = line.span(line.text());
    for (const FileArgument& argument : *arguments) {
      Item& item = card.items.emplace_back();
      item.kind = argument.quoted ? Item::Kind::string : Item::Kind::word;
      item.text = argument.text;
      item.span = line.span(argument.whole);
      item.text_span = line.span(argument.text);
    }
  } else {
    add_card(line);
  }
  if (deck_.cards.size() > before) read_rows(from, deck_.cards.back());
}

/// The file of a `.lcs` card: numbers and sources line by line, `#` begins a comment.
void Loader::read_rows(const File& from, Card& card) {
  if (card.damaged || card.items.size() != 2) return;
  const Item& name = card.items[1];
  const File* const file = open_file(from, {name.text, {}, name.span, {}, false});
  if (file == nullptr || !file->is_text) {
    card.damaged = true;
    return;
  }
  const std::string_view text = sources_.text(file->index);
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::size_t content = std::min(text.find('#', begin), end);
    LineReader reader(file->index, text.substr(0, content), begin);
    LogicalLine row;
    if (reader.next(row) && !parse_card({row, errors_, limits_.parentheses}, card.rows.emplace_back())) card.rows.pop_back();
    begin = end + 1;
  }
}

void Loader::take_limits(const Card& options) {
  // Includes are read by recursion, so even a raised limit has an end.
  const auto take = [&](const Item& item, std::string_view name, int most, int& limit) {
    if (item.kind != Item::Kind::assignment || !same_name(item.text, name)) return;
    const NumberText number = item.items.empty() ? NumberText{} : read_number(item.items.front().text);
    if (number.valid && number.value >= 1 && number.value <= most) {
      limit = static_cast<int>(number.value);
    } else {
      errors_.report("E-range", item.span, fmt::format("the option {} is a number from 1 to {}", name, most));
    }
  };
  for (const auto& item : options.items) {
    take(item, "max_include_depth", 500, limits_.include_depth);
    take(item, "max_parentheses", 1'000'000, limits_.parentheses);
  }
}

void Loader::skip_control(LineReader& reader, const SourceSpan& control) {
  first_control_ = first_control_.known() ? first_control_ : control;
  LogicalLine line;
  for (LineReader before = reader; reader.next(line); before = reader) {
    const std::string_view word = card_name(line.text());
    if (same_name(word, ".endc")) {
      return;
    }
    if (!control_tran_ && same_name(word, "tran")) {
      control_tran_ = before;
    }
  }
  errors_.report("E-syntax-control", control, "'.control' has no '.endc'");
}

void Loader::take_control_tran() {
  if (!first_control_.known()) {
    return;
  }
  const bool taken = control_tran_ && !has_card(".tran");
  LogicalLine line;
  Card card;
  if (taken && control_tran_->next(line) && parse_card({line, errors_, limits_.parentheses}, card)) {
    card.name = ".tran";
    deck_.cards.push_back(std::move(card));
  }
  errors_.diagnostics().note("N-control-skipped", first_control_,
                             taken ? "the .control block is skipped, but for its tran line" : "the .control block is skipped");
}

bool Loader::has_card(std::string_view name) const {
  return std::any_of(deck_.cards.begin(), deck_.cards.end(), [&](const Card& card) { return same_name(card.name, name); });
}

/// Whether arguments without quotes are the name of a file that is there.
bool Loader::is_one_name(const File& from, const std::vector<FileArgument>& arguments) {
  if (std::any_of(arguments.begin(), arguments.end(), [](const FileArgument& argument) { return argument.quoted; })) return false;
  const char* const begin = arguments.front().whole.data();
  const char* const end = arguments.back().whole.data() + arguments.back().whole.size();
  return !find_file({begin, static_cast<std::size_t>(end - begin)}, from.directory).path.empty();
}

void Loader::request_file(const File& from, const ParseContext& context, std::string_view name,
                          const std::vector<FileArgument>& arguments) {
  const bool library = same_name(name, ".lib");
  const std::size_t most = library ? 2 : 1;
  if (arguments.empty()) {
    context.report("E-syntax-include", name, fmt::format("a file name is missing after '{}'", name));
    return;
  }
  // LTspice's own: C:\Program Files\…
  const bool has_blanks = arguments.size() > most && (is_windows_path(arguments[0].text) || is_one_name(from, arguments));
  if (arguments.size() > most && !has_blanks) {
    context.report("E-syntax-include", arguments[most].whole,
                   fmt::format("'{}' takes {}; try quotes around a name with blanks", name, library ? "a file and a section" : "one file"));
    return;
  }
  Request request{arguments[0].text, {}, context.line.span(arguments[0].whole), {}, library};
  if (has_blanks) {
    const char* const end = arguments.back().whole.data() + arguments.back().whole.size();
    request.file = {arguments[0].whole.data(), static_cast<std::size_t>(end - arguments[0].whole.data())};
    request.file_span = context.line.span(request.file);
  } else if (arguments.size() == 2) {
    request.section = arguments[1].text;
    request.section_span = context.line.span(arguments[1].whole);
  }
  read_request(from, request);
}

void Loader::read_request(const File& from, const Request& request) {
  if (exhausted_) {
    return;
  }
  const File* const file = open_file(from, request);
  if (file == nullptr || !file->is_text) {
    return;
  }
  Visit visit{file->index, without_case(request.section)};
  if (!may_visit(visit, request) || !may_read_again(*file, request)) {
    return;
  }
  visits_.push_back(std::move(visit));
  SectionFilter filter(request.section);
  read_cards(*file, 0, filter);
  visits_.pop_back();
  if (!filter.found()) {
    const std::string near = nearest_name(request.section, filter.names());
    errors_.report("E-lib-section", request.section_span,
                   fmt::format("'{}' has no section '{}'{}", request.file, request.section, near.empty() ? "" : "; try " + near));
  }
}

const Loader::File* Loader::open_file(const File& from, const Request& request) {
  if (request.is_library && is_standard_library(request.file)) deck_.names_ltspice_library = true;
  const auto [path, not_found, is_elsewhere] = find_file(request.file, from.directory);
  if (is_elsewhere)
    errors_.diagnostics().note("N-file-beside", request.file_span,
                               fmt::format("'{}' does not exist: {} is read", request.file, path.string()));
  FileBytes read;
  if (!path.empty()) {
    std::error_code error;
    const auto canonical = std::filesystem::weakly_canonical(path, error);
    const std::string key = error ? path.string() : canonical.string();
    const auto known = files_.find(key);
    if (known != files_.end()) {
      return &known->second;
    }
    read = read_file(path);
    if (read.readable) {
      return &files_.emplace(key, add_text(path.string(), std::move(read.bytes), path.parent_path())).first->second;
    }
  } else {
    read.reason = not_found;
  }
  if (sources_.is_from_nowhere(request.file_span.file, request.file_span.begin)) return nullptr;  // LTspice's library is not asked for
  const std::string text = fmt::format("cannot read '{}': {}", request.file, read.reason);
  const bool is_from_windows = is_windows_path(request.file);
  if (request.is_library ? is_standard_library(request.file) || is_from_windows : is_from_windows && names_models(request.file)) {
    errors_.diagnostics().warning("W-lib-skipped", request.file_span, text + "; its models are missing where they are used");
  } else {
    errors_.report("E-include-unreadable", request.file_span, text);
  }
  return nullptr;
}

std::vector<std::string> Loader::files() const {
  std::vector<std::string> names = symbol_files_;
  for (const auto& [path, file] : files_) names.push_back(path);
  return names;
}

bool Loader::may_visit(const Visit& visit, const Request& request) {
  const bool open =
      std::any_of(visits_.begin(), visits_.end(), [&](const Visit& v) { return v.file == visit.file && v.section == visit.section; });
  if (open) {
    errors_.report("E-include-recursion", request.file_span, fmt::format("'{}' includes itself", request.file));
    return false;
  }
  if (visits_.size() > static_cast<std::size_t>(limits_.include_depth)) {
    errors_.report("E-include-depth", request.file_span,
                   fmt::format("includes nest deeper than {}; try .options max_include_depth= before them", limits_.include_depth));
    return false;
  }
  return true;
}

/// Files that include one another several times would multiply without end long before they nest too deep.
bool Loader::may_read_again(const File& file, const Request& request) {
  constexpr std::size_t most_repeats = 10'000;
  constexpr std::size_t most_repeated_bytes = std::size_t{64} << 20U;
  if (reads_.insert(file.index).second) {
    return true;
  }
  repeated_files_ += 1;
  repeated_bytes_ += sources_.text(file.index).size();
  exhausted_ = repeated_files_ > most_repeats || repeated_bytes_ > most_repeated_bytes;
  if (exhausted_) {
    errors_.report("E-include-repeated", request.file_span,
                   fmt::format("files are included again and again, here '{}' after {} repetitions", request.file, most_repeats));
  }
  return !exhausted_;
}

bool is_schematic(std::string_view path) {
  constexpr std::string_view ending = ".asc";
  return path.size() > ending.size() && same_name(path.substr(path.size() - ending.size()), ending);
}

WrittenNetlist write_netlist(const std::string& path, SourceStore& sources, Diagnostics& diagnostics) {
  FileBytes file = read_file(path);
  if (!file.readable) {
    diagnostics.error("E-file-unreadable", {}, "cannot read '" + path + "': " + file.reason);
    return {{}, false, {}};
  }
  Loader loader(sources, diagnostics, {});
  WrittenNetlist written{loader.write_netlist(path, std::move(file.bytes), std::filesystem::path(path).parent_path()), true, {path}};
  for (std::string& name : loader.files()) written.files.push_back(std::move(name));
  return written;
}

Loaded load(const std::string& path, SourceStore& sources, Diagnostics& diagnostics, const LoadLimits& limits, Drawing* drawing) {
  FileBytes file = read_file(path);
  if (!file.readable) {
    diagnostics.error("E-file-unreadable", {}, "cannot read '" + path + "': " + file.reason);
    return {{}, false, {}};
  }
  Loader loader(sources, diagnostics, limits);
  loader.keep_drawing(drawing);
  Loaded loaded{loader.read_deck(path, std::move(file.bytes), std::filesystem::path(path).parent_path()), true, {path}};
  for (std::string& name : loader.files()) loaded.files.push_back(std::move(name));
  return loaded;
}

Deck parse(const std::string& name, std::string_view text, SourceStore& sources, Diagnostics& diagnostics, const LoadLimits& limits) {
  Loader loader(sources, diagnostics, limits);
  return loader.read_deck(name, std::string(text), {});
}

}  // namespace pwlsim::netlist
