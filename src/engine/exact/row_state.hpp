#pragma once
/// The state of an island from row to row of a segment: propagators of the rows' distance are kept, one a mode.

#include <unordered_map>
#include <vector>

#include "engine/exact/locator.hpp"
#include "model/exosystem.hpp"
#include "model/mode.hpp"

namespace pwlsim::engine {

class RowState {
 public:
  explicit RowState(const model::System& system) : system_(system), y_(static_cast<std::size_t>(system.size())), work_(2 * y_.size()) {}

  /// The usual distance of two rows, s.
  void set_step(double step) { step_ = step; }
  /// Another segment follows.
  void forget() { is_valid_ = false; }
  /// The mode's state at absolute `time`, not before that of the row before; `phase`: of the sources.
  const double* at(const Segment& segment, const model::Exosystem::Phase& phase, double time);

 private:
  void begin(const Segment& segment);
  void advance(const model::Matrix& m, double factor);
  void advance_by_step(const model::Mode& mode, double time);

  const model::System& system_;
  std::vector<double> y_, work_;
  double time_ = 0.0, late_ = 0.0;  ///< of y_
  bool is_valid_ = false;
  std::uint64_t rows_ = 0;
  double step_ = 0.0;
  struct Propagator {
    std::uint64_t uses = 0;
    model::Matrix matrix;
  };
  std::unordered_map<const model::Mode*, Propagator> propagators_;
  Propagator* propagator_ = nullptr;  ///< of the present segment
};

}  // namespace pwlsim::engine
