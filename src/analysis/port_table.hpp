#pragma once
/// Unique names of a model's ports, and modes in terms of these names.
///
/// A port has the name of its element. A part of an element is `D1#reverse`; if an element has several ports (a relay has two) they are
/// `A1#1`, `A1#2`, …. Contacts that one control drives together are one switch.

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/diagnostic.hpp"
#include "engine/exact/exact_model.hpp"

namespace pwlsim::analysis {

/// A requested mode: names of ports or elements, on or off.
using ModeRequest = std::vector<std::pair<std::string, bool>>;

struct SwitchGroup {
  std::string name;
  std::vector<int> contacts;  ///< of the island's network.switches
  bool on_at_start = false;
};

struct IslandPorts {
  std::vector<std::string> names;  ///< of every port: diodes, complementarities, contacts
  std::vector<SwitchGroup> switches;
};

/// The ports that are on, island by island.
struct ModeChoice {
  struct OfIsland {
    std::vector<char> ports;     ///< diodes and complementarities
    std::vector<char> switches;  ///< one entry per SwitchGroup
  };
  std::vector<OfIsland> islands;
};

class PortTable {
 public:
  explicit PortTable(const engine::ExactModel& model);

  [[nodiscard]] const IslandPorts& island(std::size_t index) const { return islands_[index]; }
  /// Errors: names that are not ports, or set twice. Empty if there is an error.
  [[nodiscard]] std::optional<ModeChoice> choose(const ModeRequest& request, Diagnostics& diagnostics) const;

 private:
  struct Entry {
    std::string element, name;
    std::size_t island = 0, index = 0;
    bool is_switch = false;
  };
  void add_island(const engine::IslandModel& model, std::size_t index);
  void number_entries();
  [[nodiscard]] std::vector<const Entry*> find(const std::string& name) const;
  [[nodiscard]] std::string complaint(const std::string& name) const;

  const engine::ExactModel& model_;
  std::vector<Entry> entries_;
  std::vector<IslandPorts> islands_;
};

/// Without a part: "D1" of "D1 (reverse)".
[[nodiscard]] std::string element_of(const model::Label& label);

/// Names of all elements of an island in the order of the deck, each once.
[[nodiscard]] std::vector<std::string> element_names(const model::Island& island);

}  // namespace pwlsim::analysis
