#include "engine/exact/piece_maker.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/exact/tolerances.hpp"

namespace pwlsim::engine {
namespace {

constexpr std::size_t piece_points = linalg::legendre_points;
constexpr std::uint64_t crowd = 4096;
constexpr std::uint64_t most_doublings = 10;
/// Derivatives at the begin may differ by so many resolutions of a coefficient, and by so many roundings of their own terms.
constexpr double derivative_slack = 32.0;
/// rate·2^p below which sixteen points resolve any motion.
constexpr double easy = 0.5;
constexpr std::size_t most_kept_intervals = 512;  ///< kept for one mode

/// P_k^{(m)}(1) = (k + m)!/(2^m m! (k − m)!), k = 0 … 16.
using EndDerivatives = std::array<std::array<double, piece_points + 1>, 4>;
EndDerivatives end_derivatives() {
  EndDerivatives result{};
  for (std::size_t m = 0; m < result.size(); ++m)
    for (std::size_t k = m; k <= piece_points; ++k) {
      double value = 1.0;
      for (std::size_t j = k - m + 1; j <= k + m; ++j) value *= static_cast<double>(j);
      for (std::size_t j = 1; j <= m; ++j) value /= 2.0 * static_cast<double>(j);
      result[m][k] = value;
    }
  return result;
}

}  // namespace

PieceMaker::PieceMaker(const std::vector<IslandRun>& runs, const std::vector<IslandModel>& islands, const Probes& probes,
                       const std::atomic<int>* interrupt)
    : runs_(runs), probes_(probes), interrupt_(interrupt) {
  if (probes.sink == nullptr) return;
  for (std::size_t i = 0; i < islands.size(); ++i) {
    Track track;
    track.island = i;
    const model::System& system = islands[i].extraction.system;
    for (std::size_t k = 0; k < system.output_signal.size(); ++k)
      for (std::size_t probe = 0; probe < probes.signals.size(); ++probe)
        if (probes.signals[probe] == system.output_signal[k]) track.shares.emplace_back(k, probe);
    if (track.shares.empty()) continue;
    track.y.resize(static_cast<std::size_t>(system.size()));
    track.work.resize(2 * track.y.size());
    tracks_.push_back(std::move(track));
  }
  const std::size_t count = probes.signals.size();
  values_.resize(count * piece_points);
  starts_.resize(count * derivatives);
  bounds_.resize(count * derivatives);
  terms_.resize(count);
  largest_.resize(count);
}

void PieceMaker::run_begins(const std::vector<std::vector<double>>& signals) {
  if (probes_.sink == nullptr || signals.empty()) return;
  std::vector<double> values(probes_.signals.size());
  for (const Track& track : tracks_)
    for (const auto& [output, probe] : track.shares) values[probe] += signals[track.island][output];
  probes_.sink->before_start(values);
}

void PieceMaker::pass_on(double time) {
  const double end = std::min(time, probes_.to);
  double at = std::max(done_, probes_.from);
  done_ = time;
  if (at >= end) return;
  resumes_ = true;
  for (Track& track : tracks_) follow(track, runs_[track.island], at);
  while (at < end) {
    int level = first_level(end - at);
    const int least = always_resolved();
    for (fill(level); level > least && !resolved(std::ldexp(1.0, level)); fill(level)) --level;
    const double next = std::min(end, at + std::ldexp(1.0, level));
    hand_over_piece(at, next, level);
    if (next - at < tolerance::piece_crowding * (probes_.to - probes_.from)) ++short_;
    cut_ = interrupt_ && interrupt_->load(std::memory_order_relaxed) != 0;
    if (cut_) cut_at_ = next;
    if (cut_ || next == at) return;  // shorter than the time's own rounding
    at = next;
    step(at, level);
  }
}

/// The state at `time`, from where it is known.
void PieceMaker::follow(Track& track, const IslandRun& run, double time) {
  const Segment& segment = run.segment();
  if (track.segment != run.segment_number()) {
    track.segment = run.segment_number();
    track.mode = run.mode;
    auto& rows = track.modes[run.mode];
    if (!rows) rows = rows_of(track, *run.mode);
    track.rows = rows.get();
    track.time = segment.anchor;
    std::copy_n(segment.y0.begin(), run.mode->ny, track.y.begin());
    track.is_fresh = time == segment.anchor;
    resumes_ = false;
    short_ = 0;
  }
  if (time > track.time) track.mode->flow.apply(time - track.time, track.y.data(), track.work.data());
  track.time = time;
}

std::unique_ptr<PieceMaker::ModeRows> PieceMaker::rows_of(const Track& track, const model::Mode& mode) const {
  auto rows = std::make_unique<ModeRows>();
  const auto count = static_cast<Eigen::Index>(track.shares.size());
  linalg::Matrix c(count, mode.ny);
  for (Eigen::Index i = 0; i < count; ++i)
    c.row(i) = mode.outputs.row(static_cast<Eigen::Index>(track.shares[static_cast<std::size_t>(i)].first));
  linalg::Matrix bound = c.cwiseAbs();
  rows->derivative.resize(count * derivatives, mode.ny);
  rows->bound.resize(count * derivatives, mode.ny);
  for (int m = 0; m < derivatives; ++m) {
    rows->derivative.middleRows(m * count, count) = c;
    rows->bound.middleRows(m * count, count) = bound;
    c = linalg::Matrix(c * mode.flow.a());
    bound = linalg::Matrix(bound * mode.absolute_a);
  }
  rows->transposed = linalg::Exponential(mode.flow.a().transpose(), mode.flow.rate());
  return rows;
}

const PieceMaker::Interval& PieceMaker::interval_of(Track& track, int level) {
  auto& intervals = track.rows->intervals;
  if (const auto known = intervals.find(level); known != intervals.end()) return known->second;
  if (intervals.size() >= most_kept_intervals) intervals.clear();
  const double length = std::ldexp(1.0, level);
  const model::Mode& mode = *track.mode;
  Interval interval;
  interval.advance = mode.flow.minus_identity(length);
  interval.points.resize(static_cast<Eigen::Index>(track.shares.size() * piece_points), mode.ny);
  interval.bound.setZero(static_cast<Eigen::Index>(track.shares.size()), mode.ny);
  linalg::Vector row(mode.ny), work(2 * mode.ny);
  const auto& point = linalg::gauss_legendre().point;
  for (std::size_t s = 0; s < track.shares.size(); ++s)
    for (std::size_t i = 0; i < piece_points; ++i) {
      row = mode.outputs.row(static_cast<Eigen::Index>(track.shares[s].first)).transpose();
      track.rows->transposed.apply_once(0.5 * (1.0 + point[i]) * length, row.data(), work.data());
      interval.points.row(static_cast<Eigen::Index>(s * piece_points + i)) = row.transpose();
      interval.bound.row(static_cast<Eigen::Index>(s)) =
          interval.bound.row(static_cast<Eigen::Index>(s)).cwiseMax(row.cwiseAbs().transpose());
    }
  for (auto& [other, known] : intervals) {
    if (other < level) interval.bound = interval.bound.cwiseMax(known.bound);
    if (other > level) known.bound = known.bound.cwiseMax(interval.bound);
  }
  return intervals.emplace(level, std::move(interval)).first->second;
}

/// Where to begin: as long as what is left; no more than twice the interval before, or that with which a segment of this mode began last, and not shorter
/// than it: its rows are there.
int PieceMaker::first_level(double longest) const {
  const int whole = static_cast<int>(std::ceil(std::log2(longest)));
  bool is_known = resumes_;
  int known = level_;
  for (const Track& track : tracks_) {
    if (!track.is_fresh || !track.rows->has_first) continue;
    known = is_known ? std::min(known, track.rows->first_level) : track.rows->first_level;
    is_known = true;
  }
  if (!is_known) return whole;
  return known >= whole ? known : std::min(whole, known + 1);
}

int PieceMaker::always_resolved() const {
  double rate = 0.0;
  for (const Track& track : tracks_) rate = std::max(rate, track.mode->flow.rate());
  constexpr int everything = 1100;
  return rate > 0.0 ? static_cast<int>(std::floor(std::log2(easy / rate))) : everything;
}

/// Values at the points, and at the begin the derivatives and what bounds their rounding.
void PieceMaker::fill(int level) {
  std::fill(values_.begin(), values_.end(), 0.0);
  std::fill(starts_.begin(), starts_.end(), 0.0);
  std::fill(bounds_.begin(), bounds_.end(), 0.0);
  std::fill(terms_.begin(), terms_.end(), 0.0);
  for (Track& track : tracks_) {
    track.interval = &interval_of(track, level);
    const std::size_t count = track.shares.size();
    scratch_.resize(count * piece_points);
    linalg::multiply(track.interval->points, track.y.data(), scratch_.data());
    for (std::size_t s = 0; s < count; ++s)
      for (std::size_t i = 0; i < piece_points; ++i) values_[track.shares[s].second * piece_points + i] += scratch_[s * piece_points + i];
    const linalg::Vector size = Eigen::Map<const linalg::Vector>(track.y.data(), track.mode->ny).cwiseAbs();
    linalg::multiply(track.interval->bound, size.data(), scratch_.data());
    for (std::size_t s = 0; s < count; ++s) terms_[track.shares[s].second] += scratch_[s];
    for (std::size_t s = 0; s < count; ++s)
      for (std::size_t m = 0; m < derivatives; ++m) {
        const auto row = static_cast<Eigen::Index>(m * count + s);
        const std::size_t place = track.shares[s].second * derivatives + m;
        starts_[place] += linalg::row_times(track.rows->derivative, row, track.y.data());
        bounds_[place] += linalg::row_times(track.rows->bound, row, size.data());
      }
  }
}

bool PieceMaker::resolved(double length) const {
  static const EndDerivatives ends = end_derivatives();
  const double noise_unit = std::ldexp(tolerance::piece_point, static_cast<int>(std::min(short_ / crowd, most_doublings)));
  for (std::size_t probe = 0; probe < largest_.size(); ++probe) {
    const double* values = &values_[probe * piece_points];
    const linalg::LegendreSeries series(values);
    double size = tolerance::piece_dead * largest_[probe];
    for (std::size_t i = 0; i < piece_points; ++i) size = std::max(size, std::abs(values[i]));
    const double noise = noise_unit * terms_[probe];
    const double tolerance = tolerance::piece_resolution * size + noise;
    if (series.tail() > tolerance) return false;
    linalg::LegendreSeries derivative = series;
    double unit = 1.0;
    for (std::size_t m = 0; m < derivatives; ++m) {
      const std::size_t place = probe * derivatives + m;
      const double slack = derivative_slack * ends[m][piece_points] * tolerance + tolerance::piece_derivative * bounds_[place] * unit;
      if (std::abs(derivative(-1.0) - starts_[place] * unit) > slack) return false;
      derivative = derivative.derivative();
      unit *= 0.5 * length;
    }
  }
  return true;
}

void PieceMaker::hand_over_piece(double from, double to, int level) {
  for (std::size_t probe = 0; probe < largest_.size(); ++probe)
    for (std::size_t i = 0; i < piece_points; ++i) largest_[probe] = std::max(largest_[probe], std::abs(values_[probe * piece_points + i]));
  for (Track& track : tracks_) {
    if (!track.is_fresh) continue;
    track.is_fresh = false;
    track.rows->first_level = level;
    track.rows->has_first = true;
  }
  level_ = level;
  resumes_ = true;
  probes_.sink->take({from, to, from, std::ldexp(1.0, level), values_});
}

/// The states at the end of the interval tried last. Where the stretch ends within it, `follow` goes on from its begin.
void PieceMaker::step(double end, int level) {
  const double length = std::ldexp(1.0, level);
  for (Track& track : tracks_) {
    if (end != track.time + length) continue;
    advance(track, track.interval->advance, 1.0);
    // The time is rounded, the interval is not.
    const double rest = (end - track.time) - length;
    if (rest != 0.0) advance(track, track.mode->flow.a(), rest);
    track.time = end;
  }
}

/// y += factor·M y.
void PieceMaker::advance(Track& track, const linalg::Matrix& m, double factor) {
  linalg::multiply(m, track.y.data(), track.work.data());
  for (int i = 0; i < track.mode->ny; ++i) track.y[static_cast<std::size_t>(i)] += factor * track.work[static_cast<std::size_t>(i)];
}

}  // namespace pwlsim::engine
