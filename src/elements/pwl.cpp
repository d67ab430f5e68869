#include "elements/waveform.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace pwlsim::elements {
namespace {

constexpr double largest_expansion = 1e7;  // points of finite repetitions written out

/// A number with its derivative to one parameter.
struct Dual {
  double value = 0.0, moved = 0.0;
  friend Dual operator+(Dual a, Dual b) { return {a.value + b.value, a.moved + b.moved}; }
  friend Dual operator*(double factor, Dual a) { return {factor * a.value, factor * a.moved}; }
};

struct DualPoint {
  Dual time, value;
};
using DualPoints = std::vector<DualPoint>;

/// Entry of a gradient; `parameter` < 0: none is asked for.
double entry(const std::vector<double>& gradient, int parameter) {
  return parameter >= 0 && static_cast<std::size_t>(parameter) < gradient.size() ? gradient[static_cast<std::size_t>(parameter)] : 0.0;
}

/// What becomes of a card, with the derivatives of its numbers to one parameter.
struct Track {
  DualPoints points;
  Dual repeat_from;
  double repeats = 0.0;
};

void append(DualPoints& points, const DualPoint& point) {
  const bool repeated = !points.empty() && points.back().time.value == point.time.value && points.back().value.value == point.value.value;
  if (!repeated) points.push_back(point);
}

void append_pass(DualPoints& points, const DualPoints& block, Dual base) {
  for (const DualPoint& point : block) append(points, {base + point.time, point.value});
}

/// Times made absolute within the part; empty where they are negative or decrease.
std::optional<DualPoints> read_part(const PwlPart& part, int parameter, Diagnostics& diagnostics) {
  DualPoints points;
  Dual last;
  for (const PwlPoint& point : part.points) {
    const Dual written{point.time, entry(point.time_gradient, parameter)};
    const Dual time = point.relative ? last + written : written;
    if (time.value < last.value) {
      diagnostics.error("E-pwl-order", point.span,
                        last.value == 0.0 ? fmt::format("the time {} s is negative", time.value)
                                          : fmt::format("the times of a PWL must not decrease: {} s follows {} s", time.value, last.value));
      return std::nullopt;
    }
    points.push_back({time, {point.value, entry(point.value_gradient, parameter)}});
    last = time;
  }
  return points;
}

bool check_part(const PwlPart& part, const DualPoints& block, bool last, Diagnostics& diagnostics) {
  const char* complaint = nullptr;
  if (block.empty())
    complaint = "a PWL needs at least one time and value";
  else if (part.passes != 1.0 && block.back().time.value <= 0.0)
    complaint = "a repeated part of a PWL needs a length: its last time is 0";
  else if (std::isinf(part.passes) && !last)
    complaint = "nothing may follow a part that is repeated forever";
  else if (!std::isinf(part.passes) && part.passes * static_cast<double>(block.size()) > largest_expansion && !last)
    complaint = "this repetition has more than 1e7 points";
  if (complaint != nullptr) diagnostics.error("E-pwl", part.span, complaint);
  return complaint == nullptr;
}

/// A later pass begins where the one before ended, so a block that starts after 0 is led there by a straight line.
DualPoints next_pass(const DualPoints& block) {
  DualPoints points;
  if (block.front().time.value > 0.0) points.push_back({{}, block.back().value});
  points.insert(points.end(), block.begin(), block.end());
  return points;
}

/// The first pass is written out; of the others one is written where the model repeats it, all where more follows.
void append_part(Track& track, const DualPoints& block, double passes, bool last, Dual& base) {
  const Dual length = block.back().time;
  append_pass(track.points, block, base);
  if (last && passes > 1.0 && block.front().time.value == 0.0) {
    track.repeat_from = base;
    track.repeats = passes - 1.0;
    return;
  }
  const DualPoints again = next_pass(block);
  double done = 1.0;
  for (; done < passes && !(last && done == 2.0); done += 1.0) append_pass(track.points, again, base + done * length);
  if (last && passes > 2.0) {
    track.repeat_from = base + length;
    track.repeats = passes - 2.0;
  }
  base = base + done * length;
}

bool apply_repeat(const PwlCard& card, int parameter, Track& track, Diagnostics& diagnostics) {
  if (!card.repeat_from || *card.repeat_from < 0.0) return true;
  if (*card.repeat_from >= track.points.back().time.value || track.repeats != 0.0) {
    diagnostics.error("E-pwl", card.repeat_span,
                      track.repeats != 0.0 ? "r= and REPEAT exclude each other" : "r= must be less than the last time of the PWL");
    return false;
  }
  track.repeat_from = {*card.repeat_from, entry(card.repeat_gradient, parameter)};
  track.repeats = model::forever;
  return true;
}

std::optional<Track> track_of(const PwlCard& card, int parameter, Diagnostics& diagnostics) {
  Track track;
  Dual base;
  for (std::size_t k = 0; k < card.parts.size(); ++k) {
    const bool last = k + 1 == card.parts.size();
    const std::optional<DualPoints> block = read_part(card.parts[k], parameter, diagnostics);
    if (!block || !check_part(card.parts[k], *block, last, diagnostics)) return std::nullopt;
    append_part(track, *block, card.parts[k].passes, last, base);
  }
  if (track.points.empty()) {
    diagnostics.error("E-missing-value", card.span, fmt::format("a PWL needs at least one time and value; usage: {}", pwl_usage));
    return std::nullopt;
  }
  if (!apply_repeat(card, parameter, track, diagnostics)) return std::nullopt;
  const Dual delay{card.delay, entry(card.delay_gradient, parameter)};
  for (DualPoint& point : track.points) point.time = delay + point.time;
  track.repeat_from = delay + track.repeat_from;
  return track;
}

model::Pwl pwl_of(const Track& track, double Dual::*part) {
  model::Pwl pwl;
  for (const DualPoint& point : track.points) pwl.points.push_back({point.time.*part, point.value.*part});
  pwl.repeat_from = track.repeat_from.*part;
  pwl.repeats = track.repeats;
  return pwl;
}

}  // namespace

std::optional<model::SourceFunction> make_pwl(const PwlCard& card, Diagnostics& diagnostics) {
  const std::optional<Track> track = track_of(card, -1, diagnostics);
  if (!track) return std::nullopt;
  return pwl_of(*track, &Dual::value);
}

std::vector<std::optional<model::SourceFunction>> pwl_derivatives(const PwlCard& card) {
  std::vector<char> moves;
  const auto look = [&](const std::vector<double>& gradient) {
    if (moves.size() < gradient.size()) moves.resize(gradient.size(), 0);
    for (std::size_t k = 0; k < gradient.size(); ++k)
      if (gradient[k] != 0.0) moves[k] = 1;
  };
  for (const PwlPart& part : card.parts)
    for (const PwlPoint& point : part.points) {
      look(point.time_gradient);
      look(point.value_gradient);
    }
  look(card.repeat_gradient);
  look(card.delay_gradient);
  std::vector<std::optional<model::SourceFunction>> derivatives(moves.size());
  Diagnostics told;
  for (std::size_t k = 0; k < moves.size(); ++k)
    if (moves[k] != 0)
      if (const auto track = track_of(card, static_cast<int>(k), told)) derivatives[k] = pwl_of(*track, &Dual::moved);
  return derivatives;
}

}  // namespace pwlsim::elements
