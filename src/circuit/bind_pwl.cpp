#include "circuit/bind_pwl.hpp"

#include <fmt/format.h>

#include "base/names.hpp"
#include "circuit/pwl_file.hpp"

namespace pwlsim::circuit {
namespace {

using elements::PwlCard;
using elements::PwlPart;
using netlist::Item;
using ItemKind = Item::Kind;

class PwlBinding {
 public:
  PwlBinding(CardCursor& cursor, bool closed, Scope& scope, Reporter& reporter, SourceSpan span)
      : cursor_(cursor), closed_(closed), scope_(scope), reporter_(reporter) {
    card_.span = span;
  }

  std::optional<PwlCard> read() {
    while (at_waveform_value(cursor_)) {
      if (!(word_is(cursor_.peek(), "repeat") ? repeated_part() : plain_part())) return std::nullopt;
    }
    while (closed_ && !cursor_.at_end()) {
      if (!option(*cursor_.next())) return std::nullopt;
    }
    return std::move(card_);
  }

 private:
  bool fail(std::string id, SourceSpan span, std::string_view text) {
    reporter_.error(std::move(id), span, fmt::format("{}; usage: {}", text, elements::pwl_usage));
    return false;
  }

  bool option(const Item& item) {
    if (is_pwl_option(item)) return read_pwl_option(item, card_, scope_, reporter_);
    if (is_pwl_file(item)) return read_pwl_file(item, card_, scope_, reporter_);
    return fail("E-unexpected", item.span, fmt::format("unexpected '{}'", reporter_.text(item.span)));
  }

  bool plain_part() {
    if (word_is(cursor_.peek(), "endrepeat")) return fail("E-unexpected", cursor_.peek()->span, "ENDREPEAT without REPEAT");
    card_.parts.push_back({{}, 1.0, cursor_.peek()->span});
    return points(card_.parts.back());
  }

  bool repeated_part() {
    const SourceSpan span = cursor_.next()->span;
    const std::optional<double> passes = read_passes(span);
    if (!passes) return false;
    card_.parts.push_back({{}, *passes, span});
    if (!points(card_.parts.back())) return false;
    if (!word_is(cursor_.peek(), "endrepeat")) return fail("E-missing-value", span, "REPEAT has no ENDREPEAT");
    cursor_.next();
    return true;
  }

  std::optional<double> read_passes(SourceSpan repeat) {
    const Item* word = cursor_.next();
    if (word_is(word, "forever")) return elements::infinite;
    if (!word_is(word, "for") || !at_waveform_value(cursor_)) {
      fail("E-unexpected", word != nullptr ? word->span : repeat, "REPEAT takes FOREVER or FOR n");
      return std::nullopt;
    }
    const Item& count = *cursor_.next();
    const std::optional<Number> number = scope_.number(count);
    if (!number) return std::nullopt;
    const elements::Parameter passes{"n", "", 1.0, elements::Range::whole_positive, false, ""};
    if (elements::in_range(passes, number->value)) return number->value;
    reporter_.error("E-range", count.span,
                    fmt::format("the number of repetitions {}, not {}", elements::range_words(passes.range), number->value));
    return std::nullopt;
  }

  /// Pairs up to the end, REPEAT or ENDREPEAT.
  bool points(PwlPart& part) {
    while (at_waveform_value(cursor_) && !word_is(cursor_.peek(), "repeat") && !word_is(cursor_.peek(), "endrepeat")) {
      if (!point(part)) return false;
    }
    return true;
  }

  bool point(PwlPart& part) {
    elements::PwlPoint point;
    const Item* time = cursor_.next();
    point.span = time->span;
    point.relative = time->kind == ItemKind::word && time->text.starts_with('+');
    if (word_is(time, "+")) time = cursor_.next();  // the sign stands before an expression
    if (time == nullptr || !at_waveform_value(cursor_)) return fail("E-missing-value", point.span, "this time of a PWL has no value");
    const std::optional<Number> at = scope_.number(*time);
    if (at) scope_.claim(*at);
    const std::optional<Number> value = scope_.number(*cursor_.next());
    if (value) scope_.claim(*value);
    if (!at || !value) return false;
    point.time_gradient = at->gradient;
    point.value_gradient = value->gradient;
    point.time = at->value;
    point.value = value->value;
    part.points.push_back(point);
    return true;
  }

  CardCursor& cursor_;
  bool closed_;
  Scope& scope_;
  Reporter& reporter_;
  PwlCard card_;
};

}  // namespace

bool word_is(const Item* item, std::string_view text) {
  return item != nullptr && item->kind == ItemKind::word && same_name(item->text, text);
}

bool at_waveform_value(const CardCursor& cursor) {
  return cursor.at_positional() && !cursor.at(ItemKind::group) && !word_is(cursor.peek(), "ac") && !word_is(cursor.peek(), "dc");
}

std::optional<PwlCard> bind_pwl(CardCursor& cursor, bool closed, Scope& scope, Reporter& reporter, SourceSpan span) {
  return PwlBinding(cursor, closed, scope, reporter, span).read();
}

bool is_pwl_option(const Item& item) {
  return item.kind == ItemKind::assignment && (same_name(item.text, "r") || same_name(item.text, "td"));
}

bool read_pwl_option(const Item& item, PwlCard& card, Scope& scope, Reporter& reporter) {
  if (item.items.empty()) {
    reporter.error("E-missing-value", item.span, fmt::format("{} has no value; usage: {}", item.text, elements::pwl_usage));
    return false;
  }
  const std::optional<Number> number = scope.number(item.items[0]);
  if (!number) return false;
  scope.claim(*number);
  if (same_name(item.text, "td")) {
    card.delay = number->value;
    card.delay_gradient = number->gradient;
  } else {
    card.repeat_from = number->value;
    card.repeat_gradient = number->gradient;
    card.repeat_span = item.span;
  }
  return true;
}

}  // namespace pwlsim::circuit
