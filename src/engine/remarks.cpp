#include "engine/remarks.hpp"

#include <fmt/format.h>

namespace pwlsim::engine {

Remark doubtful_certificate(double worst) {
  return {"W-certificate",
          fmt::format("the certificate's worst residual is {:.1e}: do not trust this run beyond that; parts of the circuit "
                      "are too fast, or too far apart in size, for double precision",
                      worst)};
}

Remark projected_start() {
  return {"W-start-projected",
          "the initial values contradict the circuit; they are projected at t = 0 as any jump, conserving charge and flux"};
}

}  // namespace pwlsim::engine
