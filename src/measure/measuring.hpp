#pragma once
/// All measurements of a deck.
///
/// A measurement that needs results of others (FROM= the time of a crossing) is computed in a later pass over the run, when these are known; most decks
/// need one pass. Use:
///
///     Measuring measuring(measurements, start, stop);
///     while (measuring.begin_pass()) { run with measuring.probes(); measuring.end_pass(reached); }

#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostic.hpp"
#include "measure/fourier.hpp"
#include "measure/meter.hpp"

namespace pwlsim::measure {

struct Result {
  std::string name;
  double value = 0.0;
  std::string unit;      ///< "V", "W", "s", …; "" if it has none or it is not known
  std::string failure;   ///< why there is no value; "" if there is one
  std::string left_out;  ///< impulses that the value excludes, and why; "" if none
  SourceSpan span;
};

struct Results {
  std::vector<Result> list;  ///< in the order of the deck
  std::vector<FourierResult> fourier;

  [[nodiscard]] bool empty() const { return list.empty() && fourier.empty(); }
  void add(Results others) {
    std::move(others.list.begin(), others.list.end(), std::back_inserter(list));
    std::move(others.fourier.begin(), others.fourier.end(), std::back_inserter(fourier));
  }
};

/// The data of every measurement, including hidden ones, after all passes.
struct Record {
  std::vector<double> values;
  std::vector<std::string> failures;
  std::vector<Place> places;
  std::vector<char> impulses;  ///< whether the value excludes impulses, or includes some
};

class Measuring : public engine::PieceSink {
 public:
  /// `start`, `stop`: of the rows, s; `end`: the latest end of windows, s (a periodic run continues after `stop`). The measurements must outlive this.
  Measuring(const circuit::Measurements& measurements, double start, double stop, double end);

  /// Prepares the next pass over the run; false if none is needed.
  bool begin_pass();
  /// The number of the current pass, from 1.
  [[nodiscard]] int pass() const { return pass_; }
  [[nodiscard]] engine::Probes probes();
  void end_pass(double reached);
  [[nodiscard]] Results results() const;
  [[nodiscard]] Record record() const { return {values_, failures_, places_, impulses_}; }

  void before_start(std::span<const double> values) override;
  void take(const engine::Piece& piece) override;
  void impulse(double time, std::span<const double> values) override;

 private:
  [[nodiscard]] bool is_ready(std::size_t index) const;
  void evaluate_parameters();
  void start_meters();
  void settle(std::size_t index, double value, std::string failure);
  [[nodiscard]] std::string missing(std::size_t index) const;
  void hold(double from, double to);

  const circuit::Measurements& measurements_;
  double start_, stop_, end_;
  int pass_ = 0;
  PieceView view_;
  std::vector<double> before_start_;  ///< a piece
  std::vector<char> known_;
  std::vector<double> values_;
  std::vector<std::string> failures_, left_out_;
  std::vector<Place> places_;
  std::vector<char> impulses_;
  std::vector<std::pair<std::size_t, Meter>> meters_;  ///< of this pass
  std::vector<FourierMeter> fourier_;
  std::vector<FourierResult> fourier_results_;
  double from_ = 0.0, to_ = 0.0;  ///< the interval that the meters of this pass need
};

/// The warning for a result that failed or excludes impulses; `where`: " in the run with …", or "".
[[nodiscard]] Diagnostic failure_warning(const Result& result, const std::string& where = "");
[[nodiscard]] Diagnostic left_out_warning(const Result& result, const std::string& where = "");

/// `name = value` lines with this many significant digits (0: all), `name = failed` if there is no value; then the tables of .four.
[[nodiscard]] std::string results_text(const Results& results, int digits = 0);

}  // namespace pwlsim::measure
