#pragma once
/// Accumulations of events: infinitely many in finite time (a Zeno sequence), as of a relay that reverses a motion ever faster.
///
/// Near the limit the motion repeats on a shrinking scale: every p events the same modes, the times between them smaller by a
/// ratio r. Then t* = t_n + (t_n − t_{n−p})·r/(1 − r), and each state converges alike (Aitken's Δ² process; van der Schaft &
/// Schumacher 1996 leave such sequences out). The run continues from the limit.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/run.hpp"
#include "linalg/dense.hpp"

namespace pwlsim::engine {

class AccumulationWatch {
 public:
  struct Limit {
    double time = 0.0;         ///< t*, s
    double ratio = 0.0;        ///< r, of the times between events p apart
    int period = 0;            ///< p
    double uncertainty = 0.0;  ///< change of t* by the last p events, s
    double span = 0.0;         ///< from the first event of the sequence to t*, s
    double last = 0.0;         ///< time that the last p events took, s
    double doubt = 0.0;        ///< rounding of their times, s
    linalg::Vector xi;         ///< states there

    /// Whether the run may go on from it after an event at `time`: it is near, and known well enough.
    [[nodiscard]] bool is_near(double time) const;
  };

  /// An event of the island's own at `time`, with a number of the mode and the n states ξ after it. `doubt`: rounding of its time, where that may be more than that of the run's length.
  void note(double time, std::uintptr_t mode, const double* x, int n, double doubt = 0.0);
  /// An event from outside: earlier events no longer count.
  void reset() {
    count_ = 0;
    shrinking_ = false;
  }
  /// The limit of the last events, if they accumulate.
  [[nodiscard]] std::optional<Limit> limit();
  [[nodiscard]] std::uint64_t events() const { return count_; }
  /// N-accumulation, in a part with these elements; `least`: no time is known better, s.
  [[nodiscard]] Remark remark(const Limit& limit, const std::vector<std::string>& names, double least) const;

 private:
  struct Event {
    double time = 0.0, doubt = 0.0;
    std::uintptr_t mode = 0;
    linalg::Vector xi;
  };
  static constexpr std::uint64_t kept = 32;
  [[nodiscard]] const Event& back(int i) const { return events_[(count_ - 1 - static_cast<std::uint64_t>(i)) % kept]; }
  [[nodiscard]] bool repeats(int period) const;
  [[nodiscard]] double ratio(int period, int i) const;
  [[nodiscard]] double limit_time(int period, int i) const;

  std::vector<Event> events_;  ///< the last `kept`, in turn
  std::uint64_t count_ = 0;
  bool shrinking_ = false;  ///< since `begin_`
  double begin_ = 0.0;
};

}  // namespace pwlsim::engine
