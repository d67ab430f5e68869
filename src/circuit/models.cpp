#include "circuit/models.hpp"

#include <algorithm>
#include <cctype>

#include <fmt/format.h>

#include "base/names.hpp"
#include "circuit/cards.hpp"
#include "circuit/values.hpp"
#include "elements/catalogue.hpp"

namespace pwlsim::circuit {
namespace {

using netlist::Card;
using netlist::Item;
using ItemKind = Item::Kind;

struct FoundModel {
  Scope* scope = nullptr;
  const Card* card = nullptr;
};

FoundModel find_model(Scope& scope, std::string_view name) {
  const std::string key = without_case(name);
  for (Scope* at = &scope; at != nullptr; at = at->outer()) {
    const auto found = at->definition().models.find(key);
    if (found != at->definition().models.end()) return {at, found->second};
  }
  return {};
}

struct ChainLink {
  FoundModel found;
  ModelText text;
};

/// The model cards `card` builds on, itself first; empty after an error.
std::vector<ChainLink> chain_of(Scope& scope, const Card& card, Reporter& reporter) {
  std::vector<ChainLink> chain;
  FoundModel next{&scope, &card};
  for (;;) {
    std::optional<ModelText> text = read_model_text(*next.card, reporter);
    if (!text) return {};
    chain.push_back({next, std::move(*text)});
    const ModelText& last = chain.back().text;
    if (last.base == nullptr) return chain;
    next = find_model(*next.scope, last.base_name);
    const bool circle = std::any_of(chain.begin(), chain.end(), [&](const ChainLink& link) { return link.found.card == next.card; });
    if (next.card != nullptr && !circle) continue;
    if (circle) {
      reporter.error("E-model-circle", last.base->span, fmt::format("the model {} is based on itself", last.base_name));
    } else {
      reporter.error("E-unknown-model", last.base->span, fmt::format("unknown model '{}'", last.base_name));
    }
    return {};
  }
}

/// The text with the type that rules: the first of the chain that has one, else the last.
const ModelText& typed_text(const std::vector<ChainLink>& chain) {
  const auto typed = std::find_if(chain.begin(), chain.end(), [](const ChainLink& link) { return !link.text.type.empty(); });
  return typed == chain.end() ? chain.back().text : typed->text;
}

/// "NMOS or PMOS or VDMOS"
std::string types_of(const elements::Kind& kind) {
  std::vector<std::string_view> types;
  for (const elements::ModelKind* model : kind.models)
    if (types.size() < 3 && model->type != "LPNP") types.push_back(model->type);
  return fmt::format("{}", fmt::join(types, " or "));
}

std::vector<std::string> model_types() {
  std::vector<std::string> types;
  for (const elements::Kind& kind : elements::catalogue()) {
    for (const elements::ModelKind* model : kind.models) types.emplace_back(model->type);
  }
  return types;
}

std::string type_names(const elements::Kind& kind) {
  std::string names;
  for (const elements::ModelKind* model : kind.models) names += (names.empty() ? "" : " or ") + std::string(model->type);
  return names;
}

/// Models of other levels have other parameters, which would all be reported.
bool has_known_level(const std::vector<ChainLink>& chain, const elements::ModelKind& kind, Reporter& reporter) {
  for (const ChainLink& link : chain) {
    for (const Item* item : link.text.parameters) {
      if (kind.levels.empty() || item->kind != ItemKind::assignment || !same_name(item->text, "level") || item->items.empty()) continue;
      const std::optional<Number> level = link.found.scope->number(item->items[0]);
      if (!level) return false;
      if (std::find(kind.levels.begin(), kind.levels.end(), level->value) != kind.levels.end()) return true;
      reporter.error("E-not-idealised", item->span,
                     fmt::format("an {} of level {} lacks the parameters to idealise it; try .model {} VDMOS(Vto= Ron=), or a switch S",
                                 kind.type, level->value, chain.front().found.card->items[0].text));
      return false;
    }
  }
  return true;
}

bool is_digits(const Item& item) {
  return item.kind == ItemKind::word && !item.text.empty() &&
         std::all_of(item.text.begin(), item.text.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
}

/// `M=0,2`, a number as some countries write it, comes as an assignment and a word with nothing but the comma between them: as one assignment, 0.2.
std::optional<Item> with_decimal_comma(const Item& item, const Item* next, Reporter& reporter) {
  if (next == nullptr || item.kind != ItemKind::assignment || item.items.empty() || !is_digits(item.items[0]) || !is_digits(*next))
    return std::nullopt;
  if (item.span.file != next->span.file || item.span.end + 1 != next->span.begin) return std::nullopt;
  Item whole = item;
  whole.items[0].text += "." + next->text;
  whole.span.end = whole.items[0].span.end = next->span.end;
  reporter.note("N-decimal-comma", whole.items[0].span,
                fmt::format("{},{} is read as {}", item.items[0].text, next->text, whole.items[0].text));
  return whole;
}

/// What one card of a chain gives itself.
elements::Values own_values(const ChainLink& link, const elements::ModelKind& kind, std::vector<std::string>& ignored, Reporter& reporter) {
  elements::Values values(kind.parameters);
  const std::string owner = "model " + link.found.card->items[0].text;
  ValueReader reader(*link.found.scope, reporter, owner);
  if (kind.block == nullptr) reader.ignore_unknown();  // each parameter of a block has an effect
  const std::vector<const Item*>& items = link.text.parameters;
  for (std::size_t k = 0; k < items.size(); ++k) {
    const Item* item = items[k];
    if (const auto whole = with_decimal_comma(*item, k + 1 < items.size() ? items[k + 1] : nullptr, reporter)) {
      reader.assignment(*whole, values, &ignored);
      ++k;
      continue;
    }
    const elements::Parameter* flag = item->kind == ItemKind::word ? elements::find_parameter(kind.parameters, item->text) : nullptr;
    if (item->kind == ItemKind::assignment) {
      reader.assignment(*item, values, &ignored);
    } else if (flag != nullptr && flag->is_flag) {
      values.set(flag->name, 1.0, item->span);
    } else {
      reporter.error("E-unexpected", item->span, fmt::format("a model takes name=value, not '{}'", reporter.text(item->span)));
    }
  }
  return values;
}

/// `.step NPN QX(BF) …`
void take_stepped(Scope& top, elements::Model& model) {
  for (const elements::Parameter& parameter : model.kind->parameters) {
    const std::optional<double> value = top.own_value(stepped_model_name(model.name, parameter.name));
    if (value) model.values.set(parameter.name, *value, model.span);
  }
}

void warn_ignored(const std::vector<std::string>& ignored, const elements::Model& model, Diagnostics& diagnostics) {
  if (ignored.empty()) return;
  diagnostics.warning("W-ignored-parameter", model.span,
                      fmt::format("{} of model {} {} ignored", fmt::join(ignored, ", "), model.name, ignored.size() == 1 ? "is" : "are"));
}

}  // namespace

std::optional<ModelText> read_model_text(const Card& card, Reporter& reporter) {
  ModelText text;
  bool base_follows = false;
  for (std::size_t k = 1; k < card.items.size(); ++k) {
    const Item& item = card.items[k];
    if (item.kind == ItemKind::assignment) {
      text.parameters.push_back(&item);
    } else if ((item.kind == ItemKind::word || item.kind == ItemKind::group) && without_case(item.text.substr(0, 4)) == "ako:") {
      text.base = &item;
      text.base_name = item.text.substr(4);
      base_follows = text.base_name.empty();
      for (const Item& parameter : item.items) text.parameters.push_back(&parameter);
    } else if (item.kind == ItemKind::group && base_follows) {
      text.base_name = item.text;
      base_follows = false;
      for (const Item& parameter : item.items) text.parameters.push_back(&parameter);
    } else if (item.kind == ItemKind::word && base_follows) {
      text.base_name = item.text;
      base_follows = false;
    } else if ((item.kind == ItemKind::word || item.kind == ItemKind::group) && text.type.empty()) {
      text.type = item.text;
      text.type_span = item.text_span.known() ? item.text_span : item.span;
      for (const Item& parameter : item.items) text.parameters.push_back(&parameter);
    } else if (item.kind == ItemKind::group && item.text.empty()) {
      for (const Item& parameter : item.items) text.parameters.push_back(&parameter);
    } else {
      text.parameters.push_back(&item);
    }
  }
  if (text.type.empty() && text.base == nullptr) {
    if (!card.damaged) {
      reporter.error("E-missing-value", card.span,
                     fmt::format("the model {} has no type; usage: .model name TYPE(p=value ...)", card.items[0].text));
    }
    return std::nullopt;
  }
  return text;
}

std::optional<elements::Model> Models::read(Scope& scope, const Card& card) {
  const std::vector<ChainLink> chain = chain_of(scope, card, reporter_);
  if (chain.empty()) return std::nullopt;
  const ModelText& typed = typed_text(chain);
  const elements::ModelKind* kind = elements::find_model_kind(typed.type);
  const Item& name = card.items[0];
  if (kind == nullptr) {
    if (is_foreign_model_type(typed.type)) return elements::Model{nullptr, std::string(typed.type), name.span, {}};
    reporter_.error("E-unknown-model-type", typed.type_span,
                    fmt::format("unknown model type '{}'{}", typed.type, suggestion(typed.type, model_types())));
    return std::nullopt;
  }
  if (!has_known_level(chain, *kind, reporter_)) return std::nullopt;
  elements::Model model{kind, name.text, name.span, elements::Values(kind->parameters)};
  std::vector<std::string> ignored;
  for (auto link = chain.rbegin(); link != chain.rend(); ++link) {
    const std::size_t written = link->found.scope->session().written.size();
    const elements::Values own = own_values(*link, *kind, ignored, reporter_);
    for (elements::Written& number : link->found.scope->take_written(written)) model.written.push_back(std::move(number));
    for (const auto& given : own.all()) model.values.set_list(given.parameter->name, given.list, given.span);
  }
  if (scope.outer() == nullptr) take_stepped(scope, model);
  Diagnostics scratch;
  warn_ignored(ignored, model, scratch);
  if (kind->complete != nullptr) kind->complete(model, settings_, scratch);
  reporter_.forward(scratch);
  return model;
}

int Models::evaluated(Scope& scope, const Card& card) {
  used_.insert(&card);
  const auto [entry, is_new] = scope.evaluated_models().try_emplace(&card, -1);
  if (!is_new) return entry->second;
  std::optional<elements::Model> model = read(scope, card);
  if (!model) return -1;
  circuit_.models.push_back(std::move(*model));
  entry->second = static_cast<int>(circuit_.models.size()) - 1;
  return entry->second;
}

int Models::use(Scope& scope, const Item& name, const elements::Kind& kind) {
  const FoundModel found = find_model(scope, name.text);
  if (found.card == nullptr) {
    report_unknown(scope, name, kind);
    return -1;
  }
  if (devices_ != nullptr && !used_.contains(found.card)) tell_device(*found.card, name);
  const int index = evaluated(*found.scope, *found.card);
  if (index < 0) return -1;
  const elements::Model& model = circuit_.models[static_cast<std::size_t>(index)];
  if (std::find(kind.models.begin(), kind.models.end(), model.kind) != kind.models.end()) return index;
  const std::string_view type = model.kind != nullptr ? model.kind->type : std::string_view(model.name);
  reporter_.error("E-wrong-model-type", name.span,
                  fmt::format("the model {} is of type {}; a {} takes {}", name.text, type, kind.name, type_names(kind)));
  return -1;
}

void Models::tell_device(const Card& card, const Item& name) {
  const auto device = devices_->find(&card);
  if (device == devices_->end()) return;
  reporter_.note("N-model-at-hand", name.span,
                 fmt::format("{} is not defined, and is taken from the models at hand: {}; try a .model card for other numbers", name.text,
                             device->second));
}

bool Models::known(Scope& scope, const Item& name) { return find_model(scope, name.text).card != nullptr; }

void Models::report_unknown(Scope& scope, const Item& name, const elements::Kind& kind) {
  std::vector<std::string> names;
  for (const Scope* at = &scope; at != nullptr; at = at->outer()) {
    for (const auto& entry : at->definition().models) names.push_back(entry.second->items[0].text);
  }
  std::string cure = suggestion(name.text, names);
  const bool has_polarity = std::string_view("MQJ").find(kind.letter) != std::string_view::npos;
  if (cure.empty())
    cure = fmt::format("; try a card .model {} {}", name.text, has_polarity ? types_of(kind) : std::string(kind.models[0]->type));
  reporter_.error("E-unknown-model", name.span, fmt::format("unknown model '{}'{}", name.text, cure));
}

const elements::ModelKind* Models::kind_of(Scope& scope, const Card& card) {
  Diagnostics ignored;
  Reporter quiet = reporter_.beside(ignored);
  const std::vector<ChainLink> chain = chain_of(scope, card, quiet);
  return chain.empty() ? nullptr : elements::find_model_kind(typed_text(chain).type);
}

const elements::ModelKind* Models::kind_of(Scope& scope, const Item& name) {
  const FoundModel found = find_model(scope, name.text);
  return found.card == nullptr ? nullptr : kind_of(*found.scope, *found.card);
}

bool Models::is_idealised(Scope& scope, const Card& card) {
  const elements::ModelKind* kind = kind_of(scope, card);
  return kind != nullptr && kind->is_idealised;
}

void Models::check_unused(Scope& top, FileIndex file) {
  std::vector<const Card*> unused;
  for (const auto& [key, card] : top.definition().models) {
    if (card->span.file == file && !used_.contains(card)) unused.push_back(card);
  }
  std::sort(unused.begin(), unused.end(), [](const Card* a, const Card* b) { return a->span.begin < b->span.begin; });
  for (const Card* card : unused) {
    if (is_idealised(top, *card)) continue;
    Diagnostics scratch;
    Reporter quiet = reporter_.beside(scratch);
    (void)Models(circuit_, settings_, quiet).read(top, *card);
    reporter_.forward(scratch, true);
  }
}

}  // namespace pwlsim::circuit
