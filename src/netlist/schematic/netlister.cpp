#include "netlist/schematic/netlister.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "base/names.hpp"
#include "netlist/decode.hpp"
#include "netlist/files.hpp"
#include "netlist/schematic/element.hpp"
#include "netlist/schematic/shelf.hpp"
#include "netlist/schematic/words.hpp"

namespace pwlsim::netlist {

namespace {

/// What LTspice adds where an element of that kind stands.
struct Addition {
  char letter;
  std::array<std::string_view, 2> models;
  std::string_view library;
};
constexpr std::array<Addition, 4> additions{{{'d', {"D", ""}, "standard.dio"},
                                             {'q', {"NPN", "PNP"}, "standard.bjt"},
                                             {'m', {"NMOS", "PMOS"}, "standard.mos"},
                                             {'j', {"NJF", "PJF"}, "standard.jft"}}};

/// What has no meaning within a block.
bool is_for_top(std::string_view line) {
  constexpr std::array<std::string_view, 12> all{".tran", ".op",   ".ac",   ".dc",   ".noise",   ".tf",
                                                 ".meas", ".four", ".step", ".save", ".options", ".option"};
  const std::string_view word = take_word(line);
  return std::any_of(all.begin(), all.end(), [&](std::string_view known) { return same_name(known, word); });
}

/// All its pins lie at ends of wires or at labels.
bool is_connected(const Placed& element, const Sheet& sheet) {
  const auto is_end = [&](GridPoint pin) {
    return std::any_of(sheet.wires.begin(), sheet.wires.end(), [&](const Wire& wire) { return wire.from == pin || wire.to == pin; }) ||
           std::any_of(sheet.flags.begin(), sheet.flags.end(), [&](const Flag& flag) { return flag.at == pin; });
  };
  const std::vector<GridPoint> pins = element.pins();
  return std::all_of(pins.begin(), pins.end(), is_end);
}

bool ends_deck(std::string_view line) {
  const std::string_view word = take_word(line);
  return same_name(word, ".end") || same_name(word, ".backanno");
}

class Netlister {
 public:
  Netlister(const std::filesystem::path& folder, SourceStore& sources, Diagnostics& diagnostics, Drawing* drawing)
      : shelf_(folder), sources_(sources), diagnostics_(diagnostics), drawing_(drawing) {}

  SchematicNetlist write(FileIndex schematic, const std::filesystem::path& folder) {
    add_line(fmt::format("* {}", sources_.name(schematic)), {schematic, 0});
    const Sheet sheet = read_sheet(schematic, sources_, diagnostics_);
    note_models(sheet);
    write_elements(sheet, folder, {});
    while (!waiting_.empty()) write_block();
    write_additions();
    write_directives(sheet, false);
    add_line(".backanno", {});
    add_line(".end", {});
    for (std::string& file : shelf_.files()) netlist_.files.push_back(std::move(file));
    return std::move(netlist_);
  }

 private:
  struct SheetBlock {
    std::string name;
    std::filesystem::path file;
    std::vector<std::string> ports;
  };
  /// That a symbol asks for.
  struct Library {
    std::string file;
    SourceOrigin origin;
  };

  void add_line(const std::string& line, SourceOrigin origin) {
    netlist_.text += line + '\n';
    netlist_.origins.push_back(origin);
  }

  void note_models(const Sheet& sheet) {
    for (const Directive& directive : sheet.directives) {
      std::string_view rest = directive.text;
      if (same_name(take_word(rest), ".model")) models_.insert(without_case(take_word(rest)));
    }
  }

  void write_elements(const Sheet& sheet, const std::filesystem::path& folder, const SheetBlock& block) {
    std::vector<Placed> placed;
    for (const Instance& instance : sheet.instances) place(instance, sheet, folder, placed);
    std::vector<GridPoint> pins;
    std::vector<Wire> jumpers;
    for (const Placed& element : placed) {
      const std::vector<GridPoint> own = element.pins();
      pins.insert(pins.end(), own.begin(), own.end());
      if (is_jumper(element)) jumpers.push_back({own[0], own[1]});
    }
    const Nets nets(sheet, pins, jumpers);
    for (const Placed& element : placed) {
      if (!is_jumper(element)) write_element(element, nets);
    }
    for (const Nets::Alias& alias : nets.aliases()) add_line(fmt::format("R_label_{} {} {} 0", alias.label, alias.label, alias.net), {});
    if (drawing_ != nullptr) add_drawing(draw_sheet(sheet, placed, nets), block);
  }

  void add_drawing(DrawnSheet drawn, const SheetBlock& block) {
    drawn.block = block.name;
    drawn.ports = block.ports;
    drawing_->push_back(std::move(drawn));
  }

  void place(const Instance& instance, const Sheet& sheet, const std::filesystem::path& folder, std::vector<Placed>& placed) {
    const FoundSymbol found = shelf_.symbol(instance.symbol, folder);
    if (found.symbol == nullptr) {
      report_unknown(instance);
      return;
    }
    Placed element{&instance, found.symbol, {}};
    if (found.is_guess && !is_connected(element, sheet)) {
      report_unknown(instance);
      return;
    }
    if (found.symbol->prefix.empty() && !call_block(element, found, folder)) return;
    if (element.attribute("InstName").empty() && !is_jumper(element)) {
      diagnostics_.error("E-schematic-name", instance.span, "this symbol has no name; try a line 'SYMATTR InstName R1' after it");
      return;
    }
    placed.push_back(element);
  }

  void report_unknown(const Instance& instance) {
    const std::string near = nearest_name(without_folder(instance.symbol), standard_symbol_names());
    diagnostics_.error(
        "E-schematic-symbol", instance.span,
        fmt::format("unknown symbol '{}', and there is no file {}.asy beside the schematic; try {}", instance.symbol,
                    without_folder(instance.symbol), near.empty() ? "to copy that file, and its model, to the schematic's folder" : near));
  }

  /// A symbol without a prefix stands for a schematic of its own.
  bool call_block(Placed& element, const FoundSymbol& found, const std::filesystem::path& folder) {
    const std::string& name = element.instance->symbol;
    const std::filesystem::path file = shelf_.block(found, name, folder);
    if (file.empty()) {
      diagnostics_.error(
          "E-schematic-symbol", element.instance->span,
          fmt::format("the symbol '{}' has no prefix, so it represents a block, but there is no schematic {}.asc beside it; try to copy "
                      "that file to its folder",
                      name, without_folder(name)));
      return false;
    }
    element.block = node_name(without_folder(name));
    if (blocks_.insert(without_case(element.block)).second) {
      SheetBlock block{element.block, file, {}};
      for (const auto& pin : found.symbol->pins)
        if (pin) block.ports.push_back(is_ground_name(pin->name) ? "0" : node_name(pin->name));
      waiting_.push_back(std::move(block));
    }
    return true;
  }

  void write_element(const Placed& element, const Nets& nets) {
    kinds_.insert(element.letter());
    const SourceOrigin origin{element.instance->span.file, element.instance->span.begin};
    if (element.block.empty()) note_library(library_of(element), origin);
    add_line(element_line(element, nets), origin);
  }

  void note_library(const std::string& file, SourceOrigin origin) {
    const auto is_same = [&](const Library& known) { return known.file == file; };
    if (!file.empty() && std::none_of(libraries_.begin(), libraries_.end(), is_same)) libraries_.push_back({file, origin});
  }

  void write_block() {
    const SheetBlock block = waiting_.back();
    waiting_.pop_back();
    FileBytes file = read_file(block.file);
    DecodedText decoded = decode(std::move(file.bytes));
    const FileIndex index = sources_.add(block.file.string(), std::move(decoded.text));
    netlist_.files.push_back(block.file.string());
    const Sheet sheet = read_sheet(index, sources_, diagnostics_);
    const SourceOrigin origin{index, 0};
    add_line(fmt::format(".subckt {} {}", block.name, fmt::join(block.ports, " ")), origin);
    write_elements(sheet, block.file.parent_path(), block);
    write_directives(sheet, true);
    add_line(fmt::format(".ends {}", block.name), origin);
  }

  void write_additions() {
    for (const Addition& addition : additions) {
      if (!kinds_.contains(addition.letter)) continue;
      for (const std::string_view model : addition.models)
        if (!model.empty() && !models_.contains(without_case(model))) add_line(fmt::format(".model {} {}", model, model), {});
      add_line(fmt::format(".lib {}", addition.library), {});
    }
    for (const Library& library : libraries_) add_line(fmt::format(".lib \"{}\"", library.file), library.origin);
  }

  void write_directives(const Sheet& sheet, bool is_block) {
    for (const Directive& directive : sheet.directives)
      if (!ends_deck(directive.text) && !(is_block && is_for_top(directive.text)))
        add_line(directive.text, {sheet.file, directive.offset, true});
  }

  Shelf shelf_;
  SourceStore& sources_;
  Diagnostics& diagnostics_;
  Drawing* drawing_;
  SchematicNetlist netlist_;
  std::set<char> kinds_;
  std::set<std::string> models_, blocks_;
  std::vector<Library> libraries_;
  std::vector<SheetBlock> waiting_;
};

}  // namespace

SchematicNetlist netlist_of(FileIndex schematic, const std::filesystem::path& folder, SourceStore& sources, Diagnostics& diagnostics,
                            Drawing* drawing) {
  return Netlister(folder, sources, diagnostics, drawing).write(schematic, folder);
}

}  // namespace pwlsim::netlist
