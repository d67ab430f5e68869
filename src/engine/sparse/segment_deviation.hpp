#pragma once
/// How a deviation of the start of a part moves along a recorded run of Krylov segments: the derivative of the run's end, with sources as they are.
///
/// In a segment a deviation follows the segment's equations without sources and constants; its Krylov space is one of its own, of the same factors. Charges and fluxes e = E z
/// go through an instant as
///
///     e⁺ = E δz⁻ + δt (E z'⁻ − E z'⁺),   δt = −n δz⁻/(n z'⁻)      (n the guard that fell to zero; δt = 0 where the time is fixed),
///
/// and each position that the run takes there projects them as it did the run's own: with the first solution of its space.

#include <optional>
#include <string>
#include <vector>

#include "engine/sparse/factors.hpp"
#include "engine/sparse/krylov_space.hpp"
#include "engine/sparse/part.hpp"
#include "engine/sparse/segment_record.hpp"
#include "engine/sparse/sources.hpp"

namespace pwlsim::engine::sparse {

class SegmentDeviation {
 public:
  explicit SegmentDeviation(const Part& part);

  /// The deviation at the end, in place of that at the start. False: it cannot be followed (`failure`).
  [[nodiscard]] bool follow(const std::vector<SegmentRecord>& records, std::vector<double>& z);
  /// Takes what is fast out of a deviation: the ends of implicit Euler steps in the position that the run begins in.
  [[nodiscard]] bool smooth(const std::vector<SegmentRecord>& records, std::vector<double>& z);
  [[nodiscard]] const std::string& failure() const { return failure_; }
  /// The largest estimated error of a segment, of the largest deviation so far.
  [[nodiscard]] double worst_error() const { return worst_; }

  /// A guard that is at zero together with another, but not in nearby runs.
  struct Beside {
    double time = 0.0;
    std::string port;
  };
  [[nodiscard]] const std::vector<Beside>& beside() const { return beside_; }

 private:
  [[nodiscard]] bool open(const SegmentRecord& record, const Position& on, double shift, double length);
  [[nodiscard]] bool open_rest(const SegmentRecord& record, double done, double& reached);
  [[nodiscard]] bool resolve(double length, double& reached);
  [[nodiscard]] double largest_error(double length);
  [[nodiscard]] bool propagate(const SegmentRecord& record);
  [[nodiscard]] bool project(const SegmentRecord& record, const Position& on);
  [[nodiscard]] bool pass(const SegmentRecord& before, const SegmentRecord& after);
  [[nodiscard]] bool is_gone() const;
  void note_beside(const SegmentRecord& before, const SegmentRecord& after, double shift);

  const Part& part_;
  Factors factors_;
  Sources sources_;
  KrylovSpace space_;
  std::vector<double> zeta_, z_, more_, y_, work_;
  double worst_ = 0.0;
  double scale_ = 0.0;        ///< √energy, the largest of the deviation so far
  bool has_decayed_ = false;  ///< to nothing
  std::string failure_;
  std::vector<Beside> beside_;
};

}  // namespace pwlsim::engine::sparse
