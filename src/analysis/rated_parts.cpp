#include "analysis/rated_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/quantity.hpp"
#include "analysis/short_list.hpp"
#include "base/names.hpp"

namespace pwlsim::analysis {
namespace {

constexpr double worth_a_word = 1e-3;  ///< of the run
constexpr std::size_t most_parts = 6;  ///< in the message
constexpr double far_beyond = 3.0;     ///< times the rated current

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
  for (RatedPart& part : parts_) {
    if (part.on) part.seconds += until - time_;
    part.on = part.port < on.size() && on[part.port] != 0;
  }
  time_ = until;
}

std::optional<engine::Remark> RatedParts::remark(double end) {
  count(end, {});
  ShortList list(most_parts);
  for (const RatedPart& part : parts_) {
    if (part.seconds > worth_a_word * end) list.add(fmt::format("{} for {:.2g} % of the run", part.name, 100.0 * part.seconds / end));
  }
  if (list.empty()) return std::nullopt;
  return engine::Remark{
      "W-rated-voltage",
      fmt::format("parts of the models at hand break down at their rated voltage: {}; LTspice's models of such parts block any voltage; "
                  "try parts for a higher voltage, or their own .model cards",
                  list.str())};
}

RatedCurrents::RatedCurrents(const std::vector<circuit::RatedCurrent>& rated, const std::vector<std::string>& columns) {
  for (const circuit::RatedCurrent& each : rated)
    for (std::size_t k = 1; k < columns.size(); ++k)
      if (same_name(columns[k], fmt::format("i({})", each.element))) columns_.push_back({k, &each});
}

void RatedCurrents::add(std::span<const double> rows, std::size_t columns) {
  if (columns_.empty()) return;
  for (std::size_t row = 0; row < rows.size(); row += columns)
    for (Column& column : columns_) column.sum += std::abs(rows[row + column.index]);
  rows_ += static_cast<double>(rows.size() / columns);
}

std::optional<engine::Remark> RatedCurrents::remark() const {
  ShortList list(most_parts);
  for (const Column& column : columns_) {
    const double mean = column.sum / rows_;
    if (mean > far_beyond * column.rated->amperes)
      list.add(
          fmt::format("{} with {}, rated for {}", column.rated->element, quantity(mean, "A", 2), quantity(column.rated->amperes, "A", 2)));
  }
  if (list.empty()) return std::nullopt;
  return engine::Remark{"W-rated-current",
                        fmt::format("parts of the models at hand carry, on average over the rows, far more than they are rated for: {}; "
                                    "their straight lines are valid near the rating; try larger parts, or their own .model cards",
                                    list.str())};
}

}  // namespace pwlsim::analysis
