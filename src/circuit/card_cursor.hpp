#pragma once
/// Iterates over the items of an element card; items in bare parentheses are in line with the others.

#include <cstddef>
#include <vector>

#include "netlist/ast.hpp"

namespace pwlsim::circuit {

class CardCursor {
 public:
  explicit CardCursor(const std::vector<netlist::Item>& items) { add(items); }

  /// Null at the end.
  [[nodiscard]] const netlist::Item* peek(std::size_t ahead = 0) const {
    return at_ + ahead < items_.size() ? items_[at_ + ahead] : nullptr;
  }
  /// The item taken last; null at the start.
  [[nodiscard]] const netlist::Item* previous() const { return at_ > 0 ? items_[at_ - 1] : nullptr; }
  const netlist::Item* next() { return at_ < items_.size() ? items_[at_++] : nullptr; }
  [[nodiscard]] bool at_end() const { return at_ == items_.size(); }

  [[nodiscard]] bool at(netlist::Item::Kind kind, std::size_t ahead = 0) const {
    return peek(ahead) != nullptr && peek(ahead)->kind == kind;
  }
  /// A value by position: anything except name=value.
  [[nodiscard]] bool at_positional() const { return !at_end() && !at(netlist::Item::Kind::assignment); }
  [[nodiscard]] std::size_t positional_left() const {
    std::size_t count = 0;
    while (peek(count) != nullptr && !at(netlist::Item::Kind::assignment, count)) ++count;
    return count;
  }

 private:
  void add(const std::vector<netlist::Item>& items) {
    for (const netlist::Item& item : items) {
      if (item.kind == netlist::Item::Kind::group && item.text.empty()) {
        add(item.items);
      } else {
        items_.push_back(&item);
      }
    }
  }

  std::vector<const netlist::Item*> items_;
  std::size_t at_ = 0;
};

}  // namespace pwlsim::circuit
