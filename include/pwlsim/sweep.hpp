#pragma once
/// Many runs of one circuit: work that does not depend on the changed values is done once.

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
  /// The deck is read once. Throws Error as Circuit::run does; run throws E-unknown-element and E-no-value.
  Sweep(const Circuit& circuit, std::vector<std::string> names, const Options& options = {});
  /// The runs of the deck's `.step`.
  explicit Sweep(const Circuit& circuit, const Options& options = {});

  /// Names of the changed values; for a deck, those of `.step`.
  [[nodiscard]] const std::vector<std::string>& names() const;
  /// Names of the circuit's measurements, in the order of SweptRun::measurements.
  [[nodiscard]] std::vector<std::string> measurements() const;
  /// Number of runs of `.step`; 0 for values given in code.
  [[nodiscard]] std::size_t runs() const;
  /// The values of one of these runs, in the order of the names.
  [[nodiscard]] std::vector<double> point(std::size_t run) const;

  /// One run. `number` selects the run of `.step`, which needs no values, and the deck's random numbers. The same values and number give the same result to the
  /// last bit, for any order of the runs and any number of threads. Throws as Circuit::run does.
  [[nodiscard]] Result run(const std::vector<double>& values, std::size_t number = 0, const std::atomic<int>* interrupt = nullptr) const;

  struct Data;

 private:
  std::shared_ptr<const Data> data_;
};

/// The result of one run of a sweep.
struct SweptRun {
  bool done = false;
  std::vector<double> measurements;  ///< in the order of Sweep::measurements; NaN if one failed
  std::string id, message;           ///< of the error if it is not done
};

/// Runs points[0], points[1], … on `jobs` threads (0: one per core); each point is a vector of values. For a sweep of `.step` the points are empty
/// vectors. The thread that did a run calls `take` after it, one call at a time, with the number and the result of the run. `take` is not called for runs that
/// `interrupt` prevented.
void run_all(const Sweep& sweep, const std::vector<std::vector<double>>& points, std::size_t jobs,
             const std::function<void(std::size_t number, const SweptRun& run)>& take, const std::atomic<int>* interrupt = nullptr);

}  // namespace pwlsim
