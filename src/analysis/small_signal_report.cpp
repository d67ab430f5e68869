#include "analysis/small_signal_report.hpp"

#include <fmt/format.h>

#include <cmath>

#include "analysis/quantity.hpp"
#include "waveform/csv.hpp"

namespace pwlsim::analysis {

namespace {

using Complex = std::complex<double>;

}  // namespace

std::string small_signal_csv(const SmallSignalResult& result) {
  std::string text = "frequency";
  for (const SmallSignalResult::Column& column : result.columns) text += ',' + waveform::csv_field(column.name);
  return text + '\n' + small_signal_rows(result);
}

std::string small_signal_rows(const SmallSignalResult& result, const std::string& prefix) {
  std::string text;
  for (std::size_t k = 0; k < result.frequencies.size(); ++k) {
    text += fmt::format("{}{}", prefix, result.frequencies[k]);
    for (const SmallSignalResult::Column& column : result.columns) {
      text += ',';
      if (std::isfinite(column.values[k])) text += fmt::format("{}", column.values[k]);
    }
    text += '\n';
  }
  return text;
}

std::string small_signal_summary(const SmallSignalResult& result, const std::string& file) {
  std::string text = fmt::format("ac response in {}: {} from {} to {}", file, counted(result.frequencies.size(), "point"),
                                 quantity(result.frequencies.front(), "Hz"), quantity(result.frequencies.back(), "Hz"));
  if (result.loop) {
    for (const auto& at : result.loop->crossovers)
      text += fmt::format("; crossover at {} with a phase margin of {:.4g} degrees", quantity(at.frequency, "Hz", 4), at.phase_margin);
    for (const auto& at : result.loop->gain_margins)
      text += fmt::format("; gain margin {:.4g} dB at {}", at.decibels, quantity(at.frequency, "Hz", 4));
  }
  return text + '\n';
}

namespace {

std::string list_of(const std::vector<double>& numbers) {
  std::vector<std::string> list;
  for (const double number : numbers) list.push_back(json_number(number));
  return json_line(list);
}

std::string parts_of(const std::vector<Complex>& values, double (*part)(const Complex&)) {
  std::vector<double> numbers;
  for (const Complex& value : values) numbers.push_back(part(value));
  return list_of(numbers);
}

std::string real_parts(const std::vector<Complex>& values) {
  return parts_of(values, [](const Complex& c) { return c.real(); });
}

std::string imaginary_parts(const std::vector<Complex>& values) {
  return parts_of(values, [](const Complex& c) { return c.imag(); });
}

std::string loop_line(const LoopGain& loop) {
  std::vector<std::string> crossovers, margins;
  for (const auto& c : loop.crossovers)
    crossovers.push_back(json_line({{"frequency", json_number(c.frequency)}, {"phase_margin", json_number(c.phase_margin)}}));
  for (const auto& m : loop.gain_margins)
    margins.push_back(json_line({{"frequency", json_number(m.frequency)}, {"decibels", json_number(m.decibels)}}));
  return json_line({{"source", json_string(loop.source)},
                    {"re", real_parts(loop.values)},
                    {"im", imaginary_parts(loop.values)},
                    {"crossovers", json_line(crossovers)},
                    {"gain_margins", json_line(margins)}});
}

}  // namespace

void write_small_signals(JsonWriter& json, const SmallSignalResult* result) {
  if (result == nullptr) return json.member("ac", "null");
  json.key("ac");
  json.begin_object();
  json.member("frequencies", list_of(result->frequencies));
  json.key("signals");
  json.begin_array();
  for (std::size_t s = 0; s < result->signals.size(); ++s) {
    std::vector<Complex> values;
    for (std::size_t k = 0; k < result->frequencies.size(); ++k) values.push_back(result->values[k][s]);
    json.value(json_line({{"name", json_string(result->signals[s])}, {"re", real_parts(values)}, {"im", imaginary_parts(values)}}));
  }
  json.end_array();
  json.key("loops");
  json.begin_array();
  if (result->loop) json.value(loop_line(*result->loop));
  json.end_array();
  json.end_object();
}

}  // namespace pwlsim::analysis
