#include "netlist/byte_parser.hpp"
#include "netlist/token.hpp"

namespace pwlsim::netlist {

namespace {

constexpr bool unit_byte(unsigned char c) { return letter_byte(c) || digit_byte(c); }
constexpr bool node_byte(unsigned char c) {
  return c > ' ' && std::string_view("(){},='\"").find(static_cast<char>(c)) == std::string_view::npos;
}

constexpr ByteParser<digit_byte> digit{};
constexpr ByteParser<blank_byte> blank{};

const auto number = x3::raw[((+digit >> -('.' >> *digit)) | ('.' >> +digit)) >>
                            -(x3::no_case[x3::char_('e')] >> -x3::char_("+-") >> +digit) >> *ByteParser<unit_byte>{}];
const auto name = x3::raw[ByteParser<name_first_byte>{} >> *ByteParser<name_rest_byte>{}];
const auto node = x3::raw[+ByteParser<node_byte>{}];
const auto node_separator = (+blank >> -(',' >> *blank)) | (',' >> *blank);
const auto signal_name = x3::raw[x3::no_case[x3::char_("vi")]];
const auto sign = x3::raw[x3::lit("**") | "&&" | "||" | "==" | "!=" | "<=" | ">=" | x3::char_("-+*/^&|<>!~")];

/// Sets the token's kind and takes the text that was matched.
constexpr auto set(Token::Kind kind) {
  return [kind](auto& context) {
    x3::_val(context).kind = kind;
    x3::_val(context).text = view_of(x3::_attr(context));
  };
}

const auto make_call = [](auto& context) { x3::_val(context).kind = Token::Kind::call; };
const auto add_node = [](auto& context) { x3::_val(context).nodes.push_back(view_of(x3::_attr(context))); };

const x3::rule<struct signal_rule, Token> signal = "signal";
const auto signal_def = signal_name[set(Token::Kind::signal)] >> *blank >> '(' >> *blank >> (node[add_node] % node_separator) >> *blank >>
                        ')';

const x3::rule<struct named_rule, Token> named = "name or call";
const auto named_def = name[set(Token::Kind::name)] >> -(*blank >> x3::lit('(')[make_call]);

const x3::rule<struct simple_rule, Token> simple = "number, operator or punctuation";
const auto simple_def = number[set(Token::Kind::number)]                       //
                        | sign[set(Token::Kind::sign)]                         //
                        | x3::raw[x3::char_("({")][set(Token::Kind::open)]     //
                        | x3::raw[x3::char_(")}")][set(Token::Kind::close)]    //
                        | x3::raw[x3::char_(',')][set(Token::Kind::comma)]     //
                        | x3::raw[x3::char_('?')][set(Token::Kind::question)]  //
                        | x3::raw[x3::char_(':')][set(Token::Kind::colon)];

BOOST_SPIRIT_DEFINE(signal, named, simple)

}  // namespace

bool next_token(const char*& first, const char* last, Token& token) {
  const char* const begin = first;
  token = Token{};
  bool found = x3::parse(first, last, signal, token);
  if (!found) {
    token = Token{};
    found = x3::parse(first, last, named | simple, token);
  }
  token.whole = {begin, static_cast<std::size_t>(first - begin)};
  return found;
}

}  // namespace pwlsim::netlist
