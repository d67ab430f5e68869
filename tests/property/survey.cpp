#include "property/survey.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "property/agreement.hpp"
#include "property/examination.hpp"

namespace pwlsim::test {
namespace {

constexpr std::size_t most_printed = 3;  ///< failures that are minimised and printed; of others the seed

Family all_parts() { return {"all parts", 1, {}}; }

Family without_sources() {
  Family family{"no sources", 10'001, {}};
  family.recipe.voltage = family.recipe.current = 0.0;
  return family;
}

Family little_resistance() {
  Family family{"little resistance", 20'001, {}};
  family.recipe.resistor = 1.0;
  family.recipe.capacitor = 4.0;
  family.recipe.inductor = 3.0;
  family.recipe.diode = 4.0;
  family.recipe.stiff_source = 0.8;
  return family;
}

Family many_diodes() {
  Family family{"many diodes", 30'001, {}};
  family.recipe.diode = 8.0;
  family.recipe.most_nodes = 5;
  return family;
}

Family floating() {
  Family family{"floating", 40'001, {}};
  family.recipe.floating = 1.0;
  family.recipe.diode = 5.0;
  family.recipe.switch_ = 2.0;
  return family;
}

/// Modes up to 10^12 times faster than what one looks at.
Family real_diodes() {
  Family family{"real diodes", 50'001, {}, false};
  family.recipe.diode = 5.0;
  family.recipe.real_diodes = 0.8;
  return family;
}

Family twelve_ports() {
  Family family{"up to twelve ports", 70'001, {}};
  family.recipe.diode = 12.0;
  family.recipe.switch_ = 3.0;
  family.recipe.most_diodes = 10;
  return family;
}

int ports_of(const RandomNetwork& network) {
  return static_cast<int>(std::count_if(network.parts.begin(), network.parts.end(), [](const NetworkPart& part) {
    return part.kind == NetworkPart::Kind::diode || part.kind == NetworkPart::Kind::switch_;
  }));
}

class Surveyor {
 public:
  Surveyor(const Family& family, const Checks& checks) : family_(family), checks_(checks) {}

  Survey run(int networks) {
    for (int i = 0; i < networks; ++i) examine_seed(family_.first_seed + static_cast<std::uint64_t>(i));
    result_.networks = networks;
    std::sort(orders_.begin(), orders_.end());
    if (!orders_.empty()) result_.order = orders_[orders_.size() / 2];
    return result_;
  }

 private:
  void examine_seed(std::uint64_t seed) {
    const RandomNetwork network = make_random_network(seed, family_.recipe);
    result_.most_ports = std::max(result_.most_ports, ports_of(network));
    if (checks_.properties && !check_properties(network, seed)) return;
    if (checks_.independent) check_agreement(network, seed);
  }

  /// False where there is nothing more to learn from the network.
  bool check_properties(const RandomNetwork& network, std::uint64_t seed) {
    const Finding finding = examine(network, seed);
    if (finding.kind == Finding::Kind::refused) ++result_.refused;
    if (finding.kind == Finding::Kind::wrong) fail(seed, finding.what, finding.detail, [&] { return minimised(network, seed, finding); });
    if (finding.kind != Finding::Kind::fine) return false;
    engine::Certificate& worst = result_.worst;
    worst.complementarity = std::max(worst.complementarity, finding.certificate.complementarity);
    worst.kcl_kvl = std::max(worst.kcl_kvl, finding.certificate.kcl_kvl);
    worst.energy = std::max(worst.energy, finding.certificate.energy);
    return true;
  }

  void check_agreement(const RandomNetwork& network, std::uint64_t seed) {
    const Agreement agreement = compare_with_independent(network);
    if (agreement.kind == Agreement::Kind::refused && !checks_.properties) ++result_.refused;
    if (agreement.kind == Agreement::Kind::wrong)
      fail(seed, agreement.what, agreement.detail, [&] { return smallest_disagreement(network, agreement); });
    if (agreement.kind != Agreement::Kind::agrees || agreement.windows == 0) return;
    ++result_.compared;
    if (agreement.whole) ++result_.whole;
    result_.windows += agreement.windows;
    result_.difference = std::max(result_.difference, agreement.difference);
    result_.extrapolated = std::max(result_.extrapolated, agreement.extrapolated);
    if (agreement.order > 0.0) orders_.push_back(agreement.order);
  }

  template <typename Smaller>
  void fail(std::uint64_t seed, const std::string& what, const std::string& detail, const Smaller& smaller) {
    ++result_.wrong;
    std::string text = fmt::format("seed {}: {}: {}", seed, what, detail);
    if (result_.failures.size() < most_printed) text += "\nsmallest:\n" + to_deck(smaller());
    result_.failures.push_back(text);
  }

  const Family& family_;
  const Checks& checks_;
  Survey result_;
  std::vector<double> orders_;
};

}  // namespace

const std::vector<Family>& families() {
  static const std::vector<Family> all{all_parts(), without_sources(), little_resistance(), many_diodes(),
                                       floating(),  twelve_ports(),    real_diodes()};
  return all;
}

const Family& family(const std::string& name) {
  for (const Family& item : families())
    if (item.name == name) return item;
  throw std::invalid_argument("no family of random networks is called " + name);
}

Survey survey(const Family& family, int networks, const Checks& checks) { return Surveyor(family, checks).run(networks); }

}  // namespace pwlsim::test
