#include "elements/waveform.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace pwlsim::elements {
namespace {

using Points = std::vector<model::Pwl::Point>;

constexpr double largest_expansion = 1e7;  // points of finite repetitions written out

void append(Points& points, const model::Pwl::Point& point) {
  const bool repeated = !points.empty() && points.back().time == point.time && points.back().value == point.value;
  if (!repeated) points.push_back(point);
}

void append_pass(Points& points, const Points& block, double base) {
  for (const auto& point : block) append(points, {base + point.time, point.value});
}

/// Times made absolute within the part; empty where they are negative or decrease.
std::optional<Points> read_part(const PwlPart& part, Diagnostics& diagnostics) {
  Points points;
  double last = 0.0;
  for (const PwlPoint& point : part.points) {
    const double time = point.relative ? last + point.time : point.time;
    if (time < last) {
      diagnostics.error("E-pwl-order", point.span,
                        last == 0.0 ? fmt::format("the time {} s is negative", time)
                                    : fmt::format("the times of a PWL must not decrease: {} s follows {} s", time, last));
      return std::nullopt;
    }
    points.push_back({time, point.value});
    last = time;
  }
  return points;
}

bool check_part(const PwlPart& part, const Points& block, bool last, Diagnostics& diagnostics) {
  const char* complaint = nullptr;
  if (block.empty())
    complaint = "a PWL needs at least one time and value";
  else if (part.passes != 1.0 && block.back().time <= 0.0)
    complaint = "a repeated part of a PWL needs a length: its last time is 0";
  else if (std::isinf(part.passes) && !last)
    complaint = "nothing may follow a part that is repeated forever";
  else if (!std::isinf(part.passes) && part.passes * static_cast<double>(block.size()) > largest_expansion && !last)
    complaint = "this repetition has more than 1e7 points";
  if (complaint != nullptr) diagnostics.error("E-pwl", part.span, complaint);
  return complaint == nullptr;
}

/// A later pass begins where the one before ended, so a block that starts after 0 is led there by a straight line.
Points next_pass(const Points& block) {
  Points points;
  if (block.front().time > 0.0) points.push_back({0.0, block.back().value});
  points.insert(points.end(), block.begin(), block.end());
  return points;
}

/// The first pass is written out; of the others one is written where the model repeats it, all where more follows.
void append_part(model::Pwl& pwl, const Points& block, double passes, bool last, double& base) {
  const double length = block.back().time;
  append_pass(pwl.points, block, base);
  if (last && passes > 1.0 && block.front().time == 0.0) {
    pwl.repeat_from = base;
    pwl.repeats = passes - 1.0;
    return;
  }
  const Points again = next_pass(block);
  double done = 1.0;
  for (; done < passes && !(last && done == 2.0); done += 1.0) append_pass(pwl.points, again, base + done * length);
  if (last && passes > 2.0) {
    pwl.repeat_from = base + length;
    pwl.repeats = passes - 2.0;
  }
  base += done * length;
}

bool apply_repeat(const PwlCard& card, model::Pwl& pwl, Diagnostics& diagnostics) {
  if (!card.repeat_from || *card.repeat_from < 0.0) return true;
  if (*card.repeat_from >= pwl.points.back().time || pwl.repeats != 0.0) {
    diagnostics.error("E-pwl", card.repeat_span,
                      pwl.repeats != 0.0 ? "r= and REPEAT exclude each other" : "r= must lie before the last time of the PWL");
    return false;
  }
  pwl.repeat_from = *card.repeat_from;
  pwl.repeats = model::forever;
  return true;
}

void delay(model::Pwl& pwl, double by) {
  for (auto& point : pwl.points) point.time += by;
  pwl.repeat_from += by;
}

}  // namespace

std::optional<model::SourceFunction> make_pwl(const PwlCard& card, Diagnostics& diagnostics) {
  model::Pwl pwl;
  double base = 0.0;
  for (std::size_t k = 0; k < card.parts.size(); ++k) {
    const bool last = k + 1 == card.parts.size();
    const std::optional<Points> block = read_part(card.parts[k], diagnostics);
    if (!block || !check_part(card.parts[k], *block, last, diagnostics)) return std::nullopt;
    append_part(pwl, *block, card.parts[k].passes, last, base);
  }
  if (pwl.points.empty()) {
    diagnostics.error("E-missing-value", card.span, fmt::format("a PWL needs at least one time and value; usage: {}", pwl_usage));
    return std::nullopt;
  }
  if (!apply_repeat(card, pwl, diagnostics)) return std::nullopt;
  delay(pwl, card.delay);
  return pwl;
}

}  // namespace pwlsim::elements
