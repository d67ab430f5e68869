#pragma once
/// Runs of Krylov segments from one state to another, of which the last can be differentiated: what the search for a periodic orbit asks of them.

#include <atomic>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "engine/sparse/segment_deviation.hpp"
#include "engine/sparse/sparse.hpp"
#include "engine/sparse/sparse_model.hpp"
#include "linalg/dense.hpp"

namespace pwlsim::engine::sparse {

class PeriodMap {
 public:
  /// Just before t = 0, one a part.
  using State = std::vector<PartStart>;

  explicit PeriodMap(std::shared_ptr<const SparseModel> model, const std::atomic<int>* interrupt = nullptr);

  /// The start of a run, from initial values or from the operating point.
  [[nodiscard]] Starts start(bool uic) const { return starts_of(*model_, uic); }
  /// From `state` for `length` s with sources as from t = 0 on, without what happens at the end; `state` is the start and then the end. `records`: its segments, for `keep`.
  /// `is_trial`: it may fail, and does where it costs far more than the run kept, as from states that no motion leads to.
  Answer advance(State& state, double length, bool records, bool is_trial = false);
  /// From now on `derivative`, and what else is said of the run kept, is of the last run that was recorded.
  void keep() {
    records_ = std::move(last_);
    openings_ = last_openings_;
    worst_ = 0.0;
  }
  /// An ordinary run with rows from such a state.
  [[nodiscard]] Answer run(const State& from, const Request& request, RowSink& sink) const;

  /// Unknowns of a state that a run has left, part by part: points and deviations of them.
  [[nodiscard]] linalg::Vector unknowns(const State& state) const;
  void move_to(State& state, const linalg::Vector& unknowns) const;
  /// The same, but stores that are empty in `state` stay so where they would get no more than rounding: it would decide the signs of the diodes beside them.
  void step_to(State& state, const linalg::Vector& unknowns) const;
  /// Their stores, in √J.
  [[nodiscard]] linalg::Vector energies(const linalg::Vector& unknowns) const;
  /// What a deviation of the start makes of the end of the run kept. False: `failure`.
  [[nodiscard]] bool derivative(linalg::Vector& deviation);
  /// Takes what is fast out of a deviation of the start.
  [[nodiscard]] bool smooth(linalg::Vector& deviation);
  [[nodiscard]] const std::string& failure() const { return failure_; }
  /// The largest estimated error of `derivative` along the run kept in a segment, of the largest deviation so far.
  [[nodiscard]] double worst_error() const { return worst_; }
  /// Guards of the run kept, and of the last deviations.
  [[nodiscard]] const std::vector<SegmentDeviation::Beside>& beside() const { return beside_; }

  /// Whether all switches are where they were.
  [[nodiscard]] bool keeps_switches(const State& from, const State& to) const;
  /// Of the run kept, in order and part by part.
  [[nodiscard]] std::vector<Position> positions() const { return positions(records_); }
  /// The same of the last run that was recorded.
  [[nodiscard]] std::vector<Position> positions_of_last() const { return positions(last_); }
  /// √J, the largest of the run kept.
  [[nodiscard]] double largest() const;
  [[nodiscard]] std::size_t segments() const;

  /// A store: "v(C1)" in V, "i(L1)" in A.
  struct Store {
    std::string name, unit, element, unit_of_content;  ///< content: charge in C, flux in Vs
    double storage = 0.0;
  };
  /// As `energies` has them.
  [[nodiscard]] const std::vector<Store>& stores() const { return stores_; }
  /// The largest of each, in V and A, where segments of the run kept begin.
  [[nodiscard]] linalg::Vector largest_values() const;
  /// V and A of √J.
  [[nodiscard]] linalg::Vector values(const linalg::Vector& energies) const;
  /// The segments of the run kept, part by part, and its unknowns just after t = 0.
  [[nodiscard]] const std::vector<std::vector<SegmentRecord>>& records() const { return records_; }
  [[nodiscard]] linalg::Vector after_start() const;
  [[nodiscard]] const SparseModel& model() const { return *model_; }

 private:
  template <class Follow>
  [[nodiscard]] bool each_part(linalg::Vector& deviation, const Follow& follow);
  [[nodiscard]] static std::vector<Position> positions(const std::vector<std::vector<SegmentRecord>>& run);
  std::shared_ptr<const SparseModel> model_;
  const std::atomic<int>* interrupt_;
  std::vector<std::vector<SegmentRecord>> records_, last_;
  std::vector<std::unique_ptr<SegmentDeviation>> deviations_;
  std::vector<Store> stores_;
  std::vector<SegmentDeviation::Beside> beside_;
  std::string failure_;
  double worst_ = 0.0;
  std::uint64_t openings_ = 0, last_openings_ = 0;  ///< of the run kept, and of the last that was recorded
  Eigen::Index size_ = 0;
};

}  // namespace pwlsim::engine::sparse
