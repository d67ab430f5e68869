#include "analysis/derivative_columns.hpp"

#include <algorithm>
#include <map>
#include <memory>
#include <optional>

namespace pwlsim::analysis {
namespace {

using Method = circuit::Sensitivities::Method;

class Columns {
 public:
  Columns(const circuit::Sensitivities& card, const MeasuredPass& run, const steady::Sensitivity& sensitivity, RunMotion& motion)
      : card_(card), run_(run), sensitivity_(sensitivity), motion_(motion), functionals_(run, sensitivity) {}

  std::vector<std::vector<TwoSided>> take() {
    const std::size_t parameters = card_.parameters.size(), count = run_.measurements->list.size();
    std::vector<std::size_t> wanted;
    for (std::size_t k = 0; k < count; ++k)
      if (run_.measurements->list[k].shown && card_.wants(run_.measurements->list[k].name)) wanted.push_back(k);
    std::vector<std::vector<TwoSided>> columns(parameters, std::vector<TwoSided>(count));
    const bool is_backward = goes_backward(wanted);
    if (is_backward) adjoint_.emplace(sensitivity_, run_.measurements->probe_signals);
    for (const std::size_t k : is_backward ? wanted : std::vector<std::size_t>()) take_backward(k, columns);
    for (std::size_t p = 0; p < parameters; ++p) {
      const std::string failure = failure_of(p);
      if (!failure.empty())
        for (TwoSided& each : columns[p]) each = TwoSided::failed(failure);
      else if (!is_backward || adjoint_->is_forward_only(p))
        take_forward(p, wanted, columns[p]);
    }
    return columns;
  }

 private:
  /// As many runs backwards as there are sums, against one forward a parameter.
  bool goes_backward(const std::vector<std::size_t>& wanted) {
    if (card_.method != Method::automatic) return card_.method == Method::adjoint;
    std::size_t sums = 0;
    for (const std::size_t k : wanted) {
      const MeasuredFunctional& functional = functionals_.of(k);
      if (functional.failure.empty()) sums += 1 + functional.kinks.size() + functional.obstacles.size();
    }
    return card_.parameters.size() > sums;
  }

  std::string failure_of(std::size_t parameter) {
    std::string failure = motion_.failure(parameter);
    return failure.empty() && adjoint_ ? adjoint_->failure(parameter) : failure;
  }

  void take_forward(std::size_t parameter, const std::vector<std::size_t>& wanted, std::vector<TwoSided>& column) {
    const RunMotion::Forward forward = motion_.forward(parameter);
    const std::string& failure = forward.failure.empty() ? forward.followed.failure : forward.failure;
    ForwardReader reader(run_, sensitivity_, forward.followed, parameter, forward.direct);
    for (const std::size_t k : wanted)
      column[k] = failure.empty() ? two_sided(functionals_.of(k), [&](const MeasuredSum& sum) { return reader.read(sum); })
                                  : TwoSided::failed(failure);
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

  const circuit::Sensitivities& card_;
  const MeasuredPass& run_;
  const steady::Sensitivity& sensitivity_;
  RunMotion& motion_;
  MeasuredFunctionals functionals_;
  std::optional<steady::Adjoint> adjoint_;
};

}  // namespace

std::vector<std::vector<TwoSided>> derivative_columns(const circuit::Sensitivities& card, const MeasuredPass& run,
                                                      const steady::Sensitivity& sensitivity, RunMotion& motion) {
  return Columns(card, run, sensitivity, motion).take();
}

}  // namespace pwlsim::analysis
