#pragma once
/// An orbit linearised with small inputs: the effect of segments and instants on a deviation of the state and on inputs w_k.
///
/// Inputs are sources of value zero in the model, so that every matrix of the model has a column for w and one for each of its derivatives: the effect of an input on a guard, a jump or an output
/// comes from these columns only.

#include <optional>
#include <string>
#include <vector>

#include "engine/exact/exact_model.hpp"
#include "steady/impulses.hpp"
#include "steady/orbit_trace.hpp"
#include "steady/variation.hpp"

namespace pwlsim::steady {

/// Adds such a source to the network and returns its number; add it to the forms that it changes.
[[nodiscard]] int add_small_input(model::Network& network, const std::string& name, const model::SmallInput& input);
/// Adds it to every form that reads this source, so that it has the same effects.
void superpose_input(model::Network& network, int source, int input);

/// Columns of an island's ζ for one input: w = ζ_value, w′ = rate·ζ_slope, w^(k) = rate^k·ζ_{value+k}. −1: the island does not read it.
struct InputColumns {
  int value = -1, slope = -1;
  double rate = 1.0;
  int count = 2;  ///< of columns
  /// Calls use(k, rate^−k) for each of the columns value + k that holds anything from `first` on.
  template <class Columns, class Use>
  void each(const Columns& columns, Eigen::Index first, const Use& use) const {
    double scale = 1.0;
    for (int k = 0; k < count; ++k, scale /= rate)
      if (k < 2 || !columns.col(first + value + k).isZero(0.0)) use(k, scale);
  }
};

/// One island in one mode for a while.
struct LinearSegment {
  std::size_t island = 0;
  const model::Mode* mode = nullptr;
  double begin = 0.0, length = 0.0;  ///< s
};

/// δt = on_state·δξ + on_w·w for a guard that crosses zero; zero if the time is fixed.
struct LinearGuard {
  int island = -1;                     ///< whose deviation decides δt; −1: none
  Eigen::RowVectorXd on_state;         ///< of that island's ξ
  std::vector<double> on_w, on_slope;  ///< of each input and its derivative; empty: none moves it
  Matrix on_derivatives;               ///< of each input and its further derivatives (inputs × derivatives); may be empty
  /// Of that derivative of an input, 0 the value.
  [[nodiscard]] double on_derivative(std::size_t input, int order) const {
    if (order < 2) return order == 0 ? on_w[input] : on_slope[input];
    return order - 2 < on_derivatives.cols() ? on_derivatives(static_cast<Eigen::Index>(input), order - 2) : 0.0;
  }
  [[nodiscard]] int derivatives() const { return 2 + static_cast<int>(on_derivatives.cols()); }
  int level_switch = -1;      ///< whose threshold is passed; −1: none
  bool is_off_level = false;  ///< the threshold at which it opens
  double level_rate = 0.0;    ///< how fast its control passes, 1/s: a threshold that moves by a moves the instant by a/rate
  int row = -1;               ///< of the mode's guards
};

/// δξ⁺ = p·δξ⁻ + p_w·w + d·δt of one island.
struct LinearChange {
  std::size_t island = 0;
  std::vector<const model::Mode*> by_way_of;
  Vector d;                               ///< (P f⁻ − f⁺): n
  Vector outputs;                         ///< y⁻ − y⁺ of its outputs
  std::vector<OutputImpulse> impulses{};  ///< after take_impulses, by way
  std::optional<LinearGuard> own;         ///< by which it comes, where that is not the instant's
};

struct LinearInstant : LinearGuard {
  double time = 0.0;                    ///< s
  std::vector<LinearSegment> segments;  ///< that end here
  std::vector<int> flips;               ///< switches of the model that change here
  std::vector<LinearChange> changes;
  std::vector<LinearGuard> beside;  ///< other guards that cross at the same time, if the derivative depends on the order
};

/// A whole period.
class LinearisedOrbit {
 public:
  /// `inputs`: names given to add_input. The trace's first instant is t = 0, the wrap of the period: the period's end is on its left.
  LinearisedOrbit(const engine::ExactModel& model, const Trace& trace, double period, bool is_driven,
                  const std::vector<std::string>& inputs);

  /// The impulses of all changes, of the orbit's own trace. The signals of which some have no linear form.
  std::vector<int> take_impulses(const Trace& trace, bool is_driven);

  [[nodiscard]] const Stacking& stacking() const { return stacking_; }
  [[nodiscard]] double period() const { return period_; }
  [[nodiscard]] const std::vector<LinearInstant>& instants() const { return instants_; }
  [[nodiscard]] const std::vector<LinearSegment>& tail() const { return tail_; }
  [[nodiscard]] std::size_t inputs() const { return inputs_; }
  /// Of each input whether anything reads the last derivative that it has a column for: then it may follow further ones, too, which are not known.
  [[nodiscard]] std::vector<char> inputs_read_to_the_last() const;
  [[nodiscard]] const InputColumns& columns(std::size_t island, std::size_t input) const { return columns_[island][input]; }

 private:
  void take_step(const TraceStep& step, const std::vector<char>& on_before, const std::vector<engine::Change>& changes);
  void take_guard(const engine::Change& change, int row, LinearGuard& guard) const;
  void take_own_guards(const std::vector<engine::Change>& changes, const std::vector<char>& on_before, const std::vector<char>& on,
                       LinearInstant& instant) const;
  void take_beside(const engine::Change& change, LinearInstant& instant) const;
  void take_controls_beside(const engine::Change& change, const std::vector<char>& on_before, const std::vector<char>& on,
                            LinearInstant& instant) const;
  void take_clocks(const std::vector<char>& on_before, const std::vector<char>& on, LinearInstant& instant);

  Stacking stacking_;
  double period_;
  std::size_t inputs_;
  std::vector<std::vector<InputColumns>> columns_;
  std::vector<LinearInstant> instants_;
  std::vector<LinearSegment> tail_;
};

}  // namespace pwlsim::steady
