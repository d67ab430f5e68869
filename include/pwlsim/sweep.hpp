#pragma once
/// Many runs of one circuit: what does not depend on the values that change is done once.

#include <atomic>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <pwlsim/circuit.hpp>

namespace pwlsim {

class Sweep {
 public:
  /// `names`: parameters of the circuit, or elements outside of subcircuits (R, C, L, K; V and I become constant; gains of E, F, G, H).
  /// The deck is read once. Throws Error as Circuit::run does; E-unknown-element, E-no-value by run.
  Sweep(const Circuit& circuit, std::vector<std::string> names, const Options& options = {});
  /// The runs of the deck's `.step`.
  explicit Sweep(const Circuit& circuit, const Options& options = {});

  /// Names of what changes; those of `.step` for a deck.
  [[nodiscard]] const std::vector<std::string>& names() const;
  /// Names of the circuit's measurements, in the order of SweptRun::measurements.
  [[nodiscard]] std::vector<std::string> measurements() const;
  /// How many runs `.step` asks for; 0 for values given in code.
  [[nodiscard]] std::size_t runs() const;
  /// The values of one of them, in the order of the names.
  [[nodiscard]] std::vector<double> point(std::size_t run) const;

  /// One run. `number` is of the deck's random numbers, and of `.step`, which needs no values. The same values and number give the same result to the last bit, in
  /// whatever order and by how many threads runs are made. Throws as Circuit::run does.
  [[nodiscard]] Result run(const std::vector<double>& values, std::size_t number = 0, const std::atomic<int>* interrupt = nullptr) const;

  struct Data;

 private:
  std::shared_ptr<const Data> data_;
};

/// What came of one run of many.
struct SweptRun {
  bool done = false;
  std::vector<double> measurements;  ///< in the order of the circuit's; NaN where one failed
  std::string id, message;           ///< of the error where it is not done
};

/// Runs points[0], points[1], … on `jobs` threads (0: as many as the machine has), one point a vector of values. For a sweep of `.step` the points are empty
/// vectors. `take` is called after each run by the thread that did it, one at a time, with the run's number, its values and what came of it. Runs that `interrupt` kept
/// from being done are not taken.
void run_all(const Sweep& sweep, const std::vector<std::vector<double>>& points, std::size_t jobs,
             const std::function<void(std::size_t number, const SweptRun& run)>& take, const std::atomic<int>* interrupt = nullptr);

}  // namespace pwlsim
