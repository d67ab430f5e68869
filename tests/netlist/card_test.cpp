#include <catch2/catch.hpp>

#include "netlist/tree_text.hpp"

using tree_text::card;
using tree_text::complaints;
using tree_text::Read;
using tree_text::text_of;

TEST_CASE("cards become generic trees", "[unit]") {
  struct Row {
    const char* text;
    const char* tree;
  };
  const auto row = GENERATE(
      // words
      Row{"R1 a b 10kOhm", "R1 a b 10kOhm"}, Row{"  R1\ta \t b  1e-3  ", "R1 a b 1e-3"}, Row{"K1 L1,L2 , L3 0.9", "K1 L1 L2 L3 0.9"},
      Row{"D1 +5V -15 x1:n", "D1 +5V -15 x1:n"}, Row{"R1 x1.n out+ a/b", "R1 x1.n out+ a/b"}, Row{"R1 N$1 $G a#b", "R1 N$1 $G a#b"},
      Row{"R1 out[3] in[0][1] 5", "R1 out[3] in[0][1] 5"}, Row{"C1 a b 1\u00B5", "C1 a b 1\u00B5"}, Row{".end5", ".end5"},
      // assignments, with and without blanks
      Row{"R1 a b 10 tc1=0 tc2 = 1", "R1 a b 10 tc1=0 tc2=1"}, Row{"R1 a b R={x} m= 2", "R1 a b R={x} m=2"},
      Row{"R1 a b tc1= tc2=1", "R1 a b tc1= tc2=1"}, Row{"R1 a b R=", "R1 a b R="}, Row{"R1 a b R='x*2' ic=5V", "R1 a b R={(x*2)} ic=5V"},
      Row{"R1 a b file=\"x y\"", "R1 a b file=\"x y\""},
      // waveforms
      Row{"V1 a 0 SIN(0 1 50)", "V1 a 0 SIN(0 1 50)"}, Row{"V1 a 0 SIN(0 1 {1/(2*pi)})", "V1 a 0 SIN(0 1 {(1/(2*pi))})"},
      Row{"V1 a 0 PULSE (0 1 2u)", "V1 a 0 PULSE(0 1 2u)"}, Row{"V1 a 0 sin 0 1 50", "V1 a 0 sin 0 1 50"},
      Row{"V1 a 0 DC 5 AC 1 0 pwl ( 0 0, 1m 5 ) r=0", "V1 a 0 DC 5 AC 1 0 pwl(0 0 1m 5) r=0"},
      Row{"V1 a 0 PWL(0,0,1m,5)", "V1 a 0 PWL(0 0 1m 5)"},
      Row{"V1 a 0 PWL REPEAT FOREVER (0 0 1 1) ENDREPEAT", "V1 a 0 PWL REPEAT FOREVER (0 0 1 1) ENDREPEAT"},
      Row{"V1 a 0 PWL file=\"w.txt\"", "V1 a 0 PWL file=\"w.txt\""}, Row{"R1 a b (5)", "R1 a b (5)"},
      Row{"R1 a b 10(comment)", "R1 a b 10(comment)"}, Row{"R1 a b 10 (comment)", "R1 a b 10 (comment)"},
      // controlled sources
      Row{"E1 a b POLY(2) (c,d) (e,f) 0 1 1", "E1 a b POLY(2) (c d) (e f) 0 1 1"}, Row{"E1 a b POLY (1) c d 0 1", "E1 a b POLY(1) c d 0 1"},
      Row{"E1 a b TABLE {x} = (0,0) (1,5)", "E1 a b TABLE {x} (0 0) (1 5)"},
      Row{"E1 a b TABLE {V(c,d)} (0,0) (1,5)", "E1 a b TABLE {V(c,d)} (0 0) (1 5)"},
      Row{"E1 a b c d table=(0 0, 1 5)", "E1 a b c d table=(0 0 1 5)"}, Row{"E1 a b value={V(c)*2}", "E1 a b value={(V(c)*2)}"},
      Row{"E1 a b VALUE = { V(c)*2 }", "E1 a b VALUE={(V(c)*2)}"}, Row{"E1 a b VALUE {V(c)}", "E1 a b VALUE {V(c)}"},
      Row{"B1 a b V=V(c)*2+I(V1) tc1=0", "B1 a b V={((V(c)*2)+I(V1))} tc1=0"},
      Row{"B1 a b I=if(V(c)>0, 1, 0)", "B1 a b I={if((V(c)>0),1,0)}"}, Row{"B1 a b V = 5", "B1 a b V=5"},
      Row{"B1 a b V={x}*V(c)", "B1 a b V={(x*V(c))}"}, Row{"B1 a b V='x'", "B1 a b V={x}"},
      Row{"G1 a b cur=V(c)/R i=x", "G1 a b cur={(V(c)/R)} i={x}"}, Row{"B1 a b V=V(c)<=5?1:0", "B1 a b V={((V(c)<=5)?1:0)}"},
      Row{"a1 [x y] %vd(p,n) out m1", "a1 [x y] %vd(p n) out m1"}, Row{"a1 %vd [p n] %v[a b]", "a1 %vd [p n] %v [a b]"},
      // models
      Row{".model D1 D(Ron=0 Vfwd=0.5)", ".model D1 D(Ron=0 Vfwd=0.5)"}, Row{".model D1 D ( Ron=0 )", ".model D1 D(Ron=0)"},
      Row{".model x D Ron=0", ".model x D Ron=0"}, Row{".model y ako:x D(Vfwd={v})", ".model y ako:x D(Vfwd={v})"},
      Row{".model s SW(Ron=1m, Roff=1Meg, Vt=.5)", ".model s SW(Ron=1m Roff=1Meg Vt=.5)"}, Row{".model z D()", ".model z D()"},
      // parameters and functions
      Row{".param a=1 b=2*a c={a+b}", ".param a=1 b={(2*a)} c={(a+b)}"},
      Row{".param a=1, b = 2 * (a + 1) , c='a'", ".param a=1 b={(2*(a+1))} c={a}"}, Row{".param a=b", ".param a={b}"},
      Row{".param a=-5 b=10kOhm c=inf d=1e-3", ".param a=-5 b=10kOhm c=inf d=1e-3"}, Row{".param a=2 *b", ".param a={(2*b)}"},
      Row{".param a=x<=3 b=y!=2 c=z==1", ".param a={(x<=3)} b={(y!=2)} c={(z==1)}"}, Row{".param a=x?1:2 b=3", ".param a={(x?1:2)} b=3"},
      Row{".param a= b=2", ".param a= b=2"}, Row{".param s=\"text\"", ".param s=\"text\""}, Row{".param a={x}*2", ".param a={(x*2)}"},
      Row{".PARAM A=1", ".PARAM A=1"}, Row{".func f(a,b) {a*b}", ".func f(a b) {(a*b)}"}, Row{".func f(a,b)=a*b", ".func f(a b) {(a*b)}"},
      Row{".func f(a, b) = {a*b}", ".func f(a b) {(a*b)}"}, Row{".func f(a) a^2 + 1", ".func f(a) {((a^2)+1)}"},
      Row{".func f(a) {a}*2", ".func f(a) {(a*2)}"}, Row{".func f (a) 'a'", ".func f(a) {a}"}, Row{".func f() 5", ".func f() 5"},
      Row{".func f(x)", ".func f(x)"}, Row{".subckt s a b params: p=1 q=2*p", ".subckt s a b params: p=1 q={(2*p)}"},
      Row{".subckt s a b PARAMS:p=1", ".subckt s a b PARAMS: p=1"}, Row{".subckt s a b p={x}", ".subckt s a b p={x}"},
      Row{"X1 a b s p=k/2 q=5", "X1 a b s p={(k/2)} q=5"}, Row{"x1 a b s params: p=k", "x1 a b s params: p={k}"}, Row{".ends s", ".ends s"},
      // the rest of the dot cards
      Row{".save v(a,b) i(R1) v(x1:n) v(x1.n) i(x1.D1)", ".save v(a b) i(R1) v(x1:n) v(x1.n) i(x1.D1)"}, Row{".save v (a)", ".save v(a)"},
      Row{".print tran v(out+) V(1)", ".print tran v(out+) V(1)"}, Row{".save all", ".save all"}, Row{".save @r1[i]", ".save @r1[i]"},
      Row{".ic V(n)=5 I(L1) = 1m v(a,b)={x}", ".ic V(n)=5 I(L1)=1m v(a b)={x}"}, Row{".tran 0 1m 0 1u uic", ".tran 0 1m 0 1u uic"},
      Row{".tran {T/100} {T}", ".tran {(T/100)} {T}"},
      Row{".options reltol = 1e-4 nonunique=first", ".options reltol=1e-4 nonunique=first"}, Row{".global vdd $G_x", ".global vdd $G_x"},
      Row{".step param R list 1 2 3", ".step param R list 1 2 3"}, Row{".backanno", ".backanno"},
      Row{".meas tran x FIND V(out) WHEN V(in)=5 RISE=1", ".meas tran x FIND {V(out)} WHEN {V(in)} 5 RISE 1"}, Row{".op", ".op"},
      Row{".meas tran p AVG V(a)*I(R1) FROM=1m", ".meas tran p AVG {(V(a)*I(R1))} FROM 1m"},
      Row{".meas p AVG V(a) FROM 1m TO {2*t}", ".meas p AVG {V(a)} FROM 1m TO {(2*t)}"},
      Row{".MEASURE max MAX max(V(a),V(b))", ".MEASURE max MAX {max(V(a),V(b))}"},
      Row{".meas x TRIG V(a) VAL=0.5 TD=1u FALL=LAST TARG time=2m", ".meas x TRIG {V(a)} VAL 0.5 TD 1u FALL LAST TARG {time} 2m"},
      Row{".meas x WHEN V(a) = 3 * V(b) cross = 3", ".meas x WHEN {V(a)} {(3*V(b))} cross 3"}, Row{".four 1k v(out)", ".four 1k v(out)"},
      Row{".dot name \"file.lcs\"", ".dot name \"file.lcs\""}, Row{".title don't (mind", ".title"});
  CAPTURE(row.text);
  CHECK(card(row.text) == row.tree);
}

TEST_CASE("what is wrong on a card is underlined", "[unit]") {
  struct Row {
    const char* text;
    const char* messages;
  };
  const auto row = GENERATE(Row{"V1 a 0 SIN(0 1 50", "N-parenthesis «(»\n"}, Row{"V1 a 0 SIN(0 1 50))", "N-parenthesis «)»\n"},
                            Row{"V1 a 0 PWL(0 (1 2", "N-parenthesis «(»\n"}, Row{"a1 [x y", "E-syntax-unclosed «[»\n"},
                            Row{"a1 x]", "E-syntax-unexpected «]»\n"}, Row{"a1 [x)]", "N-parenthesis «)»\n"},
                            Row{"V1 a 0 SIN(0]1)", "E-syntax-unexpected «]»\n"}, Row{"R1 a b }", "E-syntax-unexpected «}»\n"},
                            Row{"R1 = 5", "E-syntax-unexpected «=»\n"}, Row{"R1 a b \"x", "E-syntax-unclosed «\"»\n"},
                            Row{"R1 a b {x", "E-syntax-unclosed «{»\n"}, Row{"R1 a b R==5", "E-syntax-unexpected «==»\n"},
                            Row{"R1 a b \"s\" = 5", "E-syntax-unexpected «=»\n"}, Row{"V1 a 0 SIN(0,,50)", "E-syntax-comma «,»\n"},
                            Row{"V1 a 0 SIN(,0)", "E-syntax-comma «,»\n"}, Row{"V1 a 0 SIN(0,)", "E-syntax-comma «,»\n"},
                            Row{"K1 L1, L2,", "E-syntax-comma «,»\n"},
                            Row{"V1 a 0 SIN( , 0 , , 1 , )", "E-syntax-comma «,»\nE-syntax-comma «,»\nE-syntax-comma «,»\n"},
                            Row{".ic V(n)=", "E-syntax-value «V(n)»\n"}, Row{".ic V(n)= V(m)=5", "E-syntax-unexpected «=»\n"},
                            Row{"=5", "E-syntax-card «=»\n"}, Row{"(a b)", "E-syntax-card «(»\n"}, Row{"{x}", "E-syntax-card «{»\n"},
                            Row{"\"q\"", "E-syntax-card «\"»\n"}, Row{".param a=1+", "E-syntax-expression «+»\n"},
                            Row{".param a=*2", "E-syntax-expression «*»\n"}, Row{".param a=2* b=3", "E-syntax-unexpected «=»\n"},
                            Row{".param a=(1", "E-syntax-unclosed «(»\n"}, Row{".param a=b]", "E-syntax-unexpected «]»\n"},
                            Row{".func f(a) a*", "E-syntax-expression «*»\n"}, Row{"X1 a b s p=q/", "E-syntax-expression «/»\n"},
                            Row{"V1 a 0 SIN({1+} (2", "E-syntax-expression «}»\nN-parenthesis «(»\n"});
  CAPTURE(row.text);
  CHECK(complaints(row.text) == row.messages);
}

TEST_CASE("errors of all cards are reported and parsing goes on", "[unit]") {
  const Read read("title\nR1 a b [\nR2 c d 5\n(x\nR3 e f {1+}\n");
  CHECK(read.messages() == "E-syntax-unclosed «[»\nE-syntax-card «(»\nE-syntax-expression «}»\n");
  REQUIRE(read.deck.cards.size() == 3);
  CHECK(read.deck.cards[0].damaged);
  CHECK_FALSE(read.deck.cards[1].damaged);
  CHECK(read.deck.cards[2].damaged);
  CHECK(text_of(read.deck.cards[1]) == "R2 c d 5");
}

TEST_CASE("every part knows its span, across continuations too", "[unit]") {
  const Read read("title\nV1 a 0 SIN(0 ; offset\n* more\n+ 1 {f * 2}) Rser = 5\n");
  REQUIRE(read.messages().empty());
  const auto& parsed = read.deck.cards.at(0);
  const auto text = [&](const pwlsim::SourceSpan& span) { return std::string(read.sources.text(span)); };
  CHECK(text(parsed.name_span) == "V1");
  CHECK(text(parsed.items.at(0).span) == "a");
  const auto& waveform = parsed.items.at(2);
  CHECK(text(waveform.text_span) == "SIN");
  CHECK(text(waveform.span) == "SIN(0 ; offset\n* more\n+ 1 {f * 2})");
  CHECK(text(waveform.items.at(0).span) == "0");
  CHECK(text(waveform.items.at(1).span) == "1");
  CHECK(text(waveform.items.at(2).span) == "{f * 2}");
  CHECK(text(waveform.items.at(2).expression->arguments.at(1).span) == "2");
  const auto& assignment = parsed.items.at(3);
  CHECK(text(assignment.span) == "Rser = 5");
  CHECK(text(assignment.text_span) == "Rser");
  CHECK(text(assignment.items.at(0).span) == "5");
  CHECK(text(parsed.span) == "V1 a 0 SIN(0 ; offset\n* more\n+ 1 {f * 2}) Rser = 5");
}

TEST_CASE("an assignment to a group keeps the group", "[unit]") {
  const Read read("title\n.ic V(a, b) = 5\n");
  const auto& item = read.deck.cards.at(0).items.at(0);
  CHECK(item.kind == pwlsim::netlist::Item::Kind::assignment);
  CHECK(item.text == "V(a, b)");
  REQUIRE(item.items.size() == 2);
  CHECK(item.items[0].text == "5");
  CHECK(item.items[1].kind == pwlsim::netlist::Item::Kind::group);
  CHECK(std::string(read.sources.text(item.text_span)) == "V(a, b)");
}

TEST_CASE("groups that nest beyond reason are refused, however many", "[unit]") {
  CHECK(complaints("R1 a b " + std::string(50, '(') + "1" + std::string(50, ')')).empty());
  CHECK(complaints("R1 a b " + std::string(51, '(') + "1" + std::string(51, ')')) == "E-limit-parentheses «(»\n");
  CHECK(complaints("R1 a b " + std::string(100'000, '(')) == "E-limit-parentheses «(»\n");
  CHECK(complaints("R1 a b " + std::string(100'000, '[')) == "E-limit-parentheses «[»\n");
  std::string calls;
  for (int i = 0; i < 100'000; ++i) {
    calls += "f=(";
  }
  CHECK(complaints("R1 a b " + calls) == "E-limit-parentheses «(»\n");
}

TEST_CASE("after a hundred syntax errors the rest is counted", "[unit]") {
  std::string text = "title\n";
  for (int i = 0; i < 250; ++i) {
    text += "R1 a b ]\n";
  }
  const Read read(text);
  CHECK(read.diagnostics.all().size() == 101);
  CHECK(read.diagnostics.all().back().id == "E-syntax-more");
  CHECK(read.diagnostics.all().back().text.find("150 more") == 0);
}
