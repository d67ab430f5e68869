#include "analysis/sampling.hpp"

#include <utility>

#include "analysis/row_grid.hpp"

namespace pwlsim::analysis {
namespace {

class MemorySink : public engine::RowSink {
 public:
  MemorySink(SampledRun& run, std::size_t signals) : run_(run) { run_.columns.resize(signals); }

  bool write(std::span<const double> values, std::size_t count) override {
    const std::size_t width = run_.columns.size() + 1;
    for (std::size_t row = 0; row < count; ++row) {
      run_.times.push_back(values[row * width]);
      for (std::size_t k = 0; k + 1 < width; ++k) run_.columns[k].push_back(values[row * width + k + 1]);
    }
    return true;
  }

 private:
  SampledRun& run_;
};

SampledRun run_on(const engine::Request& request, std::size_t signals, const Simulate& simulate) {
  SampledRun run;
  MemorySink sink(run, signals);
  run.answer = simulate(request, sink);
  return run;
}

}  // namespace

SampledRun sample(const circuit::Analyses& analyses, std::size_t signals, const Simulate& simulate, std::span<const double> times,
                  const RunControl& control) {
  engine::Request request = request_of(analyses, control);
  request.grid = {[times](std::uint64_t k) { return times[static_cast<std::size_t>(k)]; }, times.size()};
  return run_on(request, signals, simulate);
}

SampledRun sample_grid(const circuit::Analyses& analyses, std::size_t signals, const Simulate& simulate, const RunControl& control) {
  return run_on(request_of(analyses, control), signals, simulate);
}

std::vector<double> repeated_times(const SampledRun& run) {
  std::vector<double> times;
  for (std::size_t k = 1; k < run.times.size(); ++k) {
    if (run.times[k] == run.times[k - 1] && (times.empty() || times.back() != run.times[k])) times.push_back(run.times[k]);
  }
  return times;
}

}  // namespace pwlsim::analysis
