#pragma once
/// Models at hand: common devices, lib/devices.txt. A model that a deck uses and nowhere defines is taken from there, with a note.

#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "circuit/definitions.hpp"
#include "circuit/device.hpp"
#include "circuit/reporter.hpp"
#include "netlist/ast.hpp"

namespace pwlsim::circuit {

/// The device that `name` means: of that name, or the longest name of the table that it begins with (devices.txt says when); none otherwise.
[[nodiscard]] std::optional<Device> find_device(std::string_view name);

/// All names of the table but those of a pattern.
[[nodiscard]] std::vector<std::string> device_names();

/// lib/devices.txt.
[[nodiscard]] std::string_view device_table();

/// What was taken from the table: for each card where its numbers come from.
using DeviceSources = std::unordered_map<const netlist::Card*, std::string>;

/// The name of the text in which they stand.
inline constexpr std::string_view device_models_file = "pwlsim's models";

/// Models of D, Q, M and J cards that are nowhere defined and in the table, as cards that stand at the end of the deck. They must outlive `definitions`.
struct DeviceModels {
  netlist::Deck deck;
  DeviceSources sources;
};
[[nodiscard]] DeviceModels add_device_models(Definitions& definitions, SourceStore& sources, Reporter& reporter);

}  // namespace pwlsim::circuit
