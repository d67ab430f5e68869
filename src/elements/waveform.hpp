#pragma once
/// The waveforms of V and I cards: positional parameters as data, and their conversion to source functions.

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "base/diagnostic.hpp"
#include "elements/parameter.hpp"
#include "model/source_function.hpp"

namespace pwlsim::elements {

/// SIN, PULSE, EXP: numbers by position.
struct WaveformKind {
  std::string_view name;
  std::string_view other_name;  ///< "" if there is none
  std::string_view usage;
  ParameterTable parameters;  ///< in the order of the card
  std::size_t required = 0;   ///< this many must be given
  std::optional<model::SourceFunction> (*make)(const Values&, SourceSpan, Diagnostics&) = nullptr;
};

[[nodiscard]] std::span<const WaveformKind> waveform_kinds();
/// Null for an unknown name, and for PWL, which has no fixed parameters.
[[nodiscard]] const WaveformKind* find_waveform(std::string_view name);

inline constexpr std::string_view pwl_usage = "PWL(t1 v1 t2 v2 ... [r=time] [td=delay]) | PWL REPEAT FOREVER|FOR n (t1 v1 ...) ENDREPEAT";

/// One point of a PWL card; `relative` times (written "+1m") count from the point before.
struct PwlPoint {
  double time = 0.0, value = 0.0;
  bool relative = false;
  SourceSpan span;
  std::vector<double> time_gradient{}, value_gradient{};  ///< to the parameters of .sens
};
/// Points that are repeated `passes` times (infinite: forever). Times count from the end of the part before.
struct PwlPart {
  std::vector<PwlPoint> points;
  double passes = 1.0;
  SourceSpan span;
};
struct PwlCard {
  std::vector<PwlPart> parts;
  std::optional<double> repeat_from;  ///< `r=`; negative: no repetition
  SourceSpan repeat_span;
  double delay = 0.0;  ///< `td=`
  SourceSpan span;
  std::vector<double> repeat_gradient{}, delay_gradient{};
};

/// Errors: no point, times that are negative or decrease, an endless part that is not the last, a repetition without length.
[[nodiscard]] std::optional<model::SourceFunction> make_pwl(const PwlCard& card, Diagnostics& diagnostics);
/// The derivatives of the result of make_pwl to each parameter; empty for parameters without effect on it.
[[nodiscard]] std::vector<std::optional<model::SourceFunction>> pwl_derivatives(const PwlCard& card);

}  // namespace pwlsim::elements
