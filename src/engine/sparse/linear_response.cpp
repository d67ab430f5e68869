#include "engine/sparse/linear_response.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "engine/sparse/sparse_model.hpp"
#include "engine/sparse/tolerances.hpp"
#include "linalg/klu.hpp"

namespace pwlsim::engine::sparse {

namespace {

using Complex = std::complex<double>;
using Values = std::vector<double>;
using linalg::SparseMatrix;

/// G + sE as a real matrix for the real parts of its unknowns, then the imaginary ones:  [G + σE, −ωE; ωE, G + σE],  s = σ + jω.
class RealForm {
 public:
  RealForm(const SparseMatrix& conduction, const SparseMatrix& memory) : conduction_(conduction), memory_(memory) {
    const int n = conduction.pattern.size;
    linalg::PatternBuilder builder(2 * n);
    for (const int half : {0, n}) add(builder, conduction.pattern, half, half);
    for (const int half : {0, n}) add(builder, memory.pattern, half, half);
    for (const int half : {0, n}) add(builder, memory.pattern, n - half, half);
    pattern_ = builder.take(entry_);
  }
  [[nodiscard]] const linalg::SparsePattern& pattern() const { return pattern_; }
  [[nodiscard]] Values values(Complex s) const {
    Values values(pattern_.entries(), 0.0);
    auto entry = entry_.begin();
    const auto put = [&](const Values& of, double factor) {
      for (const double value : of) values[linalg::index(*entry++)] += factor * value;
    };
    for (int half = 0; half < 2; ++half) put(conduction_.values, 1.0);
    for (int half = 0; half < 2; ++half) put(memory_.values, s.real());
    for (const double sign : {1.0, -1.0}) put(memory_.values, sign * s.imag());
    return values;
  }

 private:
  static void add(linalg::PatternBuilder& builder, const linalg::SparsePattern& of, int row, int column) {
    for (int j = 0; j < of.size; ++j)
      for (int e = of.start[linalg::index(j)]; e < of.start[linalg::index(j + 1)]; ++e)
        builder.add(row + of.row[linalg::index(e)], column + j);
  }

  const SparseMatrix &conduction_, &memory_;
  linalg::SparsePattern pattern_;
  std::vector<int> entry_;
};

/// x += M⁻¹ (b − A x), the difference in extended precision.
void correct(const linalg::KluFactor& inverse, const linalg::SparsePattern& pattern, const Values& a, const Values& b, Values& x) {
  std::vector<long double> sums;
  Values change;
  linalg::wide_residual(pattern, a, x, b, sums, change);
  inverse.solve(change.data());
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += change[i];
}

}  // namespace

class LinearResponse::OfPart {
 public:
  OfPart(const Part& part, const std::vector<std::string>& inputs)
      : part_(part),
        form_(part.descriptor.conduction(), part.descriptor.memory()),
        ordering_(std::make_unique<linalg::KluOrdering>(form_.pattern())),
        factor_(*ordering_),
        n_(static_cast<std::size_t>(part.descriptor.size())) {
    ordering_->pivot_on_largest();
    const model::Network& network = part.island.network;
    for (const model::Source& source : network.sources) {
      const auto found = std::find(inputs.begin(), inputs.end(), source.label.name);
      input_.push_back(found == inputs.end() ? none : static_cast<std::size_t>(found - inputs.begin()));
    }
    for (const model::Signal& signal : network.signals) signals_.push_back(part.descriptor.form(signal.form));
  }

  void add(double frequency, const std::vector<Complex>& amplitudes, std::vector<Complex>& response) {
    std::vector<Complex> w;
    for (const std::size_t input : input_) w.push_back(input == none ? Complex() : amplitudes[input]);
    const Solution z = solution(2.0 * std::numbers::pi * frequency, drive(w));
    constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    for (std::size_t k = 0; k < signals_.size(); ++k) {
      Complex sum = z.known[k] != 0 ? value(signals_[k], z.unknowns) : Complex(unknown, unknown);
      for (const Form::IndexedTerm& term : signals_[k].w) sum += term.coefficient * w[linalg::index(term.index)];
      response[linalg::index(part_.island.signal_number[k])] += sum;
    }
  }

 private:
  static constexpr auto none = static_cast<std::size_t>(-1);
  struct Solution {
    Values unknowns;
    std::vector<char> known;  ///< of each signal
  };

  [[nodiscard]] Complex value(const Form& form, const Values& z) const {
    return {Form::sum(form.z, z.data()), Form::sum(form.z, z.data() + n_)};
  }
  [[nodiscard]] double size(const Form& form, const Values& z) const {
    return Form::size_of(form.z, z.data()) + Form::size_of(form.z, z.data() + n_);
  }

  /// −H w
  [[nodiscard]] Values drive(const std::vector<Complex>& w) const {
    Values real, imaginary, b(2 * n_, 0.0);
    for (const Complex& each : w) {
      real.push_back(each.real());
      imaginary.push_back(each.imag());
    }
    part_.descriptor.add_sources(real.data(), b.data());
    part_.descriptor.add_sources(imaginary.data(), b.data() + n_);
    return b;
  }

  Solution solution(double omega, const Values& b) {
    Solution result{Values(b.size(), 0.0), std::vector<char>(signals_.size(), 1)};
    if (n_ == 0) return result;
    const Values a = form_.values({0.0, omega});
    const bool is_regular = factors(a);
    if (omega == 0.0 && !(is_regular && discharges())) {
      come_to_rest(a, b, result);
    } else if (is_regular) {
      constexpr int passes = 3;
      for (int k = 0; k < passes; ++k) correct(factor_, form_.pattern(), a, b, result.unknowns);
    } else {
      result.known.assign(signals_.size(), 0);
    }
    return result;
  }

  bool factors(const Values& values) { return ordering_->structurally_regular() && factor_.refactor(values) == linalg::Factored::good; }

  /// Of E: s.
  [[nodiscard]] double largest_time() const {
    double largest = 0.0;
    for (const double each : part_.descriptor.memory().values) largest = std::max(largest, std::abs(each));
    return largest;
  }
  /// Unknowns at random, the same at each call.
  [[nodiscard]] Values any() const {
    Values z(2 * n_);
    for (std::size_t i = 0; i < z.size(); ++i) z[i] = std::cos(static_cast<double>(i));
    return z;
  }

  /// Whether G, which is factored, takes all charges and fluxes away: a pivot that is rounding of zero would let them stay for ever.
  [[nodiscard]] bool discharges() const {
    const Values start = any();
    Values stays(2 * n_);
    for (const std::size_t half : {std::size_t{0}, n_}) part_.descriptor.memory(start.data() + half, stays.data() + half);
    factor_.solve(stays.data());
    return std::all_of(stays.begin(), stays.end(),
                       [limit = tolerance::longest_discharge * largest_time()](double each) { return std::abs(each) <= limit; });
  }

  /// G is singular: something takes no charge or flux away. Steps of implicit Euler far longer than all time constants come to rest in all but its null directions, and leave
  /// what lies in these as it is: a signal that they move, of a start at random, has no value.
  void come_to_rest(const Values& g, const Values& b, Solution& result) {
    const double largest = largest_time();
    result.known.assign(signals_.size(), 0);
    if (largest == 0.0 || !factors(form_.values({tolerance::rate_of_rest / largest, 0.0}))) return;
    const Values start = any(), nothing(b.size(), 0.0);
    Values free = start;
    constexpr int steps = 12;
    for (int k = 0; k < steps; ++k) {
      correct(factor_, form_.pattern(), g, nothing, free);
      correct(factor_, form_.pattern(), g, b, result.unknowns);
    }
    for (std::size_t k = 0; k < signals_.size(); ++k)
      result.known[k] = std::abs(value(signals_[k], free)) <= tolerance::moved_by_charge * size(signals_[k], start) ? 1 : 0;
  }

  const Part& part_;
  RealForm form_;
  std::unique_ptr<linalg::KluOrdering> ordering_;
  linalg::KluFactor factor_;
  std::size_t n_;
  std::vector<std::size_t> input_;  ///< of each source of the part
  std::vector<Form> signals_;
};

LinearResponse::LinearResponse(const SparseModel& model, const std::vector<std::string>& inputs) : signals_(model.signals) {
  for (const auto& part : model.parts) parts_.emplace_back(*part, inputs);
}

LinearResponse::~LinearResponse() = default;

std::string LinearResponse::switching(const SparseModel& model) {
  for (const auto& part : model.parts)
    if (!part->descriptor.ports().empty()) return part->descriptor.ports().front().name;
  return {};
}

std::vector<Complex> LinearResponse::at(double frequency, const std::vector<Complex>& amplitudes) {
  std::vector<Complex> response(signals_);
  for (OfPart& part : parts_) part.add(frequency, amplitudes, response);
  return response;
}

}  // namespace pwlsim::engine::sparse
