#include <cmath>

#include <fmt/format.h>

#include "base/names.hpp"
#include "circuit/card_items.hpp"
#include "circuit/commands.hpp"

namespace pwlsim::circuit {
namespace {

using netlist::Card;
using netlist::Item;
using ItemKind = Item::Kind;

constexpr std::string_view tran_usage = ".tran Tstep Tstop [Tstart [Tmax]] [uic] or .tran Tstop [uic]";
constexpr double rounding_of_quotient = 1e-15;  ///< of two decimals

struct Time {
  TimeValue value;
  SourceSpan span;
};

void report_no_times(const Card& card, Reporter& reporter) {
  reporter.error("E-missing-value", card.span, fmt::format(".tran has no times; usage: {}", tran_usage));
}

class TransientReader {
 public:
  TransientReader(const Card& card, Scope& scope, Reporter& reporter) : card_(card), scope_(scope), reporter_(reporter) {}

  bool wants_steady_state = false;

  std::optional<TransientAnalysis> read(std::uint64_t row_limit) {
    for (const Item& item : card_.items) read_item(item);
    if (!ok_) return std::nullopt;
    if (times_.empty()) {
      report_no_times(card_, reporter_);
      return std::nullopt;
    }
    if (times_.size() > 4) return fail("E-unexpected", times_[4].span, ".tran takes four times at most");
    TransientAnalysis transient = arrange();
    if (!check(transient, row_limit)) return std::nullopt;
    return transient;
  }

 private:
  std::nullopt_t fail(std::string id, SourceSpan span, std::string_view text) {
    reporter_.error(std::move(id), span, fmt::format("{}; usage: {}", text, tran_usage));
    ok_ = false;
    return std::nullopt;
  }

  void read_item(const Item& item) {
    if (is_word(item, "uic") || is_word(item, "skipbp")) {
      use_initial_conditions_ = true;
    } else if (is_word(item, "startup")) {
      use_initial_conditions_ = true;
      reporter_.warning("W-startup", item.span,
                        "startup is read as uic: the sources have their values from t = 0 on and do not rise within 20 us");
    } else if (is_word(item, "steady")) {
      wants_steady_state = true;
      reporter_.note("N-tran-steady", item.span, "steady is read as .pss: the run starts from the periodic steady state");
    } else if (is_word(item, "nodiscard")) {
      return;  // every row from Tstart on is kept anyway
    } else if (item.kind == ItemKind::word && is_foreign(item.text)) {
      reporter_.error("E-not-supported", item.span, fmt::format("{} on .tran is not supported; usage: {}", item.text, tran_usage));
      ok_ = false;
    } else if (item.kind == ItemKind::assignment) {
      fail("E-unexpected", item.span, fmt::format("unexpected '{}'", item.text));
    } else {
      read_time(item);
    }
  }

  static bool is_foreign(std::string_view word) { return same_name(word, "step"); }

  void read_time(const Item& item) {
    const std::optional<Number> number = scope_.number(item);
    if (!number) {
      ok_ = false;
    } else if (number->value < 0.0) {
      fail("E-tran", item.span, fmt::format("a time of .tran must not be negative, not {}", number->value));
    } else {
      times_.push_back({{number->value, number->decimal, number->gradient}, item.span});
      scope_.claim(*number);
    }
  }

  TransientAnalysis arrange() const {
    TransientAnalysis transient;
    transient.span = card_.span;
    transient.use_initial_conditions = use_initial_conditions_;
    transient.stop = times_[times_.size() == 1 ? 0 : 1].value;
    if (times_.size() > 1) transient.step = times_[0].value;
    if (times_.size() > 3 && transient.step.seconds == 0.0) transient.step = times_[3].value;
    if (times_.size() > 2) transient.start = times_[2].value;
    return transient;
  }

  bool check(const TransientAnalysis& transient, std::uint64_t row_limit) {
    const SourceSpan stop_span = times_[times_.size() == 1 ? 0 : 1].span;
    const double length = transient.stop.seconds - transient.start.seconds;
    if (!(length > 0.0)) {
      fail("E-tran", stop_span,
           fmt::format("Tstop = {} s must be greater than Tstart = {} s", transient.stop.seconds, transient.start.seconds));
      return false;
    }
    const double rows = std::floor(length / transient.row_step() * (1.0 + rounding_of_quotient)) + 1.0;
    if (rows > static_cast<double>(row_limit)) {
      reporter_.error("E-too-many-rows", times_[0].span,
                      fmt::format("{:.6g} output rows, more than {}; try a larger Tstep, or .options max_rows=", rows, row_limit));
      return false;
    }
    return true;
  }

  const Card& card_;
  Scope& scope_;
  Reporter& reporter_;
  std::vector<Time> times_;
  bool use_initial_conditions_ = false;
  bool ok_ = true;
};

/// The last one is run, as in LTspice.
const Card* card_that_counts(const Definitions& definitions, Reporter& reporter) {
  const auto& cards = definitions.transients;
  if (cards.empty()) return nullptr;
  for (std::size_t k = 0; k + 1 < cards.size(); ++k) {
    if (cards[k]->items.empty() && !cards[k]->damaged) report_no_times(*cards[k], reporter);
    reporter.warning("W-second-tran", cards[k]->name_span,
                     fmt::format("this .tran is not run: the last one is used, at {}", reporter.where(cards.back()->span)));
  }
  return cards.back();
}

}  // namespace

void read_analyses(const Definitions& definitions, SourceSpan title, Scope& scope, Reporter& reporter, bool required,
                   FlatCircuit& circuit) {
  Analyses& analyses = circuit.analyses;
  const Card* card = card_that_counts(definitions, reporter);
  read_steady_state(definitions, scope, reporter, circuit);
  read_small_signal(definitions, scope, reporter, circuit);
  if (card != nullptr && !card->damaged) {
    TransientReader reader(*card, scope, reporter);
    analyses.transient = reader.read(analyses.row_limit);
    if (reader.wants_steady_state && definitions.steady_states.empty()) {
      analyses.steady_state.emplace().span = card->span;
      analyses.steady_state->use_initial_conditions = analyses.transient && analyses.transient->use_initial_conditions;
    }
  }
  for (const Card* operating_point : definitions.operating_points) {
    analyses.operating_point = true;
    for (const Item& item : operating_point->items) reporter.error("E-unexpected", item.span, ".op takes no arguments");
  }
  if (required && card == nullptr && definitions.steady_states.empty() && definitions.small_signals.empty() && !analyses.operating_point &&
      !definitions.misplaced_analysis) {
    const std::string_view other = definitions.other_analysis;
    reporter.error("E-no-analysis", title,
                   other.empty()
                       ? "the deck requests no analysis; try a card .tran Tstep Tstop, or .op"
                       : fmt::format("the deck requests {} alone, which is not done here; try a card .tran Tstep Tstop, or .op with "
                                     ".step for several values",
                                     other));
  }
}

}  // namespace pwlsim::circuit
