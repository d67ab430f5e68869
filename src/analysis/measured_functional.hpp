#pragma once
/// The derivative of a measured value as weighted sums of the run's derivatives, and its value along a parameter, to both sides of a kink.

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "analysis/measured_pass.hpp"
#include "steady/functional.hpp"
#include "steady/sensitivity.hpp"

namespace pwlsim::analysis {

/// A derivative that may differ on both sides of a kink.
struct TwoSided {
  double left = 0.0, right = 0.0;
  std::string kink;      ///< why they differ
  std::string failure;   ///< why there is none
  bool is_kink = false;  ///< the derivatives on each side are not known
  double noise = 0.0;    ///< left and right are equal if they differ by less, for a change by the whole parameter
  double measured = 0.0;
  [[nodiscard]] static TwoSided of(double value) { return {value, value, "", "", false, 0.0, value}; }
  [[nodiscard]] static TwoSided failed(std::string why) { return {0.0, 0.0, "", std::move(why), false, 0.0, 0.0}; }
};

/// A weighted sum of the run's derivative, of the derivatives of numbers on cards, and of the shifts of the run's start and end.
struct MeasuredSum {
  steady::Functional run;
  double start_moves = 0.0, stop_moves = 0.0;
  std::vector<double> numbers;  ///< of each `.param` that is varied

  void add(double weight, const MeasuredSum& other);
  [[nodiscard]] bool is_empty() const;
};
/// Adds the shift of that instant.
[[nodiscard]] MeasuredSum shift_of(std::size_t instant);

/// The derivative of one measurement.
struct MeasuredFunctional {
  MeasuredSum sum;
  /// weight·q counts on the side of smaller (−) or larger values of the parameter where q·sign is positive.
  struct Kink {
    MeasuredSum q;
    double weight = 0.0;
    int sign = 1;
    std::string why;
  };
  std::vector<Kink> kinks;
  /// There is no derivative to a parameter that changes `moves` and `against` differently.
  struct Obstacle {
    MeasuredSum moves, against;
    std::string why;
  };
  std::vector<Obstacle> obstacles;
  /// weight·(the largest or the least of values that are equal here).
  struct Tie {
    std::vector<MeasuredFunctional> places;
    double weight = 1.0;
    bool is_largest = true;
    double size = 0.0;  ///< of the values
    std::string why;
  };
  std::vector<Tie> ties;
  std::string failure;  ///< why there is none to any parameter; "" if there is

  void add(double weight, const MeasuredFunctional& other);
  /// Number of sums.
  [[nodiscard]] std::size_t sums() const;
};

/// How one parameter changes quantities outside of the run.
struct DirectMoves {
  int number = -1;                             ///< of a `.param`; −1: it is not one
  double start_moves = 0.0, stop_moves = 0.0;  ///< of the run's start and end, s
};

/// Evaluates sums along one parameter that has been followed forward.
class ForwardReader {
 public:
  ForwardReader(const MeasuredPass& run, const steady::Sensitivity& sensitivity, const steady::Followed& followed, std::size_t parameter,
                DirectMoves direct)
      : run_(run), sensitivity_(sensitivity), followed_(followed), parameter_(parameter), direct_(direct) {}

  [[nodiscard]] double read(const MeasuredSum& sum);

 private:
  [[nodiscard]] double read(const steady::Functional& functional);

  const MeasuredPass& run_;
  const steady::Sensitivity& sensitivity_;
  const steady::Followed& followed_;
  std::size_t parameter_;
  DirectMoves direct_;
  std::map<std::size_t, std::vector<std::vector<double>>> points_;  ///< of a piece: derivatives of the probes at its points
};

/// The derivative, with `read` evaluating each of its sums.
[[nodiscard]] TwoSided two_sided(const MeasuredFunctional& functional, const std::function<double(const MeasuredSum&)>& read);
/// The part that does not belong to the run.
[[nodiscard]] double read_direct(const MeasuredSum& sum, const DirectMoves& direct);

}  // namespace pwlsim::analysis
