#pragma once
/// The signals that a passive part leaves open in some of its positions: how ports without resistance divide a current, and the potential of what blocking ports alone join to the rest. A port that is zero on
/// both sides may stand on either: where such ports block a part may float, where they conduct a current may circulate.

#include <map>
#include <vector>

#include "engine/sparse/factors.hpp"
#include "engine/sparse/open_parts.hpp"

namespace pwlsim::engine::sparse {

class OpenSignals {
 public:
  explicit OpenSignals(const Descriptor& descriptor) : descriptor_(descriptor) {}

  /// A position of a segment with that shift, 1/s; `idle`: ports that are on and carry nothing, `free`: off, and without voltage.
  void note(const Position& on, const std::vector<int>& idle, const std::vector<int>& free, double shift);
  /// Numbers of those that are open in a position noted. Costs a factor for each of these that leaves anything open.
  [[nodiscard]] std::vector<std::size_t> find(const std::vector<Form>& signals) const;

 private:
  void add(Position on, double shift);

  const Descriptor& descriptor_;
  std::map<Position, double> noted_;  ///< with the shift of the first segment in each, 1/s
};

}  // namespace pwlsim::engine::sparse
