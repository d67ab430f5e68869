// What calls of the library cost, in C++: one line with seconds, for bench/library/measure to set beside Python and MPI.
//
//     bench_library call DECK RUNS            least processor time of a run by Circuit::run
//     bench_library threads DECK RUNS JOBS    wall time of RUNS runs with other values of L1 and a measurement, by threads and circuits by hand
//     bench_library sweep DECK NAME RUNS      processor time a run by Sweep over the element or parameter NAME, from 1 to 2
//     bench_library controller CALLS          processor time of a run with CALLS samples of a function in C++
#include <pwlsim/pwlsim.hpp>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <limits>
#include <string>
#include <thread>
#include <vector>

namespace {

double processor_seconds() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

template <class Call>
double least_of(int runs, const Call& call) {
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < runs; ++k) {
    const double start = processor_seconds();
    call();
    least = std::min(least, processor_seconds() - start);
  }
  return least;
}

double call(const char* deck, int runs) {
  const auto circuit = pwlsim::Circuit::from_file(deck);
  return least_of(runs, [&] { (void)circuit.run(); });
}

double threads(const char* deck, int runs, int jobs) {
  const auto start = std::chrono::steady_clock::now();
  std::atomic<int> begun = 0;
  const auto work = [&] {
    auto circuit = pwlsim::Circuit::from_file(deck);
    circuit.measure("swing", "PP i(L1)");
    for (int k = begun++; k < runs; k = begun++) {
      circuit.set_value("L1", 40e-6 + 20e-6 * k / runs);
      (void)circuit.run({.events = false, .evaluable = false});
    }
  };
  std::vector<std::thread> list;
  for (int k = 0; k < jobs; ++k) list.emplace_back(work);
  for (std::thread& each : list) each.join();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double sweep(const char* deck, const char* name, int runs) {
  const pwlsim::Sweep swept(pwlsim::Circuit::from_file(deck), {name}, {.events = false, .evaluable = false});
  int number = 0;
  const double start = processor_seconds();
  for (; number < runs; ++number) (void)swept.run({1.0 + static_cast<double>(number) / runs}, static_cast<std::size_t>(number));
  return (processor_seconds() - start) / runs;
}

double controller(int calls) {
  pwlsim::Circuit circuit("sampled");
  circuit.resistor("R1", "a", "b", 1).capacitor("C1", "b", "0", 1e-3).save({"v(b)"});
  circuit.controller(
      {.inputs = {"v(b)"}, .outputs = {"a"}, .every = 1e-3, .function = [](double, const auto& in, auto& out) { out[0] = 1.0 - in[0]; }});
  return least_of(5, [&] { (void)circuit.run({.stop = 1e-3 * calls, .step = 1.0, .events = false, .evaluable = false}); });
}

}  // namespace

int main(int count, char** words) {
  const std::string mode = count > 1 ? words[1] : "";
  const auto number = [&](int k) { return k < count ? std::atoi(words[k]) : 0; };
  double seconds = -1.0;
  if (mode == "call") seconds = call(words[2], number(3));
  if (mode == "threads") seconds = threads(words[2], number(3), number(4));
  if (mode == "sweep") seconds = sweep(words[2], words[3], number(4));
  if (mode == "controller") seconds = controller(number(2));
  std::printf("%.9g\n", seconds);
  return seconds < 0.0 ? EXIT_FAILURE : EXIT_SUCCESS;
}
