#pragma once
/// The nodes of a sheet and their names.

#include <map>
#include <string>
#include <vector>

#include "base/disjoint_sets.hpp"
#include "netlist/schematic/sheet.hpp"

namespace pwlsim::netlist {

/// Wires, pins and labels meet at their ends and wherever such an end lies on a wire; wires that only cross do not. Labels of one name are one net.
/// A net has the name of its first label, or `0` if one of its labels is `0`; nets without a label are N001, N002, … from the top left.
class Nets {
 public:
  /// `pins` of all symbols; `joined` are pairs of pins that a jumper joins.
  Nets(const Sheet& sheet, const std::vector<GridPoint>& pins, const std::vector<Wire>& joined);

  /// The node at a pin.
  [[nodiscard]] const std::string& name_at(GridPoint pin) const;
  /// Whether nothing else is at this pin.
  [[nodiscard]] bool is_open(GridPoint pin) const;

  /// Further labels of a net, each with the name of the net.
  struct Alias {
    std::string label, net;
  };
  [[nodiscard]] const std::vector<Alias>& aliases() const { return aliases_; }

 private:
  using Index = int;
  void add_point(GridPoint point);
  [[nodiscard]] Index root(GridPoint point) const { return sets_.find(points_.at(point)); }
  void join(GridPoint a, GridPoint b) { sets_.join(points_.at(a), points_.at(b)); }
  void join_along(const Wire& wire);
  void join_labels(const std::vector<Flag>& flags);
  void name_labelled(const std::vector<Flag>& flags);
  void name_others();

  std::map<GridPoint, Index> points_;   ///< by columns
  std::map<GridPoint, Index> by_rows_;  ///< the same with x and y exchanged
  mutable DisjointSets sets_{0};        ///< of points, once all of them are known
  std::map<Index, std::string> names_;  ///< of roots
  std::map<GridPoint, int> uses_;       ///< of places, by pins, wires and labels
  std::vector<Alias> aliases_;
};

/// Whether a point is on the wire, ends included.
[[nodiscard]] bool lies_on(GridPoint point, const Wire& wire);

/// A label as a node of a netlist: characters that would split it are replaced.
[[nodiscard]] std::string node_name(std::string_view label);

}  // namespace pwlsim::netlist
