#include <algorithm>
#include <cassert>
#include <utility>

#include "base/names.hpp"
#include "netlist/byte_parser.hpp"
#include "netlist/card_grammar.hpp"
#include "netlist/card_style.hpp"
#include "netlist/expression.hpp"
#include "netlist/number.hpp"

namespace pwlsim::netlist {

namespace {

/// What every semantic action can reach while one card is parsed.
struct State {
  const ParseContext& context;
  CardStyle style;
  std::vector<const char*> open;  ///< ( and [ not closed yet
  std::string_view last_item;     ///< text of the word or group parsed last
  bool stopped = false;           ///< too deep: the rest of the card is given up
  bool unclosed = false;
};
struct state_tag;

template <typename Context>
State& state_of(const Context& context) {
  return x3::get<state_tag>(context);
}

const auto set_text = [](Item::Kind kind) {
  return [kind](auto& context) {
    Item& item = x3::_val(context);
    const std::string_view text = view_of(x3::_attr(context));
    item.kind = kind;
    item.text.assign(text);
    item.text_span = state_of(context).context.line.span(text);
  };
};

/// An item knows where it stands. (The rules cannot do it in on_success: their semantic actions leave it no attribute.)
const auto set_span = [](auto& context) {
  Item& item = x3::_val(context);
  item.span = state_of(context).context.line.span(view_of(x3::_attr(context)));
  if (!item.text_span.known()) {
    item.text_span = {item.span.file, item.span.begin, item.span.begin};
  }
};
const auto set_left_span = [](auto& context) {
  State& state = state_of(context);
  state.last_item = view_of(x3::_attr(context));
  x3::_val(context).span = state.context.line.span(state.last_item);
};

const auto enter = [](auto& context) {
  // Far more than any card needs, far less than the recursion of the grammar bears.
  constexpr std::size_t deepest_group = 50;
  State& state = state_of(context);
  const std::string_view opening = view_of(x3::_attr(context));
  if (!state.stopped && state.open.size() == deepest_group) {
    state.stopped = true;
    state.context.report("E-limit-parentheses", opening,
                         "parentheses outside of expressions nest deeper than " + std::to_string(deepest_group));
  }
  x3::_pass(context) = !state.stopped;
  if (!state.stopped) {
    state.open.push_back(opening.data());
  }
};

const auto leave = [](auto& context) { state_of(context).open.pop_back(); };

const auto leave_unclosed = [](auto& context) {
  State& state = state_of(context);
  const char* const opening = state.open.back();
  state.open.pop_back();
  if (!state.stopped && !state.unclosed) {
    state.unclosed = true;
    if (*opening == '(')
      state.context.note("N-parenthesis", part(opening, opening + 1), "'(' is never closed: it ends with the card");
    else
      state.context.report("E-syntax-unclosed", part(opening, opening + 1), "'" + std::string(1, *opening) + "' is never closed");
  }
};

const auto set_items = [](Item::Kind kind) {
  return [kind](auto& context) {
    x3::_val(context).kind = kind;
    x3::_val(context).items = std::move(x3::_attr(context));
  };
};

const auto take = [](auto& context) { x3::_val(context) = std::move(x3::_attr(context)); };

const auto report_unexpected = [](auto& context) {
  const std::string_view text = view_of(x3::_attr(context));
  if (text == ")") return state_of(context).context.note("N-parenthesis", text, "')' closes nothing and is ignored");
  const char* const why = text.front() == '=' ? "' has nothing before it that could take a value" : "' closes nothing";
  state_of(context).context.report("E-syntax-unexpected", text, "'" + std::string(text) + why);
};

const auto check_comma = [](auto& context) {
  const State& state = state_of(context);
  const std::string_view comma = view_of(x3::_attr(context));
  const char* before = comma.data();
  while (before != state.context.line.begin() && is_blank(before[-1])) {
    --before;
  }
  const char* const after = std::find_if_not(comma.data() + 1, state.context.line.end(), is_blank);
  const bool nothing_before = before != state.context.line.begin() && (before[-1] == '(' || before[-1] == '[');
  const bool nothing_behind = after == state.context.line.end() || *after == ',' || *after == ')' || *after == ']';
  if (nothing_before || nothing_behind) {
    state.context.report("E-syntax-comma", comma, nothing_before ? "a value is missing before ','" : "a value is missing after ','");
  }
};

const auto joins_parenthesis = [](auto& context) {
  x3::_pass(context) = state_of(context).style.joins_parenthesis(x3::_val(context).text);
};

const auto braces_allowed = [](auto& context) { x3::_pass(context) = state_of(context).style.is_model(); };

const auto params_word_allowed = [](auto& context) { x3::_pass(context) = state_of(context).style.takes_params(); };

const auto start_assignment = [](auto& context) {
  State& state = state_of(context);
  Item& item = x3::_val(context);
  Item left = std::move(item);
  item = Item{};
  item.kind = Item::Kind::assignment;
  item.text_span = left.span;
  if (left.kind == Item::Kind::word) {
    item.text = std::move(left.text);
  } else {
    item.text.assign(state.last_item);
    item.items.push_back(std::move(left));
  }
};

const auto wants_expression = [](auto& context) { x3::_pass(context) = state_of(context).style.open_expression(x3::_val(context).text); };

const auto set_value = [](auto& context) {
  auto& items = x3::_val(context).items;
  items.insert(items.begin(), std::move(x3::_attr(context)));
};

const auto without_value = [](auto& context) {
  Item& item = x3::_val(context);
  if (!item.items.empty()) {
    item.items.clear();
    state_of(context).context.errors.report("E-syntax-value", item.text_span, "a value is missing after '" + item.text + " ='");
  }
};

/// -{…}
Expression with_sign(char sign, Expression operand, SourceSpan span) {
  Expression whole;
  whole.kind = Expression::Kind::unary;
  whole.text = std::string(1, sign);
  whole.span = span;
  whole.arguments.push_back(std::move(operand));
  return whole;
}

/// `Ron=…`: what stands here is a parameter of a model, not an expression.
bool holds_assignment(const char* at, const char* last) {
  const auto is_name = [](char c) { return name_rest_byte(static_cast<unsigned char>(c)); };
  at = std::find_if_not(at, last, is_blank);
  const char* const end = std::find_if_not(at, last, is_name);
  const char* const sign = std::find_if_not(end, last, is_blank);
  return end != at && sign != last && *sign == '=' && (sign + 1 == last || sign[1] != '=');
}

/// {…} or '…', read by a function of its own; a sign may stand before it.
struct DelimitedExpression : x3::parser<DelimitedExpression> {
  using attribute_type = Item;
  [[maybe_unused]] static constexpr bool has_attribute = true;

  template <typename Iterator, typename Context, typename RuleContext, typename Attribute>
  bool parse(Iterator& first, const Iterator& last, const Context& context, RuleContext&, Attribute& item) const {
    const bool is_signed = first != last && (*first == '-' || *first == '+') && first + 1 != last;
    const char* const opening = is_signed ? first + 1 : first;
    if (opening == last || (*opening != '{' && *opening != '\'')) {
      return false;
    }
    if (state_of(context).style.is_model() && holds_assignment(opening + 1, last)) return false;
    const char* const begin = first;
    Expression expression;
    first = opening;
    parse_delimited_expression(first, last, state_of(context).context, expression);
    if (is_signed) expression = with_sign(*begin, std::move(expression), state_of(context).context.line.span(begin, first));
    item.kind = Item::Kind::expression;
    item.expression = std::make_shared<const Expression>(std::move(expression));
    item.span = state_of(context).context.line.span(begin, first);
    item.text_span = item.span;
    return true;
  }
};

/// An expression without braces; one that is no more than a number is a word, as it is everywhere else.
struct OpenExpression : x3::parser<OpenExpression> {
  using attribute_type = Item;
  [[maybe_unused]] static constexpr bool has_attribute = true;

  template <typename Iterator, typename Context, typename RuleContext, typename Attribute>
  bool parse(Iterator& first, const Iterator& last, const Context& context, RuleContext&, Attribute& item) const {
    if (first == last || std::string_view("\",)]='").find(*first) != std::string_view::npos) {
      return false;
    }
    const char* const begin = first;
    Expression expression;
    const bool read = parse_open_expression(first, last, state_of(context).context, expression);
    const std::string_view text = part(begin, first);
    item.span = state_of(context).context.line.span(text);
    item.text_span = item.span;
    if (read && read_number(text).valid) {
      item.kind = Item::Kind::word;
      item.text.assign(text);
    } else {
      item.kind = Item::Kind::expression;
      item.expression = std::make_shared<const Expression>(std::move(expression));
    }
    return true;
  }
};

// The grammar begins behind the card's name.

constexpr bool word_byte(unsigned char c) {
  return c > ' ' && std::string_view("(){}[]=,\"'").find(static_cast<char>(c)) == std::string_view::npos;
}
constexpr bool string_byte(unsigned char c) { return c != '"'; }

constexpr ByteParser<word_byte> word_byte_{};
constexpr ByteParser<blank_byte> blank{};

const x3::rule<struct list_rule, std::vector<Item>> list = "items of a card";
const x3::rule<struct group_list_rule, std::vector<Item>> group_list = "items between ( and )";
const x3::rule<struct vector_list_rule, std::vector<Item>> vector_list = "items between [ and ]";
const x3::rule<struct brace_list_rule, std::vector<Item>> brace_list = "parameters of a model between { and }";
// The gaps are rules of their own because a rule with semantic actions anywhere in it fills no attribute by itself.
const x3::rule<struct gap_rule> gap = "between items of a card";
const x3::rule<struct group_gap_rule> group_gap = "between items of a group";
const x3::rule<struct vector_gap_rule> vector_gap = "between items of a vector";
const x3::rule<struct brace_gap_rule> brace_gap = "between parameters of a model";
const x3::rule<struct entry_rule, Item> entry = "item or assignment";
const x3::rule<struct word_or_group_rule, Item> word_or_group = "word or group";
const x3::rule<struct other_rule, Item> other = "string, bare group or vector";
const x3::rule<struct braced_rule, Item> braced = "expression in braces or quotes";
const x3::rule<struct open_value_rule, Item> open_value = "expression without braces";
const x3::rule<struct plain_value_rule, Item> plain_value = "value";

const auto opening = [](char c) { return x3::raw[x3::lit(c)][enter]; };
const auto closing = [](char c) { return x3::lit(c)[leave] | x3::eps[leave_unclosed]; };
const auto comma = x3::raw[x3::lit(',')][check_comma];
const auto gap_with = [](auto unexpected) {
  return *(blank | comma | x3::raw[+x3::lit('=')][report_unexpected] | x3::raw[unexpected][report_unexpected]);
};
const auto is_assignment = *blank >> '=' >> !x3::lit('=');

// A word may hold [n] behind its first character, unless it announces a vector as %v does.
const auto plain_word = (x3::char_('%') >> *word_byte_) | (word_byte_ >> *(word_byte_ | (x3::lit('[') >> *word_byte_ >> ']')));
const auto word = x3::raw[(x3::eps[params_word_allowed] >> x3::no_case["params:"]) | plain_word];
const auto name = ByteParser<name_first_byte>{} >> *ByteParser<name_rest_byte>{};

const auto word_or_group_def = x3::raw[word[set_text(Item::Kind::word)] >> -(-(x3::eps[joins_parenthesis] >> +blank) >> opening('(') >>
                                                                             group_list[set_items(Item::Kind::group)] >> closing(')')) >>
                                       -(x3::eps[braces_allowed] >> &(*blank >> '{' >> *blank >> name >> is_assignment) >> *blank >>
                                         opening('{') >> brace_list[set_items(Item::Kind::group)] >> closing('}'))][set_left_span];
const auto string = opening('"') >> x3::raw[*ByteParser<string_byte>{}][set_text(Item::Kind::string)] >> closing('"');
const auto other_def = x3::raw[(opening('(') >> group_list[set_items(Item::Kind::group)] >> closing(')')) |
                               (opening('[') >> vector_list[set_items(Item::Kind::vector)] >> closing(']')) | string][set_span];
const auto braced_def = DelimitedExpression{};
const auto open_value_def = !(name >> is_assignment) >> OpenExpression{};
const auto plain_value_def = !(plain_word >> is_assignment) >> (braced | word_or_group | other);
const auto value = *blank >> ((x3::eps[wants_expression] >> open_value[set_value]) | plain_value[set_value]);
const auto assignment = is_assignment >> x3::eps[start_assignment] >> (value | x3::eps[without_value]);
const auto entry_def = (braced[take] >> -is_assignment) | x3::raw[word_or_group[take] >> -assignment][set_span] | other[take];

const auto gap_def = gap_with(x3::char_(")]}"));
const auto group_gap_def = gap_with(x3::char_("]}"));
const auto vector_gap_def = gap_with(x3::char_(")}"));
const auto brace_gap_def = gap_with(x3::char_(")]"));
const auto list_def = gap >> *(entry >> gap);
const auto group_list_def = group_gap >> *(entry >> group_gap);
const auto vector_list_def = vector_gap >> *(entry >> vector_gap);
const auto brace_list_def = brace_gap >> *(entry >> brace_gap);

BOOST_SPIRIT_DEFINE(gap, group_gap, vector_gap, brace_gap, list, group_list, vector_list, brace_list, entry, word_or_group, other, braced,
                    open_value, plain_value)

/// `.func f(a,b) {body}`, `.func f(a,b) body` or `.func f(a,b) = body`.
void parse_function(const char*& first, const char* last, State& state, std::vector<Item>& items) {
  Item item;
  x3::parse(first, last, *blank);
  if (!x3::parse(first, last, x3::with<state_tag>(state)[word_or_group], item)) {
    return;
  }
  items.push_back(std::move(item));
  item = Item{};
  x3::parse(first, last, *blank >> -x3::lit('=') >> *blank);
  if (x3::parse(first, last, x3::with<state_tag>(state)[open_value | braced], item)) {
    items.push_back(std::move(item));
  }
}

/// `.if (a == b)`
void parse_condition(const char*& first, const char* last, State& state, std::vector<Item>& items) {
  x3::parse(first, last, *blank);
  Item item;
  if (x3::parse(first, last, x3::with<state_tag>(state)[braced | OpenExpression{}], item)) items.push_back(std::move(item));
}

/// `.param a 1/b`: in LTspice a blank may stand for the equals sign.
void parse_parameters(const char*& first, const char* last, State& state, std::vector<Item>& items) {
  x3::parse(first, last, *blank);
  for (const char* at = first; x3::parse(at, last, name >> +blank >> !x3::lit('=')); at = first) {
    Item name_item;
    Item value_item;
    const char* const begin = first;
    x3::parse(first, last, name);
    const std::string_view text = part(begin, first);
    if (!x3::parse(at, last, x3::with<state_tag>(state)[!(name >> is_assignment) >> OpenExpression{}], value_item)) {
      first = begin;
      return;
    }
    name_item.text.assign(text);
    name_item.span = name_item.text_span = state.context.line.span(text);
    items.push_back(std::move(name_item));
    items.push_back(std::move(value_item));
    first = at;
    x3::parse(first, last, *(blank | x3::lit(',')));
  }
}

/// A word, where one stands here; the text of a card's words is never altered.
bool take_word(const char*& first, const char* last, State& state, std::vector<Item>& items) {
  const char* const begin = first;
  if (!x3::parse(first, last, +word_byte_)) return false;
  Item item;
  item.text.assign(part(begin, first));
  item.span = item.text_span = state.context.line.span(part(begin, first));
  items.push_back(std::move(item));
  return true;
}

/// A keyword is followed by something other than a parenthesis, which would make a function of it; but the first may have its argument in one.
bool take_keyword(const char*& first, const char* last, bool is_first, State& state, std::vector<Item>& items) {
  const char* at = first;
  if (!x3::parse(at, last, name) || !is_measurement_keyword(part(first, at))) return false;
  if (!is_first && at != last && *at == '(') return false;
  const std::string_view text = part(first, at);
  Item item;
  item.text.assign(text);
  item.span = item.text_span = state.context.line.span(text);
  items.push_back(std::move(item));
  first = at;
  return true;
}

/// `.meas [tran] name AVG v(a)*i(b) FROM=1m TO 2m`: the equals signs are left out.
void parse_measurement(const char*& first, const char* last, State& state, std::vector<Item>& items) {
  const auto skip = [&] { x3::parse(first, last, *blank); };
  skip();
  if (!take_word(first, last, state, items)) return;
  skip();
  if (is_analysis_name(items[0].text) && take_word(first, last, state, items)) skip();
  for (bool is_first = true; first != last; is_first = false) {
    if (!take_keyword(first, last, is_first, state, items)) {
      Item item;
      if (!x3::parse(first, last, x3::with<state_tag>(state)[braced | OpenExpression{}], item)) break;
      items.push_back(std::move(item));
    }
    x3::parse(first, last, *(blank | x3::lit('=') | x3::lit(',')));
  }
}

/// `.rule from to V(a) > 0.5`
void parse_rule(const char*& first, const char* last, State& state, std::vector<Item>& items) {
  constexpr std::size_t states = 2;
  x3::parse(first, last, *blank);
  while (items.size() < states && take_word(first, last, state, items)) x3::parse(first, last, *blank);
  if (items.size() == states) parse_condition(first, last, state, items);
}

/// `.output (node) state > 0.5`
void parse_machine_output(const char*& first, const char* last, State& state, std::vector<Item>& items) {
  x3::parse(first, last, *blank);
  Item node;
  if (!x3::parse(first, last, x3::with<state_tag>(state)[plain_value], node)) return;
  items.push_back(std::move(node));
  parse_condition(first, last, state, items);
}

}  // namespace

std::string_view card_name(std::string_view line) {
  const char* first = line.data();
  x3::parse(first, line.data() + line.size(), +word_byte_);
  return part(line.data(), first);
}

bool parse_card(const ParseContext& context, Card& card) {
  const LogicalLine& line = context.line;
  const std::string_view name_text = card_name(line.text());
  if (name_text.empty()) {
    const std::string_view character = first_character(line.begin(), line.end());
    if (line.text() == ")") {
      context.note("N-parenthesis", character, "')' closes nothing and is ignored");
      return false;
    }
    context.report("E-syntax-card", character, "a card begins with a name, not with '" + std::string(character) + "'");
    return false;
  }
  const std::size_t errors_before = context.errors.count();
  card.name.assign(name_text);
  card.name_span = line.span(name_text);
  card.span = line.span(line.text());
  constexpr std::size_t usual_items = 4;
  card.items.reserve(usual_items);
  State state{context, CardStyle(name_text), {}, {}, false, false};
  const char* first = name_text.data() + name_text.size();
  if (state.style.is_function()) {
    parse_function(first, line.end(), state, card.items);
  }
  if (state.style.is_condition()) {
    parse_condition(first, line.end(), state, card.items);
  }
  if (state.style.is_parameters()) {
    parse_parameters(first, line.end(), state, card.items);
  }
  if (state.style.is_measurement()) {
    parse_measurement(first, line.end(), state, card.items);
  }
  if (state.style.is_rule()) {
    parse_rule(first, line.end(), state, card.items);
  }
  if (state.style.is_machine_output()) {
    parse_machine_output(first, line.end(), state, card.items);
  }
  x3::parse(first, line.end(), x3::with<state_tag>(state)[list], card.items);
  assert(first == line.end() || state.stopped);
  card.damaged = context.errors.count() != errors_before;
  return true;
}

}  // namespace pwlsim::netlist
