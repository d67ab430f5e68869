#pragma once
/// Repeats the pieces of one period for measurements that extend beyond it.

#include <vector>

#include "engine/run.hpp"

namespace pwlsim::analysis {

class RepeatedPieces : public engine::PieceSink {
 public:
  /// Events at the end of the period are those at its start. A driven run (`is_driven`) has them there, and stops before the end; a self-timed one begins
  /// after its event, and must continue to `self_timed_end`, so that it reaches the event again despite rounding of its time; its impulses are passed on first.
  RepeatedPieces(const engine::Probes& wanted, double period, bool is_driven)
      : wanted_(wanted), period_(period), is_driven_(is_driven), repeats_(wanted.sink != nullptr && wanted.to > period) {}

  /// The probes of the run over one period.
  [[nodiscard]] engine::Probes probes() {
    engine::Probes probes = wanted_;
    if (wanted_.sink == nullptr || (!repeats_ && is_driven_)) return probes;
    if (repeats_) {
      probes.from = 0.0;
      probes.to = period_;
    }
    if (!is_driven_ && probes.to >= period_) probes.to = self_timed_end(period_);
    probes.sink = this;
    return probes;
  }
  [[nodiscard]] static double self_timed_end(double period) { return period * (1.0 + beyond); }
  /// After the run: passes on further periods. `probed`: up to where the run has served the probes, s; returns the new end.
  double repeat(double probed) {
    if (!keeps()) return probed;
    double begin = is_driven_ ? period_ : 0.0;
    do {
      for (const Kept& kept : kept_)
        if (is_of_end(kept)) wanted_.sink->impulse(begin, kept.values);
      for (const Kept& kept : kept_)
        if (!is_of_end(kept)) hand_on(kept, begin);
      begin += period_;
    } while (begin < wanted_.to);
    return wanted_.to;
  }

  void before_start(std::span<const double> values) override { wanted_.sink->before_start(values); }
  void take(const engine::Piece& piece) override {
    if (!is_driven_ && piece.from >= period_ * (1.0 - beyond)) return;
    if (!keeps()) return wanted_.sink->take(piece);
    kept_.push_back({piece, {piece.values.begin(), piece.values.end()}, {piece.noise.begin(), piece.noise.end()}, 0.0});
    if (is_driven_) hand_on(kept_.back(), 0.0);
  }
  void impulse(double time, std::span<const double> values) override {
    if (is_driven_ && time >= period_ * (1.0 - at_end)) return;
    if (!keeps()) return wanted_.sink->impulse(time, values);
    kept_.push_back({{}, {values.begin(), values.end()}, {}, time});
    if (is_driven_) hand_on(kept_.back(), 0.0);
  }

 private:
  static constexpr double at_end = 1e-12;  ///< relative to the period: a time this near to its end is at it
  static constexpr double beyond = 1e-11;  ///< likewise, of a free period, which is known to 1e-11
  struct Kept {
    engine::Piece piece;  ///< of length 0: an impulse
    std::vector<double> values, noise;
    double time = 0.0;
  };
  [[nodiscard]] bool keeps() const { return repeats_ || (wanted_.sink != nullptr && !is_driven_); }
  [[nodiscard]] bool is_of_end(const Kept& kept) const {
    return !is_driven_ && kept.piece.length == 0.0 && kept.time >= period_ * (1.0 - beyond);
  }
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
