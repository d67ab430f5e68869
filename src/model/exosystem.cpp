#include "model/exosystem.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <variant>

#include "model/tolerances.hpp"

namespace pwlsim::model {

namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;

/// sin and cos of 2π·frequency·(time + late) + phase, with the whole cycles taken off first and no rounding before that, so that late times
/// lose nothing.
void sine_cosine(double frequency, double time, double late, double phase, double& sine, double& cosine) {
  const double cycles = frequency * time;
  const double fraction = (cycles - std::nearbyint(cycles)) + (std::fma(frequency, time, -cycles) + frequency * late);
  const double angle = two_pi * fraction + phase;
  sine = std::sin(angle);
  cosine = std::cos(angle);
}

/// A sine burst of a broken number of cycles falls back to its starting value.
bool ends_with_jump(const Exosystem::Block& block) {
  if (block.kind != Exosystem::Block::Kind::oscillation || !(block.end < forever)) return false;
  const double age = block.end - block.delay;
  double sine = 0.0, cosine = 0.0;
  sine_cosine(block.frequency, age, 0.0, block.phase, sine, cosine);
  return std::abs(std::exp(-block.damping * age) * sine - std::sin(block.phase)) > tolerance::burst_end * (1.0 + block.omega * age);
}

}  // namespace

double Exosystem::Block::derivative_bound(const double* zeta, int order, double h) const {
  switch (kind) {
    case Kind::constant:
    case Kind::level:
    case Kind::small_input:
      return 0.0;
    case Kind::ramp:
      return order == 1 ? std::abs(rate * zeta[first + 1]) : 0.0;
    case Kind::decay: {
      const double growth = damping < 0.0 ? std::exp(-damping * h) : 1.0;
      return std::pow(rate, order) * std::abs(zeta[first]) * growth;
    }
    case Kind::oscillation: {
      const double growth = damping < 0.0 ? std::exp(-damping * h) : 1.0;
      double power = 1.0;
      for (int i = 0; i < order; ++i) power *= rate;
      return power * linalg::norm(zeta + first, 2) * growth;
    }
  }
  return 0.0;
}

Exosystem::Exosystem(const std::vector<SourceFunction>& functions, bool needs_constant) {
  if (needs_constant) constant_ = blocks_[add_block({})].first;
  for (std::size_t i = 0; i < functions.size(); ++i) std::visit([&](const auto& f) { add(static_cast<int>(i), f); }, functions[i]);
  fill_matrices(static_cast<int>(functions.size()));
  curved_ = std::any_of(blocks_.begin(), blocks_.end(), [](const Block& block) { return block.is_curved(); });
}

double Exosystem::fastest() const {
  double rate = 0.0;
  for (const Block& block : blocks_)
    if (block.is_curved()) rate = std::max(rate, block.rate);
  return rate;
}

int Exosystem::add_block(Block block) {
  block.first = states_;
  states_ += block.size();
  blocks_.push_back(block);
  return static_cast<int>(blocks_.size()) - 1;
}

void Exosystem::use_constant(int source, double value) {
  if (value == 0.0) return;
  if (constant_ < 0) constant_ = blocks_[add_block({})].first;
  coefficients_.push_back({source, constant_, value});
}

int Exosystem::find_oscillation(double omega) const {
  for (std::size_t i = 0; i < blocks_.size(); ++i)
    if (blocks_[i].kind == Block::Kind::oscillation && blocks_[i].source < 0 && blocks_[i].omega == omega) return static_cast<int>(i);
  return -1;
}

void Exosystem::add(int source, const Dc& f) { use_constant(source, f.value); }

void Exosystem::add(int source, const Sin& f) {
  use_constant(source, f.offset);
  if (f.amplitude == 0.0) return;
  if (f.frequency == 0.0 && f.damping == 0.0) return use_constant(source, f.amplitude * std::sin(f.phase));
  const double omega = two_pi * f.frequency;
  const bool simple = f.delay == 0.0 && f.damping == 0.0 && !(f.cycles < forever);
  Block block;
  block.kind = Block::Kind::oscillation;
  block.frequency = f.frequency;
  block.omega = omega;
  block.damping = f.damping;
  block.rate = std::hypot(omega, f.damping);
  if (simple) {
    int shared = find_oscillation(omega);
    if (shared < 0) shared = add_block(block);
    const int first = blocks_[static_cast<std::size_t>(shared)].first;
    coefficients_.push_back({source, first, f.amplitude * std::cos(f.phase)});
    coefficients_.push_back({source, first + 1, f.amplitude * std::sin(f.phase)});
    return;
  }
  block.source = source;
  block.phase = f.phase;
  block.delay = f.delay;
  if (f.cycles < forever && f.frequency > 0.0) block.end = f.delay + f.cycles / f.frequency;
  if (std::sin(f.phase) != 0.0) {
    Block level;
    level.kind = Block::Kind::level;
    level.source = source;
    block.partner = blocks_[static_cast<std::size_t>(add_block(level))].first;
    coefficients_.push_back({source, block.partner, f.amplitude});
  }
  coefficients_.push_back({source, blocks_[static_cast<std::size_t>(add_block(block))].first, f.amplitude});
}

void Exosystem::add(int source, const Pulse& f) { add_track(source, make_track(f), true); }

void Exosystem::add(int source, const Pwl& f) { add_track(source, make_track(f), true); }

void Exosystem::add(int source, const Exp& f) {
  Track level;
  level.initial = f.v1;
  level.prefix = {{f.td1, f.v2, 0.0}, {f.td2, f.v1, 0.0}};
  add_track(source, level, false);
  for (const auto& [delay, tau, step] : {std::tuple{f.td1, f.tau1, f.v2 - f.v1}, std::tuple{f.td2, f.tau2, f.v1 - f.v2}}) {
    Block decay;
    decay.kind = Block::Kind::decay;
    decay.source = source;
    decay.damping = 1.0 / tau;
    decay.rate = std::abs(decay.damping);
    decay.delay = delay;
    coefficients_.push_back({source, blocks_[static_cast<std::size_t>(add_block(decay))].first, -step});
  }
}

void Exosystem::add(int source, const Held& f) {
  Block level;
  level.kind = Block::Kind::level;
  level.source = source;
  const int index = add_block(level);
  Track track;
  track.initial = f.value;
  tracks_.push_back({std::move(track), index, true, f.channel});
  coefficients_.push_back({source, blocks_[static_cast<std::size_t>(index)].first, 1.0});
}

void Exosystem::add(int source, const SmallInput& f) {
  Block block;
  block.kind = Block::Kind::small_input;
  block.source = source;
  block.rate = f.rate;
  block.derivatives = f.states - 1;
  const int index = add_block(block);
  tracks_.push_back({{}, index, false});
  coefficients_.push_back({source, blocks_[static_cast<std::size_t>(index)].first, 1.0});
}

Exosystem Exosystem::with_held(std::span<const double> values) const {
  Exosystem other = *this;
  for (TrackBlock& block : other.tracks_)
    if (block.channel >= 0) block.track.initial = values[static_cast<std::size_t>(block.channel)];
  return other;
}

void Exosystem::hold(Phase& phase, int channel, double value, double time) const {
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    Track::Cursor& cursor = phase.cursors[i];
    if (tracks_[i].channel != channel || (cursor.value == value && cursor.next == forever)) continue;
    phase.held[i] = value;
    cursor.next = time;
    phase.next = std::min(phase.next, time);
  }
}

void Exosystem::add_track(int source, Track track, bool may_jump) {
  Block block;
  block.source = source;
  block.rate = track.largest_slope();
  if (const double largest = track.largest_value(); largest > 0.0) block.scale = largest;
  block.kind = block.rate > 0.0 ? Block::Kind::ramp : Block::Kind::level;
  if (track.prefix.empty() && track.loop.empty()) return use_constant(source, track.initial);
  const int index = add_block(block);
  tracks_.push_back({std::move(track), index, may_jump});
  coefficients_.push_back({source, blocks_[static_cast<std::size_t>(index)].first, 1.0});
}

void Exosystem::fill_matrices(int sources) {
  a_ = linalg::Matrix::Zero(states_, states_);
  rows_ = linalg::Matrix::Zero(sources, states_);
  for (const auto& c : coefficients_) rows_(c.source, c.state) += c.value;
  for (int state = 0; state < states_; ++state)
    for (int source = 0; source < sources; ++source)
      if (rows_(source, state) != 0.0) terms_.push_back({source, state, rows_(source, state)});
  for (const auto& block : blocks_) {
    const int i = block.first;
    if (block.kind == Block::Kind::ramp || block.kind == Block::Kind::small_input)
      for (int k = 1; k < block.size(); ++k) a_(i + k - 1, i + k) = block.rate;
    if (block.kind == Block::Kind::decay) a_(i, i) = -block.damping;
    if (block.kind == Block::Kind::oscillation) {
      a_(i, i) = a_(i + 1, i + 1) = -block.damping;
      a_(i, i + 1) = block.omega;
      a_(i + 1, i) = -block.omega;
    }
  }
}

linalg::Vector Exosystem::values(const linalg::Vector& zeta) const {
  linalg::Vector w(rows_.rows());
  values(zeta.data(), w.data());
  return w;
}

void Exosystem::values(const double* zeta, double* w) const {
  std::fill(w, w + rows_.rows(), 0.0);
  for (const Term& term : terms_) w[term.source] += term.value * zeta[term.state];
}

linalg::Vector Exosystem::rates(const linalg::Vector& zeta) const {
  linalg::Vector result(zeta.size());
  for (const Block& block : blocks_) {
    const Eigen::Index i = block.first, n = block.size();
    result.segment(i, n) = a_.block(i, i, n, n).lazyProduct(zeta.segment(i, n));
  }
  return result;
}

Exosystem::Phase Exosystem::start(double time) const {
  Phase phase;
  for (const auto& t : tracks_) {
    phase.cursors.push_back(t.track.before(time));
    phase.held.push_back(t.track.initial);
  }
  phase.stage.assign(blocks_.size(), 1);
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    const Block& block = blocks_[i];
    if (block.source < 0 || !block.is_curved()) continue;
    phase.stage[i] = block.delay >= time ? 0 : block.end < time ? 2 : 1;
    if (block.delay >= time) phase.pending.emplace_back(block.delay, static_cast<int>(i));
    if (block.end < forever && block.end >= time) phase.pending.emplace_back(block.end, static_cast<int>(i));
  }
  std::stable_sort(phase.pending.begin(), phase.pending.end(), [](const auto& x, const auto& y) { return x.first < y.first; });
  refresh_next(phase);
  return phase;
}

void Exosystem::refresh_next(Phase& phase) const {
  phase.next = phase.pending.empty() ? forever : phase.pending.front().first;
  for (const auto& cursor : phase.cursors) phase.next = std::min(phase.next, cursor.next);
}

bool Exosystem::advance(Phase& phase, double time, double tolerance) const {
  bool jumped = false;
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    auto& cursor = phase.cursors[i];
    if (cursor.next > time + tolerance) continue;
    if (tracks_[i].channel >= 0) {
      jumped |= cursor.value != phase.held[i];
      cursor.value = phase.held[i];
      cursor.next = forever;
      continue;
    }
    jumped |= tracks_[i].track.pass(cursor, time, tolerance) && tracks_[i].may_jump;
  }
  while (!phase.pending.empty() && phase.pending.front().first <= time + tolerance) {
    const auto [when, which] = phase.pending.front();
    phase.pending.erase(phase.pending.begin());
    const auto i = static_cast<std::size_t>(which);
    if (++phase.stage[i] == 2 && ends_with_jump(blocks_[i])) jumped = true;
  }
  refresh_next(phase);
  return jumped;
}

void Exosystem::evaluate(const Phase& phase, double time, double* zeta) const {
  if (constant_ >= 0) zeta[constant_] = 1.0;
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    const Block& block = blocks_[static_cast<std::size_t>(tracks_[i].block)];
    const auto& cursor = phase.cursors[i];
    zeta[block.first] = cursor.at(time);
    if (block.kind == Block::Kind::ramp) zeta[block.first + 1] = cursor.slope / block.rate;
    if (block.kind == Block::Kind::small_input) std::fill_n(zeta + block.first, block.size(), 0.0);
  }
  evaluate_curved(phase, time, 0.0, zeta);
}

void Exosystem::sizes(const Phase& phase, double time, const double* zeta, double* size) const {
  for (int i = 0; i < states_; ++i) size[i] = std::abs(zeta[i]);
  for (std::size_t i = 0; i < tracks_.size(); ++i)
    size[blocks_[static_cast<std::size_t>(tracks_[i].block)].first] = phase.cursors[i].size_at(time);
  for (const Block& block : blocks_)
    if (block.kind == Block::Kind::oscillation) {
      const int i = block.first;
      size[i] = size[i + 1] = std::sqrt(zeta[i] * zeta[i] + zeta[i + 1] * zeta[i + 1]);
    }
}

void Exosystem::evaluate_curved(const Phase& phase, double time, double late, double* zeta) const {
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    const Block& block = blocks_[i];
    if (!block.is_curved()) continue;
    const bool alive = phase.stage[i] == 1;
    double* z = zeta + block.first;
    const double age = time - block.delay;
    if (block.kind == Block::Kind::decay) {
      z[0] = alive ? std::exp(-block.damping * (age + late)) : 0.0;
      continue;
    }
    z[0] = z[1] = 0.0;
    // What rounding took off the age, where the delay is no longer than the time.
    const double rest = alive ? (time - age) - block.delay : 0.0;
    if (alive) sine_cosine(block.frequency, age, late + rest, block.phase, z[0], z[1]);
    if (alive && block.damping != 0.0) {
      const double envelope = std::exp(-block.damping * (age + late));
      z[0] *= envelope;
      z[1] *= envelope;
    }
    if (block.partner >= 0) zeta[block.partner] = alive ? 0.0 : std::sin(block.phase);
  }
}

}  // namespace pwlsim::model
