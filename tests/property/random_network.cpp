#include "property/random_network.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>

#include "model/builder.hpp"

namespace pwlsim::test {
namespace {

using Kind = NetworkPart::Kind;

// Units in which the middle of every range is one: 1 kΩ, 1 ms, 10 V.
constexpr double resistance_unit = 1e3, time_unit = 1e-3, voltage_unit = 10.0;

/// Three digits are enough to make a network generic, and keep its deck short.
double rounded(double value) { return std::strtod(fmt::format("{:.3g}", value).c_str(), nullptr); }

class Sets {
 public:
  explicit Sets(int size) : parent_(static_cast<std::size_t>(size)) { std::iota(parent_.begin(), parent_.end(), 0); }
  int find(int i) { return parent_[at(i)] == i ? i : parent_[at(i)] = find(parent_[at(i)]); }
  void join(int a, int b) { parent_[at(find(a))] = find(b); }

 private:
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }
  std::vector<int> parent_;
};

bool is_stiff_voltage(const NetworkPart& part) { return part.kind == Kind::voltage && part.value == 0.0; }

/// A voltage source without resistance whose ends parts of no resistance join.
bool is_in_rigid_loop(const RandomNetwork& network, const NetworkPart& source) {
  Sets sets(network.nodes + 1);
  for (const NetworkPart& part : network.parts) {
    const bool rigid = part.kind == Kind::diode || part.kind == Kind::switch_ || is_stiff_voltage(part);
    if (&part != &source && rigid) sets.join(part.p, part.n);
  }
  return sets.find(source.p) == sets.find(source.n);
}

/// A current source whose current has no way round that is open to both directions.
bool has_no_return(const RandomNetwork& network, const NetworkPart& source) {
  Sets sets(network.nodes + 1);
  for (const NetworkPart& part : network.parts)
    if (part.kind != Kind::diode && part.kind != Kind::switch_ && part.kind != Kind::current) sets.join(part.p, part.n);
  return sets.find(source.p) != sets.find(source.n);
}

class Generator {
 public:
  Generator(std::uint64_t seed, const Recipe& recipe) : random_(seed), recipe_(recipe) {}

  RandomNetwork run() {
    network_.nodes = random_.whole(2, recipe_.most_nodes);
    slowest_ = rounded(std::pow(10.0, random_.between(2.0, 4.0)));
    network_.stop = 5.0 / slowest_;
    add_tree();
    const int extra = random_.whole(1, network_.nodes + 2);
    for (int i = 0; i < extra; ++i) add_part(any_node(), any_node());
    soften_sources();
    return std::move(network_);
  }

 private:
  int any_node() { return random_.whole(0, network_.nodes); }

  /// Every node is tied to an earlier one; to ground by one part at least, of any kind if the network may float.
  void add_tree() {
    const bool may_float = random_.chance(recipe_.floating);
    for (int node = 1; node <= network_.nodes; ++node) {
      const int other = random_.whole(node == 1 || may_float ? 0 : 1, node - 1);
      add_part(node, other);
    }
    if (!may_float) add(Kind::resistor, random_.whole(1, network_.nodes), 0);
  }

  Kind any_kind() {
    const double weights[] = {recipe_.resistor, recipe_.capacitor, recipe_.inductor, recipe_.diode,
                              recipe_.switch_,  recipe_.voltage,   recipe_.current};
    double left = random_.unit() * std::accumulate(std::begin(weights), std::end(weights), 0.0);
    int kind = 0;
    while (kind < 6 && left >= weights[kind]) left -= weights[kind++];
    return static_cast<Kind>(kind);
  }

  void add_part(int p, int n) {
    if (p == n) return;
    const Kind kind = any_kind();
    if (random_.chance(0.5)) std::swap(p, n);
    add(may_add(kind) ? kind : Kind::resistor, p, n);
    const bool twice = kind != Kind::voltage && random_.chance(0.1);
    if (twice && may_add(kind)) add(kind, p, n);
  }

  bool may_add(Kind kind) const {
    if (kind == Kind::diode) return count(kind) < recipe_.most_diodes;
    return kind != Kind::switch_ || count(kind) < recipe_.most_switches;
  }

  int count(Kind kind) const {
    return static_cast<int>(
        std::count_if(network_.parts.begin(), network_.parts.end(), [&](const NetworkPart& part) { return part.kind == kind; }));
  }

  double spread_value(double unit) { return rounded(unit * std::pow(10.0, random_.between(-recipe_.spread, recipe_.spread))); }

  void add(Kind kind, int p, int n) {
    static constexpr const char* letters = "RCLDSVI";
    NetworkPart part;
    part.kind = kind;
    part.name = letters[static_cast<int>(kind)] + std::to_string(count(kind) + 1);
    part.p = p;
    part.n = n;
    const bool at_rest = random_.chance(0.3);
    switch (kind) {
      case Kind::resistor:
        part.value = spread_value(resistance_unit);
        break;
      case Kind::capacitor:
        part.value = spread_value(time_unit / resistance_unit);
        part.initial = at_rest ? 0.0 : rounded(random_.between(-voltage_unit, voltage_unit));
        break;
      case Kind::inductor:
        part.value = spread_value(time_unit * resistance_unit);
        part.initial = at_rest ? 0.0 : rounded(random_.between(-1.0, 1.0) * voltage_unit / resistance_unit);
        break;
      case Kind::diode:
        if (recipe_.real_diodes > 0.0 && random_.chance(recipe_.real_diodes)) {
          part.value = rounded(std::pow(10.0, random_.between(-3.0, 0.0)));
          part.leak = rounded(std::pow(10.0, random_.between(5.0, 9.0)));
        }
        break;
      case Kind::switch_:
        set_pulse(part, 0.0, 1.0);
        break;
      case Kind::voltage:
        if (!random_.chance(recipe_.stiff_source)) part.value = spread_value(resistance_unit);
        set_source(part, voltage_unit);
        break;
      case Kind::current:
        set_source(part, voltage_unit / resistance_unit);
        break;
    }
    network_.parts.push_back(std::move(part));
  }

  void set_source(NetworkPart& part, double unit) {
    const double level = rounded(random_.between(-unit, unit));
    const double other = rounded(random_.between(-unit, unit));
    const double choice = random_.unit();
    if (choice < 0.3) {
      part.function = model::Dc{level};
      part.waveform = fmt::format("DC {}", level);
    } else if (choice < 0.65) {
      model::Sin sine;
      sine.offset = random_.chance(0.5) ? 0.0 : level;
      sine.amplitude = other;
      sine.frequency = frequency();
      part.function = sine;
      part.waveform = fmt::format("SIN({} {} {})", sine.offset, sine.amplitude, sine.frequency);
    } else {
      set_pulse(part, level, other);
    }
  }

  double frequency() { return rounded(slowest_ * std::pow(10.0, random_.between(0.0, 0.7))); }

  void set_pulse(NetworkPart& part, double low, double high) {
    model::Pulse pulse;
    pulse.initial = low;
    pulse.pulsed = high;
    pulse.period = rounded(1.0 / frequency());
    pulse.delay = rounded(random_.between(0.0, 0.5) * pulse.period);
    pulse.width = rounded(random_.between(0.1, 0.8) * pulse.period);
    if (random_.chance(0.5)) pulse.rise = pulse.fall = rounded(0.05 * pulse.period);
    part.function = pulse;
    part.waveform = fmt::format("PULSE({} {} {} {} {} {} {})", low, high, pulse.delay, pulse.rise, pulse.fall, pulse.width, pulse.period);
  }

  /// Gives resistance to the sources that need it.
  void soften_sources() {
    for (NetworkPart& part : network_.parts)
      if (is_stiff_voltage(part) && is_in_rigid_loop(network_, part)) part.value = spread_value(resistance_unit);
    std::vector<std::pair<int, int>> stranded;
    for (const NetworkPart& part : network_.parts)
      if (part.kind == Kind::current && has_no_return(network_, part)) stranded.emplace_back(part.p, part.n);
    for (const auto& [p, n] : stranded) add(Kind::resistor, p, n);
  }

  Random random_;
  const Recipe& recipe_;
  RandomNetwork network_;
  double slowest_ = 0.0;
};

/// Emits one network in some numbering.
class Emitter {
 public:
  explicit Emitter(const RandomNetwork& network) : network_(network), state_(network.parts.size(), -1) {}

  model::Network run(const std::vector<int>& part_order, const std::vector<int>& node_order) {
    for (const int node : node_order) static_cast<void>(builder_.node(fmt::format("n{}", node + 1)));
    for (const int part : part_order) emit(static_cast<std::size_t>(part));
    for (std::size_t i = 0; i < network_.parts.size(); ++i) save(i);
    return builder_.take();
  }

 private:
  model::NodeIndex node(int number) { return number == 0 ? model::ground : builder_.node(fmt::format("n{}", number)); }

  void emit(std::size_t index) {
    const NetworkPart& part = network_.parts[index];
    const model::Label label{part.name, {}};
    const auto p = node(part.p), n = node(part.n);
    switch (part.kind) {
      case Kind::resistor:
        builder_.add(model::Resistor{label, p, n, part.value});
        return;
      case Kind::capacitor:
        state_[index] = builder_.add(model::Capacitor{label, p, n, part.value, true, part.initial});
        return;
      case Kind::inductor:
        state_[index] = builder_.add(model::Inductor{label, p, n, part.value, true, part.initial});
        return;
      case Kind::diode:
        builder_.add(model::Diode{label, p, n, part.value, 0.0});
        if (part.leak > 0.0) builder_.add(model::Resistor{label, p, n, part.leak});
        return;
      case Kind::switch_:
        emit_switch(part, p, n);
        return;
      case Kind::voltage: {
        const int source = builder_.add(model::Source{label, part.function});
        const int branch = builder_.add(model::Branch{label, p, n, {}});
        auto& voltage = builder_.network().branches[static_cast<std::size_t>(branch)].voltage;
        voltage.push_back({model::Term::Kind::source, source, 1.0});
        if (part.value > 0.0) voltage.push_back({model::Term::Kind::branch_current, branch, part.value});
        return;
      }
      case Kind::current: {
        const int source = builder_.add(model::Source{label, part.function});
        builder_.add(model::Injection{label, p, n, {{model::Term::Kind::source, source, 1.0}}});
        return;
      }
    }
  }

  void emit_switch(const NetworkPart& part, model::NodeIndex p, model::NodeIndex n) {
    const auto gate = builder_.node("g" + part.name);
    const model::Label clock{"VG" + part.name, {}};
    const int source = builder_.add(model::Source{clock, part.function});
    builder_.add(model::Branch{clock, gate, model::ground, {{model::Term::Kind::source, source, 1.0}}});
    model::Switch item;
    item.label.name = part.name;
    item.p = p;
    item.n = n;
    item.control = model::voltage_between(gate, model::ground);
    item.on_level = item.off_level = clock_threshold;
    builder_.add(item);
  }

  void save(std::size_t index) {
    const NetworkPart& part = network_.parts[index];
    if (part.kind == Kind::capacitor)
      builder_.add(model::Signal{"v(" + part.name + ")", model::voltage_between(node(part.p), node(part.n))});
    if (part.kind == Kind::inductor)
      builder_.add(model::Signal{"i(" + part.name + ")", {{model::Term::Kind::inductor_current, state_[index], 1.0}}});
  }

  const RandomNetwork& network_;
  std::vector<int> state_;
  model::NetworkBuilder builder_;
};

std::vector<int> counted(std::size_t size) {
  std::vector<int> order(size);
  std::iota(order.begin(), order.end(), 0);
  return order;
}

std::string node_text(int node) { return node == 0 ? "0" : fmt::format("n{}", node); }

}  // namespace

bool RandomNetwork::has_sources() const {
  return std::any_of(parts.begin(), parts.end(),
                     [](const NetworkPart& part) { return part.kind == Kind::voltage || part.kind == Kind::current; });
}

RandomNetwork make_random_network(std::uint64_t seed, const Recipe& recipe) { return Generator(seed, recipe).run(); }

bool sources_can_be_met(const RandomNetwork& network) {
  return std::none_of(network.parts.begin(), network.parts.end(), [&](const NetworkPart& part) {
    return (is_stiff_voltage(part) && is_in_rigid_loop(network, part)) || (part.kind == Kind::current && has_no_return(network, part));
  });
}

model::Network to_model(const RandomNetwork& network, const std::vector<int>& part_order, const std::vector<int>& node_order) {
  return Emitter(network).run(part_order, node_order);
}

model::Network to_model(const RandomNetwork& network) {
  return to_model(network, counted(network.parts.size()), counted(static_cast<std::size_t>(network.nodes)));
}

std::string to_deck(const RandomNetwork& network) {
  std::string deck = "random network\n";
  std::string saved;
  for (const NetworkPart& part : network.parts) {
    const std::string head = fmt::format("{} {} {}", part.name, node_text(part.p), node_text(part.n));
    switch (part.kind) {
      case Kind::resistor:
        deck += fmt::format("{} {}\n", head, part.value);
        break;
      case Kind::capacitor:
      case Kind::inductor:
        deck += fmt::format("{} {} ic={}\n", head, part.value, part.initial);
        saved +=
            part.kind == Kind::inductor ? fmt::format(" i({})", part.name) : fmt::format(" v({},{})", node_text(part.p), node_text(part.n));
        break;
      case Kind::diode:
        if (part.leak > 0.0) {
          // The deck's Ron is the slope of both together.
          deck += fmt::format("{} D{}\n.model D{} D(Ron={} Roff={})\n", head, part.name, part.name,
                              part.value * part.leak / (part.value + part.leak), part.leak);
        } else {
          deck += head + " DI\n";
        }
        break;
      case Kind::switch_:
        deck += fmt::format("{} g{} 0 SWI\nVG{} g{} 0 {}\n", head, part.name, part.name, part.name, part.waveform);
        break;
      case Kind::voltage:
        deck += fmt::format("{} {} Rser={}\n", head, part.waveform, part.value);
        break;
      case Kind::current:
        deck += fmt::format("{} {}\n", head, part.waveform);
        break;
    }
  }
  return deck + fmt::format(".model DI D\n.model SWI SW(Vt={})\n.save{}\n.tran {} {} uic\n.end\n", clock_threshold, saved,
                            network.stop / 100, network.stop);
}

RandomNetwork smallest(RandomNetwork network, const std::function<bool(const RandomNetwork&)>& fails) {
  for (bool smaller = true; smaller;) {
    smaller = false;
    for (std::size_t i = 0; i < network.parts.size(); ++i) {
      RandomNetwork without = network;
      without.parts.erase(without.parts.begin() + static_cast<long>(i));
      if (without.parts.empty() || !sources_can_be_met(without) || !fails(without)) continue;
      network = std::move(without);
      smaller = true;
      --i;
    }
  }
  return network;
}

}  // namespace pwlsim::test
