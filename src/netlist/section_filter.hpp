#pragma once
/// Selects the cards of a file: all outside of `.lib name … .endl` sections, or those of one section.

#include <string>
#include <string_view>
#include <vector>

#include "base/names.hpp"

namespace pwlsim::netlist {

class SectionFilter {
 public:
  /// `wanted` is empty for the whole file.
  explicit SectionFilter(std::string_view wanted) : wanted_(wanted) {}

  void begin(std::string_view name) {
    names_.emplace_back(name);
    inside_ = true;
    chosen_ = same_name(name, wanted_);
    found_ = found_ || chosen_;
  }
  /// False if no section is open.
  bool end() {
    const bool was_inside = inside_;
    inside_ = false;
    chosen_ = false;
    return was_inside;
  }

  [[nodiscard]] bool wants_cards() const { return wanted_.empty() ? !inside_ : chosen_; }
  [[nodiscard]] bool found() const { return wanted_.empty() || found_; }
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }

 private:
  std::string_view wanted_;
  std::vector<std::string> names_;
  bool inside_ = false;
  bool chosen_ = false;
  bool found_ = false;
};

}  // namespace pwlsim::netlist
