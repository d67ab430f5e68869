#include "analysis/run_json.hpp"

#include <fmt/format.h>

#include "analysis/json.hpp"
#include "analysis/quantity.hpp"
#include "analysis/small_signal_report.hpp"

namespace pwlsim::analysis {
namespace {

std::string text_or_null(const std::string& text) { return text.empty() ? "null" : json_string(text); }

void write_rows(JsonWriter& json, const RunOutcome& outcome, const RunReport& run) {
  if (!outcome.rows) {
    json.member("output", "null");
    return;
  }
  json.member("output", json_line({{"file", json_string(outcome.rows->file)},
                                   {"format", json_string(outcome.rows->format)},
                                   {"rows", std::to_string(run.statistics.rows)},
                                   {"end", json_number(outcome.rows->end)},
                                   {"complete", json_truth(outcome.rows->complete)}}));
}

void write_signals(JsonWriter& json, const std::vector<std::string>& signals) {
  json.key("signals");
  json.begin_array();
  for (const std::string& name : signals) json.value(json_line({{"name", json_string(name)}, {"unit", json_string(unit_of_signal(name))}}));
  json.end_array();
}

/// `values` may have further ones behind those of the signals.
void write_operating_point(JsonWriter& json, const std::vector<std::string>& signals, const std::vector<double>* values) {
  if (values == nullptr) {
    json.member("operating_point", "null");
    return;
  }
  json.key("operating_point");
  json.begin_object();
  for (std::size_t k = 0; k < signals.size(); ++k) json.member(signals[k], json_number((*values)[k]));
  json.end_object();
}

void write_measurements(JsonWriter& json, const measure::Results& results) {
  json.key("measurements");
  json.begin_array();
  for (const measure::Result& result : results.list)
    json.value(json_line({{"name", json_string(result.name)},
                          {"value", result.failure.empty() ? json_number(result.value) : "null"},
                          {"unit", json_string(result.unit)},
                          {"left_out", text_or_null(result.left_out)},
                          {"failure", text_or_null(result.failure)}}));
  json.end_array();
  json.key("fourier");
  json.begin_array();
  for (const measure::FourierResult& result : results.fourier) {
    std::vector<std::string> harmonics;
    for (const measure::Harmonic& h : result.harmonics)
      harmonics.push_back(
          json_line({{"frequency", json_number(h.frequency)}, {"magnitude", json_number(h.magnitude)}, {"phase", json_number(h.phase)}}));
    json.value(json_line({{"signal", json_string(result.column)},
                          {"thd", result.failure.empty() ? json_number(result.total_distortion) : "null"},
                          {"thd_of_listed", result.failure.empty() ? json_number(result.listed_distortion) : "null"},
                          {"failure", text_or_null(result.failure)},
                          {"harmonics", json_line(harmonics)}}));
  }
  json.end_array();
}

void write_parameters(JsonWriter& json, const circuit::Sweeps& sweeps, std::size_t run) {
  const std::vector<double> values = sweeps.point(run);
  json.key("parameters");
  json.begin_object();
  for (std::size_t k = 0; k < values.size(); ++k) json.member(sweeps.list[k].name, json_number(values[k]));
  json.end_object();
}

void write_runs(JsonWriter& json, const SweptRuns& sweep, const std::vector<std::string>& signals) {
  if (sweep.list.empty()) {
    json.member("runs", "null");
    return;
  }
  json.key("runs");
  json.begin_array();
  for (std::size_t k = 0; k < sweep.list.size(); ++k) {
    const SweptRun& run = sweep.list[k];
    json.begin_object();
    write_parameters(json, sweep.sweeps, k);
    json.member("file", text_or_null(run.file));
    json.member("failure", text_or_null(failure_text(run)));
    json.member("end", json_number(run.end));
    json.member("rows", std::to_string(run.rows));
    json.member("events", std::to_string(run.statistics.events));
    write_operating_point(json, signals, run.operating_point.empty() ? nullptr : &run.operating_point);
    write_measurements(json, run.measurements);
    write_orbit(json, run.orbit.get());
    write_small_signals(json, run.small_signal ? &*run.small_signal : nullptr);
    write_derivatives(json, run.sensitivities);
    write_certificate(json, run.certificate);
    json.end_object();
  }
  json.end_array();
}

}  // namespace

std::string run_json(const RunOutcome& outcome, const RunReport& run) {
  JsonWriter json;
  json.begin_object();
  json.member("deck", json_string(outcome.deck));
  json.member("title", text_or_null(outcome.title));
  json.member("status", std::to_string(outcome.status));
  write_rows(json, outcome, run);
  json.member("plot", text_or_null(outcome.plot));
  json.member("report", text_or_null(outcome.report));
  write_signals(json, outcome.signals);
  write_operating_point(json, outcome.signals, outcome.operating_point ? &*outcome.operating_point : nullptr);
  write_measurements(json, outcome.measurements);
  write_orbit(json, outcome.steady_state ? &*outcome.steady_state : nullptr);
  write_small_signals(json, outcome.small_signal ? &*outcome.small_signal : nullptr);
  write_derivatives(json, outcome.sensitivities);
  write_runs(json, outcome.sweep, outcome.signals);
  write_check(json, outcome.check ? &*outcome.check : nullptr);
  json.key("notes");
  json.begin_array();
  for (const std::string& note : run.notes) json.value(json_string(note));
  json.end_array();
  json.member("idealisation", departures_json(run.departures));
  json.key("stats");
  if (run.engine.empty())
    json.value("null");
  else
    write_statistics(json, run);
  json.end_object();
  return json.take();
}

}  // namespace pwlsim::analysis
