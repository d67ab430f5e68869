#pragma once
/// The first root of guards that are sums of exponentials and a straight line (model/modal_form.hpp), or the proof that there is none.
///
/// Over [l, r] each term is enclosed between straight lines: by its chord, its tangents and the sign of its second derivative where the rate is real, by
/// ±|second derivative|(r − l)²/8 about the chord if it is slow, by its own decaying magnitude if it is fast. A term that decays very fast adds only this, so
/// that the interval need not be of its length. An undecided interval is halved. The searched time may be the remainder of a long run: the search begins with a length that contains the
/// last root found in the mode, and continues with doubled lengths.

#include <algorithm>
#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "model/modal_form.hpp"

namespace pwlsim::engine {

class ModalSearch {
 public:
  struct Guard {
    int row = 0;
    double value = 0.0;        ///< at the start
    double noise = 0.0;        ///< its rounding error
    bool leaves_zero = false;  ///< zero at the start, and rising
  };
  enum class Verdict { positive, root, undecided };
  struct Found {
    Verdict verdict = Verdict::undecided;
    std::size_t guard = 0;  ///< number of the one with the first root
    double lower = 0.0,
           upper = 0.0;  ///< the root is its only one between these, s from the start; undecided: all are positive up to `lower`
    double at = 0.0;     ///< the root
  };

  /// Over (0, h], from y; undecided, too, when it takes very many intervals. No allocation once its buffers have grown.
  Found search(const model::ModalForm& form, std::span<const Guard> guards, const double* y, double h);

  [[nodiscard]] std::uint64_t intervals() const { return intervals_; }

 private:
  using Complex = std::complex<double>;
  /// Of one rate at one time: e^{λτ}, (e^{λτ} − 1)/λ and (that − τ)/λ.
  struct Exponents {
    Complex e0, e1, e2;
    double size = 0.0;     ///< |e^{λτ}|
    double growth = 1.0;   ///< the same, at least 1
    double lasting = 0.0;  ///< that the error of a velocity adds up, unless it grows: up to τ
    double moving = 0.0;   ///< that the error of a phase does
  };
  struct Coefficients {
    Complex velocity, push, bend;  ///< p z', p f' and p (λ z' + f')
    double bend_size = 0.0;
    double noise = 0.0;  ///< of the velocity
  };
  struct Line {
    double at_left = 0.0, at_right = 0.0;
    [[nodiscard]] double least() const { return std::min(at_left, at_right); }
    [[nodiscard]] double most() const { return std::max(at_left, at_right); }
  };
  struct Noise {
    double value = 0.0, slope = 0.0;
  };
  struct Interval {
    double left = 0.0, right = 0.0;
    const Exponents* at_left = nullptr;
    const Exponents* at_right = nullptr;
  };

  struct Bend {
    double second = 0.0, third = 0.0;  ///< derivatives
  };

  [[nodiscard]] double turn() const;
  void make_room(std::size_t guards);
  void begin(std::span<const Guard> guards, const double* y);
  static void evaluate(const model::ModalRate& rate, double tau, Exponents& out);
  void evaluate(double tau, Exponents* out) const;
  [[nodiscard]] double value(std::size_t guard, double tau, const Exponents* at) const;
  [[nodiscard]] double slope(std::size_t guard, const Exponents* at) const;
  [[nodiscard]] Bend bend(std::size_t guard, const Exponents* at) const;
  [[nodiscard]] double least_value(std::size_t guard, const Interval& interval, Line line) const;
  void bound_slope(std::size_t guard, const Interval& interval, Line& least, Line& most) const;
  [[nodiscard]] Noise noise_of(std::size_t guard, const Interval& interval) const;
  Verdict judge(std::size_t guard, const Interval& interval);
  Found examine(const Interval& interval, std::uint64_t open, int depth);
  Found first_root(const Interval& interval, std::uint64_t falling);
  double root(std::size_t guard, const Interval& interval);

  const model::ModalForm* form_ = nullptr;
  std::span<const Guard> guards_;
  std::size_t count_ = 0;                   ///< of rates
  std::vector<double> z_, push_, size_;     ///< z', f', and magnitudes of the terms of z'
  std::vector<double> error_;               ///< of z', where it is more than rounding
  std::vector<Coefficients> coefficients_;  ///< guards × rates
  std::vector<double> drift_;               ///< of guards
  std::vector<Exponents> points_;           ///< at the ends of the interval that is halved, and where intervals of each depth were halved
  std::vector<Exponents> trial_;
  double positive_until_ = 0.0;
  bool is_stuck_ = false;  ///< at a guard that is rounding at an interval's start: shorter intervals decide no more
  std::uint64_t intervals_ = 0, last_interval_ = 0;  ///< all so far, and the number at which this search gives up
};

}  // namespace pwlsim::engine
