/// The program beside one that was derived by hand for each circuit (circuits.hpp): time of a cycle, and error.
///
///     cmake -S . -B build -DCMAKE_BUILD_TYPE=Release -DPWLSIM_BENCH=ON && ninja -C build bench_by_hand && build/bench/bench_by_hand
///
/// A cycle costs what 20,200 cycles take more than 200, over 20,000, 64 rows each: fixed costs cancel. Errors are against the hand-derived
/// program in long double, of the largest value of each signal.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>

#include "by_hand/circuits.hpp"
#include "circuit/compile.hpp"
#include "engine/exact/exact.hpp"
#include "netlist/load.hpp"

namespace {

using namespace pwlsim;

constexpr std::uint64_t few = 200, many = 20200, rows = 64;
constexpr int repetitions = 7;

using Rows = by_hand::Rows<double>;
using Clock = std::chrono::steady_clock;

/// Rows of (time, v(out), i(L1)).
class Collector : public engine::RowSink {
 public:
  bool write(std::span<const double> values, std::size_t count) override {
    for (std::size_t k = 0; k < count; ++k) result.push_back({values[3 * k + 2], values[3 * k + 1]});
    return true;
  }
  Rows result;
};

struct Times {
  double model = 0.0, simulate = 0.0;  ///< s
};

/// A netlist of netlists/ over a number of its periods.
class Netlist {
 public:
  Netlist(const std::string& name, double period) : period_(period) {
    SourceStore sources;
    Diagnostics diagnostics;
    const netlist::Loaded loaded = netlist::load(std::string(PWLSIM_SOURCE_DIR "/netlists/") + name + ".net", sources, diagnostics);
    compiled_ = circuit::compile(loaded.deck, sources, diagnostics);
    if (!compiled_) throw std::runtime_error(name + " does not compile");
  }

  Rows run(std::uint64_t cycles, Times& times) const {
    Diagnostics diagnostics;
    const auto model = engine::prepare(compiled_->network, diagnostics);
    engine::Request request;
    request.stop = period_ * static_cast<double>(cycles);
    request.grid.rows = rows;
    request.grid.time = [stop = request.stop](std::uint64_t k) { return stop * static_cast<double>(k) / static_cast<double>(rows - 1); };
    request.use_initial_conditions = true;
    Collector collector;
    const engine::Answer answer = engine::run(*model, request, collector);
    times = {answer.statistics.seconds_model, answer.statistics.seconds_simulate};
    return std::move(collector.result);
  }

 private:
  double period_;
  std::optional<circuit::Compiled> compiled_;
};

template <class Real>
double error(const Rows& found, const by_hand::Rows<Real>& exact) {
  if (found.size() != exact.size()) throw std::runtime_error("rows are missing");
  double most_i = 0.0, most_v = 0.0, off_i = 0.0, off_v = 0.0;
  for (std::size_t k = 0; k < found.size(); ++k) {
    most_i = std::max(most_i, static_cast<double>(std::abs(exact[k].i)));
    most_v = std::max(most_v, static_cast<double>(std::abs(exact[k].v)));
    off_i = std::max(off_i, static_cast<double>(std::abs(static_cast<Real>(found[k].i) - exact[k].i)));
    off_v = std::max(off_v, static_cast<double>(std::abs(static_cast<Real>(found[k].v) - exact[k].v)));
  }
  return std::max(off_i / most_i, off_v / most_v);
}

/// The shortest of several runs.
double shortest(const std::function<double()>& run) {
  double best = std::numeric_limits<double>::infinity();
  for (int k = 0; k < repetitions; ++k) best = std::min(best, run());
  return best;
}

template <class ByHand, class Exact>
void compare(const char* name, double period, const ByHand& by_hand, const Exact& exact) {
  const Netlist netlist(name, period);
  Rows own, found;
  const auto time_by_hand = [&](std::uint64_t cycles) {
    return shortest([&] {
      const auto start = Clock::now();
      own = by_hand.run(cycles, rows);
      return std::chrono::duration<double>(Clock::now() - start).count();
    });
  };
  double model = std::numeric_limits<double>::infinity();
  const auto time_of_netlist = [&](std::uint64_t cycles) {
    return shortest([&] {
      Times times;
      found = netlist.run(cycles, times);
      model = std::min(model, times.model);
      return times.simulate;
    });
  };
  const double hand_few = time_by_hand(few), hand_cycle = (time_by_hand(many) - hand_few) / (many - few);
  const double few_cycles = time_of_netlist(few), cycle = (time_of_netlist(many) - few_cycles) / (many - few);
  const auto reference = exact.run(many, rows);
  const double modes = few_cycles - few * cycle;
  std::printf("%-10s %10.1f %10.1f %8.1f %12.1e %12.1e %10.0f %10.0f\n", name, 1e9 * hand_cycle, 1e9 * cycle, cycle / hand_cycle,
              error(own, reference), error(found, reference), 1e6 * model, 1e6 * modes);
}

template <class Real>
by_hand::Buck<Real> buck(Real load, Real start, Real on) {
  return {by_hand::Filter<Real>(Real(47) / 1000000, Real(100) / 1000000, load), 24, start, on, Real(1) / 100000};
}

template <class Real>
by_hand::Buck<Real> continuous() {
  return buck<Real>(Real(5) / 2, 0, Real(45) / 10000000);
}

/// The gate passes one half in the middle of its edges of 10 ns.
template <class Real>
by_hand::Buck<Real> discontinuous() {
  return buck<Real>(25, Real(5) / 1000000000, Real(3) / 1000000);
}

template <class Real>
by_hand::Bridge<Real> bridge() {
  return {by_hand::Filter<Real>(Real(1) / 1000, Real(1) / 1000, 50), 325, 50};
}

}  // namespace

int main() {
  std::printf("%-10s %10s %10s %8s %12s %12s %10s %10s\n", "circuit", "by hand", "pwlsim", "ratio", "error", "error of", "model", "modes");
  std::printf("%-10s %10s %10s %8s %12s %12s %10s %10s\n", "", "ns/cycle", "ns/cycle", "", "by hand", "pwlsim", "us", "us");
  compare("buck", 1e-5, continuous<double>(), continuous<long double>());
  compare("buck_dcm", 1e-5, discontinuous<double>(), discontinuous<long double>());
  compare("fullwave", 0.02, bridge<double>(), bridge<long double>());
}
