#include "engine/missing_rest.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace pwlsim::engine {

void MissingRest::add_restless(const std::vector<std::string>& names) {
  constexpr std::size_t most_names = 8;
  const auto told = static_cast<std::ptrdiff_t>(std::min(names.size(), most_names));
  const std::string more = names.size() > most_names ? fmt::format(" and {} more", names.size() - most_names) : "";
  parts.push_back(
      fmt::format("{}{} {} toggling", fmt::join(names.begin(), names.begin() + told, ", "), more, names.size() == 1 ? "keeps" : "keep"));
  elements.insert(elements.end(), names.begin(), names.end());
}

void MissingRest::add(const MissingRest& other) {
  parts.insert(parts.end(), other.parts.begin(), other.parts.end());
  elements.insert(elements.end(), other.elements.begin(), other.elements.end());
}

std::string MissingRest::text() const {
  constexpr std::size_t most_parts = 3;
  const auto told = static_cast<std::ptrdiff_t>(std::min(parts.size(), most_parts));
  const std::string more = parts.size() > most_parts ? fmt::format("; and {} more", parts.size() - most_parts) : "";
  return fmt::format("no DC operating point: {}{}", fmt::join(parts.begin(), parts.begin() + told, "; "), more);
}

}  // namespace pwlsim::engine
