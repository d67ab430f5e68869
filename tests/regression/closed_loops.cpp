#include "regression/closed_loops.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "support/random.hpp"

namespace pwlsim::test {

namespace {

enum class Stage {
  buck,
  boost,
  synchronous_buck,
  synchronous_boost,
  synchronous_buck_boost,
  half_bridge,
  full_bridge,
  interleaved,
  flyback,
  forward,
  sepic,
  power_factor
};
constexpr std::array<const char*, 12> stage_names{"buck",        "boost",       "synchronous buck", "synchronous boost", "buck-boost",
                                                  "half bridge", "full bridge", "interleaved",      "flyback",           "forward",
                                                  "SEPIC",       "power factor"};

enum class LoopControl {
  peak,
  valley,
  current_band,
  voltage_band,
  width,
  constant_on,
  constant_off,
  boundary,
  toggle,
  longest_duty,
  flip_flop,
  bursts
};
constexpr std::array<const char*, 12> control_names{"peak current", "valley current", "current band", "voltage band",
                                                    "pulse width",  "constant on",    "constant off", "boundary conduction",
                                                    "toggle",       "longest duty",   "D flip-flop",  "bursts"};

/// What a seed decides; the way in which it is written decides nothing of it.
struct Plan {
  Stage stage = Stage::buck;
  LoopControl control = LoopControl::peak;
  std::string switch_on, switch_off, diode_on, diode_off, drop, ramp, coupling;
  double inductance = 0.0, capacitance = 0.0, load = 0.0, series = 0.0, period = 0.0, target = 0.0;
  bool snubber = false, dead_time = false, body_diodes = false, slope = false, winding = false, rises = false, load_steps = false,
       symmetric = false;

  [[nodiscard]] bool is(Stage wanted) const { return stage == wanted; }
  /// Switches in the place of diodes, which take the inverted gate.
  [[nodiscard]] bool synchronous() const { return stage >= Stage::synchronous_buck && stage <= Stage::interleaved; }
  [[nodiscard]] bool alternating() const { return is(Stage::half_bridge) || is(Stage::full_bridge); }
  [[nodiscard]] bool inverting() const { return is(Stage::synchronous_buck_boost); }
  [[nodiscard]] bool steps_down() const {
    return is(Stage::buck) || is(Stage::synchronous_buck) || is(Stage::interleaved) || is(Stage::forward);
  }
  [[nodiscard]] int legs() const { return is(Stage::interleaved) ? 2 : 1; }
};

constexpr double input = 12.0;

LoopControl draw_control(Random& random, Stage stage) {
  using enum LoopControl;
  switch (stage) {
    case Stage::half_bridge:
    case Stage::full_bridge:
      return random.one_of(std::array{current_band, width, peak});
    case Stage::interleaved:
      return random.one_of(std::array{peak, width});
    case Stage::buck:
    case Stage::synchronous_buck:
      return random.one_of(std::array{peak, valley, current_band, voltage_band, width, constant_on, constant_off, boundary, toggle,
                                      longest_duty, flip_flop, bursts});
    case Stage::synchronous_boost:
    case Stage::synchronous_buck_boost:
      return random.one_of(std::array{peak, valley, current_band, width, constant_on});
    case Stage::flyback:  // the primary's current is zero as soon as the switch is off
      return random.one_of(std::array{peak, current_band, width, toggle, longest_duty, flip_flop, bursts});
    default:
      return random.one_of(std::array{peak, current_band, width, constant_off, boundary, toggle, longest_duty, flip_flop, bursts});
  }
}

double least_load(Stage stage) {
  if (stage == Stage::power_factor) return 5.0;
  if (stage == Stage::flyback || stage == Stage::forward) return 1.0;
  return stage == Stage::buck || stage == Stage::synchronous_buck || stage == Stage::interleaved ? 0.5 : 2.5;
}

Plan draw_plan(std::uint64_t seed) {
  Random random(seed);
  Plan plan;
  plan.stage = static_cast<Stage>(random.whole(0, 11));
  plan.control = draw_control(random, plan.stage);
  plan.switch_on = random.one_of(std::array{"0", "1m", "10m", "50m"});
  plan.switch_off = random.one_of(std::array{"inf", "inf", "1Meg", "100Meg", "1G"});
  plan.diode_on = random.one_of(std::array{"0", "1m", "20m"});
  plan.diode_off = random.one_of(std::array{"inf", "inf", "10Meg", "1G"});
  plan.drop = random.one_of(std::array{"0", "0.5", "0.7"});
  plan.ramp = random.one_of(std::array{"0", "1n", "10n"});
  plan.coupling = random.one_of(std::array{"1", "0.99", "0.999"});
  plan.inductance = random.one_of(std::array{4.7e-6, 10e-6, 22e-6, 47e-6});
  plan.capacitance = random.one_of(std::array{10e-6, 22e-6, 47e-6, 100e-6});
  plan.load = std::max(random.one_of(std::array{0.5, 1.0, 2.5, 5.0, 20.0, 100.0}), least_load(plan.stage));
  // A band of the voltage needs a ripple that follows the current.
  plan.series =
      plan.control == LoopControl::voltage_band ? random.one_of(std::array{0.05, 0.1}) : random.one_of(std::array{0.0, 5e-3, 20e-3, 0.1});
  plan.period = 1.0 / random.one_of(std::array{50e3, 100e3, 200e3});
  plan.target = input * random.between(0.3, 0.9) * (plan.steps_down() || plan.inverting() ? 1.0 : 1.5);
  plan.snubber = random.chance(0.25);
  plan.dead_time = random.chance(0.25);
  plan.body_diodes = plan.dead_time || random.chance(0.3);
  plan.slope = random.chance(0.6);
  plan.winding = random.chance(0.4);
  plan.rises = random.chance(0.3);
  plan.load_steps = random.chance(0.4) && !plan.alternating();
  plan.symmetric = random.chance(0.5);
  return plan;
}

class Writer {
 public:
  Writer(const Plan& plan, std::uint64_t seed, int way)
      : plan_(plan), random_(1000 * seed + static_cast<std::uint64_t>(way)), plain_(way == 0) {}

  std::string run() {
    models();
    stage();
    load();
    for (int leg = 0; leg < plan_.legs(); ++leg) control(leg);
    for (std::size_t left = plain_ ? 0 : cards_.size(); left > 1; --left)
      std::swap(cards_[left - 1], cards_[static_cast<std::size_t>(random_.whole(0, static_cast<int>(left) - 1))]);
    std::string text;
    for (const auto& line : cards_) text += line + "\n";
    // Rows beside the clock's edges.
    text += fmt::format(".tran {:.9g} {:g} uic\n.save v(out) i(L1){}\n.end\n", plan_.period / 10.0 * 1.00317, 40.0 * plan_.period,
                        plan_.legs() > 1 ? " i(L2)" : "");
    return text;
  }

 private:
  template <class... Values>
  void card(fmt::format_string<Values...> text, Values&&... values) {
    cards_.push_back(fmt::format(text, std::forward<Values>(values)...));
  }
  /// One of `count` spellings, the first where the deck is plain.
  int spelling(int count) { return plain_ ? 0 : random_.whole(0, count - 1); }
  std::string new_node() { return fmt::format("n{}", ++nodes_); }

  void models() {
    card(".model SX SW(Ron={} Roff={} Vt=0.5)", plan_.switch_on, plan_.switch_off);
    card(".model DX D(Ron={} Roff={} Vfwd={})", plan_.diode_on, plan_.diode_off, plan_.drop);
    card(".model SLOG SW(Ron=1u Roff=inf Vt=0.5)");
    card("{}", plan_.rises ? fmt::format("Vin in 0 PWL(0 {:g} {:g} {:g})", input / 2.0, 5.0 * plan_.period, input)
                           : fmt::format("Vin in 0 {:g}", input));
  }

  // Power stages. The gates of a leg are q and nq, those of the second p and np.

  void stage();
  void isolated_stage();
  void power_switch(const char* name, const char* a, const char* c, const char* gate) {
    card("{} {} {} {} 0 SX", name, a, c, gate);
    if (plan_.body_diodes) card("D{} {} {} DX", name, c, a);
  }
  void inductor(const char* name, const char* a, const char* c) {
    if (plan_.winding) {
      card("{0} {1} {0}m {2:g}", name, a, plan_.inductance);
      card("R{0} {0}m {1} 5m", name, c);
    } else {
      card("{} {} {} {:g}", name, a, c, plan_.inductance);
    }
  }
  void output_capacitor() {
    card("C1 out {} {:g}", plan_.series > 0.0 ? "cx" : "0", plan_.capacitance);
    if (plan_.series > 0.0) card("Rx cx 0 {:g}", plan_.series);
  }
  void load();

  // Controls. Each drives the node d0, or d1 of the second leg.

  void control(int leg);
  void clocked(int leg);
  void banded();
  void timed();
  void pulse_width(int leg);
  void voltage_controlled();
  void sense() { card("Bis0 is0 0 V=i(L1)"); }
  void clock(const std::string& name, double delay, double on, double period) {
    card("V{0} {0} 0 PULSE(0 1 {1:g} {2} {2} {3:g} {4:g})", name, delay, plan_.ramp, on, period);
  }
  void level(const char* name, double value) { card("V{0} {0} 0 {1:g}", name, value); }
  [[nodiscard]] double mean_current() const {
    const double output = plan_.target / plan_.load;
    return plan_.is(Stage::synchronous_boost) || plan_.is(Stage::boost) || plan_.inverting() ? 2.0 * output : output;
  }
  [[nodiscard]] double ripple() const { return 0.25 * input * plan_.period / plan_.inductance; }

  // Logic.

  void comparison(const std::string& plus, const std::string& minus, const std::string& out);
  void inverter(const std::string& in, const std::string& out);
  void buffer(const std::string& in, const std::string& out);
  void chain(std::string in, const std::string& out, int length);
  void latch(const std::string& set, const std::string& reset, const std::string& out) {
    card("A{2} {0} {1} 0 0 0 0 {2} 0 SRFLOP", set, reset, out);
  }
  void drive(const std::string& in, const std::string& gate, const std::string& inverted);

  const Plan& plan_;
  Random random_;
  bool plain_;
  int nodes_ = 0;
  std::vector<std::string> cards_;
};

void Writer::stage() {
  using enum Stage;
  switch (plan_.stage) {
    case buck:
    case synchronous_buck:
    case interleaved:
      power_switch("S1", "in", "sw", "q");
      if (plan_.is(buck))
        card("D2 0 sw DX");
      else
        power_switch("S2", "sw", "0", "nq");
      inductor("L1", "sw", "out");
      if (!plan_.is(interleaved)) break;
      power_switch("S3", "in", "sv", "p");
      power_switch("S4", "sv", "0", "np");
      inductor("L2", "sv", "out");
      break;
    case boost:
    case synchronous_boost:
      inductor("L1", "in", "sw");
      power_switch("S1", "sw", "0", "q");
      if (plan_.is(boost))
        card("D2 sw out DX");
      else
        power_switch("S2", "out", "sw", "nq");
      break;
    case synchronous_buck_boost:
      power_switch("S1", "in", "sw", "q");
      inductor("L1", "sw", "0");
      power_switch("S2", "sw", "out", "nq");
      break;
    case half_bridge:
    case full_bridge:
      if (plan_.is(half_bridge)) card("Vn n 0 {:g}", -input);
      power_switch("S1", "in", "sw", "q");
      power_switch("S2", "sw", plan_.is(half_bridge) ? "n" : "0", "nq");
      inductor("L1", "sw", "out");
      if (plan_.is(half_bridge)) return;
      power_switch("S3", "in", "sv", "nq");
      power_switch("S4", "sv", "0", "q");
      return;
    default:
      isolated_stage();
  }
  output_capacitor();
}

void Writer::isolated_stage() {
  using enum Stage;
  if (plan_.is(flyback)) {
    inductor("L1", "in", "dr");
    power_switch("S1", "dr", "0", "q");
    card("L9 0 sec {:g}", 0.25 * plan_.inductance);
    card("K1 L1 L9 {}", plan_.coupling);
    for (const char* text : {"D2 sec out DX", "Dcl dr clm DX", "Ccl clm in 100n", "Rcl clm in 2k"}) card("{}", text);
  } else if (plan_.is(forward)) {
    for (const char* text : {"L7 in dr 1m", "S1 dr 0 q 0 SX", "Lr 0 rr 1m", "Dr rr in DX", "Ls sec 0 1m", "K1 L7 Lr -0.999",
                             "K2 L7 Ls 0.999", "K3 Lr Ls -0.999", "D3 sec sw DX", "D2 0 sw DX"})
      card("{}", text);
    inductor("L1", "sw", "out");
  } else if (plan_.is(sepic)) {
    inductor("L1", "in", "dr");
    power_switch("S1", "dr", "0", "q");
    card("Cc dr sw 10u");
    card("L9 sw 0 {:g}", plan_.inductance);
    card("D2 sw out DX");
  } else {
    card("Vac a1 b1 SIN(0 {:g} {:g})", input, 1.0 / (20.0 * plan_.period));
    for (const char* text : {"Da a1 rect DX", "Db b1 rect DX", "Dc 0 a1 DX", "Dd 0 b1 DX", "Crect rect 0 1u", "D2 sw out DX"})
      card("{}", text);
    inductor("L1", "rect", "sw");
    power_switch("S1", "sw", "0", "q");
  }
}

void Writer::load() {
  card("R1 out {} {:g}", plan_.is(Stage::full_bridge) ? "sv" : "0", plan_.load);
  if (plan_.load_steps) card("Istep out 0 PULSE(0 {:g} {:g} 1n 1n 1 2)", 0.25 * input / plan_.load, 20.3 * plan_.period);
  if (plan_.snubber) {
    card("Rsn {} snx 10", plan_.is(Stage::flyback) ? "dr" : "sw");
    card("Csn snx 0 1n");
  }
  if (plan_.inverting())
    card("Bfb fb 0 V=-v(out)");
  else
    card("Efb fb 0 out {} 1", plan_.is(Stage::full_bridge) ? "sv" : "0");
}

void Writer::control(int leg) {
  using enum LoopControl;
  switch (plan_.control) {
    case peak:
    case valley:
      clocked(leg);
      break;
    case current_band:
    case voltage_band:
      banded();
      break;
    case width:
      pulse_width(leg);
      break;
    case constant_on:
    case toggle:
    case bursts:
      voltage_controlled();
      break;
    default:
      timed();
  }
  drive(fmt::format("d{}", leg), leg == 0 ? "q" : "p", leg == 0 ? "nq" : "np");
}

/// A clock turns one switch on, and the current's peak or valley off.
void Writer::clocked(int leg) {
  const double period = plan_.period, delay = 0.5 * leg * period + 0.1 * period;
  const std::string current = fmt::format("is{}", leg), tick = fmt::format("ck{}", leg), bound = fmt::format("rf{}", leg),
                    passed = fmt::format("cm{}", leg), out = fmt::format("d{}", leg);
  card("B{0} {0} 0 V=i(L{1})", current, leg + 1);
  clock(tick, delay, 0.03 * period, period);
  if (plan_.control == LoopControl::valley) {
    level(bound.c_str(), mean_current() - ripple());
    comparison(bound, current, passed);
    latch(passed, tick, out);
    return;
  }
  const double highest = mean_current() / plan_.legs() + ripple();
  if (plan_.slope)
    card("V{0} {0} 0 PULSE({1:g} {2:g} {3:g} {4:g} 0 0 {4:g})", bound, highest, highest - ripple(), delay, period);
  else
    level(bound.c_str(), highest);
  comparison(current, bound, passed);
  latch(tick, passed, out);
}

/// A signal between two bounds: a trigger with hysteresis, a switch with one, or two comparisons and a latch.
void Writer::banded() {
  const bool of_current = plan_.control == LoopControl::current_band;
  const double half = of_current ? ripple() : 0.01 * plan_.target;
  if (of_current) sense();
  const std::string signal = of_current ? "is0" : "fb";
  if (plan_.alternating())
    card("Vrf rf 0 SIN(0 {:g} {:g})", 0.6 * mean_current(), 1.0 / (40.0 * plan_.period));
  else
    level("rf", of_current ? mean_current() : plan_.target);
  switch (spelling(3)) {
    case 0:
      card("Ad rf {} 0 0 0 0 d0 0 DIFFSCHMITT Vt=0 Vh={:g}", signal, half);
      break;
    case 1:
      card(".model SH SW(Ron=1u Roff=inf Vt=0 Vh={:g})", half);
      card("Vph vph 0 1");
      card("Sh vph d0 rf {} SH", signal);
      card("Rh d0 0 1k");
      break;
    default:
      card("Bhi hi 0 V=v(rf)+{:g}", half);
      card("Blo lo 0 V=v(rf)-{:g}", half);
      comparison(signal, "hi", "cr");
      comparison("lo", signal, "cs");
      latch("cs", "cr", "d0");
  }
}

/// The current's peak turns the switch off; a time, a zero of the current, or a clock on.
void Writer::timed() {
  const double period = plan_.period;
  sense();
  level("rf", mean_current() + ripple());
  comparison("is0", "rf", "cr");
  switch (plan_.control) {
    case LoopControl::constant_off:
      inverter("d0", "nd0");
      card("Adl nd0 0 0 0 0 0 cs 0 BUF Td={:g}", 0.4 * period);
      latch("cs", "cr", "d0");
      break;
    case LoopControl::boundary:
      switch (spelling(3)) {
        case 0:
          card("Bcs cs 0 V={{if(v(is0)<=0,1,0)}}");
          break;
        case 1:
          card("Bcs cs 0 V={{if(v(is0)>0,0,1)}}");
          break;
        default:
          card("Bcz cz 0 V={{if(v(is0)>0,1,0)}}");
          inverter("cz", "cs");
      }
      latch("cs", "cr", "d0");
      break;
    case LoopControl::longest_duty:
      clock("ck", 0.1 * period, 0.01 * period, period);
      clock("dm", 0.7 * period, 0.2 * period, period);
      card("Aor cr dm 0 0 0 0 rs 0 OR");
      latch("ck", "rs", "d0");
      break;
    default:
      level("one", 1.0);
      clock("ck", 0.1 * period, 0.3 * period, period);
      card("Adf one 0 ck 0 cr 0 d0 0 DFLOP");
  }
}

/// A control voltage against a sawtooth or triangle.
void Writer::pulse_width(int leg) {
  const double period = plan_.period;
  if (leg == 0 && plan_.alternating()) {
    card("Vctl ctl 0 SIN(0.5 0.4 {:g})", 1.0 / (40.0 * period));
  } else if (leg == 0) {
    level("rf", plan_.target);
    card("Bi 0 xi I=(v(rf)-v(fb))*1u");
    card("Ci xi 0 {:g} ic=0.4", 5e-6 * period);
    card("Bctl ctl 0 V=limit(v(xi)+0.02*(v(rf)-v(fb)),0.05,0.95)");
  }
  const double rise = plan_.symmetric ? 0.5 : 0.99;
  card("Vtr{0} tr{0} 0 PULSE(0 1 {1:g} {2:g} {3:g} 0 {4:g})", leg, 0.5 * leg * period, rise * period, (1.0 - rise) * period, period);
  comparison("ctl", fmt::format("tr{}", leg), fmt::format("d{}", leg));
}

void Writer::voltage_controlled() {
  const double period = plan_.period;
  if (plan_.control == LoopControl::toggle) {
    clock("ck", 0.1 * period, 0.125 * period, 0.5 * period);
    inverter("d0", "dn0");
    card("Adf dn0 0 ck 0 0 0 d0 0 DFLOP");
    return;
  }
  level("rf", plan_.target);
  if (plan_.control == LoopControl::bursts) {
    card("Ah rf fb 0 0 0 0 en 0 DIFFSCHMITT Vt=0 Vh={:g}", 0.02 * plan_.target);
    clock("ck", 0.1 * period, 0.35 * period, period);
    card("Aan en ck 0 0 0 0 d0 0 AND");
    return;
  }
  card("Bfbv fbv 0 V=v(fb)+0.02*i(L1)");
  comparison("rf", "fbv", "cs");
  card("Adl d0 0 0 0 0 0 rs 0 BUF Td={:g}", 0.4 * period);
  latch("cs", "rs", "d0");
}

void Writer::comparison(const std::string& plus, const std::string& minus, const std::string& out) {
  switch (spelling(4)) {
    case 0:
      card("B{2} {2} 0 V={{if(v({0})>v({1}),1,0)}}", plus, minus, out);
      break;
    case 1:
      card("B{2} {2} 0 V=u(v({0})-v({1}))", plus, minus, out);
      break;
    case 2:
      card("A{2} {0} {1} 0 0 0 0 {2} 0 DIFFSCHMITT Vt=0 Vh=0", plus, minus, out);
      break;
    default:
      card("B{2} {2} 0 V={{if(v({0})-v({1})>0,1,0)}}", plus, minus, out);
  }
}

void Writer::inverter(const std::string& in, const std::string& out) {
  switch (spelling(4)) {
    case 0:
      card("A{1} {0} 0 0 0 0 {1} 0 0 INV", in, out);
      break;
    case 1:
      card("B{1} {1} 0 V={{if(v({0})>0.5,0,1)}}", in, out);
      break;
    case 2:
      card("Vp{0} p{0} 0 1", out);
      card("Rp{0} p{0} {0} 1k", out);
      card("S{1} {1} 0 {0} 0 SLOG", in, out);
      break;
    default:
      card("E{1} {1} 0 VALUE={{1-v({0})}}", in, out);
  }
}

void Writer::buffer(const std::string& in, const std::string& out) {
  switch (spelling(4)) {
    case 0:
      card("A{1} {0} 0 0 0 0 0 {1} 0 BUF", in, out);
      break;
    case 1:
      card("B{1} {1} 0 V={{if(v({0})>0.5,1,0)}}", in, out);
      break;
    case 2: {
      const std::string between = new_node();
      inverter(in, between);
      inverter(between, out);
      break;
    }
    default:
      card("A{1} {0} {0} 0 0 0 0 {1} 0 AND", in, out);
  }
}

void Writer::chain(std::string in, const std::string& out, int length) {
  if (length == 0) {
    card("E{1} {1} 0 {0} 0 1", in, out);
    return;
  }
  for (int i = 1; i < length; ++i) {
    const std::string next = new_node();
    buffer(in, next);
    in = next;
  }
  buffer(in, out);
}

/// The gates of a leg, through chains of up to three buffers, with a dead time where the plan has one.
void Writer::drive(const std::string& in, const std::string& gate, const std::string& inverted) {
  const int length = spelling(4), length_of_other = spelling(4);
  if (plan_.dead_time) {
    card("A{0}dl {0} 0 0 0 0 0 {0}dl 0 BUF Td={1:g}", in, 0.02 * plan_.period);
    card("A{1}and {0} {0}dl 0 0 0 0 {1}a 0 AND", in, gate);
    chain(gate + "a", gate, length);
    if (!plan_.synchronous()) return;
    card("A{1}nor {0} {0}dl 0 0 0 {1}a 0 0 OR", in, inverted);
    chain(inverted + "a", inverted, length_of_other);
    return;
  }
  chain(in, gate, length);
  if (!plan_.synchronous()) return;
  const std::string opposite = new_node();
  inverter(spelling(2) == 0 ? in : gate, opposite);
  chain(opposite, inverted, length_of_other);
}

}  // namespace

ClosedLoop random_closed_loop(std::uint64_t seed, int way) {
  const Plan plan = draw_plan(seed);
  ClosedLoop loop;
  loop.name =
      fmt::format("{}, {}", stage_names[static_cast<std::size_t>(plan.stage)], control_names[static_cast<std::size_t>(plan.control)]);
  loop.text = fmt::format("closed loop {}: {}\n", seed, loop.name) + Writer(plan, seed, way).run();
  return loop;
}

}  // namespace pwlsim::test
