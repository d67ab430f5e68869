#include "elements/catalogue.hpp"

#include <algorithm>
#include <array>

#include "base/names.hpp"

namespace pwlsim::elements {
namespace {

using ByLetter = std::array<const Kind*, 26>;

ByLetter index_by_letter() {
  ByLetter index{};
  for (const Kind& kind : catalogue()) index[static_cast<std::size_t>(kind.letter - 'A')] = &kind;
  return index;
}

}  // namespace

const Kind* find_kind(char letter) {
  static const ByLetter index = index_by_letter();
  const char lower = lower_letter(letter);
  return lower >= 'a' && lower <= 'z' ? index[static_cast<std::size_t>(lower - 'a')] : nullptr;
}

const ModelKind* find_model_kind(std::string_view type) {
  for (const Kind& kind : catalogue()) {
    const auto found = std::find_if(kind.models.begin(), kind.models.end(), [&](const ModelKind* m) { return same_name(m->type, type); });
    if (found != kind.models.end()) return *found;
  }
  return nullptr;
}

}  // namespace pwlsim::elements
