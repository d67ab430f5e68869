#pragma once
/// A list in a message: "a, b and 3 more".

#include <fmt/format.h>

#include <cstddef>
#include <string>
#include <string_view>

namespace pwlsim::analysis {

class ShortList {
 public:
  explicit ShortList(std::size_t most) : most_(most) {}

  void add(std::string_view item) {
    if (++count_ <= most_) text_ += fmt::format("{}{}", count_ > 1 ? ", " : "", item);
  }
  [[nodiscard]] bool empty() const { return count_ == 0; }
  [[nodiscard]] std::string str() const { return count_ > most_ ? fmt::format("{} and {} more", text_, count_ - most_) : text_; }

 private:
  std::size_t most_, count_ = 0;
  std::string text_;
};

}  // namespace pwlsim::analysis
