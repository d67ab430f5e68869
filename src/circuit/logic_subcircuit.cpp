#include "circuit/logic_subcircuit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "base/names.hpp"

namespace pwlsim::circuit {
namespace {

constexpr std::string_view name_begin = "ltspice.", with_delay = "td", no_outputs = "none";

constexpr LogicType logic_types[] = {
    {"buf", Logic::buffer, "12345", 1, 1},      {"inv", Logic::inverter, "12345", 1, 1},  {"and", Logic::conjunction, "12345"},
    {"or", Logic::disjunction, "12345"},        {"xor", Logic::exactly_one, "12345"},     {"schmitt", Logic::schmitt, "12"},
    {"diffschmitt", Logic::schmitt, "12"},      {"srflop", Logic::set_reset, "12"},       {"dflop", Logic::d_flip_flop, "1345"},
    {"samplehold", Logic::sample_hold, "1234"}, {"ota", Logic::transconductance, "1234"},
};

/// Of that name; without a type where the name is none that Device::name writes.
LogicDevice device_named(std::string_view name) {
  std::vector<std::string_view> parts;
  for (std::string_view rest = name.starts_with(name_begin) ? name.substr(name_begin.size()) : ""; !rest.empty();) {
    const std::size_t end = std::min(rest.find('.'), rest.size());
    parts.push_back(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  LogicDevice device;
  if (parts.size() < 3) return device;
  for (const char digit : {'1', '2', '3', '4', '5'})
    if (parts[1].find(digit) != std::string_view::npos) device.used += digit;
  for (const char digit : {'6', '7'})
    if (parts[2].find(digit) != std::string_view::npos) device.outputs += digit;
  device.is_late = parts.size() > 3 && parts[3] == with_delay;
  if (parts.size() > 3 && !device.is_late) device.parts = parts[3];
  device.type = find_logic_type(parts[0]);
  if (device.type != nullptr && !same_name(device.name(), name)) device.type = nullptr;
  return device;
}

/// The cards of a device's subcircuit. Its logic is in bits of 0 and 1 V against the common: node y holds the answer.
class Writer {
 public:
  explicit Writer(const LogicDevice& device) : device_(device) {}

  std::string write() {
    if (device_.type->logic == Logic::sample_hold) return sample_hold();
    if (device_.type->logic == Logic::transconductance) return transconductance();
    head();
    if (device_.type->logic == Logic::schmitt) {
      closes("y", "_one", device_.uses('1') ? "i1" : "com", device_.uses('2') ? "i2" : "com", "trip");
    } else if (device_.type->logic == Logic::set_reset) {
      bits(device_.used);
      latch("y", sum({{"1", 1}, {"2", -2}}));
    } else if (device_.type->logic == Logic::d_flip_flop) {
      flip_flop();
    } else {
      gate();
    }
    if (device_.is_late) late();
    levels(device_.is_late ? "(late*v(_e,com)+(1-late)*v(_y,com))" : "v(_y,com)");
    return text_ + ".ends\n";
  }

 private:
  struct WeightedInput {
    std::string input;
    int weight = 1;
  };

  template <class... Arguments>
  void card(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    text_ += fmt::format(format, std::forward<Arguments>(arguments)...) + "\n";
  }

  void head() {
    card(".subckt {}{} com params: vhigh=1 vlow=0 ref={{(vhigh+vlow)/2}} vt={{(vhigh+vlow)/2}} vh=0 td=0", device_.name(), ports());
    card("Vone _one com 1");
    card(".model high SW(Vt={{ref}})");
    card(".model low SW(Vt={{-ref}})");
    card(".model trip SW(Vt={{vt}} Vh={{vh}})");
    card(".model sum SW(Vt=0)");
    card(".model latch SW(Vt=0 Vh=0.5)");
  }

  /// Node _`node` is what `from` is while the switch is closed, else 0.
  void closes(std::string_view node, std::string_view from, std::string_view p, std::string_view n, std::string_view model) {
    card("S{0} {1} _{0} {2} {3} {4}", node, from, p, n, model);
    card("R{0} _{0} com 1", node);
  }

  void bits(const std::string& of) {
    for (const char input : of) closes(fmt::format("b{}", input), "_one", fmt::format("i{}", input), "com", "high");
  }

  /// Of the bits that are used.
  [[nodiscard]] std::string sum(std::initializer_list<WeightedInput> parts) const {
    std::string text;
    for (const WeightedInput& part : parts)
      if (device_.uses(part.input[0])) text += fmt::format("{:+}*v(_b{},com)", part.weight, part.input);
    return text;
  }

  void latch(std::string_view node, std::string_view set) {
    card("B{0} _c{0} com V=0{1}", node, set);
    closes(node, "_one", fmt::format("_c{}", node), "com", "latch");
  }

  void gate() {
    const auto count = static_cast<double>(device_.used.size());
    if (device_.used.size() == 1) {
      const std::string input = fmt::format("i{}", device_.used[0]);
      return closes("y", "_one", input, "com", "high");
    }
    bits(device_.used);
    std::string all;
    for (const char input : device_.used) all += fmt::format("+v(_b{},com)", input);
    card("Bs _s com V=0{}{:+}", all, device_.type->logic == Logic::conjunction ? 0.5 - count : -0.5);
    if (device_.type->logic != Logic::exactly_one) return closes("y", "_one", "_s", "com", "sum");
    closes("x", "_one", "_s", "com", "sum");
    card("Bt _t com V=v(_s,com)-1");
    closes("y", "_x", "com", "_t", "sum");
  }

  /// A master that follows D while the clock is low, and a slave that follows it while the clock is high; preset and clear act on both.
  void flip_flop() {
    std::string without_clock = device_.used;
    std::erase(without_clock, '3');
    bits(without_clock);
    const std::string force = sum({{"4", 4}, {"5", -8}});
    const std::string_view clock = device_.uses('3') ? "i3" : "com";
    card("Bd _d com V={}-1", device_.uses('1') ? "2*v(_b1,com)" : "0");
    closes("dm", "_d", "com", clock, "low");
    latch("m", "+v(_dm,com)" + force);
    card("Bk _k com V=2*v(_m,com)-1");
    closes("ks", "_k", clock, "com", "high");
    latch("y", "+v(_ks,com)" + force);
  }

  /// Bit p follows y one round later, so that between them an edge shows; each of its two directions starts a timer of its own, and bit e changes when
  /// that ends. While neither runs, e is what p was: of two edges of one direction within the delay the second is lost, but not what came of it. A delay of 0,
  /// as a value may turn out to be, leaves all this at rest.
  void late() {
    card(".param late={{td > 0 ? 1 : 0}}");
    card(".model half SW(Vt=0.5)");
    card(".model below SW(Vt=-0.5)");
    card(".model over SW(Vt=1)");
    card(".model clamp D");
    card("Vtwo _two com 2");
    card("Bin _in com V=late*v(_y,com)");
    latch("p", "+2*v(_in,com)-1");
    timer("rise", "_in", "_p");
    timer("fall", "_p", "_in");
    card("Bidle _idle com V=0.5-v(_rise,com)-v(_fall,com)-v(_riseedge,com)-v(_falledge,com)");
    latch("q", "+2*v(_p,com)-1");
    card("Bpast _past com V=2*v(_q,com)-1");
    closes("now", "_past", "_idle", "com", "sum");
    latch("e", "+v(_riseend,com)-v(_fallend,com)+v(_now,com)");
  }

  /// The bit of that name runs from an edge on, until 1 A has charged the capacitor to 1 V; then the bit of its end is there for an instant. Else, and at
  /// that instant, the capacitor is shorted. An edge at the end starts anew.
  void timer(const std::string& name, std::string_view p, std::string_view n) {
    const std::string edge = name + "edge", end = name + "end", time = name + "time";
    closes(edge, "_one", p, n, "half");
    closes(end, "_one", "_" + time, "com", "over");
    latch(name, fmt::format("+3*v(_{},com)-2*v(_{},com)", edge, end));
    card("Bs{0} _s{0} com V=v(_{0},com)-2*v(_{1},com)", name, end);
    card("I{0} com _{0} 1", time);
    card("C{0} _{0} com {{late*td+1-late}}", time);
    card("S{0} _{0} com com _s{1} below", time, name);
    card("D{0} _{0} _two clamp", time);
  }

  /// v(first) - v(second), as far as they are used.
  [[nodiscard]] std::string difference(char first, char second) const {
    std::string text = "0";
    if (device_.uses(first)) text += fmt::format("+v(i{},com)", first);
    if (device_.uses(second)) text += fmt::format("-v(i{},com)", second);
    return text;
  }

  [[nodiscard]] std::string ports() const {
    std::string text;
    for (const char input : device_.used) text += fmt::format(" i{}", input);
    for (const char out : device_.outputs) text += fmt::format(" o{}", out);
    return text;
  }

  /// A master that follows the input while the clock is low, and a slave that follows the master while the clock is high; both follow while S/H is high.
  /// With a delay a second such pair samples the slave at the late edge of the clock.
  std::string sample_hold() {
    card(".subckt {}{} com params: vhigh=10 vlow=-10 ref=0.5 td=0", device_.name(), ports());
    card("Vone _one com 1");
    card(".model high SW(Vt={{ref}})");
    card(".model sum SW(Vt=0)");
    bits(device_.used.substr(device_.used.find_first_of("34")));
    const std::string bits_sum = sum({{"3", 1}, {"4", 1}});
    card("Bx _x com V={}", difference('1', '2'));
    card("Bt _t com V=0.5{}", sum({{"3", -1}, {"4", 1}}));
    card("Sm _x _m _t com sum");
    card("Cm _m com 1u");
    card("Bm _held com V=v(_m,com)");
    card("Bh _h com V={}-0.5", bits_sum);
    card("Ss _held _s _h com sum");
    card("Cs _s com 1u");
    if (device_.is_late) late_sample();
    card("Bo7 o7 com V=limit({},{{vlow}},{{vhigh}})", device_.is_late ? "late*v(_w,com)+(1-late)*v(_s,com)" : "v(_s,com)");
    return text_ + ".ends\n";
  }

  void late_sample() {
    card("By _y com V=v(_b3,com)");
    card(".model latch SW(Vt=0 Vh=0.5)");
    late();
    card("Bc _c com V=v(_s,com)");
    card("Bl _l com V=0.5-v(_e,com)");
    card("Su _c _u _l com sum");
    card("Cu _u com 1u");
    card("Bu _late com V=v(_u,com)");
    card("Bk _k com V=v(_e,com)-0.5");
    card("Sw _late _w _k com sum");
    card("Cw _w com 1u");
  }

  /// The second pair of inputs, where it is used, is a factor.
  std::string transconductance() {
    card(".subckt {}{} com params: g=1 ref=0 vhigh=0 vlow=0 rout=1 cout=0 iout=0 isource={{iout}} isink={{iout}}", device_.name(), ports());
    std::string current = fmt::format("{{g}}*({}+{{ref}})", difference('2', '1'));
    if (device_.uses('3') || device_.uses('4')) current += fmt::format("*({})", difference('4', '3'));
    if (device_.has_part('i'))
      card("Bo com o7 I=limit({},{{-abs(isink)}},{{isource}})", current);
    else
      card("Bo com o7 I={}", current);
    if (device_.has_part('r')) card("Ro o7 com {{rout}}");
    if (device_.has_part('c')) card("Co o7 com {{cout}}");
    card(".model clamp D");
    if (device_.has_part('h')) card("Vh _h com {{vhigh}}\nDh o7 _h clamp");
    if (device_.has_part('l')) card("Vl _l com {{vlow}}\nDl _l o7 clamp");
    return text_ + ".ends\n";
  }

  void levels(std::string_view bit) {
    for (const char out : device_.outputs) {
      const bool inverts = device_.type->logic == Logic::inverter || out == '6';
      if (inverts)
        card("Bo{0} o{0} com V={{vhigh}}+{{vlow-vhigh}}*{1}", out, bit);
      else
        card("Bo{0} o{0} com V={{vlow}}+{{vhigh-vlow}}*{1}", out, bit);
    }
  }

  const LogicDevice& device_;
  std::string text_;
};

}  // namespace

const LogicType* find_logic_type(std::string_view name) {
  const auto* found =
      std::find_if(std::begin(logic_types), std::end(logic_types), [&](const LogicType& type) { return same_name(type.name, name); });
  return found == std::end(logic_types) ? nullptr : found;
}

std::string LogicDevice::name() const {
  return fmt::format("{}{}.{}.{}{}", name_begin, type->name, used, outputs.empty() ? no_outputs : outputs,
                     is_late         ? fmt::format(".{}", with_delay)
                     : parts.empty() ? ""
                                     : "." + parts);
}

bool has_two_levels(std::string_view name) {
  const LogicDevice device = device_named(name);
  return device.type != nullptr && device.type->logic != Logic::sample_hold && device.type->logic != Logic::transconductance;
}

std::string logic_subcircuit(std::string_view name) {
  if (same_name(name, analog_switch))
    return ".subckt xspice.aswitch c r a b params: cntl_off=0 cntl_on=1 r_off=1e12 r_on=1\n"
           "Bm _m 0 V={cntl_on < cntl_off ? -1 : 1}*(v(c,r)-{(cntl_on+cntl_off)/2})\n"
           "S1 a b _m 0 middle\n.model middle SW(Vt=0 Vh=0 Ron={r_on} Roff={r_off})\n.ends\n";
  const LogicDevice device = device_named(name);
  return device.type == nullptr ? "" : Writer(device).write();
}

}  // namespace pwlsim::circuit
