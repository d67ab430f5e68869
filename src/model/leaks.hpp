#pragma once
/// Resistors at potentials to which otherwise only inductors connect.
///
/// A leak R from such a potential to the rest makes a rate R/L of 10¹⁵ s⁻¹ and more in A itself: in extended precision its rounding is a voltage, that of a current
/// times R, and the slow rates of a mode lose as many digits. As a port that never conducts, with R beside it, the leak is in D instead: A has the rates of a
/// network whose leak is a wire, and the slow motion (slow_manifold.hpp) comes from R/D without any large number. Both describe the same network.

#include "model/network.hpp"

namespace pwlsim::model {

/// Of √(L/C). Why: with smaller ones A is not stiff, and nothing is gained.
inline constexpr double least_leak = 1e6;
/// 1/s, of R/L where there is no C. Why: below it the rounding of extended precision leaves slow rates right to 10⁻¹⁰ 1/s.
inline constexpr double least_rate = 1e9;

/// A diode that blocks for good (Diode::blocks) is put beside each leak of a tree of leaks between parts that capacitors, sources, smaller resistors, diodes and
/// contacts hold together, where an inductor crosses the cut that the leak closes.
void put_ports_beside_leaks(Network& network);
/// The network as it was: nothing but a mode of the dense engine keeps these diodes from conducting.
[[nodiscard]] Network without_ports_of_leaks(Network network);

}  // namespace pwlsim::model
