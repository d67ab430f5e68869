/// PartRun: the jumps with which exact segments begin, and their impulses.
#include <algorithm>
#include <cmath>

#include "base/arithmetic.hpp"
#include "engine/sparse/part_run.hpp"
#include "engine/sparse/tolerances.hpp"

namespace pwlsim::engine::sparse {

namespace {

/// States that jump move, all together, by more than so many errors of the segment.
constexpr double least_errors = 10.0;

}  // namespace

/// The jump with which the segment begins, to first_.
PartRun::Sought PartRun::take_jump_of(const Point& step, double h) {
  const std::vector<double> impulses = segment_->impulses(), whole = segment_->first_unknowns();
  const double length = segment_->step_length();
  if (!trusts_jumps_ && !is_jump_of(step.on)) {
    refused_jumps_.push_back(step.on);
    return Sought::not_found;
  }
  const Sought sought = take_step_of_jump(step, h);
  if (sought == Sought::jumped) add_impulses(impulses, whole, length);
  return sought;
}

/// Where impulses leave no digits in a segment that begins before the jump.
PartRun::Sought PartRun::jump_by_step(const Point& step, double h) {
  if (starting_ && !given_jumps_)
    return Sought::not_found;  // what is given may be moved by what is fast alone: shorter segments follow that
  const double longest = std::max(room(), break_tolerance_);
  const double length = segment_->step(factors_, {point_.time, step.on, point_.z, start_memory_, longest}, first_.z);
  if (length == 0.0 || !(difference(states_, first_.z) > tolerance::jump)) return Sought::not_found;
  const std::vector<double> none;
  if (segment_->open(factors_, {point_.time, step.on, first_.z, none, longest, length}) != ExactSegment::Opened::yes)
    return Sought::not_found;
  const std::vector<double> whole = first_.z;
  std::vector<double> impulses;
  segment_->unknowns(segment_->at(0.0), impulses);
  for (std::size_t i = 0; i < impulses.size(); ++i) impulses[i] = whole[i] - impulses[i];
  if (!backward_impulses(impulses, whole, step.on, tolerance::visible_impulse).empty() || !segment_->take_back(length, first_.z))
    return Sought::not_found;
  const Sought sought = take_step_of_jump(step, h);
  if (sought == Sought::jumped) add_impulses(impulses, whole, length);
  return sought;
}

/// Of a jump with which an Euler step begins: what it delivers is the step's length times what impulses make of its end.
void PartRun::add_impulses(const std::vector<double>& impulses, const std::vector<double>& whole, double length) {
  if (request_.probes.sink == nullptr) return;
  jump_impulses_.resize(impulses.size(), 0.0);
  jump_terms_.resize(impulses.size(), 0.0);
  for (std::size_t i = 0; i < impulses.size(); ++i) {
    jump_impulses_[i] += length * impulses[i];
    jump_terms_[i] += length * whole[i];
  }
}

/// The run stands after a jump, in the position of it; what flows there is to be found.
PartRun::Sought PartRun::take_step_of_jump(const Point& step, double h) {
  start_memory_.clear();
  segment_->note_jump(std::max(ports_.largest_voltage(point_.z), ports_.largest_voltage(first_.z)));
  const std::vector<double> first = point_.z = std::move(first_.z);
  // once more, from there: what is left of impulses is rounding of far smaller ones
  if (open_segment(step.on) != ExactSegment::Opened::yes) return Sought::not_found;
  segment_->unknowns(segment_->at(0.0), point_.z);
  descriptor_.measure_states(first.data(), states_);
  if (difference(states_, point_.z) > tolerance::second_jump) return Sought::not_found;
  descriptor_.measure_states(point_.z.data(), states_);
  descriptor_.forget_currents(point_.z);
  first_ = step;
  if (request_.jumps && stepper_.euler(first_, h, second_) == Solved::yes) jump_steps_ = {first_, second_};  // for what is told of it
  jumps_taken_.push_back(step.on);
  return Sought::jumped;
}

/// Ports of which a jump in that position asks what they do not do: conduct an impulse backwards, or block one forwards, by so much of the largest in a current, or
/// in a voltage. `whole`: the end of the step that the impulses are a part of.
std::vector<std::size_t> PartRun::backward_impulses(const std::vector<double>& impulses, const std::vector<double>& whole,
                                                    const Position& on, double share) const {
  const auto nodes = static_cast<std::size_t>(descriptor_.nodes());
  const double other = tolerance::other_rounding * largest(whole);
  const auto rounding = [&](auto largest_of) {
    return std::max({share * largest_of(impulses), tolerance::step_rounding * largest_of(whole), other});
  };
  const double voltage = rounding([&](const std::vector<double>& z) { return largest(std::span(z).first(nodes)); });
  const double input = rounding([&](const std::vector<double>& z) {
    double most = 0.0;
    for (const DescriptorPort& port : descriptor_.ports()) most = std::max(most, std::abs(z[static_cast<std::size_t>(port.row)]));
    return most;
  });
  std::vector<std::size_t> ports;
  for (std::size_t i = 0; i < static_cast<std::size_t>(descriptor_.first_switch()); ++i) {
    const DescriptorPort& port = descriptor_.ports()[i];
    if (!port.blocks(on) && port.response(on[i] != 0, impulses.data()) < -(on[i] != 0 ? input : voltage)) ports.push_back(i);
  }
  return ports;
}

/// Whether the jump with which the segment begins, to first_, is one of the position. In the Euler step that found it, what flows in its length may have hidden an
/// impulse backwards: a capacitor that a current discharges in a short time does not jump. One that is backwards by rounding leads where it does with the other sides.
bool PartRun::is_jump_of(const Position& on) {
  const double same = tolerance::same_jump * segment_->relaxation();
  const std::vector<double> impulses = segment_->impulses(), whole = segment_->first_unknowns();
  const std::vector<std::size_t> backward = backward_impulses(impulses, whole, on, tolerance::impulse_rounding);
  if (backward.empty()) return true;
  Position other = on;
  for (const std::size_t i : backward) other[i] ^= 1;
  descriptor_.hold_blocked(other);
  if (open_segment(other) != ExactSegment::Opened::yes) return backward_impulses(impulses, whole, on, tolerance::visible_impulse).empty();
  std::vector<double> z;
  segment_->unknowns(segment_->at(0.0), z);
  return segment_->distance(first_.z, z) <= same;
}

/// Whether the segment that is open begins with the states of the instant. Leaves the Euler steps as they are.
bool PartRun::is_continuous() {
  std::vector<double> z;
  segment_->unknowns(segment_->at(0.0), z);
  return !moves(states_, point_.z, z);
}

double PartRun::least_distance() const { return std::max(tolerance::jump_energy, least_errors * segment_->relative_error()); }

/// Whether states, those of `from`, move beyond rounding.
bool PartRun::moves(const std::vector<double>& states, const std::vector<double>& from, const std::vector<double>& to) const {
  return difference(states, to) > tolerance::jump && segment_->distance(from, to) > least_distance();
}

void PartRun::note_start_jumps(const std::vector<double>& states, const std::vector<double>& z) {
  descriptor_.measure_states(z.data(), start_jumps_);
  for (std::size_t i = 0; i < states.size(); ++i) start_jumps_[i] = std::abs(start_jumps_[i] - states[i]);
}

bool PartRun::start_projected() const {
  if (start_jumps_.empty()) return start_projected_;
  for (std::size_t i = 0; i < start_jumps_.size(); ++i)
    if (start_jumps_[i] > tolerance::jump * scale_.size(i, point_.z)) return true;
  return false;
}

void PartRun::note_segment_impulses() {
  impulses_.assign(signals_.size(), 0.0);
  if (jump_impulses_.empty()) return;
  std::vector<double> most(jump_impulses_.size());
  const auto nodes = static_cast<std::ptrdiff_t>(descriptor_.nodes());
  const std::span all(jump_impulses_);
  std::fill(most.begin(), most.begin() + nodes, largest(all.first(static_cast<std::size_t>(nodes))));
  std::fill(most.begin() + nodes, most.end(), largest(all.subspan(static_cast<std::size_t>(nodes))));
  for (std::size_t i = 0; i < signals_.size(); ++i) {
    const auto& form = signals_[i].z;
    const double impulse = Form::sum(form, jump_impulses_.data());
    const double terms = std::max(Form::size_of(form, jump_terms_.data()), Form::size_of(form, most.data()));
    if (std::abs(impulse) > tolerance::step_rounding * terms) impulses_[i] = impulse;
  }
}

}  // namespace pwlsim::engine::sparse
