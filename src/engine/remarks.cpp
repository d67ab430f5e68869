#include "engine/remarks.hpp"

#include <fmt/format.h>

namespace pwlsim::engine {

Remark doubtful_certificate(double worst) {
  return {"W-certificate", fmt::format("the certificate's worst residual is {:.1e}: trust no more digits than that; parts of the circuit "
                                       "are too fast, or too far apart in size, for double precision",
                                       worst)};
}

Remark projected_start() {
  return {"W-start-projected",
          "the initial values contradict the circuit; they are projected at t = 0 like any jump, conserving charge and flux"};
}

Remark starts_without_operating_point(const std::string& what) {
  return {"W-no-operating-point", what + ". It starts from the values of .ic, and from zero elsewhere; try uic, which also uses ic="};
}

void ModeText::add(const std::string& name, bool is_on) {
  if (sides_.empty() || sides_.back().name != name) sides_.push_back({name, false});
  sides_.back().is_on |= is_on;
}

std::string ModeText::side(bool is_on) const {
  constexpr std::size_t most_names = 8;
  std::vector<std::string> names;
  for (const Side& side : sides_)
    if (side.is_on == is_on) names.push_back(side.name);
  const std::size_t more = names.size() > most_names ? names.size() - most_names : 0;
  names.resize(names.size() - more);
  std::string text = fmt::format("{}", fmt::join(names, ", "));
  if (more > 0) text += fmt::format(" and {} more", more);
  if (!text.empty()) text += is_on ? " on" : " off";
  return text;
}

std::string ModeText::str() const {
  const std::string on = side(true), off = side(false);
  return on + (on.empty() || off.empty() ? "" : ", ") + off;
}

}  // namespace pwlsim::engine
