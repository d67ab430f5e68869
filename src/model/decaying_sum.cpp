#include "model/decaying_sum.hpp"

#include <algorithm>
#include <cmath>

#include "model/mode.hpp"

namespace pwlsim::model {

namespace {

constexpr int most_halvings = 6;

/// A term of f, and of df/ds, at one end of a part of [0, 1].
struct End {
  double s = 0.0;
  std::vector<double> values, slopes;
};

struct Prover {
  const DecayingSum& sum;
  double level, slowest;

  [[nodiscard]] End end_at(double s) const {
    End end{s, {}, {}};
    for (const DecayingTerm& term : sum.terms) {
      const double r = slowest / term.time_constant;
      const double lower_power = r > 1.0 ? std::pow(s, r - 1.0) : 1.0;
      end.values.push_back(term.start * s * lower_power);
      end.slopes.push_back(term.start * r * lower_power);
    }
    return end;
  }

  /// By the drift.
  [[nodiscard]] double risen_at(const End& end) const {
    return sum.drift != 0.0 ? sum.drift * slowest * std::min(-std::log(end.s), time_constants_to_rest) : 0.0;
  }

  /// d/ds of that.
  [[nodiscard]] double slope_of_rise(const End& end) const {
    if (sum.drift == 0.0) return 0.0;
    return -sum.drift * slowest / end.s;  // infinite at s = 0
  }

  [[nodiscard]] double value(const End& end) const {
    double f = sum.rest + risen_at(end);
    for (const double term : end.values) f += term;
    return f;
  }

  [[nodiscard]] bool holds(const End& p, const End& q, int halvings) const {
    double least = sum.rest + std::min(risen_at(p), risen_at(q));
    auto [least_slope, most_slope] = std::minmax({slope_of_rise(p), slope_of_rise(q)});
    for (std::size_t k = 0; k < p.values.size(); ++k) {
      least += std::min(p.values[k], q.values[k]);
      least_slope += std::min(p.slopes[k], q.slopes[k]);
      most_slope += std::max(p.slopes[k], q.slopes[k]);
    }
    if (least >= level) return true;
    if (value(p) < level || value(q) < level) return false;
    if (least_slope >= 0.0 || most_slope <= 0.0) return true;
    if (halvings == 0) return false;
    const End middle = end_at(0.5 * (p.s + q.s));
    return holds(p, middle, halvings - 1) && holds(middle, q, halvings - 1);
  }
};

}  // namespace

double DecayingSum::slowest() const {
  double longest = 0.0;
  for (const DecayingTerm& term : terms) longest = std::max(longest, term.time_constant);
  return longest;
}

double DecayingSum::drifted() const { return drift * time_constants_to_rest * slowest(); }

bool DecayingSum::stays_above(double level) const {
  double least = rest;
  for (const DecayingTerm& term : terms) least += std::min(term.start, 0.0);
  if (least + std::min(drifted(), 0.0) >= level) return true;
  const Prover prover{*this, level, slowest()};
  return prover.holds(prover.end_at(0.0), prover.end_at(1.0), most_halvings);
}

bool DecayingSum::keeps_sign() const {
  double least = rest, most = rest;
  (drift < 0.0 ? least : most) += drifted();
  for (const DecayingTerm& term : terms) (term.start < 0.0 ? least : most) += term.start;
  return (least < 0.0) == (most < 0.0);
}

}  // namespace pwlsim::model
