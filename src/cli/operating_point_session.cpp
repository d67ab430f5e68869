/// `.op`: the DC operating point, printed.

#include "analysis/report.hpp"
#include "cli/analysis_session.hpp"
#include "cli/signals.hpp"

namespace pwlsim::cli {
namespace {

class OperatingPointSession : public AnalysisSession {
 public:
  [[nodiscard]] bool is_asked(const circuit::Analyses& analyses) const override { return analyses.operating_point; }
  [[nodiscard]] bool needs_those_before() const override { return false; }

  [[nodiscard]] int run(RunContext& run) override {
    const engine::OperatingPoint point = run.engine.operating_point();
    run.take_remarks(point.answer);
    if (point.answer.outcome != engine::Outcome::completed) {
      const int status = run.fail(Status::run_failed, point.answer.id, point.answer.message);
      return point.answer.outcome == engine::Outcome::interrupted ? status_of_signal(caught_signal()) : status;
    }
    run.outcome.operating_point = point.values;
    run.outcome.operating_point->resize(run.outcome.signals.size());
    if (run.options.json) return 0;
    const std::string text =
        analysis::operating_point_text(run.outcome.signals, *run.outcome.operating_point, digits_for(run.table_stream()));
    return print(text, run.messages, run.table_stream());
  }
};

}  // namespace

std::unique_ptr<AnalysisSession> operating_point_session() { return std::make_unique<OperatingPointSession>(); }

}  // namespace pwlsim::cli
