#pragma once
/// The syntax tree of a deck: generic cards. No element letter, keyword or unit has a meaning here;
/// `circuit` gives them one. Every part carries its span.
///
/// How text becomes items (a blank, a comma or the end of the card ends each of them):
///
///     R1 a b 10kOhm tc1 = 0         words a, b, 10kOhm; assignment tc1 with the word 0
///     .save v(a,b) i(R1) v(x1:n)    groups v[a b], i[R1], v[x1:n], their items words
///     SIN(0 1 {f})                  group SIN with words 0, 1 and an expression
///     SIN 0 1 50                    four words
///     PULSE (0 1 2u)                group PULSE: the blank is allowed behind SIN SINE PULSE PWL EXP SFFM AM POLY, and behind
///                                   any word on a dot card (`.model x D ( Ron=0 )`, `.func f (a,b) …`)
///     E1 a b POLY(2) (c,d) (e,f)    words a, b; group POLY[2]; two bare groups (empty text)
///     E1 a b TABLE {x} = (0,0)      words a, b, TABLE; expression; bare group: an `=` behind an expression counts as a blank
///     E1 a b table = (0 0, 1 5)     assignment `table` with a bare group
///     .model D1 D Ron=0             words D1, D; assignment
///     .ic V(n)=5                    assignment of text "V(n)"; items[0] the word 5, items[1] the group V[n]
///     a1 [x y] %vd(p,n) out         vector of words; group %vd[p n]; word (`out[3]` without a blank is one word)
///     .func f(a,b) = a*b            group f[a b] and an expression, with or without `=` and braces
///
/// A value that may be an expression without braces is a word where `read_number` takes it ("2", "-5", "10k", "inf"), a string
/// where quoted, else an expression (a lone name is an Expression of kind name). So it is with all assignments of `.param`,
/// `.subckt` and X cards, with the body of `.func`, and with V=, I=, VALUE=, VOL=, CUR=, LAPLACE= of B, E, F, G and H cards.
/// On a card that measures stand, behind its name, keywords (words) and expressions, without the equals signs:
///
///     .meas tran p AVG v(a)*i(b) FROM=1m     words tran, p, AVG; expression; words FROM, 1m
///     .meas t FIND v(a) WHEN v(b)=2*v(c)     words t, FIND; expression; word WHEN; two expressions
///
/// `.if (a == b)` and `.elseif` hold one expression, with or without parentheses.
/// On .subckt and X cards `params:p=1` reads as the word `params:` and the assignment.
///
/// Guarantees: the text of a word, group or card name is never altered; an expression item has an expression; a card on which
/// a syntax error was reported is `damaged`: it holds what could be read, and an expression that could not be is a NaN number.

#include <memory>
#include <string>
#include <vector>

#include "base/source.hpp"

namespace pwlsim::netlist {

/// Arithmetic expression, as in `{2*pi*f}` or on the right of `.param`.
struct Expression {
  enum class Kind {
    number,       ///< `number`; `text` as spelled (a suffix is already applied to `number`)
    name,         ///< `text`: parameter, constant, or (inside V(…) and I(…)) a node or element, also when it looks like a number
    unary,        ///< `text` is "-", "+", "!"; one argument
    binary,       ///< `text` is one of + - * / ^ ** < > <= >= == != & && | ||; two arguments
    conditional,  ///< c ? a : b; three arguments
    call          ///< `text` is the function as spelled; any number of arguments, also none
  };
  Kind kind = Kind::number;
  double number = 0.0;
  std::string text;
  std::vector<Expression> arguments;
  SourceSpan span;
};

/// One thing on a card after its first word.
struct Item {
  enum class Kind {
    word,        ///< `text`: node, name, number, keyword: as spelled
    expression,  ///< {…} or '…' (or an unbraced one where the card calls for it): `expression`
    string,      ///< "…": `text` without the quotes
    group,       ///< `text(items…)`: SIN(0 1 50), V(a,b), D(Ron=0), POLY(2); `text` empty for a bare ( … )
    vector,      ///< [ items… ]
    assignment   ///< `text` = items[0]; `items` is empty where the value is missing; items[1] is the left side where that is a group
  };
  Kind kind = Kind::word;
  std::string text;
  SourceSpan span;       ///< the whole item
  SourceSpan text_span;  ///< of `text` alone; empty, at the item's begin, where there is none
  std::vector<Item> items;
  std::shared_ptr<const Expression> expression;
};

/// A condition of `.if` within a subcircuit, and whether it must hold for a card to count.
struct Guard {
  Item condition;
  bool holds = true;
};

/// One logical line (continuations joined). `name` is its first word: "R1", ".tran", ".param".
struct Card {
  std::string name;
  SourceSpan name_span;
  std::vector<Item> items;
  SourceSpan span;
  bool damaged = false;         ///< a syntax error on this card has been reported
  bool made_call = false;       ///< a subcircuit, whatever its name begins with: of a card that `circuit` made
  std::vector<Guard> guards{};  ///< that each call of its subcircuit decides
  std::vector<Card> rows{};     ///< of `.lcs`: the lines of its file, their first words as names
};

/// A deck after includes and library sections have been read in place. `.subckt`/`.ends` are still cards of the flat list.
struct Deck {
  std::string title;
  SourceSpan title_span;
  std::vector<Card> cards;
  bool is_board = false;               ///< the netlist of a printed circuit board, which is refused as such
  bool names_ltspice_library = false;  ///< a `.lib` of LTspice's own `standard.dio` or its like
};

}  // namespace pwlsim::netlist
