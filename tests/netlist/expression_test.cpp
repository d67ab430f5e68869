#include <catch2/catch.hpp>

#include "netlist/tree_text.hpp"

using tree_text::complaints;
using tree_text::Read;
using tree_text::text_of;

namespace {

/// The fully parenthesised tree of an expression in braces.
std::string tree(const std::string& expression) {
  const Read read("title\nR1 a b {" + expression + "}\n");
  return read.messages().empty() ? text_of(read.deck.cards.at(0).items.at(2)) : read.messages();
}

}  // namespace

TEST_CASE("operators bind as language.md says", "[unit]") {
  struct Row {
    const char* text;
    const char* tree;
  };
  const auto row = GENERATE(
      Row{"1", "{1}"}, Row{"a+b*c", "{(a+(b*c))}"}, Row{"a-b-c", "{((a-b)-c)}"}, Row{"a/b/c", "{((a/b)/c)}"}, Row{"(a+b)*c", "{((a+b)*c)}"},
      // unary minus binds weaker than power, which is left-associative
      Row{"-2^2", "{(-(2^2))}"}, Row{"2^3^2", "{((2^3)^2)}"}, Row{"2**3**2", "{((2**3)**2)}"}, Row{"2^-3", "{(2^(-3))}"},
      Row{"2^-3*4", "{((2^(-3))*4)}"}, Row{"a*-b", "{(a*(-b))}"}, Row{"--a", "{(-(-a))}"}, Row{"-a*b", "{((-a)*b)}"}, Row{"+a", "{(+a)}"},
      // conditions
      Row{"a?b:c", "{(a?b:c)}"}, Row{"a?b:c?d:e", "{(a?b:(c?d:e))}"}, Row{"a?b?c:d:e", "{(a?(b?c:d):e)}"},
      Row{"a>0?b+1:c*2", "{((a>0)?(b+1):(c*2))}"}, Row{"(a?b:c)+1", "{((a?b:c)+1)}"}, Row{"a||b&&c", "{(a||(b&&c))}"},
      Row{"a|b&c", "{(a|(b&c))}"}, Row{"!a&&b", "{((!a)&&b)}"}, Row{"!(a==b)", "{(!(a==b))}"}, Row{"a<b==c>=d", "{((a<b)==(c>=d))}"},
      Row{"a!=b", "{(a!=b)}"}, Row{"a<=b|c", "{((a<=b)|c)}"}, Row{"a+b<c", "{((a+b)<c)}"},
      // calls
      Row{"f(x)", "{f(x)}"}, Row{"f (x, y)", "{f(x,y)}"}, Row{"f()", "{f()}"}, Row{"f(-x^2)", "{f((-(x^2)))}"},
      Row{"f(g(x),h(y,z))+1", "{(f(g(x),h(y,z))+1)}"}, Row{"limit(x,a?b:c,d)", "{limit(x,(a?b:c),d)}"},
      // numbers with suffixes
      Row{"2*10k", "{(2*10k)}"}, Row{"1k5+4R7", "{(1k5+4R7)}"}, Row{"1e-3-1", "{(1e-3-1)}"}, Row{"1.e3", "{1.e3}"}, Row{"3*.5", "{(3*.5)}"},
      // names of nodes and elements are not numbers, signs or operators inside V and I
      Row{"V(a,b)*2", "{(V(a,b)*2)}"}, Row{"v(1)+i(V1)", "{(v(1)+i(V1))}"}, Row{"V( x1:n )", "{V(x1:n)}"},
      Row{"V(out+,out-)", "{V(out+,out-)}"}, Row{"V(a/b)", "{V(a/b)}"}, Row{"I(x1.D1)", "{I(x1.D1)}"}, Row{"V(a b)", "{V(a,b)}"},
      Row{"V (n)", "{V(n)}"}, Row{"Vin*2", "{(Vin*2)}"}, Row{"i+v", "{(i+v)}"},
      // blanks, names, braces within braces
      Row{" a\t+ b ", "{(a+b)}"}, Row{"a_1.b+N$1", "{(a_1.b+N$1)}"}, Row{"{a+b}*c", "{((a+b)*c)}"});
  CAPTURE(row.text);
  CHECK(tree(row.text) == row.tree);
}

TEST_CASE("numbers in expressions have their value, names of nodes have none", "[unit]") {
  const Read read("title\nR1 a b {4k7 + V(10)}\n");
  const auto& sum = *read.deck.cards.at(0).items.at(2).expression;
  CHECK(sum.arguments.at(0).number == 4700.0);
  CHECK(sum.arguments.at(1).arguments.at(0).kind == pwlsim::netlist::Expression::Kind::name);
  CHECK(sum.arguments.at(1).arguments.at(0).text == "10");
}

TEST_CASE("quotes mean the same as braces", "[unit]") { CHECK(tree_text::card("R1 a b '2*(x+1)'") == "R1 a b {(2*(x+1))}"); }

TEST_CASE("spans of an expression underline what was written", "[unit]") {
  const Read read("title\nR1 a b { (x + 1) * -y }\n");
  const auto text = [&](const pwlsim::netlist::Expression& e) { return std::string(read.sources.text(e.span)); };
  const auto& product = *read.deck.cards.at(0).items.at(2).expression;
  CHECK(text(product) == "(x + 1) * -y");
  CHECK(text(product.arguments.at(0)) == "(x + 1)");
  CHECK(text(product.arguments.at(0).arguments.at(1)) == "1");
  CHECK(text(product.arguments.at(1)) == "-y");
  CHECK(std::string(read.sources.text(read.deck.cards.at(0).items.at(2).span)) == "{ (x + 1) * -y }");
}

TEST_CASE("what is wrong in an expression is underlined", "[unit]") {
  struct Row {
    const char* text;
    const char* messages;
  };
  const auto row = GENERATE(
      Row{"{}", "E-syntax-expression «}»\n"}, Row{"''", "E-syntax-expression «»\n"}, Row{"{1+}", "E-syntax-expression «}»\n"},
      Row{"'1+'", "E-syntax-expression «+»\n"}, Row{"{*2}", "E-syntax-expression «*»\n"}, Row{"{a b}", "E-syntax-expression «b»\n"},
      Row{"{2 3}", "E-syntax-expression «3»\n"}, Row{"{(a}", "E-syntax-unclosed «(»\n"}, Row{"{a)}", "E-syntax-expression «)»\n"},
      Row{"'(a'", "E-syntax-unclosed «(»\n"}, Row{"{f(a}", "E-syntax-unclosed «(»\n"}, Row{"{a,b}", "E-syntax-expression «,»\n"},
      Row{"{(a,b)}", "E-syntax-expression «,»\n"}, Row{"{f(a,)}", "E-syntax-expression «)»\n"}, Row{"{f(,a)}", "E-syntax-expression «,»\n"},
      Row{"{a?b}", "E-syntax-expression «?»\n"}, Row{"{a:b}", "E-syntax-expression «:»\n"}, Row{"{(a?b)}", "E-syntax-expression «?»\n"},
      Row{"{(a:b)}", "E-syntax-expression «:»\n"}, Row{"{a=b}", "E-syntax-expression «=»\n"}, Row{"{a%b}", "E-syntax-expression «%»\n"},
      Row{"{1k5k5}", "E-syntax-number «1k5k5»\n"}, Row{"{0x1F}", "E-syntax-number «0x1F»\n"}, Row{"{1..2}", "E-syntax-expression «.2»\n"},
      Row{"{a", "E-syntax-unclosed «{»\n"}, Row{"'a", "E-syntax-unclosed «'»\n"}, Row{"{a & & b}", "E-syntax-expression «&»\n"},
      Row{"{a \"b\"}", "E-syntax-expression «\"»\n"}, Row{"{\u00E9 \u00E9}", "E-syntax-expression «\u00E9»\n"});
  CAPTURE(row.text);
  CHECK(complaints(std::string("R1 a b ") + row.text) == row.messages);
}

TEST_CASE("several faulty expressions on one card are all reported", "[unit]") {
  CHECK(complaints("V1 a 0 SIN({1+} {2*} 50)") == "E-syntax-expression «}»\nE-syntax-expression «}»\n");
}

TEST_CASE("a faulty expression leaves a damaged card with what could be read", "[unit]") {
  const Read read("title\nR1 a b {1+} tc1=5\n");
  const auto& card = read.deck.cards.at(0);
  CHECK(card.damaged);
  REQUIRE(card.items.size() == 4);
  REQUIRE(card.items[2].expression != nullptr);
  CHECK(card.items[2].expression->number != card.items[2].expression->number);  // NaN
  CHECK(text_of(card.items[3]) == "tc1=5");
}

TEST_CASE("parentheses nest as deep as the limit and no deeper", "[unit]") {
  const auto nested = [](int depth) {
    const auto count = static_cast<std::size_t>(depth);
    return "title\nR1 a b {" + std::string(count, '(') + "1" + std::string(count, ')') + "}\n";
  };
  CHECK(Read(nested(1000)).messages().empty());
  CHECK(Read(nested(1001)).messages() == "E-limit-parentheses «(»\n");
  const Read deep(nested(100'000));
  CHECK(deep.messages() == "E-limit-parentheses «(»\n");
  // The underlined one is the first beyond the limit: column 8 + 1000 + 1.
  CHECK(deep.sources.position(deep.diagnostics.all()[0].span.file, deep.diagnostics.all()[0].span.begin).column == 1009);
  pwlsim::netlist::LoadLimits limits;
  limits.parentheses = 3;
  CHECK(Read(nested(3), limits).messages().empty());
  CHECK(Read(nested(4), limits).messages() == "E-limit-parentheses «(»\n");
  CHECK(Read("title\n.options max_parentheses=2000\nR1 a b {" + std::string(1500, '(') + "1" + std::string(1500, ')') + "}\n")
            .messages()
            .empty());
}

TEST_CASE("a thousand nested calls with signs are read", "[unit]") {
  std::string text = "title\nR1 a b {";
  for (int i = 0; i < 1000; ++i) {
    text += "1+abs(";
  }
  CHECK(Read(text + "1" + std::string(1000, ')') + "}\n").messages().empty());
}

TEST_CASE("chains too deep to evaluate are refused", "[unit]") {
  std::string sum = "1";
  for (int i = 0; i < 100'000; ++i) {
    sum += "+1";
  }
  CHECK(Read("title\nR1 a b {" + sum + "}\n").messages() == "E-limit-expression «+»\n");
  CHECK(Read("title\nR1 a b {" + std::string(100'000, '-') + "1}\n").messages() == "E-limit-expression «-»\n");
}

TEST_CASE("limits that make no sense are refused", "[unit]") {
  struct Row {
    const char* option;
    const char* messages;
  };
  const auto row =
      GENERATE(Row{"max_parentheses=0", "E-range «max_parentheses=0»\n"}, Row{"max_parentheses=x", "E-range «max_parentheses=x»\n"},
               Row{"max_parentheses=", "E-range «max_parentheses=»\n"}, Row{"max_include_depth=1e4", "E-range «max_include_depth=1e4»\n"},
               Row{"MAX_PARENTHESES = 2k", ""});
  CHECK(complaints(std::string(".options ") + row.option) == row.messages);
}
