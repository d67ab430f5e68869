#pragma once
/// Twisting (hard case 13): x' = v, v' = −2 sgn x − sgn v, which comes to rest at t = 1 + 2/√3 through infinitely many events.

#include <string>

namespace pwlsim::test {

/// The deck from (0, 1). `friction`: a further term of v' as an expression; `tran`: step and stop.
[[nodiscard]] inline std::string twisting_deck(const std::string& friction, const std::string& tran) {
  return "twisting\nB1 0 x I={V(v)}\nC1 x 0 1 ic=0\nB2 0 v I={-2*sgn(V(x)) - sgn(V(v))" + friction +
         "}\nC2 v 0 1 ic=1\n.save v(x) v(v)\n.tran " + tran + " uic\n.end\n";
}

struct Place {
  double x = 0.0, v = 0.0;
};

/// Without friction: v' = −3 until v = 0 after v/3, then v' = −1 until x = 0 again, with the speed −v/√3; and so on, mirrored.
[[nodiscard]] Place twisted(double time);

}  // namespace pwlsim::test
