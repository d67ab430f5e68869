#pragma once
/// Numbers and waveforms, as written on a card.

#include <limits>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace pwlsim {

/// A number, kept to the last bit; or text as a deck has it: "10k", "{2*R}" (an expression of parameters), "inf".
/// Circuit::run reports text that is not a number.
class Value {
 public:
  template <class Number, std::enable_if_t<std::is_arithmetic_v<Number>, int> = 0>
  Value(Number number) : text_(text_of(static_cast<double>(number))) {}
  Value(const char* text) : text_(text) {}
  Value(std::string text) : text_(std::move(text)) {}

  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  /// The shortest decimal text that reads back to `number`.
  static std::string text_of(double number);

  std::string text_;
};

/// `name=value` on a card. docs/reference/elements.md lists names, units, defaults and ranges.
using Parameters = std::vector<std::pair<std::string, Value>>;

/// The waveform of a source: a constant, the result of a function below, or text as a deck has it ("SIN(0 10 50)").
/// Volts or amperes, seconds.
class Waveform {
 public:
  template <class Number, std::enable_if_t<std::is_arithmetic_v<Number>, int> = 0>
  Waveform(Number constant) : value_(constant) {}
  Waveform(const char* text) : value_(text) {}
  Waveform(std::string text) : value_(std::move(text)) {}
  Waveform(Value constant) : value_(std::move(constant)) {}

  [[nodiscard]] const std::string& text() const { return value_.text(); }

 private:
  Value value_;
};

/// offset + amplitude·e^(−damping (t − delay))·sin(2π·frequency (t − delay) + phase); before `delay` it keeps the value it has there.
struct Sine {
  Value offset = 0, amplitude = 1, frequency = 50;  ///< V or A, V or A, Hz
  Value delay = 0, damping = 0, phase = 0;          ///< s, 1/s, degrees
};
[[nodiscard]] Waveform sine(const Sine& sine);

/// Edge n begins at delay + n·period. Rise and fall of 0 are true jumps.
struct Pulse {
  Value low = 0, high = 1;                                ///< V or A
  Value delay = 0, rise = 0, fall = 0;                    ///< s
  Value width = std::numeric_limits<double>::infinity();  ///< s at `high`
  Value period = 0;                                       ///< s; 0: one pulse
};
[[nodiscard]] Waveform pulse(const Pulse& pulse);

/// Straight lines through points (time in s, value); equal times are a jump. The first and the last value apply outside.
/// With `repeat` the waveform up to the last point repeats forever.
[[nodiscard]] Waveform straight_lines(const std::vector<std::pair<double, double>>& points, bool repeat = false);

}  // namespace pwlsim
