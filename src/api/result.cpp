#include <pwlsim/result.hpp>

#include <fmt/format.h>

#include <algorithm>

#include "api/messages.hpp"
#include "api/result_data.hpp"
#include "base/names.hpp"

namespace pwlsim {
namespace {

/// Where a signal is; the number of signals where it is not.
std::size_t place_of(const std::vector<std::string>& signals, std::string_view name) {
  const auto found = std::find_if(signals.begin(), signals.end(), [&](const std::string& other) { return same_name(other, name); });
  return static_cast<std::size_t>(found - signals.begin());
}

Error unknown(std::string_view what, std::string_view name, const std::vector<std::string>& names) {
  const std::string near = nearest_name(name, names);
  return api::error("E-unknown-signal",
                    fmt::format("no {} '{}'; try {}", what, name, near.empty() ? "to save it" : fmt::format("'{}'", near)));
}

}  // namespace

bool Result::completed() const { return data_->completed; }
double Result::end() const { return data_->end; }
const std::vector<double>& Result::time() const { return data_->time; }
const std::vector<std::string>& Result::signals() const { return data_->signals; }
bool Result::has_signal(std::string_view name) const { return place_of(data_->signals, name) < data_->signals.size(); }
const std::vector<Event>& Result::events() const { return data_->events; }
const std::vector<std::string>& Result::on_at_start() const { return data_->on_at_start; }
const std::vector<Measurement>& Result::measurements() const { return data_->measurements; }
const std::vector<Fourier>& Result::fourier() const { return data_->fourier; }
const Certificate& Result::certificate() const { return data_->certificate; }
const Statistics& Result::statistics() const { return data_->statistics; }
const std::vector<Message>& Result::messages() const { return data_->messages; }
const std::vector<std::pair<std::string, double>>& Result::stepped() const { return data_->stepped; }

const std::vector<double>& Result::signal(std::string_view name) const {
  const std::size_t place = place_of(data_->signals, name);
  if (place == data_->signals.size()) throw unknown("signal was saved as", name, data_->signals);
  return data_->columns[place];
}

double Result::measurement(std::string_view name) const {
  std::vector<std::string> names;
  for (const Measurement& each : data_->measurements) {
    names.push_back(each.name);
    if (!same_name(each.name, name)) continue;
    if (each.failure.empty()) return each.value;
    throw api::error("W-measurement-failed", fmt::format("measurement {} failed: {}", each.name, each.failure));
  }
  throw unknown("measurement is named", name, names);
}

}  // namespace pwlsim
