/// What extremes contribute to derivatives: the members of MeasuredFunctionals that read them.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/measured_derivative.hpp"

namespace pwlsim::analysis {

namespace {

using circuit::Measurement;
using Kind = Measurement::Kind;

}  // namespace

std::string MeasuredFunctionals::event_at(std::size_t instant) const { return sensitivity_.instant_text(instant); }

/// Values that tie count all.
void MeasuredFunctionals::add_extreme(double weight, std::size_t number, bool is_largest, MeasuredFunctional& sum) {
  const Measurement& measurement = run_.measurements->list[number];
  const measure::Place& place = run_.record.places[number];
  const auto known = run_.extremes.find(number);
  std::vector<double> times;
  if (known != run_.extremes.end()) times = is_largest ? known->second.largest : known->second.least;
  if (times.size() < 2) return sum.add(weight, of_extreme(measurement, is_largest ? place.largest_at : place.least_at, is_largest, place));
  MeasuredFunctional::Tie tie;
  tie.weight = weight;
  tie.is_largest = is_largest;
  tie.size = known->second.size;
  tie.why = fmt::format("its {} value occurs at t = {} s and at t = {} s", is_largest ? "largest" : "least", times.front(), times.back());
  // The one that was measured comes first.
  const double measured = is_largest ? place.largest_at : place.least_at;
  std::stable_sort(times.begin(), times.end(), [&](double a, double b) { return std::abs(a - measured) < std::abs(b - measured); });
  for (const double time : times) tie.places.push_back(of_extreme(measurement, time, is_largest, place));
  sum.ties.push_back(std::move(tie));
}

MeasuredFunctional MeasuredFunctionals::of_extreme(const Measurement& measurement, double time, bool is_largest,
                                                   const measure::Place& place) {
  const double near = same_place * run_.stop;
  const bool at_begin = time <= place.from + near, at_end = time >= place.to - near;
  const bool is_period = sensitivity_.is_settled() && place.from <= near && place.to >= run_.stop - near;
  if (is_period && (at_begin || at_end) && sensitivity_.orbit().instants().back().time < run_.stop - near)
    return of_wrap(measurement, is_largest);
  return at_begin || at_end ? of_extreme_at_end(measurement, time, is_largest, at_begin) : of_extreme_inside(measurement, time, is_largest);
}

/// At an instant the value goes with it on the side that is the extreme; elsewhere the time of the extreme does not matter.
MeasuredFunctional MeasuredFunctionals::of_extreme_inside(const Measurement& measurement, double time, bool is_largest) {
  const auto instant = instant_at(time);
  Jet left = jet_of(measurement.expression, time, instant ? Side::left : Side::right);
  if (!instant) return std::move(left.moved);
  Jet right = jet_of(measurement.expression, time, Side::right);
  Jet& taken = (left.value >= right.value) == is_largest ? left : right;
  MeasuredFunctional result = std::move(taken.moved);
  result.sum.add(taken.rate, shift_of(*instant));
  return result;
}

/// At an end of the window the value there counts, and on the side of the parameter on which an instant comes to lie within the window, what that makes of it.
MeasuredFunctional MeasuredFunctionals::of_extreme_at_end(const Measurement& measurement, double time, bool is_largest, bool at_begin) {
  const auto instant = instant_at(time);
  const MeasuredFunctional moves = at_begin ? from_moves(measurement) : to_moves(measurement);
  Jet inside = jet_of(measurement.expression, time, at_begin ? Side::right : Side::left);
  MeasuredFunctional result = std::move(inside.moved);
  result.add(inside.rate, moves);
  if (!instant) return result;
  if (time <= same_place * run_.stop) {
    result.obstacles.push_back({shift_of(*instant), moves.sum, "an edge at t = 0 moves"});
    return result;
  }
  const Jet outside = jet_of(measurement.expression, time, at_begin ? Side::left : Side::right);
  const double step = outside.value - inside.value, towards = is_largest ? 1.0 : -1.0;
  const bool jumps = std::abs(step) > same_value * (std::abs(outside.value) + std::abs(inside.value));
  const std::string why = fmt::format("{}, an end of its window", event_at(*instant));
  if (jumps && step * towards > 0.0) {
    result.obstacles.push_back({shift_of(*instant), moves.sum, "its value jumps: " + why});
    return result;
  }
  // The value outside is no rival where it jumps; else it is one where it grows away from the instant.
  const double away = at_begin ? -outside.rate : outside.rate, rival = !jumps && away * towards > 0.0 ? outside.rate : 0.0;
  MeasuredSum apart = shift_of(*instant);
  apart.add(-1.0, moves.sum);
  result.kinks.push_back({std::move(apart), inside.rate - rival, at_begin ? 1 : -1, why});
  return result;
}

/// At the begin of the period, which is its end.
MeasuredFunctional MeasuredFunctionals::of_wrap(const Measurement& measurement, bool is_largest) {
  Jet left = jet_of(measurement.expression, run_.stop, Side::left), right = jet_of(measurement.expression, 0.0, Side::right);
  const bool is_end = (left.value >= right.value) == is_largest;
  Jet& taken = is_end ? left : right;
  MeasuredFunctional result = std::move(taken.moved);
  result.sum.add(taken.rate, shift_of(0));
  if (is_end) result.sum.stop_moves += taken.rate;
  return result;
}

MeasuredFunctional MeasuredFunctionals::of_extreme_time(std::size_t number, bool is_largest) {
  const Measurement& measurement = run_.measurements->list[number];
  const measure::Place& place = run_.record.places[number];
  const double near = same_place * run_.stop, time = is_largest ? place.largest_at : place.least_at;
  MeasuredFunctional moves;
  const auto known = run_.extremes.find(number);
  const std::size_t ties = known == run_.extremes.end() ? 1 : (is_largest ? known->second.largest : known->second.least).size();
  const auto instant = instant_at(time);
  const bool at_end = time <= place.from + near || time >= place.to - near;
  if (ties > 1)
    moves.failure = "the extreme value occurs more than once";
  else if (instant)
    moves.sum = shift_of(*instant);
  else if (at_end)
    return time <= place.from + near ? from_moves(measurement) : to_moves(measurement);
  else
    moves.failure = "the time of an extreme between events has no derivative here";
  if (instant && at_end) {
    MeasuredFunctional end = time <= place.from + near ? from_moves(measurement) : to_moves(measurement);
    end.obstacles.push_back({shift_of(*instant), end.sum, fmt::format("{}, an end of its window", event_at(*instant))});
    return end;
  }
  return moves;
}

}  // namespace pwlsim::analysis
