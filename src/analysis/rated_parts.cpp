#include "analysis/rated_parts.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace pwlsim::analysis {
namespace {

constexpr double worth_a_word = 1e-3;  ///< of the run
constexpr std::size_t most_parts = 6;  ///< in the message

}  // namespace

void RatedParts::begin(std::span<const std::string> elements, std::span<const char> on) {
  for (std::size_t port = 0; port < elements.size(); ++port) {
    const std::string& name = elements[port];
    if (std::find(ports_.begin(), ports_.end(), name) != ports_.end()) parts_.push_back({port, name.substr(0, name.find(' ')), false, 0.0});
  }
  count(0.0, on);
  if (next_ != nullptr) next_->begin(elements, on);
}

void RatedParts::happened(const engine::Event& event, std::span<const char> on) {
  count(event.time, on);
  if (next_ != nullptr) next_->happened(event, on);
}

void RatedParts::count(double until, std::span<const char> on) {
  for (Part& part : parts_) {
    if (part.on) part.seconds += until - time_;
    part.on = part.port < on.size() && on[part.port] != 0;
  }
  time_ = until;
}

std::optional<engine::Remark> RatedParts::remark(double end) {
  count(end, {});
  std::string list;
  std::size_t number = 0;
  for (const Part& part : parts_) {
    if (!(part.seconds > worth_a_word * end)) continue;
    if (++number <= most_parts)
      list += fmt::format("{}{} for {:.2g} % of the run", number > 1 ? ", " : "", part.name, 100.0 * part.seconds / end);
  }
  if (number == 0) return std::nullopt;
  if (number > most_parts) list += fmt::format(" and {} more", number - most_parts);
  return engine::Remark{
      "W-rated-voltage",
      fmt::format("parts of the models at hand break down at their rated voltage: {}; LTspice's models of such parts block any voltage; "
                  "try parts for a higher voltage, or .model cards of their own",
                  list)};
}

}  // namespace pwlsim::analysis
