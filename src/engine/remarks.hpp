#pragma once
/// Remarks that every engine makes in the same words.

#include <string>
#include <vector>

#include "engine/run.hpp"

namespace pwlsim::engine {

/// W-certificate: `worst` is the residual that is doubtful.
[[nodiscard]] Remark doubtful_certificate(double worst);

/// W-start-projected: of the whole circuit.
[[nodiscard]] Remark projected_start();

inline constexpr const char* no_operating_point = "E-no-operating-point";
/// W-no-operating-point: `what` has none.
[[nodiscard]] Remark starts_without_operating_point(const std::string& what);

/// Sides of ports for Answer::mode. Ports of one element are adjacent; the element is on if one of them is.
class ModeText {
 public:
  void add(const std::string& name, bool is_on);
  /// "D1, S2 on, D3 off"; a long list is cut and counted.
  [[nodiscard]] std::string str() const;

 private:
  struct Side {
    std::string name;
    bool is_on = false;
  };
  [[nodiscard]] std::string side(bool is_on) const;

  std::vector<Side> sides_;
};

}  // namespace pwlsim::engine
