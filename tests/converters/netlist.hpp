#pragma once
/// A converter as the independent integrator and the text of its deck have it. Shares nothing with src.

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace pwlsim::test::converters {

inline constexpr double infinity = std::numeric_limits<double>::infinity();

/// Offset + amplitude·sin(2π·frequency·t + phase), or a PULSE of SPICE.
struct Wave {
  enum class Kind { constant, sine, pulse };
  Kind kind = Kind::constant;
  double offset = 0.0;                                   ///< the constant; V1 of a pulse
  double amplitude = 0.0, frequency = 0.0, phase = 0.0;  ///< degrees
  double high = 1.0, delay = 0.0, rise = 0.0, fall = 0.0, width = 0.0, period = 0.0;

  /// `inside` lies in the same piece of a pulse as `time`, not at its ends.
  [[nodiscard]] long double value(long double time, long double inside) const;
  /// Of its magnitude.
  [[nodiscard]] double largest() const;
  [[nodiscard]] std::string text() const;
};

/// Constant, sine, pulse from 0 to 1.
[[nodiscard]] Wave constant(double value);
[[nodiscard]] Wave sine(double amplitude, double frequency, double phase);
[[nodiscard]] Wave pulse(double delay, double rise, double fall, double width, double period);

/// On: v = drop + on·(i - drop/off) (a diode), v = on·i (a switch). Off: v = off·i.
struct Contact {
  double on = 0.0, off = infinity, drop = 0.0;
};

struct Branch {
  enum class Kind { resistor, inductor, capacitor, source, diode, thyristor, contact };
  Kind kind = Kind::resistor;
  std::string name, plus, minus;
  double value = 0.0;     ///< of R, L, C
  double initial = 0.0;   ///< of L, C
  Wave wave{};            ///< of a source
  std::size_t model = 0;  ///< of a valve, a contact: index into Converter::models
  std::size_t gate = 0;   ///< of a thyristor, a contact: index into Converter::gates
  double holding = 0.0;   ///< of a thyristor: what its current must be to last without a gate

  /// A thyristor is a diode while its gate is on and, without a gate, from then until its current has fallen to the holding current; else it blocks.
  [[nodiscard]] bool is_valve() const { return kind == Kind::diode || kind == Kind::thyristor; }
};

/// All pairs of these inductors.
struct Coupling {
  std::vector<std::string> inductors;
  double factor = 0.0;
};

struct Converter {
  std::string family;
  std::vector<Branch> branches;
  std::vector<Coupling> couplings;
  std::vector<Wave> gates;
  std::vector<Contact> models;
  double stop = 0.0, row_step = 0.0;
  double fast = 0.0;  ///< s: the shortest period of its sources

  /// Capacitor voltages and inductor currents, in order of the branches.
  [[nodiscard]] std::vector<std::string> signals() const;
  [[nodiscard]] std::string text() const;
};

/// Cards of a converter one after the other.
class ConverterBuilder {
 public:
  explicit ConverterBuilder(std::string family) { converter.family = std::move(family); }

  void resistor(const std::string& plus, const std::string& minus, double value) {
    add(Branch::Kind::resistor, "R", plus, minus).value = value;
  }
  std::string inductor(const std::string& plus, const std::string& minus, double value, double initial = 0.0);
  void capacitor(const std::string& plus, const std::string& minus, double value, double initial = 0.0);
  void source(const std::string& plus, const std::string& minus, const Wave& wave) {
    add(Branch::Kind::source, "V", plus, minus).wave = wave;
  }
  void diode(const std::string& anode, const std::string& cathode, std::size_t model = 0) {
    add(Branch::Kind::diode, "D", anode, cathode).model = model;
  }
  void thyristor(const std::string& anode, const std::string& cathode, std::size_t gate, double holding = 0.0, std::size_t model = 0);
  void contact(const std::string& plus, const std::string& minus, std::size_t gate, std::size_t model);
  std::size_t gate(const Wave& wave);
  void couple(std::vector<std::string> inductors, double factor) { converter.couplings.push_back({std::move(inductors), factor}); }

  Converter converter;

 private:
  Branch& add(Branch::Kind kind, const std::string& letter, const std::string& plus, const std::string& minus);
};

}  // namespace pwlsim::test::converters
