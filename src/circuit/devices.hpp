#pragma once
/// Models at hand: common devices, lib/devices.txt. A model that a deck uses without defining it is taken from there, with a note.

#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "circuit/definitions.hpp"
#include "circuit/part_numbers.hpp"
#include "circuit/reporter.hpp"
#include "netlist/ast.hpp"

namespace pwlsim::circuit {

/// The device for `name`: of that name, or of the longest name in the table that it begins with (by the rules of devices.txt); none otherwise.
[[nodiscard]] std::optional<Device> find_device(std::string_view name);

/// All names of the table except patterns.
[[nodiscard]] std::vector<std::string> device_names();

/// lib/devices.txt.
[[nodiscard]] std::string_view device_table();

/// The models taken from the table: for each card the source of its numbers.
using DeviceSources = std::unordered_map<const netlist::Card*, std::string>;

/// The name of the text that contains them.
inline constexpr std::string_view device_models_file = "pwlsim's models";

/// Adds models of D, Q, M and J cards that are not defined but in the table, as cards at the end of the deck. The result must outlive `definitions`.
struct DeviceModels {
  netlist::Deck deck;
  DeviceSources sources;
};
[[nodiscard]] DeviceModels add_device_models(Definitions& definitions, SourceStore& sources, Reporter& reporter);

}  // namespace pwlsim::circuit
