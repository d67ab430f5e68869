#pragma once
/// The derivative of a measured value as sums of what it reads of the run's derivatives, and its value along a parameter, to both sides of a kink.

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "analysis/measured_pass.hpp"
#include "steady/functional.hpp"
#include "steady/sensitivity.hpp"

namespace pwlsim::analysis {

/// A derivative that is another one on the other side of a kink.
struct TwoSided {
  double left = 0.0, right = 0.0;
  std::string kink;      ///< why they differ
  std::string failure;   ///< why there is none
  bool is_kink = false;  ///< there is one on each side, which is not known
  double noise = 0.0;    ///< left and right that differ by less, for a change by all of the parameter, are one: `measured`
  double measured = 0.0;
  [[nodiscard]] static TwoSided of(double value) { return {value, value, "", "", false, 0.0, value}; }
  [[nodiscard]] static TwoSided failed(std::string why) { return {0.0, 0.0, "", std::move(why), false, 0.0, 0.0}; }
};

/// A sum of what is read of the run's derivative, of the derivatives of numbers that cards hold, and of the run's begin and end.
struct MeasuredSum {
  steady::Functional run;
  double start_moves = 0.0, stop_moves = 0.0;
  std::vector<double> numbers;  ///< of each `.param` that is varied

  void add(double weight, const MeasuredSum& other);
  [[nodiscard]] bool is_empty() const;
};
/// The time by which that instant moves.
[[nodiscard]] MeasuredSum shift_of(std::size_t instant);

/// The derivative of one measurement.
struct MeasuredFunctional {
  MeasuredSum sum;
  /// weight·q counts where q·sign is positive on the side of smaller (−) or larger values of the parameter.
  struct Kink {
    MeasuredSum q;
    double weight = 0.0;
    int sign = 1;
    std::string why;
  };
  std::vector<Kink> kinks;
  /// There is no derivative to a parameter that moves `moves` and `against` differently.
  struct Obstacle {
    MeasuredSum moves, against;
    std::string why;
  };
  std::vector<Obstacle> obstacles;
  /// weight·(the largest, or the least, of values that are equal here).
  struct Tie {
    std::vector<MeasuredFunctional> places;
    double weight = 1.0;
    bool is_largest = true;
    double size = 0.0;  ///< of the values
    std::string why;
  };
  std::vector<Tie> ties;
  std::string failure;  ///< why there is none to any parameter; "" where there is

  void add(double weight, const MeasuredFunctional& other);
  /// Number of sums that are to be read.
  [[nodiscard]] std::size_t sums() const;
};

/// How one parameter moves what does not belong to the run.
struct DirectMoves {
  int number = -1;                             ///< of a `.param`; −1: it is none
  double start_moves = 0.0, stop_moves = 0.0;  ///< of the run's begin and end, s
};

/// Reads sums along one parameter that has been followed forward.
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

/// The derivative by what `read` makes of each of its sums.
[[nodiscard]] TwoSided two_sided(const MeasuredFunctional& functional, const std::function<double(const MeasuredSum&)>& read);
/// What does not belong to the run.
[[nodiscard]] double read_direct(const MeasuredSum& sum, const DirectMoves& direct);

}  // namespace pwlsim::analysis
