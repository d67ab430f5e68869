#include "circuit/raw_system_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <memory>

#include <fmt/format.h>

#include "base/names.hpp"
#include "circuit/bind_source.hpp"
#include "elements/catalogue.hpp"
#include "elements/raw_system.hpp"
#include "netlist/number.hpp"

namespace pwlsim::circuit {
namespace {

using elements::RawSystem;
using elements::Rows;
using netlist::Card;
using netlist::Item;
using ItemKind = Item::Kind;

constexpr std::array<std::string_view, 8> keywords{"A", "B", "C", "D", "E", "F", "x0", "w"};

/// One keyword and the lines behind it.
struct KeywordBlock {
  std::string_view keyword;
  SourceSpan span;
  std::vector<const Card*> lines;
  Rows rows;
};

class RawSystemReader {
 public:
  RawSystemReader(const Card& card, Scope& scope, Reporter& reporter) : card_(card), scope_(scope), reporter_(reporter) {}

  std::shared_ptr<const RawSystem> read() {
    split();
    for (KeywordBlock& block : blocks_)
      if (block.keyword != "w") read_numbers(block);
    if (failed_) return nullptr;
    take_sizes();
    require_matrices();
    place("A", states_, states_, raw_.a);
    place("B", states_, ports_, raw_.b);
    place("C", ports_, states_, raw_.c);
    place("D", ports_, ports_, raw_.d);
    place("E", states_, inputs_, raw_.e);
    place("F", ports_, inputs_, raw_.f);
    Rows start;
    place("x0", 1, states_, start);
    raw_.start = start.empty() ? std::vector<double>(states_, 0.0) : start[0];
    if (const KeywordBlock* w = find("w")) read_inputs(*w);
    if (failed_) return nullptr;
    raw_.states = static_cast<int>(states_);
    raw_.ports = static_cast<int>(ports_);
    return std::make_shared<const RawSystem>(std::move(raw_));
  }

 private:
  void fail(SourceSpan span, std::string text) {
    reporter_.error("E-lcs", span, std::move(text));
    failed_ = true;
  }

  [[nodiscard]] const KeywordBlock* find(std::string_view keyword) const {
    const auto found = std::find_if(blocks_.begin(), blocks_.end(), [&](const KeywordBlock& block) { return block.keyword == keyword; });
    return found == blocks_.end() ? nullptr : &*found;
  }

  void split() {
    for (const Card& line : card_.rows) {
      const auto keyword =
          std::find_if(keywords.begin(), keywords.end(), [&](std::string_view word) { return same_name(word, line.name); });
      if (keyword != keywords.end() && line.items.empty()) {
        if (find(*keyword) != nullptr) fail(line.span, fmt::format("a second {}", *keyword));
        blocks_.push_back({*keyword, line.span, {}, {}});
      } else if (blocks_.empty()) {
        fail(line.span, fmt::format("rows must follow a keyword: {}", fmt::join(keywords, " ")));
      } else {
        blocks_.back().lines.push_back(&line);
      }
      if (failed_) return;
    }
  }

  void read_numbers(KeywordBlock& block) {
    for (const Card* line : block.lines) {
      std::vector<double>& row = block.rows.emplace_back();
      read_number(line->name, line->name_span, row);
      for (const Item& item : line->items) read_number(item.kind == ItemKind::word ? item.text : "", item.span, row);
      if (row.size() != block.rows[0].size())
        fail(line->span, fmt::format("a row of {} numbers in {}, whose first row has {}", row.size(), block.keyword, block.rows[0].size()));
    }
  }

  void read_number(std::string_view text, SourceSpan span, std::vector<double>& row) {
    const netlist::NumberText number = netlist::read_number(text);
    row.push_back(number.value);
    if (!number.valid || number.infinite)
      fail(span, fmt::format("'{}' is not a number", reporter_.text(span)));
    else if (!std::isfinite(number.value))
      fail(span, fmt::format("'{}' is too large", reporter_.text(span)));
  }

  void take_sizes() {
    const auto count = [&](std::string_view keyword) { return find(keyword) != nullptr ? find(keyword)->lines.size() : 0; };
    states_ = count("A");
    ports_ = std::max(count("C"), count("D"));
    if (const KeywordBlock* b = find("B"); ports_ == 0 && b != nullptr && !b->rows.empty()) ports_ = b->rows[0].size();
    inputs_ = count("w");
    if (states_ + ports_ == 0) fail(card_.span, fmt::format("{} has neither states nor ports", card_.items[0].text));
  }

  /// D, E, F and x0 may be left out; A where there are no states, B and C where there are no ports or no states.
  void require_matrices() {
    const auto require = [&](std::string_view keyword, std::initializer_list<std::string_view> readers) {
      if (find(keyword) != nullptr) return;
      for (const std::string_view reader : readers)
        if (const KeywordBlock* block = find(reader); block != nullptr && !block->lines.empty())
          return fail(block->span, fmt::format("{} is missing, which {} needs; only D, E, F and x0 are zero if left out", keyword, reader));
    };
    require("A", {"B", "C", "E", "x0"});
    if (states_ == 0) return;
    require("B", {"C", "D", "F"});
    require("C", {"B", "D", "F"});
  }

  /// The matrix behind `keyword`, or none: zero.
  void place(std::string_view keyword, std::size_t rows, std::size_t columns, Rows& matrix) {
    const KeywordBlock* block = find(keyword);
    if (block == nullptr) return;
    const std::size_t given = block->rows.empty() ? 0 : block->rows[0].size();
    if (block->rows.size() == rows && given == columns) {
      matrix = block->rows;
    } else if (rows != 0 || columns != 0 || !block->rows.empty()) {
      fail(block->span, fmt::format("{} is {} by {}, but must be {} by {}: {} states, {} ports, {} inputs", keyword, block->rows.size(),
                                    given, rows, columns, states_, ports_, inputs_));
    }
  }

  /// Each line as on a V card.
  void read_inputs(const KeywordBlock& block) {
    for (const Card* line : block.lines) {
      std::vector<Item> items = line->items;
      Item head;
      head.text = line->name;
      head.span = head.text_span = line->name_span;
      if (!items.empty() && items[0].kind == ItemKind::group && items[0].text.empty() && items[0].span.begin == line->name_span.end) {
        items[0].text = line->name;
        items[0].text_span = line->name_span;
        items[0].span = cover(line->name_span, items[0].span);
      } else {
        items.insert(items.begin(), std::move(head));
      }
      elements::Instance source;
      source.kind = elements::find_kind('V');
      source.values = elements::Values(source.kind->parameters);
      CardCursor cursor(items);
      (void)bind_source(cursor, scope_, reporter_, *line, source);
      raw_.inputs.push_back(source.waveform.value_or(model::Dc{}));
    }
  }

  const Card& card_;
  Scope& scope_;
  Reporter& reporter_;
  std::vector<KeywordBlock> blocks_;
  RawSystem raw_;
  std::size_t states_ = 0, ports_ = 0, inputs_ = 0;
  bool failed_ = false;
};

}  // namespace

void read_raw_systems(const std::vector<const Card*>& cards, Scope& scope, Reporter& reporter, FlatCircuit& circuit) {
  for (const Card* card : cards) {
    const bool shaped = card->items.size() == 2 && card->items[0].kind == ItemKind::word;
    if (!shaped && !card->damaged) {
      reporter.error("E-lcs", card->span, ".lcs needs a name and a file; usage: .lcs name \"file\"");
    }
    if (!shaped) continue;
    elements::Instance instance;
    instance.name = card->items[0].text;
    instance.span = card->items[0].span;
    if (!card->damaged) instance.raw_system = RawSystemReader(*card, scope, reporter).read();
    if (instance.raw_system != nullptr) instance.kind = &elements::raw_system_kind();
    circuit.instances.push_back(std::move(instance));
  }
}

}  // namespace pwlsim::circuit
