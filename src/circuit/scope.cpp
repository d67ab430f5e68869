#include "circuit/scope.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/names.hpp"
#include "circuit/guarded_cards.hpp"
#include "netlist/number.hpp"

namespace pwlsim::circuit {

using ItemKind = netlist::Item::Kind;

Scope::Scope(const Definition& definition, Scope* outer, Session& session) : definition_(definition), outer_(outer), session_(session) {
  for (const auto* list : {&definition.formals, &definition.parameters}) {
    for (const ParameterText& text : *list) {
      const auto [entry, is_new] = entries_.insert_or_assign(without_case(text.name), Entry{text});
      if (is_new) order_.push_back(entry->first);
    }
  }
}

bool Scope::give(std::string_view name, double value, std::vector<double> gradient) {
  const auto found = entries_.find(without_case(name));
  if (found == entries_.end()) return false;
  found->second.state = State::known;
  found->second.value = value;
  found->second.is_given = true;
  found->second.gradient = std::move(gradient);
  return true;
}

void Scope::define(const std::string& name, double value, SourceSpan span, std::vector<double> gradient) {
  if (give(name, value, gradient)) return;
  const std::string key = without_case(name);
  entries_.insert_or_assign(key, Entry{{name, span, nullptr}, State::known, value, true, false, std::move(gradient)});
  order_.push_back(key);
}

void Scope::define_failed(const std::string& name, SourceSpan span) {
  define(name, 0.0, span);
  entries_.at(without_case(name)).state = State::failed;
}

void Scope::evaluate_all() {
  // A chain of definitions longer than the depth of evaluation is resolved from its other end; what is left then is an error.
  depth_is_error_ = false;
  const auto evaluate = [this](Entry& entry) {
    if (entry.is_given || entry.text.value == nullptr || !may_be_undecided(*entry.text.value)) (void)parameter(entry, 0);
  };
  for (auto key = order_.begin(); key != order_.end() && !session_.too_deep; ++key) evaluate(entries_.at(*key));
  depth_is_error_ = true;
  session_.too_deep = false;
  for (auto key = order_.rbegin(); key != order_.rend(); ++key) evaluate(entries_.at(*key));
}

Scope& Scope::enclosing(const Definition& where) {
  Scope* at = this;
  while (&at->definition_ != &where) at = at->outer_;
  return *at;
}

std::pair<Scope*, Scope::Entry*> Scope::find(std::string_view name) {
  const std::string key = without_case(name);
  for (Scope* at = this; at != nullptr; at = at->outer_) {
    const auto found = at->entries_.find(key);
    if (found != at->entries_.end()) return {at, &found->second};
  }
  return {nullptr, nullptr};
}

std::optional<double> Scope::parameter(Entry& entry, int depth) {
  switch (entry.state) {
    case State::known:
      return entry.value;
    case State::failed:
      return std::nullopt;
    case State::evaluating:
      report_circle(entry);
      return std::nullopt;
    case State::unknown:
      break;
  }
  if (depth > Session::deepest) {
    report_depth(entry);
    return std::nullopt;
  }
  entry.state = State::evaluating;
  session_.evaluating.push_back(entry.text.name);
  const auto value = entry.text.value != nullptr ? session_.evaluation.value(*this, *entry.text.value, depth + 1) : std::nullopt;
  session_.evaluating.pop_back();
  if (value) entry.value = *value;
  entry.state = value ? State::known : (session_.too_deep ? State::unknown : State::failed);
  return value;
}

void Scope::report_depth(const Entry& entry) {
  if (depth_is_error_) {
    session_.reporter.error("E-too-deep", entry.text.span, fmt::format("parameters or functions nest deeper than {}", Session::deepest));
  } else {
    session_.too_deep = true;
  }
}

void Scope::report_circle(const Entry& entry) {
  const auto& names = session_.evaluating;
  const auto same = [&](const std::string& name) { return same_name(name, entry.text.name); };
  const auto begin = std::find_if(names.begin(), names.end(), same);
  std::vector<std::string> circle(begin, names.end());
  circle.push_back(entry.text.name);
  session_.reporter.error("E-parameter-circle", entry.text.span,
                          fmt::format("parameters defined in a circle: {}", fmt::join(circle, " -> ")));
}

std::vector<std::string> Scope::visible_names() const {
  std::vector<std::string> names;
  constexpr std::size_t largest_search = 10000;  // looking through more for every error would take long
  for (const Scope* at = this; at != nullptr && at->entries_.size() <= largest_search; at = at->outer_) {
    for (const auto& entry : at->entries_) names.push_back(entry.second.text.name);
  }
  return names;
}

void Scope::report_no_number(const netlist::Item& item) {
  const bool is_parameter = item.kind == ItemKind::word && find(item.text).second != nullptr;
  const std::string_view text = session_.reporter.text(item.span);
  session_.reporter.error("E-not-a-number", item.span,
                          fmt::format("'{}' is not a number{}", text,
                                      is_parameter ? fmt::format("; try {{{}}}", item.text) : session_.evaluation.fix(text, *this)));
}

std::optional<Number> Scope::number(const netlist::Item& item, bool infinity_allowed) {
  if (item.kind == ItemKind::group && item.text.empty() && item.items.size() == 1) return number(item.items[0], infinity_allowed);
  Number number;
  if (item.kind == ItemKind::word) {
    const netlist::NumberText text = netlist::read_number(item.text);
    if (text.valid) {
      number.decimal = text.infinite ? "" : text.decimal_digits;
    }
  }
  ++session_.numbers;
  const std::optional<double> value = session_.evaluation.value(*this, item, 0);
  --session_.numbers;
  if (!value) return std::nullopt;
  if (std::isinf(*value) && !infinity_allowed) {
    session_.reporter.error("E-not-finite", item.span, "inf is allowed only for limits");
    return std::nullopt;
  }
  number.value = *value;
  if (session_.varied.empty()) return number;
  ++session_.numbers;
  number.gradient = session_.evaluation.gradient(*this, item);
  --session_.numbers;
  if (!number.gradient.empty()) session_.written.push_back({item.span, number.value, number.gradient});
  return number;
}

std::optional<SourceSpan> Scope::bare_femto(const netlist::Item& item, int depth) {
  if (item.expression) return bare_femto(*item.expression, depth);
  if (item.kind == ItemKind::word) return netlist::read_number(item.text).bare_femto ? std::optional(item.span) : std::nullopt;
  return item.kind == ItemKind::group && item.items.size() == 1 ? bare_femto(item.items[0], depth) : std::nullopt;
}

std::optional<SourceSpan> Scope::bare_femto(const netlist::Expression& expression, int depth) {
  using Kind = netlist::Expression::Kind;
  if (expression.kind == Kind::number)
    return netlist::read_number(expression.text).bare_femto ? std::optional(expression.span) : std::nullopt;
  if (expression.kind == Kind::name) {
    const auto [home, entry] = find(expression.text);
    if (entry == nullptr || depth > Session::deepest) return std::nullopt;
    if (!entry->has_looked_for_femto) {
      entry->has_looked_for_femto = true;  // before it is followed: parameters may be defined in a circle
      if (!entry->is_given && entry->text.value != nullptr) entry->femto = home->bare_femto(*entry->text.value, depth + 1);
    }
    return entry->femto;
  }
  for (const netlist::Expression& argument : expression.arguments)
    if (const std::optional<SourceSpan> found = bare_femto(argument, depth)) return found;
  return std::nullopt;
}

void Scope::set_bare_femto(std::string_view name, std::optional<SourceSpan> where) {
  const auto found = entries_.find(without_case(name));
  if (found == entries_.end()) return;
  found->second.has_looked_for_femto = true;
  found->second.femto = where;
}

std::vector<double> Scope::gradient_of(std::string_view name) {
  const auto [home, entry] = find(name);
  if (entry == nullptr || session_.varied.empty() || entry->state != State::known) return {};
  if (entry->has_gradient) return entry->gradient;
  entry->has_gradient = true;
  if (!entry->is_given && entry->text.value != nullptr) entry->gradient = session_.evaluation.gradient(*home, *entry->text.value);
  if (home->outer_ == nullptr)
    for (std::size_t k = 0; k < session_.varied.size(); ++k)
      if (session_.varied[k] == without_case(name)) {
        entry->gradient.resize(std::max(entry->gradient.size(), k + 1), 0.0);
        entry->gradient[k] += 1.0;
      }
  return entry->gradient;
}

std::optional<double> Scope::own_value(std::string_view name) {
  const auto found = entries_.find(without_case(name));
  return found != entries_.end() ? parameter(found->second, 0) : std::nullopt;
}

std::vector<elements::Written> Scope::take_written(std::size_t first) {
  auto& list = session_.written;
  const auto begin = list.begin() + static_cast<std::ptrdiff_t>(std::min(first, list.size()));
  std::vector<elements::Written> taken(begin, list.end());
  list.erase(begin, list.end());
  return taken;
}

const FunctionText* find_function(Scope& scope, const std::string& key, Scope*& home) {
  for (home = &scope; home != nullptr; home = home->outer()) {
    const auto found = home->definition().functions.find(key);
    if (found != home->definition().functions.end()) return &found->second;
  }
  return nullptr;
}

}  // namespace pwlsim::circuit
