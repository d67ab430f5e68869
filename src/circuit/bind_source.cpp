#include "circuit/bind_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <variant>

#include "base/names.hpp"
#include "circuit/bind_pwl.hpp"
#include "circuit/pwl_file.hpp"
#include "circuit/values.hpp"
#include "elements/waveform.hpp"

namespace pwlsim::circuit {
namespace {

using elements::PwlCard;
using elements::WaveformKind;
using netlist::Item;
using ItemKind = Item::Kind;

constexpr std::string_view foreign_waveforms[] = {"SFFM", "AM", "TRNOISE", "TRRANDOM", "EXTERNAL", "WAVEFILE", "PATTERN"};

bool is_foreign(std::string_view name) {
  for (std::string_view foreign : foreign_waveforms) {
    if (same_name(foreign, name)) return true;
  }
  return false;
}

/// A bound of its values from below.
double least_value(const model::SourceFunction& function) {
  if (const auto* constant = std::get_if<model::Dc>(&function)) return constant->value;
  if (const auto* sine = std::get_if<model::Sin>(&function))
    return sine->damping < 0.0 ? -model::forever : sine->offset - std::abs(sine->amplitude);
  if (const auto* pulse = std::get_if<model::Pulse>(&function)) return std::min(pulse->initial, pulse->pulsed);
  if (const auto* exponential = std::get_if<model::Exp>(&function)) return std::min(exponential->v1, exponential->v2);
  const auto* pwl = std::get_if<model::Pwl>(&function);
  if (pwl == nullptr || pwl->points.empty()) return -model::forever;
  return std::ranges::min(pwl->points, {}, &model::Pwl::Point::value).value;
}

class SourceBinding {
 public:
  SourceBinding(CardCursor& cursor, Scope& scope, Reporter& reporter, const netlist::Card& card, elements::Instance& instance)
      : cursor_(cursor), scope_(scope), reporter_(reporter), card_(card), instance_(instance) {}

  bool bind() {
    if (cursor_.at_end() && !card_.damaged) assume_zero();
    while (!cursor_.at_end() && step()) {
    }
    finish_pwl();
    if (!waveform_seen_ && dc_) instance_.waveform = model::Dc{*dc_};
    if (load_ != nullptr) finish_load();
    return waveform_seen_ && dc_seen_;
  }

 private:
  /// An ammeter, or a source that a sweep or another analysis would set.
  void assume_zero() {
    dc_ = 0.0;
    reporter_.note("N-no-value", card_.span, fmt::format("{} has no value: it is 0", card_.name));
  }

  /// LTspice's load never delivers power: it carries nothing against a negative voltage.
  void finish_load() {
    if (!instance_.waveform) return;
    instance_.is_load = instance_.kind->letter == 'I' && least_value(*instance_.waveform) >= 0.0;
    if (!instance_.is_load)
      reporter_.note("N-load", load_->span,
                     fmt::format("load is ignored: {} is no current source, or its current may be negative", card_.name));
  }

  void missing(std::string_view what) {
    reporter_.error("E-missing-value", card_.span, fmt::format("{} needs {}; usage: {}", card_.name, what, instance_.kind->usage));
  }

  bool unexpected(const Item& item) {
    reporter_.error("E-unexpected", item.span, fmt::format("unexpected '{}'; usage: {}", reporter_.text(item.span), instance_.kind->usage));
    return false;
  }

  /// One part of the card; false where the rest cannot be understood.
  bool step() {
    const Item& item = *cursor_.peek();
    if (item.kind == ItemKind::assignment) return assignment();
    if (word_is(&item, "ac")) return alternating();
    if (word_is(&item, "load")) {
      load_ = cursor_.next();
      return true;
    }
    if (word_is(&item, "dc")) {
      cursor_.next();
      if (cursor_.at_positional()) return dc_seen_ ? unexpected(*cursor_.next()) : constant();
      missing("a value after DC");
      return false;
    }
    if (item.kind == ItemKind::group && is_constant_group(item)) return constant_group();
    if (item.kind == ItemKind::group) return grouped();
    if (item.kind == ItemKind::word && is_waveform(item.text)) return listed();
    return dc_seen_ || waveform_seen_ ? unexpected(item) : constant();
  }

  static bool is_waveform(std::string_view name) {
    return elements::find_waveform(name) != nullptr || same_name(name, "pwl") || is_foreign(name);
  }

  bool constant() {
    dc_seen_ = true;
    if (const std::optional<Number> number = scope_.number(*cursor_.next())) dc_ = number->value;
    return true;
  }

  /// DC(48)
  [[nodiscard]] bool is_constant_group(const Item& item) const { return same_name(item.text, "dc") && item.items.size() == 1 && !dc_seen_; }

  bool constant_group() {
    dc_seen_ = true;
    if (const std::optional<Number> number = scope_.number(cursor_.next()->items[0])) dc_ = number->value;
    return true;
  }

  /// Magnitude and phase in degrees, either of which may be missing.
  bool alternating() {
    cursor_.next();
    double values[2] = {1.0, 0.0};
    for (int k = 0; k < 2 && at_number(); ++k)
      if (const std::optional<Number> number = scope_.number(*cursor_.next())) values[k] = number->value;
    instance_.alternating = std::polar(values[0], values[1] * std::numbers::pi / 180.0);
    if (!dc_) dc_ = 0.0;
    return true;
  }

  bool at_number() const {
    if (!cursor_.at_positional() || cursor_.at(ItemKind::group)) return false;
    const Item& item = *cursor_.peek();
    return item.kind != ItemKind::word || (!is_waveform(item.text) && !word_is(&item, "dc"));
  }

  bool assignment() {
    const Item& item = *cursor_.next();
    const bool empty = item.items.empty();
    if (same_name(item.text, "dc") && !empty) return named_constant(item);
    if (same_name(item.text, "ac")) {
      const std::optional<Number> number = empty ? std::nullopt : scope_.number(item.items[0]);
      if (number) instance_.alternating = number->value;
      return true;
    }
    if (pwl_ && is_pwl_file(item)) {
      if (read_pwl_file(item, *pwl_, scope_, reporter_)) return true;
      pwl_.reset();
      return false;
    }
    if (pwl_ && is_pwl_option(item)) {
      read_pwl_option(item, *pwl_, scope_, reporter_);
      return true;
    }
    ValueReader(scope_, reporter_, card_.name).assignment(item, instance_.values);
    return true;
  }

  bool named_constant(const Item& item) {
    if (dc_seen_) return unexpected(item);
    dc_seen_ = true;
    if (const std::optional<Number> number = scope_.number(item.items[0])) dc_ = number->value;
    return true;
  }

  bool grouped() {
    const Item& group = *cursor_.next();
    CardCursor inside(group.items);
    return waveform(group.text, group.text_span, group.span, inside);
  }

  /// Without parentheses: SIN 0 1 50
  bool listed() {
    const Item& name = *cursor_.next();
    return waveform(name.text, name.span, card_.span, cursor_);
  }

  bool waveform(std::string_view name, SourceSpan name_span, SourceSpan span, CardCursor& values) {
    const WaveformKind* kind = elements::find_waveform(name);
    if (waveform_seen_) {
      reporter_.error("E-unexpected", name_span, fmt::format("{} has a second waveform", card_.name));
      return false;
    }
    waveform_seen_ = true;
    if (same_name(name, "pwl")) return piecewise(span, values);
    if (kind == nullptr) {
      reporter_.error(is_foreign(name) ? "E-not-supported" : "E-unknown-waveform", name_span, complaint(name));
      return false;
    }
    fixed(*kind, span, values);
    return true;
  }

  static std::string complaint(std::string_view name) {
    if (is_foreign(name)) return fmt::format("the waveform {} is not supported", name);
    std::vector<std::string> names{"PWL", "SINE"};
    for (const WaveformKind& kind : elements::waveform_kinds()) names.emplace_back(kind.name);
    return fmt::format("unknown waveform '{}'{}", name, suggestion(name, names));
  }

  void fixed(const WaveformKind& kind, SourceSpan span, CardCursor& cursor) {
    elements::Values values(kind.parameters);
    ValueReader reader(scope_, reporter_, kind.name);
    std::size_t count = 0;
    for (; at_waveform_value(cursor); ++count) {
      const Item& item = *cursor.next();
      if (count < kind.parameters.size()) {
        reader.positional(item, kind.parameters[count], values);
      } else {
        reporter_.error("E-unexpected", item.span,
                        fmt::format("{} takes {} values at most; usage: {}", kind.name, kind.parameters.size(), kind.usage));
      }
    }
    if (&cursor != &cursor_ && !cursor.at_end()) unexpected(*cursor.peek());
    if (count < kind.required) {
      reporter_.error("E-missing-value", span, fmt::format("{} needs {}; usage: {}", kind.name, kind.parameters[count].name, kind.usage));
      return;
    }
    make(kind, values, span);
  }

  void make(const WaveformKind& kind, const elements::Values& values, SourceSpan span) {
    Diagnostics scratch;
    instance_.waveform_values = values;
    instance_.waveform = kind.make(values, span, scratch);
    reporter_.forward(scratch);
  }

  bool piecewise(SourceSpan span, CardCursor& values) {
    pwl_ = bind_pwl(values, &values != &cursor_, scope_, reporter_, span);
    return pwl_.has_value();
  }

  void finish_pwl() {
    if (!pwl_) return;
    Diagnostics scratch;
    instance_.waveform = elements::make_pwl(*pwl_, scratch);
    if (instance_.waveform) instance_.waveform_moves = elements::pwl_derivatives(*pwl_);
    reporter_.forward(scratch);
  }

  CardCursor& cursor_;
  Scope& scope_;
  Reporter& reporter_;
  const netlist::Card& card_;
  elements::Instance& instance_;
  std::optional<double> dc_;
  bool dc_seen_ = false;
  bool waveform_seen_ = false;
  const Item* load_ = nullptr;  ///< the word
  std::optional<PwlCard> pwl_;
};

}  // namespace

bool bind_source(CardCursor& cursor, Scope& scope, Reporter& reporter, const netlist::Card& card, elements::Instance& instance) {
  return SourceBinding(cursor, scope, reporter, card, instance).bind();
}

}  // namespace pwlsim::circuit
