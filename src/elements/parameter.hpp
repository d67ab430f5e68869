#pragma once
/// Parameters as data: those of an element, a model or a waveform, and the values given for one of them.

#include <limits>
#include <span>
#include <string_view>
#include <vector>

#include "base/source.hpp"

namespace pwlsim::elements {

inline constexpr double infinite = std::numeric_limits<double>::infinity();

enum class Range { any, not_negative, positive, whole_positive, minus_one_to_one };

/// honoured: the simulation uses it. ignored: skipped with one warning. refused: an error, because it would change the answer.
enum class Use { honoured, ignored, refused };

struct Parameter {
  std::string_view name;  ///< as the documentation spells it; compared without case
  std::string_view unit;
  double fallback = 0.0;
  Range range = Range::any;
  bool infinity_allowed = false;
  std::string_view text;  ///< one sentence
  Use use = Use::honoured;
  bool is_list = false;  ///< accepts [ … ] too; the range applies to every member
  bool is_flag = false;  ///< a word without a value
};

using ParameterTable = std::span<const Parameter>;

[[nodiscard]] const Parameter* find_parameter(ParameterTable table, std::string_view name);

/// Whether `value` is allowed for `parameter`; never for a nan.
[[nodiscard]] bool in_range(const Parameter& parameter, double value);

/// The range as text: "must not be negative".
[[nodiscard]] std::string_view range_words(Range range);

/// A number of the deck that depends on parameters, with its derivatives.
struct Written {
  SourceSpan span;
  double value = 0.0;
  std::vector<double> gradient;
};

/// Values given for the parameters of one table; others have their fallback.
class Values {
 public:
  struct Given {
    const Parameter* parameter = nullptr;
    double value = 0.0;  ///< the first member of a list
    SourceSpan span;
    std::vector<double> list;
  };

  Values() = default;
  explicit Values(ParameterTable table) : table_(table) {}

  /// `name` must be in the table. A second value for one name replaces the first.
  void set(std::string_view name, double value, SourceSpan span = {}) { set_list(name, {value}, span); }
  void set_list(std::string_view name, std::vector<double> list, SourceSpan span = {});
  [[nodiscard]] const Given* find(std::string_view name) const;
  [[nodiscard]] bool has(std::string_view name) const { return find(name) != nullptr; }
  /// `name` must be in the table.
  [[nodiscard]] double get(std::string_view name) const;
  [[nodiscard]] std::vector<double> list(std::string_view name) const;
  /// The span of the value; unknown if it is the fallback.
  [[nodiscard]] SourceSpan span(std::string_view name) const;
  [[nodiscard]] const std::vector<Given>& all() const { return given_; }
  [[nodiscard]] ParameterTable table() const { return table_; }

 private:
  ParameterTable table_;
  std::vector<Given> given_;
};

}  // namespace pwlsim::elements
