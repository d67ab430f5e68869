#include "circuit/part_numbers.hpp"

#include <algorithm>
#include <array>
#include <cctype>

#include <fmt/format.h>

namespace pwlsim::circuit {
namespace {

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }

/// Takes a name apart from its begin. What cannot be taken stays.
class Reading {
 public:
  explicit Reading(std::string_view name) : rest_(name) {}

  [[nodiscard]] std::string_view rest() const { return rest_; }
  bool take(std::string_view text) {
    if (!rest_.starts_with(text)) return false;
    rest_.remove_prefix(text.size());
    return true;
  }
  template <std::size_t count>
  bool take_one_of(const std::array<std::string_view, count>& texts) {
    return std::any_of(texts.begin(), texts.end(), [&](std::string_view text) { return take(text); });
  }
  bool take_letter() {
    const bool found = !rest_.empty() && is_letter(rest_.front());
    if (found) rest_.remove_prefix(1);
    return found;
  }
  /// Exactly `digits` digits; 0 where there are fewer.
  double number(std::size_t digits) {
    double value = 0.0;
    if (digits > this->digits()) return value;
    for (const char c : rest_.substr(0, digits)) value = 10.0 * value + (c - '0');
    rest_.remove_prefix(digits);
    return value;
  }
  /// All digits that come, if they are `least` to `most`; else 0.
  double number(std::size_t least, std::size_t most) { return digits() >= least && digits() <= most ? number(digits()) : 0.0; }
  [[nodiscard]] std::size_t digits() const {
    return static_cast<std::size_t>(std::find_if_not(rest_.begin(), rest_.end(), is_digit) - rest_.begin());
  }

 private:
  std::string_view rest_;
};

/// Letters behind the numbers, and no further ones but a grade's: `nf10` no longer names this part.
bool is_grade(std::string_view rest) {
  constexpr std::size_t longest = 8;
  return rest.size() <= longest && (rest.empty() || !is_digit(rest.front()));
}

Device mosfet(bool p_channel, double threshold, double ohms, double volts, std::string_view source) {
  return {"VDMOS",
          fmt::format("{}Vto={:g} Ron={:g} Vfwd=0.75 Rfwd={:g} BV={:g}", p_channel ? "pchan " : "", p_channel ? -threshold : threshold,
                      ohms, ohms / 2, volts),
          source};
}

Device carbide_mosfet(double threshold, double body_drop, double ohms, double volts, std::string_view source) {
  return {"VDMOS", fmt::format("Vto={:g} Ron={:g} Vfwd={:g} Rfwd={:g} BV={:g}", threshold, ohms, body_drop, ohms, volts), source};
}

/// `rise` V above the drop at the current in the name.
Device diode(double drop, double rise, double amperes, double volts, std::string_view source) {
  return {"D", fmt::format("Vfwd={:g} Ron={:.3g} Vrev={:g} Iave={:g}", drop, rise / amperes, volts, amperes), source};
}

constexpr double low_threshold = 1.7, normal_threshold = 3.0;  // V, of gates for 5 V and for 10 V

double threshold_of_grade(std::string_view grade) {
  return grade.starts_with('l') || grade.starts_with('m') ? low_threshold : normal_threshold;
}

/// BSC093N15NS5 has 9.3 mohm and 150 V, IPP070N8N3 80 V, BSC010NE2LS 25 V, BSC12DN20NS3 125 mohm, IPD042P03L3 is a P channel; IPW60R041P6 has 600 V and 41 mohm.
std::optional<Device> infineon(std::string_view key) {
  constexpr std::array<std::string_view, 15> families{"bsc", "bsz", "bsb", "bso", "ipp", "ipb", "ipd", "ipi",
                                                      "ipa", "ipc", "ipf", "ips", "ipu", "ipt", "ipw"};
  constexpr std::string_view source = "Infineon: resistance and voltage from the name";
  Reading reading(key);
  if (!reading.take_one_of(families)) return std::nullopt;
  Reading of_volts = reading;
  if (const double tens = of_volts.digits() == 2 ? of_volts.number(2) : 0.0; tens >= 20.0 && of_volts.take("r")) {
    const double milliohms = of_volts.number(3, 3);
    if (milliohms <= 0.0 || !is_grade(of_volts.rest())) return std::nullopt;
    return mosfet(false, normal_threshold, 1e-3 * milliohms, 10.0 * tens, source);
  }
  double ohms = 0.0;
  if (reading.digits() == 3) ohms = 1e-4 * reading.number(3);
  if (const double tens = reading.number(2, 2); tens > 0.0 && reading.take("d")) ohms = 1e-2 * tens + 5e-3;
  const bool p_channel = reading.take("p");
  if (ohms <= 0.0 || (!p_channel && !reading.take("n"))) return std::nullopt;
  double volts = 25.0;
  if (!reading.take("e2")) volts = 10.0 * reading.number(std::min<std::size_t>(reading.digits(), 2));
  if (volts <= 0.0 || volts > 600.0) return std::nullopt;
  if (reading.rest().starts_with('s')) return std::nullopt;  // of cars: the first number is a current
  return mosfet(p_channel, threshold_of_grade(reading.rest()), ohms, volts, source);
}

/// 7R6, 8M8, 013, 14: with the letter for the point; 0: none.
double milliohms_of(Reading& reading, std::string_view point) {
  const double whole = reading.number(1, 3);
  if (!reading.take(point)) return whole;
  return reading.digits() == 0 ? 0.0 : whole + 0.1 * reading.number(1);
}

/// PSMN1R5-30YL has 1.5 mohm and 30 V, BUK7Y7R6-40E 7.6 mohm and 40 V (LTspice writes BUK7Y7R640E); BUK9 is for 5 V at the gate.
std::optional<Device> nexperia(std::string_view key) {
  Reading reading(key);
  const bool is_psmn = reading.take("psmn"), is_low = !is_psmn && reading.take("buk9");
  if (!is_psmn && !is_low && !reading.take("buk7")) return std::nullopt;
  if (!is_psmn && !reading.take_letter()) return std::nullopt;
  const double milliohms = milliohms_of(reading, "r");
  (void)reading.take("-");
  const double volts = reading.number(2, 3);
  if (milliohms <= 0.0 || volts < 20.0 || volts > 200.0 || !is_grade(reading.rest())) return std::nullopt;
  const bool says_low = is_psmn && reading.rest().size() > 1 && reading.rest()[1] == 'l';
  return mosfet(false, is_low || says_low ? low_threshold : normal_threshold, 1e-3 * milliohms, volts,
                "Nexperia: resistance and voltage from the name");
}

/// C3M0065090 has 65 mohm and 900 V, the diode C4D20120 20 A and 1200 V.
std::optional<Device> wolfspeed(std::string_view key) {
  constexpr std::string_view source = "Wolfspeed: resistance or current, and voltage, from the name";
  constexpr std::array<std::string_view, 2> mosfets{"c2m", "c3m"};
  constexpr std::array<std::string_view, 5> diodes{"c2d", "c3d", "c4d", "c5d", "c6d"};
  Reading reading(key);
  const bool is_third = key.starts_with("c3m"), is_mosfet = reading.take_one_of(mosfets);
  if (!is_mosfet && !reading.take_one_of(diodes)) return std::nullopt;
  const std::size_t digits = is_mosfet ? 4 : 2;
  if (reading.digits() != digits + 3) return std::nullopt;
  const double size = reading.number(digits), volts = 10.0 * reading.number(3);
  if (size <= 0.0 || volts < 500.0 || volts > 3300.0 || !is_grade(reading.rest())) return std::nullopt;
  return is_mosfet ? carbide_mosfet(is_third ? 2.5 : 2.8, is_third ? 3.5 : 2.5, 1e-3 * size, volts, source)
                   : diode(0.95, 0.55, size, volts, source);
}

/// UJ3C065030 has 650 V and 30 mohm; SCT3080AL 80 mohm and 650 V, with K 1200 V.
std::optional<Device> other_carbide(std::string_view key) {
  constexpr std::array<std::string_view, 3> cascodes{"uj3c", "uf3c", "uj4c"};
  constexpr std::array<std::string_view, 2> rohms{"sct2", "sct3"};
  Reading reading(key);
  if (reading.take_one_of(cascodes)) {
    if (reading.digits() != 6) return std::nullopt;
    const double volts = 10.0 * reading.number(3), milliohms = reading.number(3);
    if (milliohms <= 0.0 || volts < 600.0 || !is_grade(reading.rest())) return std::nullopt;
    return carbide_mosfet(5.0, 1.0, 1e-3 * milliohms, volts, "UnitedSiC: voltage and resistance from the name");
  }
  if (!reading.take_one_of(rohms)) return std::nullopt;
  const double milliohms = reading.number(3, 3);
  const bool is_low = reading.take("a");
  if (milliohms <= 0.0 || (!is_low && !reading.take("k")) || !is_grade(reading.rest())) return std::nullopt;
  return carbide_mosfet(4.0, 2.5, 1e-3 * milliohms, is_low ? 650.0 : 1200.0, "Rohm: resistance and a letter for the voltage from the name");
}

/// SUD50N04-8M8P has 8.8 mohm and 40 V, SUM110P04-05 is a P channel of 5 mohm.
std::optional<Device> vishay_mosfet(std::string_view key) {
  constexpr std::array<std::string_view, 6> families{"sum", "sup", "sud", "sqm", "sqd", "sqp"};
  Reading reading(key);
  if (!reading.take_one_of(families) || reading.number(1, 3) <= 0.0) return std::nullopt;
  const bool p_channel = reading.take("p");
  if (!p_channel && !reading.take("n")) return std::nullopt;
  const double volts = 10.0 * reading.number(2, 2);
  if (volts <= 0.0 || !reading.take("-")) return std::nullopt;
  const double milliohms = milliohms_of(reading, "m");
  if (milliohms <= 0.0 || !is_grade(reading.rest())) return std::nullopt;
  return mosfet(p_channel, 2.0, 1e-3 * milliohms, volts, "Vishay: voltage and resistance from the name");
}

/// RFN10NS3S: 10 A and 300 V, fast. RFUH20TF6S likewise.
std::optional<Device> rohm_diode(std::string_view key) {
  constexpr std::array<std::string_view, 4> families{"rfuhs", "rfuh", "rfus", "rfn"};
  Reading reading(key);
  if (!reading.take_one_of(families)) return std::nullopt;
  const double amperes = reading.number(1, 2);
  if (amperes <= 0.0 || !reading.take_letter()) return std::nullopt;
  (void)reading.take_letter();
  const double volts = 100.0 * reading.number(1, 1);
  if (volts <= 0.0 || !is_grade(reading.rest())) return std::nullopt;
  return diode(0.8, volts > 400.0 ? 0.6 : 0.3, amperes, volts, "Rohm: current and voltage from the name");
}

/// STTH8L06: 8 A and 600 V, fast. STPS20H100: a Schottky diode of 20 A and 100 V; STPS340 of 3 A and 40 V.
std::optional<Device> st_diode(std::string_view key) {
  constexpr std::string_view source = "ST: current and voltage from the name";
  Reading reading(key);
  const bool is_fast = reading.take("stth");
  if (!is_fast && !reading.take("stps")) return std::nullopt;
  Reading with_letter = reading;
  double amperes = with_letter.number(1, 3), number = 0.0;
  if (amperes > 0.0 && with_letter.take_letter() && with_letter.digits() > 1) {
    number = with_letter.number(2, 3);
    reading = with_letter;
  } else if (const std::size_t digits = reading.digits(); digits >= 3 && digits <= 5) {
    const std::size_t of_voltage = digits == 5 ? 3 : 2;
    amperes = reading.number(digits - of_voltage);
    number = reading.number(of_voltage);
  }
  const double volts = is_fast ? 100.0 * number : number;
  if (amperes <= 0.0 || volts < 20.0 || volts > 1500.0 || !is_grade(reading.rest())) return std::nullopt;
  if (is_fast) return diode(0.85, volts > 400.0 ? 0.6 : 0.25, amperes, volts, source);
  return diode(volts > 60.0 ? 0.5 : 0.35, 0.25, amperes, volts, source);
}

/// VS-30ETH06: 30 A and 600 V. VS-E5TH0812: 8 A and 1200 V.
std::optional<Device> vishay_diode(std::string_view key) {
  constexpr std::string_view source = "Vishay: current and voltage from the name";
  constexpr std::array<std::string_view, 9> families{"eth", "etu", "etx", "etl", "epf", "epu", "eph", "epx", "ets"};
  constexpr std::array<std::string_view, 2> generations{"e4", "e5"};
  Reading reading(key);
  (void)reading.take("vs-");
  double amperes = 0.0;
  if (reading.take_one_of(generations)) {
    if (!reading.take_letter() || !reading.take_letter() || reading.digits() != 4) return std::nullopt;
    amperes = reading.number(2);
  } else {
    amperes = reading.number(1, 2);
    if (amperes <= 0.0 || !reading.take_one_of(families) || reading.digits() != 2) return std::nullopt;
  }
  const double volts = 100.0 * reading.number(2);
  if (amperes <= 0.0 || volts <= 0.0 || volts > 1600.0 || !is_grade(reading.rest())) return std::nullopt;
  return diode(0.9, volts > 600.0 ? 0.9 : 0.5, amperes, volts, source);
}

}  // namespace

std::optional<Device> read_part_number(std::string_view key) {
  for (const auto read : {infineon, nexperia, wolfspeed, other_carbide, vishay_mosfet, rohm_diode, st_diode, vishay_diode})
    if (auto device = read(key)) return device;
  return std::nullopt;
}

}  // namespace pwlsim::circuit
