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

/// What texts stand for in a scope: what it needs to evaluate its parameters (evaluation.hpp).
class Evaluation {
 public:
  virtual ~Evaluation() = default;

  /// Of an item that holds a number or an expression, `depth` parameters deep; an error has been reported where there is none.
  [[nodiscard]] virtual std::optional<double> value(Scope& scope, const netlist::Item& item, int depth) const = 0;
  /// To Session::varied; empty where it does not depend on them.
  [[nodiscard]] virtual std::vector<double> gradient(Scope& scope, const netlist::Item& item) const = 0;
  /// "; try …" for a text that is meant as a number and is none.
  [[nodiscard]] virtual std::string fix(std::string_view text, Scope& scope) const = 0;
};

/// What all scopes of one deck share.
struct Session {
  Session(Reporter& r, const Evaluation& e) : reporter(r), evaluation(e) {}

  static constexpr int deepest = 1000;  ///< parameters and functions within one another

  Reporter& reporter;
  const Evaluation& evaluation;
  std::vector<std::string> evaluating;  ///< names of the parameters under evaluation, outermost first
  Random random;
  bool draws_random = false;  ///< some expression has asked it
  std::uint64_t function_calls = 0;  ///< of .func functions, in all
  bool functions_exhausted = false;
  /// Parameters of the deck whose derivatives are asked for (keys), and numbers that depend on them and whose reader has not said what becomes of them.
  std::vector<std::string> varied;
  std::vector<elements::Written> written;
  std::vector<char> read_apart;  ///< of each: read by an expression that is no number of a card
  int numbers = 0;               ///< numbers within one another
  int nesting = 0;        ///< expressions within one another, through parameters and functions too
  bool too_deep = false;  ///< a chain of parameters was too long to follow from where it was entered
};

/// A number as it stands on a card.
struct Number {
  double value = 0.0;
  bool bare_femto = false;  ///< "10F": femto, worth a warning behind a capacitance
  std::string decimal;      ///< plain decimal text where the card has a plain number, else ""
  std::vector<double> gradient{};  ///< to Session::varied; empty where it does not depend on them
};

/// Parameters of one definition as one call of it sees them. Evaluated at first use and kept; the last definition of a name wins, a value
/// given by the call over both. Names are sought here, then in the scope the definition stands in. Every error is reported once;
/// the value is then absent.
class Scope {
 public:
  Scope(const Definition& definition, Scope* outer, Session& session);
  Scope(const Scope&) = delete;
  Scope& operator=(const Scope&) = delete;

  /// A value from the call. False if the definition has no such parameter.
  bool give(std::string_view name, double value, std::vector<double> gradient = {});
  /// The same for one that the definition need not have.
  void define(const std::string& name, double value, SourceSpan span, std::vector<double> gradient = {});
  /// One whose value could not be read, which has been reported.
  void define_failed(const std::string& name, SourceSpan span);
  /// Evaluates every parameter, so that each mistake is reported even where nothing uses it.
  void evaluate_all();

  /// The number an item stands for; an infinite one only where `inf` was written and `infinity_allowed`.
  [[nodiscard]] std::optional<Number> number(const netlist::Item& item, bool infinity_allowed = false);

  /// How the parameter of that name depends on those of Session::varied; empty where there is none, or it does not.
  [[nodiscard]] std::vector<double> gradient_of(std::string_view name);
  /// The value of a parameter of this scope itself; none where there is none.
  [[nodiscard]] std::optional<double> own_value(std::string_view name);
  /// The reader of the last number follows its gradient.
  void claim(const Number& number) {
    if (!number.gradient.empty() && !session_.written.empty()) session_.written.pop_back();
  }
  /// What has been read since there were `first` numbers, taken.
  [[nodiscard]] std::vector<elements::Written> take_written(std::size_t first);
  [[nodiscard]] Session& session() { return session_; }
  [[nodiscard]] const Definition& definition() const { return definition_; }
  [[nodiscard]] Scope* outer() const { return outer_; }
  /// The scope of the definition `where`, which is this one's or encloses it.
  [[nodiscard]] Scope& enclosing(const Definition& where);
  /// The models of this scope that have been evaluated, by card: what Models keeps of them.
  [[nodiscard]] std::unordered_map<const netlist::Card*, int>& evaluated_models() { return evaluated_models_; }
  /// Whether a parameter of that name is seen here.
  [[nodiscard]] bool knows(std::string_view name) { return find(name).second != nullptr; }

 private:
  friend class Evaluator;

  enum class State { unknown, evaluating, known, failed };
  struct Entry {
    ParameterText text;
    State state = State::unknown;
    double value = 0.0;
    bool is_given = false;         ///< by a call or a sweep: its text does not count
    bool has_gradient = false;
    std::vector<double> gradient{};  ///< to Session::varied
  };

  /// Null where neither this scope nor an outer one has it.
  [[nodiscard]] std::pair<Scope*, Entry*> find(std::string_view name);
  [[nodiscard]] std::optional<double> parameter(Entry& entry, int depth);
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

/// The .func function of that key as `scope` sees it, and the scope it is defined in; null where there is none.
[[nodiscard]] const FunctionText* find_function(Scope& scope, const std::string& key, Scope*& home);

}  // namespace pwlsim::circuit
