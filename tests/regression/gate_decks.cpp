#include "regression/gate_decks.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "support/random.hpp"

namespace pwlsim::test {

namespace {

/// Edges of a converter's gates, as text: what people write, which binary fractions do not hit.
struct Timing {
  std::string period, on, ramp, delay;
  double period_seconds = 0.0;
};

enum class Given { pulses, inverted, one_source, polylines, floating, comparison };

class GateDeckWriter {
 public:
  explicit GateDeckWriter(std::uint64_t seed) : random_(seed) {}

  GateDeck run(std::uint64_t seed) {
    given_ = static_cast<Given>(random_.whole(0, 5));
    take_timing();
    deck_.text = fmt::format("gates {}\n", seed);
    const int family = random_.whole(0, 5);
    if (family == 0) buck(1);
    if (family == 1) half_bridge();
    if (family == 2) full_bridge();
    if (family == 3) buck(random_.whole(2, 3));
    if (family == 4) three_level_leg();
    if (family == 5) phase_shifted_bridge();
    deck_.text += fmt::format(".model SX SW(Ron={} Vt={})\n.model DX D(Ron={})\n.tran {} {} uic\n", on_resistance_, 0.5 * swing_,
                              on_resistance_, row_step_, stop_);
    return deck_;
  }

 private:
  void take_timing() {
    constexpr std::array<const char*, 6> periods{"10u", "{1/30k}", "20u", "3.3u", "{1/7k}", "12.5u"};
    constexpr std::array<double, 6> seconds{10e-6, 1.0 / 30e3, 20e-6, 3.3e-6, 1.0 / 7e3, 12.5e-6};
    constexpr std::array<const char*, 5> ramps{"0", "1n", "10n", "33.3n", "1u"};
    constexpr std::array<const char*, 3> delays{"0", "{1u/3}", "0.7u"};
    constexpr std::array<const char*, 4> resistances{"10m", "1m", "0", "50m"};
    constexpr std::array<double, 4> swings{1.0, 5.0, 12.0, 3.3};
    const auto which = static_cast<std::size_t>(random_.whole(0, 5));
    timing_.period = periods[which];
    timing_.period_seconds = seconds[which];
    timing_.ramp = random_.one_of(ramps);
    if (timing_.ramp == "1u" && timing_.period_seconds < 5e-6) timing_.ramp = "10n";
    timing_.on = fmt::format("{:.3g}", random_.between(0.3, 0.6) * timing_.period_seconds);
    timing_.delay = random_.one_of(delays);
    on_resistance_ = random_.one_of(resistances);
    swing_ = random_.one_of(swings);
    stop_ = fmt::format("{:.3g}", random_.whole(20, 40) * timing_.period_seconds);
    row_step_ = fmt::format("{:.4g}", std::stod(stop_) / random_.whole(50, 90));
  }

  template <class... Values>
  void card(fmt::format_string<Values...> text, Values&&... values) {
    deck_.text += fmt::format(text, std::forward<Values>(values)...) + "\n";
  }

  [[nodiscard]] std::string pulse(double low, double high, const std::string& delay) const {
    return fmt::format("PULSE({} {} {} {} {} {} {})", low, high, delay, timing_.ramp, timing_.ramp, timing_.on, timing_.period);
  }

  /// One period of the same as corners that repeat.
  [[nodiscard]] std::string polyline(double low, double high) const {
    if (timing_.ramp == "0")
      return fmt::format("PWL(0 {} {} {} {} {} {} {}) r=0", high, timing_.on, high, timing_.on, low, timing_.period, low);
    return fmt::format("PWL(0 {0} {2} {1} {{{2}+{3}}} {1} {{2*{2}+{3}}} {0} {4} {0}) r=0", low, high, braced(timing_.ramp), timing_.on,
                       timing_.period);
  }
  static std::string braced(const std::string& text) { return text.front() == '{' ? text.substr(1, text.size() - 2) : text; }

  void note_gate(const std::string& node) { deck_.gates.push_back("v(" + node + ")"); }

  /// Two switches between `top`, `middle` and `bottom`, of which one conducts: the upper one from `delay` on. `name`: a letter or two.
  void leg(const std::string& name, const std::string& top, const std::string& middle, const std::string& bottom,
           const std::string& delay) {
    const std::string h = "h" + name, l = "l" + name;
    note_gate(h);
    Given given = given_;
    if (given == Given::polylines && delay != "0") given = Given::pulses;
    std::string upper = h + " 0", lower = l + " 0";
    switch (given) {
      case Given::pulses:
        card("V{0} {0} 0 {1}", h, pulse(0.0, swing_, delay));
        card("V{0} {0} 0 {1}", l, pulse(swing_, 0.0, delay));
        break;
      case Given::inverted:
        card("V{0} {0} 0 {1}", h, pulse(0.0, swing_, delay));
        card("E{0} {0} 0 value={{{2}-v({1})}}", l, h, swing_);
        break;
      case Given::one_source:
        card("V{0} {0} 0 {1}", h, pulse(0.0, swing_, delay));
        card("V{0} {0} 0 {1}", l, swing_);
        lower = l + " " + h;
        break;
      case Given::polylines:
        card("V{0} {0} 0 {1}", h, polyline(0.0, swing_));
        card("V{0} {0} 0 {1}", l, polyline(swing_, 0.0));
        break;
      case Given::floating:
        card("V{0} {0} {1} {2}", h, middle, pulse(0.0, swing_, delay));
        card("V{0} {0} {1} {2}", l, bottom, pulse(swing_, 0.0, delay));
        upper = h + " " + middle;
        lower = l + " " + bottom;
        break;
      case Given::comparison:
        card("V{0} {0} 0 SIN({1} {2} {{1/(7.3*{3})}} 0 0 {4})", h, 0.5 * swing_, 0.4 * swing_, braced(timing_.period),
             random_.whole(0, 11) * 30);
        card("V{0} {0} 0 PULSE(0 {1} {2} {{{3}/2}} {{{3}/2}} 0 {4})", l, swing_, delay, braced(timing_.period), timing_.period);
        card("E{0}u u{0} 0 value={{v({1})-v({2})+{3}}}", name, h, l, 0.5 * swing_);
        card("E{0}d d{0} 0 value={{v({2})-v({1})+{3}}}", name, h, l, 0.5 * swing_);
        upper = fmt::format("u{} 0", name);
        lower = fmt::format("d{} 0", name);
        break;
    }
    if (given != Given::comparison) note_gate(l);
    card("S{}u {} {} {} SX", name, top, middle, upper);
    card("S{}d {} {} {} SX", name, middle, bottom, lower);
  }

  void buck(int phases) {
    card("Vin in 0 12");
    for (int i = 0; i < phases; ++i) {
      const std::string name(1, static_cast<char>('a' + i));
      leg(name, "in", "m" + name, "0",
          i == 0 ? timing_.delay : fmt::format("{{{}+{}*{}/{}}}", braced(timing_.delay), i, braced(timing_.period), phases));
      card("L{0} m{0} out 10u ic=0", name);
    }
    card("C1 out 0 100u ic=0\nR1 out 0 {}", random_.between(0.3, 2.0));
    deck_.signal = "v(out)";
  }

  void half_bridge() {
    card("Vin in 0 400\nC1 in n 1u ic=200\nC2 n 0 1u ic=200");
    leg("a", "in", "m", "0", timing_.delay);
    card("L1 m o 100u ic=0\nR1 o n 10");
    deck_.signal = "i(L1)";
  }

  void full_bridge() {
    card("Vin in 0 100");
    leg("a", "in", "p", "0", timing_.delay);
    leg("b", "in", "q", "0", fmt::format("{{{}+{}/2}}", braced(timing_.delay), braced(timing_.period)));
    card("L1 p o 200u ic=0\nR1 o q 7");
    deck_.signal = "i(L1)";
  }

  void phase_shifted_bridge() {
    card("Vin in 0 200");
    leg("a", "in", "p", "0", timing_.delay);
    leg("b", "in", "q", "0", fmt::format("{{{}+{:.3g}}}", braced(timing_.delay), random_.between(0.1, 0.4) * timing_.period_seconds));
    card("L1 p o 20u ic=0\nLp o q 500u ic=0\nLs s 0 500u ic=0\nK1 Lp Ls 0.98");
    card("D1 s x DX\nD2 0 x DX\nD3 y s DX\nD4 y 0 DX\nLf x z 100u ic=0\nCf z y 10u ic=0\nRf z y 20");
    deck_.signal = "v(z,y)";
  }

  /// Levels 1, 0, −1: S1 and S3 change together, S2 and S4 do. The diodes hold the middle.
  void three_level_leg() {
    card("Vp p 0 100\nVn 0 n 100");
    const std::array<const char*, 4> name{"a", "b", "c", "d"};
    const std::string upper = timing_.delay, lower = fmt::format("{{{}+{}/2}}", braced(timing_.delay), braced(timing_.period));
    // S2 conducts but where S4 does: for the other half period's time.
    for (int i = 0; i < 4; ++i) {
      const bool is_upper = i % 2 == 0, starts_on = i == 1 || i == 2;
      card("V{0} g{0} 0 {1}", name[static_cast<std::size_t>(i)],
           starts_on ? pulse(swing_, 0.0, is_upper ? upper : lower) : pulse(0.0, swing_, is_upper ? upper : lower));
      note_gate(fmt::format("g{}", name[static_cast<std::size_t>(i)]));
    }
    card("S1 p x ga 0 SX\nS2 x o gb 0 SX\nS3 o y gc 0 SX\nS4 y n gd 0 SX");
    card("D1 0 x DX\nD2 y 0 DX\nDa x p DX\nDb o x DX\nDc y o DX\nDd n y DX");
    card("L1 o l 300u ic=0\nR1 l 0 12");
    deck_.signal = "i(L1)";
    deck_.shares = true;
  }

  Random random_;
  Given given_ = Given::pulses;
  Timing timing_;
  std::string on_resistance_, stop_, row_step_;
  double swing_ = 1.0;
  GateDeck deck_;
};

}  // namespace

GateDeck random_gate_deck(std::uint64_t seed) { return GateDeckWriter(seed).run(seed); }

}  // namespace pwlsim::test
