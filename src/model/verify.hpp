#pragma once
/// Signs of guards just after an instant: the first derivative that is not rounding decides (lexicographic nonnegativity,
/// van der Schaft & Schumacher 1996, eq. (3.6)-(3.7); in a consistent mode ny+1 derivatives suffice, by Cayley–Hamilton).

#include <vector>

#include "model/mode.hpp"

namespace pwlsim::model {

struct Departure {
  int order = 0;       ///< of the first nonzero derivative; −1: identically zero (indeterminate)
  double value = 0.0;  ///< that derivative, unscaled
};

class Verifier {
 public:
  /// Departures of guard rows `rows` of the mode at y into out[0 … rows.size()). Rounding level: mode.noise times the size
  /// of the terms, including an error of a tenth of the state's norm in every entry of c. (An error in proportion to the largest
  /// row of the mode, as of least squares, is not assumed: u comes from factors of incidence-like matrices, row by row
  /// exact; assuming it would hide a diode with a finite Roff beside one with a small Ron.)
  /// A mode that is the slow motion beside decays of time constant T resolves no time below that: a guard that is below zero by no more than it rises within a few
  /// T has not crossed if the decays hold it until then: they are not followed, or their remainder is enough.
  void departures(const Mode& mode, const double* y, const std::vector<int>& rows, Departure* out);

  /// Factor on the rounding level, for a state that no mode accepts at the ordinary one; above 1, the remainder of a state that once had
  /// the norm `largest` counts as rounding too. It stays until set again.
  void relax(double factor, double largest) {
    relaxation_ = factor;
    largest_ = largest;
  }
  [[nodiscard]] double relaxation() const { return relaxation_; }
  /// The remainder of the decays beside a slow motion when it was entered (Decays::coordinates); valid until set again.
  void set_left(const Vector* left) { left_ = left; }
  /// Decays that end within this time, s, are not followed.
  void set_unseen(double time) { unseen_ = time; }

 private:
  void take(const Mode& mode, const double* y);
  void prepare();
  [[nodiscard]] double square_of_most_rounding(const Mode& mode, const double* y) const;
  Departure departure(const Mode& mode, int row);  ///< of a row whose value is rounding
  Departure after_decays(const Mode& mode, int row, Departure first);
  Departure undone(const Mode& mode, int row, Departure first);
  [[nodiscard]] bool may_be_held(const Mode& mode, int row, const Departure& now, double next) const;
  [[nodiscard]] double rounding(const Mode& mode, int row, int order, double size) const;
  bool significant(const Mode& mode, int row, int order, double& value);
  void extend(const Mode& mode, int order);

  double relaxation_ = 1.0, largest_ = 0.0;
  double unseen_ = 0.0;
  const Vector* left_ = nullptr;
  /// The state that was asked about last, since the next question is often about the same one: `mode_`, and z_ up to ny. Modes must stay as and
  /// where they are.
  const Mode* mode_ = nullptr;
  int ny_ = 0;
  int known_ = 0;                 ///< derivatives computed so far, the value among them
  std::vector<double> z_, size_;  ///< A^j y/‖A‖^j and its bound, j = 0 …
  std::vector<double> norm_;
  std::vector<double> values_;  ///< of every guard; behind them the sizes of their terms, where known_ > 0
};

}  // namespace pwlsim::model
