#pragma once
/// Integrals, derivatives and rational functions of s in A elements and expressions. A state is the voltage of a capacitor at an inner
/// node that the injected current moves: of less than 1 F, with currents scaled alike. `part` names the inner nodes of an
/// element that has several of them.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "elements/emission.hpp"
#include "elements/moving_form.hpp"
#include "elements/twin.hpp"

namespace pwlsim::elements {

/// ∫ input dt, from `start` at the operating point and at the start with uic. The integral stops at the bounds until the input turns.
struct Integral {
  Varied start;
  double least = -infinite, most = infinite;
};
/// The integral stays at its start value while `control` is above the level.
struct Hold {
  MovingForm control;
  double level = 0.0;
};
/// The jumps of an integral: to its start value, or from one end of a range to the other. Equal ends mean no range.
struct Resets {
  std::optional<Hold> hold{};
  double from = 0.0, to = 0.0;
};
[[nodiscard]] model::LinearForm add_integral(Emission& emission, std::string_view part, const MovingForm& input, const Integral& integral,
                                             const Resets& resets = {});
[[nodiscard]] std::string twin_integral(Twin& twin, std::string_view part, std::string_view input, const Integral& integral);

[[nodiscard]] model::LinearForm add_derivative(Emission& emission, std::string_view part, const MovingForm& input);
[[nodiscard]] std::string twin_derivative(Twin& twin, std::string_view part, std::string_view input);

/// The fraction in p = s/(rate·unit), powers ascending, both of length order + 1.
struct CanonicalForm {
  double rate = 1.0;  ///< 1/s: makes the largest coefficient of the monic denominator one, a number that does not move
  std::vector<Varied> num, den;
};
[[nodiscard]] CanonicalForm canonical_form(const RationalFunction& fraction);

/// A proper fraction, s in units of `unit` 1/s; its states start at their DC values.
[[nodiscard]] MovingForm add_transfer(Emission& emission, std::string_view part, const RationalFunction& fraction, double unit,
                                      const MovingForm& input);
[[nodiscard]] std::string twin_transfer(Twin& twin, std::string_view part, const RationalFunction& fraction, double unit,
                                        std::string_view input);

}  // namespace pwlsim::elements
