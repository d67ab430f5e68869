#pragma once
/// The program's answer beside the independent one of independent.hpp.

#include <string>

#include "property/random_network.hpp"

namespace pwlsim::test {

/// Implicit Euler with steps h, h/2, h/4, h/8 must come towards the program's states. Where a network is too fast for these steps over the
/// whole run (undamped tanks, most of all), windows that are short enough are compared instead: one at the start, and others about
/// edges of the sources, events and an instant in the middle, from the program's states at their beginning; since a passive network never
/// increases the distance of two solutions, every window is a test of its own. Of every state, what a window that was too long leaves unexplained
/// must be seen to move in a shorter one that agrees. Where none of this decides, all steps are made 8 times shorter; at last
/// windows one after the other cover the whole run (a tank that pumps a little each period moves a state far, and in no window). Distances
/// are in the norm of the stored energy, √Σ(C v² + L i²), relative to its largest value in the window.
struct Agreement {
  enum class Kind { agrees, refused, wrong };
  Kind kind = Kind::agrees;
  std::string what, detail;
  int windows = 0;            ///< compared
  bool whole = false;         ///< the whole run was one window
  double difference = 0.0;    ///< largest distance of the program from the solution with h/8
  double extrapolated = 0.0;  ///< largest distance from 2 x(h/8) − x(h/4)
  double order = 0.0;  ///< of that with the largest difference: log₂ of the mean factor by which a halving brings the solutions nearer
};

[[nodiscard]] Agreement compare_with_independent(const RandomNetwork& network);

/// The same with another network given to implicit Euler, of the same stores, sources and switches: to see what the comparison notices, with the
/// longest steps.
[[nodiscard]] Agreement compare_with_independent(const RandomNetwork& network, const RandomNetwork& beside);

/// The network with every part removed that the disagreement does not need.
[[nodiscard]] RandomNetwork smallest_disagreement(const RandomNetwork& network, const Agreement& agreement);

}  // namespace pwlsim::test
