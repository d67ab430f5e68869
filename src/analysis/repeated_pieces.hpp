#pragma once
/// The pieces of one period, handed on again and again for measurements that reach beyond it.

#include <vector>

#include "engine/run.hpp"

namespace pwlsim::analysis {

class RepeatedPieces : public engine::PieceSink {
 public:
  /// What happens at the end of the period happens at its begin. A driven run (`is_driven`) has it there, and stops left of the end; a self-timed one begins
  /// right of it, and rounding decides whether it comes to it again.
  RepeatedPieces(const engine::Probes& wanted, double period, bool is_driven)
      : wanted_(wanted), period_(period), is_driven_(is_driven), repeats_(wanted.sink != nullptr && wanted.to > period) {}

  /// What the run over one period is asked for.
  [[nodiscard]] engine::Probes probes() {
    engine::Probes probes = wanted_;
    if (wanted_.sink == nullptr || (!repeats_ && is_driven_)) return probes;
    if (repeats_) {
      probes.from = 0.0;
      probes.to = period_;
    }
    probes.sink = this;
    return probes;
  }
  /// After the run: the further periods. How far the probes have been served, s, where the run served them so far.
  double repeat(double probed) {
    if (!repeats_) return probed;
    for (double begin = period_; begin < wanted_.to; begin += period_)
      for (const Kept& kept : kept_) hand_on(kept, begin);
    return wanted_.to;
  }

  void before_start(std::span<const double> values) override { wanted_.sink->before_start(values); }
  void take(const engine::Piece& piece) override {
    if (!is_driven_ && piece.from >= period_ * (1.0 - at_end)) return;
    if (!repeats_) return wanted_.sink->take(piece);
    kept_.push_back({piece, {piece.values.begin(), piece.values.end()}, {piece.noise.begin(), piece.noise.end()}, 0.0});
    hand_on(kept_.back(), 0.0);
  }
  void impulse(double time, std::span<const double> values) override {
    if (is_driven_ && time >= period_ * (1.0 - at_end)) return;
    if (!repeats_) return wanted_.sink->impulse(time, values);
    kept_.push_back({{}, {values.begin(), values.end()}, {}, time});
    hand_on(kept_.back(), 0.0);
  }

 private:
  static constexpr double at_end = 1e-12;  ///< of the period: what lies this near to its end lies at it
  struct Kept {
    engine::Piece piece;  ///< of length 0: an impulse
    std::vector<double> values, noise;
    double time = 0.0;
  };
  void hand_on(const Kept& kept, double later) {
    if (kept.piece.length == 0.0) return wanted_.sink->impulse(kept.time + later, kept.values);
    engine::Piece piece = kept.piece;
    piece.values = kept.values;
    piece.noise = kept.noise;
    piece.from += later;
    piece.to += later;
    piece.begin += later;
    if (piece.to > wanted_.from && piece.from < wanted_.to) wanted_.sink->take(piece);
  }

  engine::Probes wanted_;
  double period_;
  bool is_driven_, repeats_;
  std::vector<Kept> kept_;
};

}  // namespace pwlsim::analysis
