#pragma once
/// Rows of a run for a picture, in bounded memory: all of them while they are few, then the extremes of each of many equal pieces of time.

#include <cstddef>
#include <span>
#include <vector>

namespace pwlsim::waveform {

class ThinnedRows {
 public:
  /// Rows hold a time from `from` to `to` and `signals` values. `most_rows`: how many are kept, at least 2.
  ThinnedRows(double from, double to, std::size_t signals, std::size_t most_rows);

  /// One row; times do not decrease.
  void add(std::span<const double> row);

  /// Whether rows were left out: then every piece of time that holds any has two rows, at its first and its last time, with the extremes of each signal in
  /// the order in which they occurred.
  [[nodiscard]] bool thinned() const { return !pieces_.empty(); }

  struct Rows {
    std::vector<double> times;
    std::vector<std::vector<double>> columns;  ///< one a signal
  };
  [[nodiscard]] Rows rows() const;

 private:
  struct Piece {
    double first = 0.0, last = 0.0;  ///< times
    bool used = false;
  };
  struct Extremes {
    double low = 0.0, high = 0.0;
    bool low_first = true;
  };
  void fold();
  void add_to_piece(std::span<const double> row);

  double from_, to_;
  std::size_t signals_, most_rows_;
  std::vector<double> all_;  ///< whole rows, while they are few
  std::vector<Piece> pieces_;
  std::vector<Extremes> extremes_;  ///< piece by piece, one a signal
};

}  // namespace pwlsim::waveform
