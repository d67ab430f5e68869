#pragma once
/// Parameters and expressions: one Scope for the deck and one for every call of a subcircuit.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "circuit/definitions.hpp"
#include "circuit/random.hpp"
#include "circuit/reporter.hpp"
#include "elements/parameter.hpp"
#include "netlist/ast.hpp"

namespace pwlsim::circuit {

class Scope;

/// Evaluates texts for a scope, which needs this for its parameters (evaluation.hpp).
class Evaluation {
 public:
  virtual ~Evaluation() = default;

  /// The value of an item that is a number or an expression, `depth` parameters deep; if there is none, an error has been reported.
  [[nodiscard]] virtual std::optional<double> value(Scope& scope, const netlist::Item& item, int depth) const = 0;
  /// Derivatives to Session::varied; empty if it does not depend on them.
  [[nodiscard]] virtual std::vector<double> gradient(Scope& scope, const netlist::Item& item) const = 0;
  /// "; try …" for a text that is meant as a number but is not one.
  [[nodiscard]] virtual std::string fix(std::string_view text, Scope& scope) const = 0;
};

/// The data that all scopes of one deck share.
struct Session {
  Session(Reporter& r, const Evaluation& e) : reporter(r), evaluation(e) {}

  static constexpr int deepest = 1000;  ///< nesting of parameters and functions

  Reporter& reporter;
  const Evaluation& evaluation;
  std::vector<std::string> evaluating;  ///< names of the parameters under evaluation, outermost first
  Random random;
  bool draws_random = false;         ///< some expression has drawn a number
  std::uint64_t function_calls = 0;  ///< of .func functions, in all
  bool functions_exhausted = false;
  /// Parameters of the deck whose derivatives are requested (keys), and numbers that depend on them but whose reader does not follow them.
  std::vector<std::string> varied;
  std::vector<elements::Written> written;
  std::vector<char> read_apart;  ///< of each: read by an expression that is not a number of a card
  int numbers = 0;               ///< nesting of numbers
  int nesting = 0;               ///< nesting of expressions, through parameters and functions too
  bool too_deep = false;         ///< a chain of parameters was too long to follow from where it was entered
};

/// A number on a card.
struct Number {
  double value = 0.0;
  std::string decimal;             ///< plain decimal text if the card has a plain number, else ""
  std::vector<double> gradient{};  ///< to Session::varied; empty if it does not depend on them
};

/// Parameters of one definition for one call of it. Evaluated at first use and kept; the last definition of a name is used, a value
/// given by the call takes precedence. Names are looked up here, then in the scope that contains the definition. Every error is reported once;
/// the value is then absent.
class Scope {
 public:
  Scope(const Definition& definition, Scope* outer, Session& session);
  Scope(const Scope&) = delete;
  Scope& operator=(const Scope&) = delete;

  /// A value from the call. False if the definition has no such parameter.
  bool give(std::string_view name, double value, std::vector<double> gradient = {});
  /// The same for a parameter that the definition need not have.
  void define(const std::string& name, double value, SourceSpan span, std::vector<double> gradient = {});
  /// A parameter whose value could not be read, which has been reported.
  void define_failed(const std::string& name, SourceSpan span);
  /// Evaluates every parameter, so that each mistake is reported even if nothing uses it.
  void evaluate_all();

  /// The number of an item; infinite only if `inf` was written and `infinity_allowed`.
  [[nodiscard]] std::optional<Number> number(const netlist::Item& item, bool infinity_allowed = false);

  /// The number with a bare F that the item is, or that stands in its expression or in a parameter it reads: "10F", which is femto.
  [[nodiscard]] std::optional<SourceSpan> bare_femto(const netlist::Item& item, int depth = 0);
  /// The same of a value that has been given from outside.
  void set_bare_femto(std::string_view name, std::optional<SourceSpan> where);

  /// The derivatives of the parameter of that name to Session::varied; empty if there is none, or if it does not depend on them.
  [[nodiscard]] std::vector<double> gradient_of(std::string_view name);
  /// The value of a parameter of this scope itself; none where there is none.
  [[nodiscard]] std::optional<double> own_value(std::string_view name);
  /// Call if the reader of the last number follows its gradient.
  void claim(const Number& number) {
    if (!number.gradient.empty() && !session_.written.empty()) session_.written.pop_back();
  }
  /// What has been read since there were `first` numbers, taken.
  [[nodiscard]] std::vector<elements::Written> take_written(std::size_t first);
  [[nodiscard]] Session& session() { return session_; }
  [[nodiscard]] const Definition& definition() const { return definition_; }
  [[nodiscard]] Scope* outer() const { return outer_; }
  /// The scope of the definition `where`, which is that of this scope or encloses it.
  [[nodiscard]] Scope& enclosing(const Definition& where);
  /// The evaluated models of this scope, by card, for Models.
  [[nodiscard]] std::unordered_map<const netlist::Card*, int>& evaluated_models() { return evaluated_models_; }
  /// Whether a parameter of that name is visible here.
  [[nodiscard]] bool knows(std::string_view name) { return find(name).second != nullptr; }

 private:
  friend class Evaluator;

  enum class State { unknown, evaluating, known, failed };
  struct Entry {
    ParameterText text;
    State state = State::unknown;
    double value = 0.0;
    bool is_given = false;  ///< by a call or a sweep: its text is not used
    bool has_gradient = false;
    std::vector<double> gradient{};  ///< to Session::varied
    bool has_looked_for_femto = false;
    std::optional<SourceSpan> femto{};  ///< a number with a bare F in its text
  };

  /// Null if neither this scope nor an outer one has it.
  [[nodiscard]] std::pair<Scope*, Entry*> find(std::string_view name);
  [[nodiscard]] std::optional<double> parameter(Entry& entry, int depth);
  [[nodiscard]] std::optional<SourceSpan> bare_femto(const netlist::Expression& expression, int depth);
  void report_depth(const Entry& entry);
  void report_circle(const Entry& entry);
  void report_no_number(const netlist::Item& item);
  [[nodiscard]] std::vector<std::string> visible_names() const;

  const Definition& definition_;
  Scope* outer_;
  Session& session_;
  std::unordered_map<std::string, Entry> entries_;
  std::vector<std::string> order_;  ///< keys as first defined
  std::unordered_map<const netlist::Card*, int> evaluated_models_;
  bool depth_is_error_ = true;  ///< not while a chain of parameters may still be resolved from its other end
};

/// The .func function of that key visible in `scope`, and the scope that defines it; null if there is none.
[[nodiscard]] const FunctionText* find_function(Scope& scope, const std::string& key, Scope*& home);

}  // namespace pwlsim::circuit
