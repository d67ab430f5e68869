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
///     PULSE (0 1 2u)                group PULSE: the blank is allowed after SIN SINE PULSE PWL EXP SFFM AM POLY, and after
///                                   any word on a dot card (`.model x D ( Ron=0 )`, `.func f (a,b) …`)
///     E1 a b POLY(2) (c,d) (e,f)    words a, b; group POLY[2]; two bare groups (empty text)
///     E1 a b TABLE {x} = (0,0)      words a, b, TABLE; expression; bare group: an `=` after an expression counts as a blank
///     E1 a b table = (0 0, 1 5)     assignment `table` with a bare group
///     .model D1 D Ron=0             words D1, D; assignment
///     .ic V(n)=5                    assignment of text "V(n)"; items[0] the word 5, items[1] the group V[n]
///     a1 [x y] %vd(p,n) out         vector of words; group %vd[p n]; word (`out[3]` without a blank is one word)
///     .func f(a,b) = a*b            group f[a b] and an expression, with or without `=` and braces
///
/// A value that may be an expression without braces is a word if `read_number` accepts it ("2", "-5", "10k", "inf"), a string
/// if quoted, else an expression (a single name is an Expression of kind name). This applies to all assignments of `.param`,
/// `.subckt` and X cards, with the body of `.func`, and with V=, I=, VALUE=, VOL=, CUR=, LAPLACE= of B, E, F, G and H cards.
/// A card that measures has keywords (words) and expressions after its name, without the equals signs:
///
///     .meas tran p AVG v(a)*i(b) FROM=1m     words tran, p, AVG; expression; words FROM, 1m
///     .meas t FIND v(a) WHEN v(b)=2*v(c)     words t, FIND; expression; word WHEN; two expressions
///
/// `.if (a == b)` and `.elseif` hold one expression, with or without parentheses; `.rule from to v(a)>0.5` two words and an expression,
/// `.output (n) state` a bare group and an expression.
/// On .subckt and X cards `params:p=1` reads as the word `params:` and the assignment.
///
/// Guarantees: the text of a word, group or card name is never altered; an expression item has an expression; a card with
/// a reported syntax error is `damaged`: it contains the parts that could be read, and an unreadable expression is a NaN number.

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
    group,       ///< `text(items…)`: SIN(0 1 50), V(a,b), D(Ron=0), POLY(2); `text` is empty for a bare ( … )
    vector,      ///< [ items… ]
    assignment   ///< `text` = items[0]; `items` is empty if the value is missing; items[1] is the left side if that is a group
  };
  Kind kind = Kind::word;
  std::string text;
  SourceSpan span;       ///< the whole item
  SourceSpan text_span;  ///< of `text` alone; empty, at the item's start, if there is none
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
  bool made_call = false;       ///< a card made by `circuit` that calls a subcircuit, whatever its name begins with
  std::vector<Guard> guards{};  ///< evaluated by each call of its subcircuit
  std::vector<Card> rows{};     ///< for `.lcs`: the lines of its file, with their first words as names
};

/// A deck with includes and library sections read in place. `.subckt`/`.ends` are still cards of the flat list.
struct Deck {
  std::string title;
  SourceSpan title_span;
  std::vector<Card> cards;
  bool is_board = false;               ///< the netlist of a printed circuit board, which is refused as such
  bool names_ltspice_library = false;  ///< has a `.lib` of LTspice's own `standard.dio` or similar
};

}  // namespace pwlsim::netlist
