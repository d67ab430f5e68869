#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/names.hpp"
#include "circuit/card_items.hpp"
#include "circuit/commands.hpp"
#include "circuit/measured_expression.hpp"
#include "netlist/card_style.hpp"

namespace pwlsim::circuit {
namespace {

using netlist::Card;
using netlist::Item;
using ItemKind = Item::Kind;
using MeasurementKind = Measurement::Kind;
using Results = std::unordered_map<std::string, int>;

constexpr std::string_view meas_usage =
    ".meas [tran|pss] name AVG|MIN|MAX|PP|RMS|INTEG expr [FROM= TO=] | FIND expr AT= | FIND expr WHEN a=b [RISE=] | WHEN a=b | TRIG a=b "
    "TARG "
    "c=d | "
    "AVG expr LAST=n PERIODS OF V1 | "
    "PARAM expr";
constexpr std::string_view fourier_usage = ".four frequency [harmonics [periods]] v(node) ...";
constexpr double most_harmonics = 10000;

struct KindName {
  std::string_view name;
  MeasurementKind kind;
};
constexpr KindName kind_names[] = {
    {"avg", MeasurementKind::average},
    {"min", MeasurementKind::minimum},
    {"max", MeasurementKind::maximum},
    {"pp", MeasurementKind::peak_to_peak},
    {"rms", MeasurementKind::rms},
    {"integ", MeasurementKind::integral},
    {"integral", MeasurementKind::integral},
    {"min_at", MeasurementKind::time_of_minimum},
    {"max_at", MeasurementKind::time_of_maximum},
    {"find", MeasurementKind::value},
    {"deriv", MeasurementKind::derivative},
    {"derivative", MeasurementKind::derivative},
    {"when", MeasurementKind::time},
    {"param", MeasurementKind::parameter},
    {"period", MeasurementKind::period},
};

bool is_keyword(const Item& item) { return item.kind == ItemKind::word && netlist::is_measurement_keyword(item.text); }

bool reads(const MeasuredExpression& expression, StepKind kind) {
  return std::any_of(expression.steps.begin(), expression.steps.end(), [&](const auto& step) { return step.kind == kind; });
}

bool is_of_motion(const MeasuredExpression& expression) { return reads(expression, StepKind::signal) || reads(expression, StepKind::time); }

/// The place of a measurement's name on its card.
std::size_t name_place(const Card& card) {
  return !card.items.empty() && netlist::is_analysis_name(card.items[0].text) && card.items.size() > 1 ? 1 : 0;
}

/// `.meas pss …`
bool measures_orbit(const Card& card) { return name_place(card) > 0 && same_name(card.items[0].text, "pss"); }

/// One card; parts of it that are measurements of their own go to `parts`, and count on from `next_result`.
class CardReader {
 public:
  CardReader(const Card& card, const Results& results, Scope& scope, Reporter& reporter, FlatCircuit& circuit, int next_result)
      : items_(card.items),
        at_(name_place(card)),
        is_of_orbit_(measures_orbit(card)),
        reader_(scope, reporter, results, circuit),
        scope_(scope),
        reporter_(reporter),
        card_(card),
        next_result_(next_result),
        transient_(circuit.analyses.transient) {}

  std::vector<Measurement> parts;

  std::optional<Measurement> read() {
    Measurement measurement;
    measurement.name = items_[at_].text;
    measurement.span = items_[at_++].span;
    name_ = measurement.name;
    const bool done = at("trig") ? read_interval(measurement) : read_kind(measurement);
    if (!done) return std::nullopt;
    if (at_ < items_.size()) return fail("E-unexpected", items_[at_].span, fmt::format("unexpected '{}'", text(items_[at_])));
    return measurement;
  }

 private:
  std::nullopt_t fail(std::string id, SourceSpan span, std::string_view what) {
    reporter_.error(std::move(id), span, fmt::format("measurement {}: {}; usage: {}", name_, what, meas_usage));
    return std::nullopt;
  }
  bool refuse(std::string id, SourceSpan span, std::string_view what) {
    (void)fail(std::move(id), span, what);
    return false;
  }
  std::string_view text(const Item& item) const { return reporter_.text(item.span); }
  bool at(std::string_view keyword) const { return at_ < items_.size() && is_word(items_[at_], keyword); }
  bool take(std::string_view keyword) {
    const bool found = at(keyword);
    at_ += static_cast<std::size_t>(found);
    return found;
  }

  bool read_kind(Measurement& measurement) {
    if (at_ >= items_.size()) return refuse("E-missing-value", card_.span, "it does not say what to measure");
    if (at_ + 1 < items_.size() && same_name(text(items_[at_]), "time") && is_word(items_[at_ + 1], "when")) ++at_;
    const Item& word = items_[at_];
    const auto* found =
        std::find_if(std::begin(kind_names), std::end(kind_names), [&](const KindName& k) { return is_word(word, k.name); });
    if (found == std::end(kind_names)) {
      const bool is_error = word.kind == ItemKind::word && same_name(std::string_view(word.text).substr(0, 3), "err");
      return refuse(is_error ? "E-not-supported" : "E-unexpected", word.span,
                    fmt::format("{} is {}", text(word), is_error ? "not supported" : "not a kind of measurement"));
    }
    ++at_;
    measurement.kind = found->kind;
    if (measurement.kind == MeasurementKind::time) return read_when(measurement);
    if (measurement.kind == MeasurementKind::period)
      return is_of_orbit_ || refuse("E-measurement", word.span, "PERIOD is that of the periodic steady state; try .meas pss");
    std::optional<MeasuredExpression> expression = next_expression("an expression");
    if (!expression) return false;
    measurement.expression = std::move(*expression);
    const SourceSpan span = measurement.expression.span;
    if (measurement.kind == MeasurementKind::parameter)
      return !is_of_motion(measurement.expression) ||
             refuse("E-measurement", span, "PARAM takes numbers and results of other measurements; for a signal at a time try FIND … AT=");
    if (measurement.kind == MeasurementKind::value || measurement.kind == MeasurementKind::derivative) return read_place(measurement);
    return at("trig") ? read_window_between(measurement) : read_window(measurement);
  }

  bool read_place(Measurement& measurement) {
    if (take("when")) return read_when(measurement);
    if (!take("at")) return refuse("E-missing-value", card_.span, "AT= or WHEN is missing");
    measurement.at = next_number("AT=");
    return measurement.at.has_value();
  }

  bool read_when(Measurement& measurement) {
    std::optional<Crossing> crossing = read_crossing(measurement);
    if (!crossing) return false;
    if (is_instant(*crossing))
      take_instant(measurement, std::move(crossing->right));
    else
      measurement.when = std::move(crossing);
    return true;
  }

  /// time=2m within the run: it passes there once, also at the run's end, beyond which a crossing would have to lead.
  bool is_instant(const Crossing& crossing) const {
    const auto is_only = [](const MeasuredExpression& x, StepKind kind) { return x.steps.size() == 1 && x.steps[0].kind == kind; };
    if (!is_only(crossing.left, StepKind::time) || !is_only(crossing.right, StepKind::number)) return false;
    if (crossing.delay || crossing.edge == Edge::fall || crossing.count != 1 || !transient_) return false;
    const double time = crossing.right.steps[0].number;
    return time > 0.0 && time <= transient_->stop.seconds;
  }

  static void take_instant(Measurement& measurement, MeasuredExpression time) {
    if (measurement.kind == MeasurementKind::time) {
      measurement.kind = MeasurementKind::parameter;
      measurement.expression = std::move(time);
    } else {
      measurement.at = std::move(time);
    }
  }

  /// a [VAL] b, and what of TD, RISE, FALL, CROSS follows; FROM and TO for the measurement.
  std::optional<Crossing> read_crossing(Measurement& measurement) {
    Crossing crossing;
    std::optional<MeasuredExpression> left = next_expression("what crosses");
    if (!left) return std::nullopt;
    (void)take("val");
    std::optional<MeasuredExpression> right = next_expression("what it crosses");
    if (!right) return std::nullopt;
    crossing.left = std::move(*left);
    crossing.right = std::move(*right);
    while (at_ < items_.size()) {
      if (take("td")) {
        crossing.delay = next_number("TD=");
        if (!crossing.delay) return std::nullopt;
      } else if (at("rise") || at("fall") || at("cross")) {
        if (!read_count(crossing)) return std::nullopt;
      } else if (at("from") || at("to")) {
        if (!read_window(measurement)) return std::nullopt;
      } else {
        break;
      }
    }
    return crossing;
  }

  bool read_count(Crossing& crossing) {
    const Item& word = items_[at_++];
    crossing.edge = is_word(word, "rise") ? Edge::rise : is_word(word, "fall") ? Edge::fall : Edge::any;
    crossing.last = take("last");
    if (crossing.last) return true;
    if (at_ >= items_.size() || is_keyword(items_[at_]))
      return refuse("E-missing-value", word.span, fmt::format("a number is missing after {}", word.text));
    const Item& item = items_[at_++];
    const std::optional<Number> number = scope_.number(item);
    if (!number) return false;
    constexpr double largest = 1e15;
    if (number->value < 1.0 || number->value > largest || number->value != std::floor(number->value))
      return refuse("E-range", item.span, fmt::format("{} counts from 1, or is LAST, not {}", word.text, number->value));
    crossing.count = static_cast<std::uint64_t>(number->value);
    return true;
  }

  /// LAST=n PERIODS OF V1
  bool read_last_periods(Measurement& measurement) {
    Measurement::LastPeriods last;
    last.span = items_[at_ - 1].span;
    // Elsewhere these words are no keywords and are read as expressions.
    const auto says = [&](std::string_view word) { return at_ < items_.size() && same_name(text(items_[at_]), word); };
    if (at_ < items_.size() && !says("period") && !says("periods")) {
      const std::optional<Number> number = scope_.number(items_[at_++]);
      if (!number) return false;
      if (number->value < 1.0 || number->value != std::floor(number->value))
        return refuse("E-range", last.span, fmt::format("LAST counts whole periods from 1, not {}", number->value));
      last.count = number->value;
    }
    const bool has_word = says("periods") || says("period");
    at_ += static_cast<std::size_t>(has_word);
    if (!has_word || !says("of") || at_ + 1 >= items_.size())
      return refuse("E-missing-value", last.span, "LAST=n is followed by PERIODS OF and a source");
    last.source = text(items_[at_ + 1]);
    at_ += 2;
    measurement.last_periods = std::move(last);
    return true;
  }

  bool read_window(Measurement& measurement) {
    if (take("last")) return read_last_periods(measurement);
    while (at("from") || at("to")) {
      const bool is_from = is_word(items_[at_++], "from");
      auto& place = is_from ? measurement.from : measurement.to;
      place = next_number(is_from ? "FROM=" : "TO=");
      if (!place) return false;
    }
    return true;
  }

  /// AVG … TRIG … TARG …: between two times that are measured first.
  bool read_window_between(Measurement& measurement) {
    const std::optional<int> from = read_instant("trig");
    const std::optional<int> to = from ? read_instant("targ") : std::nullopt;
    if (!to) return false;
    measurement.from = result(*from);
    measurement.to = result(*to);
    return true;
  }

  /// TRIG … TARG …: the difference of two times that are measured first.
  bool read_interval(Measurement& measurement) {
    const std::optional<int> from = read_instant("trig");
    const std::optional<int> to = from ? read_instant("targ") : std::nullopt;
    if (!to) return false;
    measurement.kind = MeasurementKind::parameter;
    measurement.expression = result(*to);
    measurement.expression.steps.push_back(result(*from).steps.front());
    measurement.expression.steps.push_back({.kind = StepKind::operation, .operation = "-"});
    return true;
  }

  /// TRIG or TARG as a measurement of its own; its number.
  std::optional<int> read_instant(std::string_view keyword) {
    if (!take(keyword)) return fail("E-missing-value", card_.span, fmt::format("{} is missing", keyword == "targ" ? "TARG" : "TRIG"));
    Measurement part;
    part.name = fmt::format("{} of {}", keyword == "targ" ? "TARG" : "TRIG", name_);
    part.span = card_.span;
    part.shown = false;
    part.kind = MeasurementKind::time;
    if (take("at")) {
      std::optional<MeasuredExpression> time = next_number("AT=");
      if (!time) return std::nullopt;
      part.kind = MeasurementKind::parameter;
      part.expression = std::move(*time);
    } else if (!read_when(part)) {
      return std::nullopt;
    }
    parts.push_back(std::move(part));
    return next_result_ + static_cast<int>(parts.size()) - 1;
  }

  static MeasuredExpression result(int index) {
    MeasuredExpression expression;
    expression.steps.push_back({.kind = StepKind::result, .index = index});
    return expression;
  }

  std::optional<MeasuredExpression> next_expression(std::string_view what) {
    if (at_ >= items_.size() || is_keyword(items_[at_])) {
      const SourceSpan span = at_ < items_.size() ? items_[at_].span : card_.span;
      return fail("E-missing-value", span, fmt::format("{} is missing", what));
    }
    return reader_.read(items_[at_++]);
  }

  /// Of numbers and results alone.
  std::optional<MeasuredExpression> next_number(std::string_view what) {
    std::optional<MeasuredExpression> expression = next_expression(what);
    if (expression && is_of_motion(*expression))
      return fail("E-measurement", expression->span, fmt::format("{} takes numbers and results of other measurements", what));
    return expression;
  }

  const std::vector<Item>& items_;
  std::size_t at_;
  bool is_of_orbit_;
  MeasuredExpressionReader reader_;
  Scope& scope_;
  Reporter& reporter_;
  const Card& card_;
  int next_result_;
  const std::optional<TransientAnalysis>& transient_;
  std::string name_;
};

class MeasurementReader {
 public:
  /// Those of the periodic steady state, or of the transient run.
  MeasurementReader(Scope& scope, Reporter& reporter, FlatCircuit& circuit, bool of_orbit)
      : scope_(scope),
        reporter_(reporter),
        circuit_(circuit),
        of_orbit_(of_orbit),
        measurements_(of_orbit ? circuit.orbit_measurements : circuit.measurements) {}

  void read(const std::vector<const Card*>& cards) {
    for (const Card* card : cards) announce(*card);
    auto& list = measurements_.list;
    list.resize(announced_.size());
    for (std::size_t k = 0; k < announced_.size(); ++k) {
      CardReader reader(*announced_[k], results_, scope_, reporter_, circuit_, static_cast<int>(list.size()));
      std::optional<Measurement> measurement = reader.read();
      if (!measurement && circuit_.written_by_ltspice) measurement = left_out(*announced_[k]);
      if (!measurement) continue;
      list[k] = std::move(*measurement);
      std::move(reader.parts.begin(), reader.parts.end(), std::back_inserter(list));
    }
    if (!reporter_.failed()) check_circles();
  }

  void read_fourier(const Card& card) {
    FourierAnalysis analysis;
    analysis.span = card.span;
    std::vector<double> numbers;
    for (const Item& item : card.items) {
      const bool is_number = item.kind != ItemKind::group || item.text.empty();
      if (is_number && analysis.signals.empty()) {
        const std::optional<Number> number = scope_.number(item);
        if (!number) return;
        numbers.push_back(number->value);
      } else if (std::optional<SaveRequest> request = save_request(item, reporter_); request && request->kind != SaveRequest::Kind::all) {
        std::string column = request->column;
        analysis.signals.push_back({std::move(column), add_probe(circuit_, std::move(*request))});
      } else {
        return;
      }
    }
    if (card.damaged || !check_fourier(card, numbers, analysis)) return;
    measurements_.fourier.push_back(std::move(analysis));
  }

 private:
  /// LTspice measures after the run, which such a card does not stop. In its place: what is never found, nor shown.
  Measurement left_out(const Card& card) {
    const SourceSpan span = card.span;
    reporter_.soften([&](Diagnostic& diagnostic) {
      const bool is_here = diagnostic.span.file == span.file && diagnostic.span.begin >= span.begin && diagnostic.span.begin <= span.end;
      if (!is_here) return false;
      diagnostic.id = "W-measurement";
      diagnostic.text = "left out: " + diagnostic.text;
      return true;
    });
    const Item& name = card.items[name_place(card)];
    Measurement measurement;
    measurement.kind = MeasurementKind::time;
    measurement.name = name.text;
    measurement.span = name.span;
    measurement.shown = false;
    measurement.when.emplace();
    measurement.when->left.steps.push_back({.kind = StepKind::number, .number = 0.0});
    measurement.when->right.steps.push_back({.kind = StepKind::number, .number = 1.0});
    return measurement;
  }

  /// Cards of other analyses are left out; a name counts before its card is read.
  void announce(const Card& card) {
    if (card.damaged || measures_orbit(card) != of_orbit_) return;
    const std::size_t place = name_place(card);
    if (place > 0 && !of_orbit_ && !same_name(card.items[0].text, "tran")) {
      reporter_.warning("W-ignored-card", card.items[0].span,
                        fmt::format("{} {} is ignored: only .tran and .pss are measured", card.name, card.items[0].text));
      return;
    }
    if (place >= card.items.size() || card.items[place].kind != ItemKind::word) {
      reporter_.error("E-missing-value", card.span, fmt::format("{} names no measurement; usage: {}", card.name, meas_usage));
      return;
    }
    const Item& name = card.items[place];
    const auto [entry, is_new] = results_.try_emplace(without_case(name.text), static_cast<int>(announced_.size()));
    if (is_new) {
      announced_.push_back(&card);
      return;
    }
    const Card& first = *announced_[static_cast<std::size_t>(entry->second)];
    reporter_.error("E-duplicate-measurement", name.span,
                    fmt::format("a second measurement {}; the first is at {}", name.text, reporter_.where(first.span)));
  }

  bool check_fourier(const Card& card, const std::vector<double>& numbers, FourierAnalysis& analysis) {
    const auto refuse = [&](std::string id, std::string_view what) {
      reporter_.error(std::move(id), card.span, fmt::format("{}; usage: {}", what, fourier_usage));
      return false;
    };
    if (numbers.empty()) return refuse("E-missing-value", ".four has no frequency");
    if (analysis.signals.empty()) return refuse("E-missing-value", ".four names no signal");
    if (numbers.size() > 3) return refuse("E-unexpected", ".four takes three numbers at most");
    analysis.frequency = numbers[0];
    if (!(numbers[0] > 0.0)) return refuse("E-range", "the frequency of .four must be positive");
    if (numbers.size() > 1) {
      if (numbers[1] < 1.0 || numbers[1] > most_harmonics || numbers[1] != std::floor(numbers[1]))
        return refuse("E-range", fmt::format("the harmonics of .four are 1 to {}", most_harmonics));
      analysis.harmonics = static_cast<std::uint64_t>(numbers[1]) + 1;
    }
    if (numbers.size() > 2) {
      const bool all = numbers[2] == -1.0;
      if (!all && (numbers[2] < 1.0 || numbers[2] != std::floor(numbers[2])))
        return refuse("E-range", "the periods of .four are 1 or more, or -1 for as many as the run contains");
      analysis.periods = all ? 0.0 : numbers[2];
    }
    return true;
  }

  /// Results that need one another.
  void check_circles() {
    const auto& list = measurements_.list;
    std::vector<char> state(list.size(), 0);  // 1: being followed, 2: done
    for (std::size_t k = 0; k < list.size(); ++k) follow(k, state);
  }

  void follow(std::size_t index, std::vector<char>& state) {
    if (state[index] == 2) return;
    const Measurement& measurement = measurements_.list[index];
    if (state[index] == 1) {
      reporter_.error("E-measurement", measurement.span, fmt::format("the measurement {} needs its own result", measurement.name));
      return;
    }
    state[index] = 1;
    for (const int other : results_read(measurement)) follow(static_cast<std::size_t>(other), state);
    state[index] = 2;
  }

  Scope& scope_;
  Reporter& reporter_;
  FlatCircuit& circuit_;
  bool of_orbit_;
  Measurements& measurements_;
  Results results_;
  std::vector<const Card*> announced_;
};

}  // namespace

std::vector<int> results_read(const Measurement& measurement) {
  std::vector<int> numbers;
  const auto note = [&](const MeasuredExpression& expression) {
    for (const auto& step : expression.steps)
      if (step.kind == StepKind::result) numbers.push_back(step.index);
  };
  note(measurement.expression);
  for (const auto* part : {&measurement.from, &measurement.to, &measurement.at})
    if (*part) note(**part);
  if (measurement.when) {
    note(measurement.when->left);
    note(measurement.when->right);
    if (measurement.when->delay) note(*measurement.when->delay);
  }
  return numbers;
}

void read_measurements(const Definitions& definitions, Scope& scope, Reporter& reporter, FlatCircuit& circuit) {
  const bool has_orbit = circuit.analyses.steady_state.has_value() || !definitions.steady_states.empty();
  const bool has_transient = !definitions.transients.empty();
  const auto ignore = [&](const Card& card, std::string_view analysis) {
    reporter.warning("W-ignored-card", card.name_span, fmt::format("{} is ignored: there is no {} to measure", card.name, analysis));
  };
  const auto& cards = definitions.measurements;
  const auto of_orbit = std::find_if(cards.begin(), cards.end(), [](const Card* card) { return measures_orbit(*card); });
  const auto of_run = std::find_if_not(cards.begin(), cards.end(), [](const Card* card) { return measures_orbit(*card); });
  if (!has_orbit && of_orbit != cards.end()) ignore(**of_orbit, ".pss");
  if (!has_transient && of_run != cards.end()) ignore(**of_run, ".tran");
  if (!has_transient && !has_orbit && !definitions.fourier_analyses.empty()) ignore(*definitions.fourier_analyses.front(), ".tran");
  MeasurementReader run(scope, reporter, circuit, false), orbit(scope, reporter, circuit, true);
  if (has_transient) run.read(cards);
  if (has_orbit) orbit.read(cards);
  for (const Card* card : definitions.fourier_analyses)
    if (has_orbit || has_transient) (has_orbit ? orbit : run).read_fourier(*card);
}

}  // namespace pwlsim::circuit
