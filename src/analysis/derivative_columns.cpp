#include "analysis/derivative_columns.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "analysis/derivative_table.hpp"

namespace pwlsim::analysis {
namespace {

using Method = circuit::SensitivityAnalysis::Method;

/// Of what is read of the start: less of a free direction is none.
constexpr double no_reading = 1e-9;

class Columns {
 public:
  Columns(const circuit::SensitivityAnalysis& card, const MeasuredPass& run, const steady::Sensitivity& sensitivity, RunMotion& motion,
          const std::atomic<int>& interrupt)
      : card_(card), run_(run), sensitivity_(sensitivity), motion_(motion), interrupt_(interrupt), functionals_(run, sensitivity) {}

  std::vector<std::vector<TwoSided>> take() {
    const std::size_t parameters = card_.parameters.size(), count = run_.measurements->list.size();
    std::vector<std::size_t> wanted;
    for (std::size_t k = 0; k < count; ++k)
      if (run_.measurements->list[k].shown && card_.wants(run_.measurements->list[k].name)) wanted.push_back(k);
    std::vector<std::vector<TwoSided>> columns(parameters, std::vector<TwoSided>(count));
    const bool is_backward = goes_backward(wanted);
    free_ = motion_.free_directions();
    if (is_backward || !free_.empty()) adjoint_.emplace(sensitivity_, run_.measurements->probe_signals);
    for (const std::size_t k : is_backward ? wanted : std::vector<std::size_t>()) {
      if (!is_interrupted())
        take_backward(k, columns);
      else
        for (auto& column : columns) column[k] = TwoSided::failed(interrupted_derivative);
    }
    for (std::size_t p = 0; p < parameters; ++p) {
      const TwoSided failed = !is_backward && is_interrupted() ? TwoSided::failed(interrupted_derivative) : failure_of(p);
      if (!failed.failure.empty())
        columns[p].assign(count, failed);
      else if (!is_backward || adjoint_->is_forward_only(p))
        take_forward(p, wanted, columns[p]);
    }
    for (const std::size_t k : wanted)
      if (!free_.empty() && reads_free(functionals_.of(k)))
        for (auto& column : columns)
          if (column[k].failure.empty()) column[k] = TwoSided::failed("it depends on an offset that the orbit leaves open (multiplier 1)");
    return columns;
  }

 private:
  [[nodiscard]] bool is_interrupted() const { return interrupt_.load(std::memory_order_relaxed) != 0; }

  /// What a functional reads of a free direction, and of how much it is the sum; infinite where that depends on what is taken.
  std::pair<double, double> read_along(const MeasuredFunctional& functional, const steady::Vector& free) const {
    const auto reads = [&](const MeasuredSum& sum) {
      const steady::Vector start = adjoint_->to_start(sum.run, {});
      return std::pair(start.dot(free), start.norm() * free.norm());
    };
    std::pair<double, double> result = reads(functional.sum);
    double &value = result.first, &size = result.second;
    const auto must_be_nothing = [&](const MeasuredSum& sum) {
      const auto [read, of] = reads(sum);
      if (std::abs(read) > no_reading * of) value = std::numeric_limits<double>::infinity();
    };
    for (const auto& kink : functional.kinks) must_be_nothing(kink.q);
    for (const auto& obstacle : functional.obstacles) {
      must_be_nothing(obstacle.moves);
      must_be_nothing(obstacle.against);
    }
    for (const auto& tie : functional.ties) {
      const auto [first, of] = read_along(tie.places.front(), free);
      for (const MeasuredFunctional& place : tie.places)
        if (std::abs(read_along(place, free).first - first) > no_reading * of) value = std::numeric_limits<double>::infinity();
      value += tie.weight * first;
      size += std::abs(tie.weight) * of;
    }
    return result;
  }

  bool reads_free(const MeasuredFunctional& functional) const {
    return std::any_of(free_.begin(), free_.end(), [&](const steady::Vector& free) {
      const auto [value, size] = read_along(functional, free);
      return !(std::abs(value) <= no_reading * size);
    });
  }

  /// As many runs backwards as there are sums, against one forward a parameter.
  bool goes_backward(const std::vector<std::size_t>& wanted) {
    if (card_.method != Method::automatic) return card_.method == Method::adjoint;
    std::size_t sums = 0;
    for (const std::size_t k : wanted) {
      const MeasuredFunctional& functional = functionals_.of(k);
      if (functional.failure.empty()) sums += functional.sums();
    }
    return card_.parameters.size() > sums;
  }

  TwoSided failure_of(std::size_t parameter) {
    TwoSided failed = TwoSided::failed(motion_.failure(parameter));
    if (failed.failure.empty() && adjoint_) failed = failed_at_kink(adjoint_->failure(parameter), adjoint_->is_kink(parameter));
    if (failed.failure.empty() && adjoint_ && sensitivity_.has_rests()) failed = failed_forward(motion_.forward_to_last_rest(parameter));
    return failed;
  }

  static TwoSided failed_at_kink(std::string why, bool is_kink) {
    TwoSided failed = TwoSided::failed(std::move(why));
    failed.is_kink = is_kink;
    return failed;
  }

  static TwoSided failed_forward(const RunMotion::Forward& forward) {
    return forward.failure.empty() ? failed_at_kink(forward.followed.failure, forward.followed.is_kink)
                                   : failed_at_kink(forward.failure, forward.is_kink);
  }

  void take_forward(std::size_t parameter, const std::vector<std::size_t>& wanted, std::vector<TwoSided>& column) {
    const RunMotion::Forward forward = motion_.forward(parameter);
    const TwoSided failed = failed_forward(forward);
    ForwardReader reader(run_, sensitivity_, forward.followed, parameter, forward.direct);
    for (const std::size_t k : wanted)
      column[k] = failed.failure.empty() ? two_sided(functionals_.of(k), [&](const MeasuredSum& sum) { return reader.read(sum); }) : failed;
  }

  void take_backward(std::size_t measurement, std::vector<std::vector<TwoSided>>& columns) {
    const MeasuredFunctional& functional = functionals_.of(measurement);
    std::map<const MeasuredSum*, std::vector<double>> known;
    const auto values = [&](const MeasuredSum& sum) -> const std::vector<double>& {
      std::vector<double>& list = known[&sum];
      if (list.empty()) list = motion_.backward(sum, *adjoint_);
      return list;
    };
    for (std::size_t p = 0; p < columns.size(); ++p)
      columns[p][measurement] = two_sided(functional, [&](const MeasuredSum& sum) { return values(sum)[p]; });
  }

  const circuit::SensitivityAnalysis& card_;
  const MeasuredPass& run_;
  const steady::Sensitivity& sensitivity_;
  RunMotion& motion_;
  const std::atomic<int>& interrupt_;
  MeasuredFunctionals functionals_;
  std::optional<steady::Adjoint> adjoint_;
  std::vector<steady::Vector> free_;
};

}  // namespace

std::vector<std::vector<TwoSided>> derivative_columns(const circuit::SensitivityAnalysis& card, const MeasuredPass& run,
                                                      const steady::Sensitivity& sensitivity, RunMotion& motion,
                                                      const std::atomic<int>& interrupt) {
  return Columns(card, run, sensitivity, motion, interrupt).take();
}

}  // namespace pwlsim::analysis
