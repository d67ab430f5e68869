#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "circuit/card_items.hpp"
#include "circuit/commands.hpp"
#include "circuit/measured_expression.hpp"

namespace pwlsim::circuit {
namespace {

using netlist::Card;
using netlist::Item;
using ItemKind = Item::Kind;

constexpr std::string_view ac_usage =
    ".ac dec|oct|lin N f1 f2 | list f ... [from=V1 | from=freq(V1) | from=duty(V1)] [loop=V1[,I1]] [harm=m] [sample=t]";
constexpr double most_frequencies = 1e6;

bool is_of_letter(char c, char letter) { return c == letter || c == letter - 'a' + 'A'; }

class SmallSignalReader {
 public:
  SmallSignalReader(const Card& card, Scope& scope, Reporter& reporter) : card_(card), scope_(scope), reporter_(reporter) {
    signal_.span = card.span;
  }

  std::optional<SmallSignalAnalysis> read() {
    for (const Item& item : card_.items) {
      if (item.kind == ItemKind::assignment)
        take_assignment(item);
      else if (item.kind == ItemKind::group && (is_named(item, "freq") || is_named(item, "duty")))
        take_timing(item);
      else if (spacing_.empty() && (is_word(item, "dec") || is_word(item, "oct") || is_word(item, "lin") || is_word(item, "list")))
        spacing_ = item.text;
      else if (follows_loop_ && item.kind == ItemKind::word && !item.text.empty() && is_of_letter(item.text[0], 'i'))
        signal_.loop_current = item.text;
      else
        take_number(item);
      if (!ok_) return std::nullopt;
      follows_loop_ = item.kind == ItemKind::assignment && is_named(item, "loop");
    }
    make_frequencies();
    return ok_ ? std::optional(std::move(signal_)) : std::nullopt;
  }

 private:
  static bool is_named(const Item& item, std::string_view name) { return same_name(item.text, name); }

  void fail(std::string id, SourceSpan span, std::string_view what) {
    if (ok_) reporter_.error(std::move(id), span, fmt::format("{}; usage: {}", what, ac_usage));
    ok_ = false;
  }

  void take_number(const Item& item) {
    const std::optional<Number> number = scope_.number(item);
    ok_ &= number.has_value();
    if (number) numbers_.push_back(number->value);
  }

  void take_assignment(const Item& item) {
    if (item.items.empty()) return fail("E-missing-value", item.span, fmt::format("a value is missing after {}=", item.text));
    const Item& value = item.items[0];
    if (is_named(item, "from")) {
      if (value.kind == ItemKind::group) return take_timing(value);
      signal_.input = SmallSignalAnalysis::Input::source;
      signal_.sources = {value.text};
      signal_.input_span = value.span;
    } else if (is_named(item, "loop")) {
      signal_.loop = value.text;
      signal_.input_span = value.span;
    } else if (is_named(item, "harm")) {
      const std::optional<Number> number = scope_.number(value);
      ok_ &= number.has_value();
      if (number && number->value != std::floor(number->value)) fail("E-range", value.span, "harm= is a whole number");
      if (ok_) signal_.harmonic = static_cast<int>(number->value);
    } else if (is_named(item, "sample")) {
      const std::optional<Number> number = scope_.number(value);
      ok_ &= number.has_value();
      if (number && !(number->value >= 0.0)) fail("E-range", value.span, "sample= is a time of the period");
      if (ok_) signal_.sample = number->value;
    } else {
      fail("E-unexpected", item.span, fmt::format("unknown parameter '{}'", item.text));
    }
  }

  void take_timing(const Item& group) {
    if (!is_named(group, "freq") && !is_named(group, "duty"))
      return fail("E-unexpected", group.span, fmt::format("'{}' is not an input", group.text));
    signal_.input = is_named(group, "freq") ? SmallSignalAnalysis::Input::frequency : SmallSignalAnalysis::Input::duty;
    signal_.input_span = group.span;
    for (const Item& source : group.items) signal_.sources.push_back(source.text);
    if (signal_.sources.empty()) fail("E-missing-value", group.span, fmt::format("{}() names no source", group.text));
  }

  void make_frequencies() {
    const bool is_list = same_name(spacing_, "list"), is_linear = same_name(spacing_, "lin");
    if (spacing_.empty() || numbers_.empty()) return fail("E-missing-value", card_.span, ".ac has no frequencies");
    if (is_list) {
      signal_.frequencies = numbers_;
    } else {
      if (numbers_.size() != 3) return fail("E-missing-value", card_.span, ".ac takes a number of points and two frequencies");
      const double count = numbers_[0], from = numbers_[1], to = numbers_[2];
      if (count < 1.0 || count != std::floor(count)) return fail("E-range", card_.span, "the number of points of .ac is 1, 2, ...");
      if (!(to >= from) || !(from > 0.0 || (is_linear && from >= 0.0)))
        return fail("E-range", card_.span, "the frequencies of .ac must be positive and ascending");
      const double base = same_name(spacing_, "oct") ? 2.0 : 10.0;
      constexpr double rounding = 1e-9;
      const double steps = is_linear ? count - 1.0 : std::floor(count * std::log(to / from) / std::log(base) + rounding);
      if (steps > most_frequencies) return fail("E-range", card_.span, fmt::format(".ac has more than {} frequencies", most_frequencies));
      for (double k = 0.0; k <= steps; ++k)
        signal_.frequencies.push_back(is_linear ? from + (count > 1.0 ? (to - from) * k / steps : 0.0) : from * std::pow(base, k / count));
    }
    for (const double f : signal_.frequencies)
      if (!(f >= 0.0 && std::isfinite(f))) fail("E-range", card_.span, "the frequencies of .ac must not be negative");
  }

  const Card& card_;
  Scope& scope_;
  Reporter& reporter_;
  SmallSignalAnalysis signal_;
  std::string spacing_;
  std::vector<double> numbers_;
  bool follows_loop_ = false;
  bool ok_ = true;
};

struct PartName {
  std::string_view letters;  ///< behind v or i
  SmallSignalAnalysis::Column::ComplexPart part;
};
constexpr PartName part_names[] = {{"m", SmallSignalAnalysis::Column::ComplexPart::magnitude},
                                   {"p", SmallSignalAnalysis::Column::ComplexPart::phase},
                                   {"r", SmallSignalAnalysis::Column::ComplexPart::real},
                                   {"i", SmallSignalAnalysis::Column::ComplexPart::imaginary},
                                   {"db", SmallSignalAnalysis::Column::ComplexPart::decibels}};

/// vm(a), vp(a), vr(a), vi(a), vdb(a), and the same of i; v(a) is magnitude and phase.
class ColumnReader {
 public:
  ColumnReader(Reporter& reporter, FlatCircuit& circuit, std::vector<SmallSignalAnalysis::Column>& columns)
      : reporter_(reporter), circuit_(circuit), columns_(columns) {}

  void read(const Item& item) {
    const bool is_signal =
        item.kind == ItemKind::group && !item.text.empty() && (is_of_letter(item.text[0], 'v') || is_of_letter(item.text[0], 'i'));
    const std::string_view letters = is_signal ? std::string_view(item.text).substr(1) : std::string_view();
    const auto* known =
        std::find_if(std::begin(part_names), std::end(part_names), [&](const PartName& part) { return same_name(part.letters, letters); });
    if (!is_signal || (!letters.empty() && known == std::end(part_names))) {
      reporter_.error(
          "E-unexpected", item.span,
          fmt::format("'{}' is not part of a signal; usage: .print ac vm(a) vp(a) vr(a) vi(a) vdb(a)", reporter_.text(item.span)));
      return;
    }
    Item signal = item;
    signal.text = item.text.substr(0, 1);
    std::optional<SaveRequest> request = save_request(signal, reporter_);
    if (!request || request->kind == SaveRequest::Kind::all) return;
    const std::string inside = request->column.substr(request->column.find('('));
    const int probe = add_probe(circuit_, std::move(*request));
    const auto add = [&](std::string_view part_letters, SmallSignalAnalysis::Column::ComplexPart part) {
      columns_.push_back({fmt::format("{}{}{}", signal.text, part_letters, inside), part, probe});
    };
    if (!letters.empty()) return add(known->letters, known->part);
    add("m", SmallSignalAnalysis::Column::ComplexPart::magnitude);
    add("p", SmallSignalAnalysis::Column::ComplexPart::phase);
  }

 private:
  Reporter& reporter_;
  FlatCircuit& circuit_;
  std::vector<SmallSignalAnalysis::Column>& columns_;
};

}  // namespace

/// Beside a .tran without .pss, as in decks of other simulators, it is left out.
void read_small_signal(const Definitions& definitions, Scope& scope, Reporter& reporter, FlatCircuit& circuit) {
  const auto& cards = definitions.small_signals;
  if (cards.empty() || cards.back()->damaged) return;
  for (std::size_t k = 0; k + 1 < cards.size(); ++k)
    reporter.warning("W-ignored-card", cards[k]->name_span,
                     fmt::format("this .ac is ignored: the last one is used, at {}", reporter.where(cards.back()->span)));
  std::optional<SmallSignalAnalysis>& small_signal = circuit.analyses.small_signal;
  small_signal = SmallSignalReader(*cards.back(), scope, reporter).read();
  if (!small_signal) return;
  ColumnReader columns(reporter, circuit, small_signal->columns);
  for (const Card* card : definitions.response_prints)
    for (std::size_t k = 1; k < card->items.size(); ++k) columns.read(card->items[k]);
}

}  // namespace pwlsim::circuit
