#include "engine/sparse/transient.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace pwlsim::engine::sparse {

namespace {

using Clock = std::chrono::steady_clock;

constexpr double merge_fraction = 1e-14;
constexpr std::size_t rows_per_block = 256;
constexpr int steps_between_checks = 64;
/// Residuals beyond so many tolerances are told; those of diodes that changed sides within the tolerance are below it.
constexpr double doubtful_tolerances = 10.0;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

}  // namespace

Transient::Transient(const model::Network& network, const Descriptor& descriptor, const Request& request, double reltol, RowSink& sink)
    : network_(network), request_(request), reltol_(reltol), sink_(sink), block_(network, descriptor, request, reltol) {
  width_ = 1 + network.signals.size();
  rows_.resize(rows_per_block * width_);
  tolerance_ = merge_fraction * request.stop;
  if (request.grid.rows > 0) row_time_ = first_row_time_ = request.grid.time(0);
}

bool Transient::begin() {
  const Start start = request_.use_initial_conditions ? start_from_initial_values(network_, block_.descriptor())
                                                      : start_from_operating_point(network_, block_.descriptor());
  answer_ = start.answer;
  if (answer_.outcome != Outcome::completed) return false;
  if (!block_.begin(start)) return false;
  if (block_.start_projected() && request_.use_initial_conditions)
    answer_.remarks.push_back(
        {"W-start-projected",
         "the initial values contradict the circuit; they are projected at t = 0 as any jump, conserving charge and flux"});
  return true;
}

Answer Transient::run() {
  const auto clock = Clock::now();
  bool going = begin();
  for (int count = 0; going; ++count) {
    if (block_.finished()) break;
    going = rows_before(block_.time(), false) && block_.advance() && event_rows();
    if (going && count % steps_between_checks == 0) {
      if (request_.progress) request_.progress(block_.time());
      going = !interrupted();
    }
  }
  const Answer& failure = block_.failure();
  if (!failure.id.empty() && answer_.outcome == Outcome::completed) {
    answer_.outcome = failure.outcome;
    answer_.id = failure.id;
    answer_.message = failure.message;
    answer_.elements = failure.elements;
  }
  if (answer_.outcome == Outcome::completed && going) rows_before(request_.stop, true);
  flush();
  answer_.time = std::min(block_.time(), request_.stop);
  answer_.statistics.seconds_simulate = seconds_since(clock) - sink_seconds_;
  finish();
  return std::move(answer_);
}

bool Transient::interrupted() {
  if (!request_.interrupt || request_.interrupt->load(std::memory_order_relaxed) == 0) return false;
  answer_.outcome = Outcome::interrupted;
  answer_.id = "E-interrupted";
  answer_.message = fmt::format("stopped at t = {} s by a signal", block_.time());
  return true;
}

/// A row within rounding of an instant holds the values after it.
bool Transient::rows_before(double time, bool inclusive) {
  const double limit = inclusive ? time : time - tolerance_;
  while (next_row_ < request_.grid.rows && (row_time_ < limit || (inclusive && row_time_ <= limit))) {
    if (std::abs(last_event_row_ - row_time_) > tolerance_) {
      double* row = &rows_[buffered_ * width_];
      row[0] = row_time_;
      block_.signals(row_time_, row + 1);
      if (!push_row()) return false;
    }
    ++next_row_;
    if (next_row_ < request_.grid.rows) row_time_ = request_.grid.time(next_row_);
  }
  return true;
}

bool Transient::event_rows() {
  if (!request_.events || !block_.instant() || block_.instant()->time < first_row_time_ - tolerance_) return true;
  const double time = block_.instant()->time;
  const bool on_grid = next_row_ < request_.grid.rows && std::abs(row_time_ - time) <= tolerance_;
  last_event_row_ = on_grid ? row_time_ : time;
  double* row = &rows_[buffered_ * width_];
  row[0] = last_event_row_;
  std::copy(block_.signals_before().begin(), block_.signals_before().end(), row + 1);
  if (!push_row()) return false;
  row = &rows_[buffered_ * width_];
  row[0] = last_event_row_;
  block_.signals(time, row + 1);
  return push_row();
}

bool Transient::push_row() {
  ++answer_.statistics.rows;
  return ++buffered_ < rows_per_block || (flush() && !interrupted());
}

bool Transient::flush() {
  if (buffered_ == 0) return true;
  const auto clock = Clock::now();
  const bool accepted = sink_.write({rows_.data(), buffered_ * width_}, buffered_);
  sink_seconds_ += seconds_since(clock);
  buffered_ = 0;
  if (!accepted && answer_.outcome == Outcome::completed) answer_.outcome = Outcome::sink_stopped;
  return accepted;
}

void Transient::finish() {
  answer_.statistics.islands = 1;
  block_.add_statistics(answer_.statistics);
  const auto clock = Clock::now();
  Certificate& c = answer_.certificate;
  c = block_.certificate().check();
  if (std::max(c.complementarity, c.kcl_kvl) > doubtful_tolerances * reltol_)
    answer_.remarks.push_back(
        {"W-certificate", fmt::format("the certificate's worst residual is {:.1e}: do not trust this run beyond that; parts of the circuit "
                                      "are too fast, or too far apart in size, for double precision",
                                      std::max(c.complementarity, c.kcl_kvl))});
  c.has_passivity = c.passive = block_.descriptor().passive();
  if (!c.passive)
    answer_.remarks.push_back(
        {"N-not-examined",
         "the circuit holds controlled sources or blocks that may feed energy in, so that its solution need not be the only "
         "one; the sparse engine takes the one it finds, --engine exact examines it"});
  answer_.statistics.seconds_certificate = seconds_since(clock);
}

}  // namespace pwlsim::engine::sparse
