#pragma once
/// Differences between the circuit that runs and the one written: parts that were replaced, left out, or read otherwise than by other simulators. Messages report them;
/// this makes a list of them.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostic.hpp"
#include "base/source.hpp"

namespace pwlsim::analysis {

struct Idealisation {
  std::string_view kind;  ///< "replaced", "ignored" or "read otherwise"
  std::string subject;    ///< the text in the deck: a model's name, a parameter, a card
  std::string place;      ///< "buck.net:7", or ""
  std::string text;       ///< the message
};

/// "" for a message that does not report such a difference.
[[nodiscard]] std::string_view departure_kind(std::string_view id);

/// In the order of the messages, without errors.
[[nodiscard]] std::vector<Idealisation> departures(const Diagnostics& diagnostics, const SourceStore& sources);

/// "not as written: 2 replaced, 3 ignored, 1 read otherwise (--verbose lists them)" and a line feed; "" for none.
[[nodiscard]] std::string departures_line(std::span<const Idealisation> list);
/// One line each, in columns: kind, place, subject, message. Ended by a line feed; "" for none.
[[nodiscard]] std::string departures_table(std::span<const Idealisation> list);

/// A JSON array of objects with the members of Idealisation.
[[nodiscard]] std::string departures_json(std::span<const Idealisation> list);

}  // namespace pwlsim::analysis
