#include <pwlsim/value.hpp>

#include <cmath>

#include "waveform/csv.hpp"

namespace pwlsim {

std::string Value::text_of(double number) {
  if (std::isinf(number)) return number > 0.0 ? "inf" : "-inf";
  return waveform::shortest(number);
}

Waveform sine(const Sine& sine) {
  std::string text = "SIN(";
  for (const Value* value : {&sine.offset, &sine.amplitude, &sine.frequency, &sine.delay, &sine.damping, &sine.phase})
    text += value->text() + " ";
  text.back() = ')';
  return text;
}

Waveform pulse(const Pulse& pulse) {
  std::string text = "PULSE(";
  for (const Value* value : {&pulse.low, &pulse.high, &pulse.delay, &pulse.rise, &pulse.fall, &pulse.width, &pulse.period})
    text += value->text() + " ";
  text.back() = ')';
  return text;
}

Waveform straight_lines(const std::vector<std::pair<double, double>>& points, bool repeat) {
  std::string text = "PWL(";
  for (const auto& [time, value] : points) text += Value(time).text() + " " + Value(value).text() + " ";
  return text + (repeat ? "r=0)" : ")");
}

}  // namespace pwlsim
