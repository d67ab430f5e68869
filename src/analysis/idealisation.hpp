#pragma once
/// Where the circuit that runs is not the one written: what was replaced, left out or read otherwise than other simulators read it. Told by messages;
/// here they are a list.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostic.hpp"
#include "base/source.hpp"

namespace pwlsim::analysis {

struct Departure {
  std::string_view kind;  ///< "replaced", "ignored" or "read otherwise"
  std::string subject;    ///< what stands in the deck there: a model's name, a parameter, a card
  std::string place;      ///< "buck.net:7", or ""
  std::string text;       ///< the message
};

/// "" for a message that tells of none.
[[nodiscard]] std::string_view departure_kind(std::string_view id);

/// In the order of the messages; errors tell of none.
[[nodiscard]] std::vector<Departure> departures(const Diagnostics& diagnostics, const SourceStore& sources);

/// "not as written: 2 replaced, 3 ignored, 1 read otherwise (--verbose lists them)" and a line feed; "" for none.
[[nodiscard]] std::string departures_line(std::span<const Departure> list);
/// One line each, in columns: kind, place, subject, message. Ended by a line feed; "" for none.
[[nodiscard]] std::string departures_table(std::span<const Departure> list);

/// A JSON array of objects with the members of Departure.
[[nodiscard]] std::string departures_json(std::span<const Departure> list);

}  // namespace pwlsim::analysis
