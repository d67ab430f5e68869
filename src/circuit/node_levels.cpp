#include "circuit/node_levels.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "circuit/level_edges.hpp"
#include "circuit/unread_parts.hpp"

namespace pwlsim::circuit {
namespace {

using elements::AffineSum;
using elements::Formula;
using elements::FormulaPart;
using elements::Instance;
using model::NodeIndex;
using PartKind = FormulaPart::Kind;

/// The way from one value to another.
enum class Edges { none, short_ones, long_ones };

/// One value or two, ascending.
struct Taken {
  std::vector<double> values{0.0};
  Edges edges = Edges::none;  ///< on its way from one to the other it is between them for a time
};
using MaybeTaken = std::optional<Taken>;

/// Values that differ by less are one but for the rounding of the arithmetic that made them.
constexpr double level_rounding = 1e-12;

MaybeTaken taken(std::vector<double> values, Edges edges) {
  std::sort(values.begin(), values.end());
  const auto is_same = [](double a, double b) { return b - a <= level_rounding * std::max(std::abs(a), std::abs(b)); };
  values.erase(std::unique(values.begin(), values.end(), is_same), values.end());
  if (values.empty() || values.size() > 2) return std::nullopt;
  return Taken{std::move(values), edges};
}

/// a + factor·b
MaybeTaken sum_of(const Taken& a, const Taken& b, double factor) {
  std::vector<double> values;
  for (const double x : a.values)
    for (const double y : b.values) values.push_back(x + factor * y);
  return taken(std::move(values), factor != 0.0 ? std::max(a.edges, b.edges) : a.edges);
}

Edges edges_of(bool has_some, bool has_short_ones) {
  if (!has_some) return Edges::none;
  return has_short_ones ? Edges::short_ones : Edges::long_ones;
}

/// In a run until `stop`.
MaybeTaken taken_by(const model::SourceFunction& function, double stop) {
  if (const auto* dc = std::get_if<model::Dc>(&function)) return Taken{{dc->value}};
  if (const auto* pulse = std::get_if<model::Pulse>(&function))
    return taken({pulse->initial, pulse->pulsed}, edges_of(pulse->rise > 0.0 || pulse->fall > 0.0, has_short_edges(*pulse, stop)));
  const auto* pwl = std::get_if<model::Pwl>(&function);
  if (pwl == nullptr) return std::nullopt;
  std::vector<double> values;
  bool has_edges = pwl->repeats > 0.0 && pwl->points.back().value != pwl->points.front().value && pwl->repeat_from == 0.0;
  for (std::size_t k = 0; k < pwl->points.size(); ++k) {
    values.push_back(pwl->points[k].value);
    has_edges |= k > 0 && pwl->points[k].time > pwl->points[k - 1].time && values[k] != values[k - 1];
  }
  return taken(std::move(values), edges_of(has_edges, has_short_edges(*pwl, stop)));
}

class NodeLevels {
 public:
  explicit NodeLevels(const FlatCircuit& circuit)
      : stop_(circuit.analyses.transient ? circuit.analyses.transient->stop.seconds : model::forever) {
    for (const Instance& instance : circuit.instances) {
      if (!is_voltage(instance)) continue;
      holders_.emplace(instance.nodes[0], &instance);
      holders_.emplace(instance.nodes[1], &instance);
    }
    for (const GateOutput& output : circuit.gate_outputs) gates_.emplace(output.node, taken({output.low, output.high}, Edges::none));
  }

  /// Empty: it takes other values, or that is not known.
  MaybeTaken of(NodeIndex node) {
    constexpr int deepest = 30;
    if (node == model::ground) return Taken{};
    if (depth_ >= deepest) return std::nullopt;
    ++depth_;
    MaybeTaken result = held(node);
    --depth_;
    return result;
  }

  MaybeTaken of(const elements::NodePair& pair) {
    const std::size_t known = used_.size();
    const MaybeTaken p = of(pair.p), n = p ? of(pair.n) : std::nullopt;
    MaybeTaken result = n ? sum_of(*p, *n, -1.0) : std::nullopt;
    if (!result) used_.resize(known);
    return result;
  }
  /// Elements that hold what has been found since the last call.
  [[nodiscard]] std::vector<const Instance*> take_used() { return std::exchange(used_, {}); }

 private:
  /// Two terminals whose voltage nothing else changes.
  static bool is_voltage(const Instance& instance) {
    if (instance.kind == nullptr || instance.nodes.size() != 2) return false;
    const char letter = instance.kind->letter;
    if (letter == 'V') return instance.waveform.has_value() && !(instance.values.has("rser") && instance.values.get("rser") != 0.0);
    return letter == 'E' || (letter == 'B' && !instance.formula_is_current);
  }

  MaybeTaken held(NodeIndex node) {
    if (const auto gate = gates_.find(node); gate != gates_.end()) return gate->second;
    const auto [first, last] = holders_.equal_range(node);
    for (auto at = first; at != last; ++at) {
      const Instance& instance = *at->second;
      const bool is_first = instance.nodes[0] == node;
      const MaybeTaken other = of(instance.nodes[is_first ? 1 : 0]);
      const MaybeTaken own = other ? across(instance) : std::nullopt;
      if (!own) continue;
      used_.push_back(&instance);
      return sum_of(*other, *own, is_first ? 1.0 : -1.0);
    }
    return std::nullopt;
  }

  MaybeTaken across(const Instance& instance) {
    if (instance.waveform) return taken_by(*instance.waveform, stop_);
    if (instance.formula) return of_formula(instance, *instance.formula);
    if (instance.coefficients.size() != instance.control_nodes.size() + 1) return std::nullopt;
    MaybeTaken sum = Taken{{instance.coefficients[0]}};
    for (std::size_t k = 0; sum && k < instance.control_nodes.size(); ++k) {
      const MaybeTaken control = of(instance.control_nodes[k]);
      sum = control ? sum_of(*sum, *control, instance.coefficients[k + 1]) : std::nullopt;
    }
    return sum;
  }

  /// Under every combination of what its comparisons, choices and voltages may be.
  MaybeTaken of_formula(const Instance& instance, const Formula& formula) {
    constexpr std::size_t most_atoms = 8;
    std::vector<MaybeTaken> parts;
    for (const FormulaPart& part : formula.parts) parts.push_back(alone(instance, part));
    const auto is_atom = [&](std::size_t k) { return parts[k] && parts[k]->values.size() == 2; };
    std::vector<std::size_t> atoms;
    for (std::size_t k = 0; k < parts.size(); ++k)
      if (is_atom(k)) atoms.push_back(k);
    if (atoms.size() > most_atoms) return std::nullopt;
    std::vector<double> values;
    for (std::size_t bits = 0; bits < (std::size_t{1} << atoms.size()); ++bits) {
      const std::optional<double> value = evaluate(formula, parts, atoms, bits);
      if (!value) return std::nullopt;
      values.push_back(*value);
    }
    Edges edges = Edges::none;
    for (const std::size_t k : atoms) edges = std::max(edges, parts[k]->edges);
    return taken(std::move(values), edges);
  }

  /// What a part takes whatever the others do; of a choice, its condition.
  MaybeTaken alone(const Instance& instance, const FormulaPart& part) {
    if (part.kind == PartKind::step || part.kind == PartKind::choice) return Taken{{0.0, 1.0}};
    if (part.kind == PartKind::voltage) return of(instance.control_nodes[static_cast<std::size_t>(part.index)]);
    if (part.kind == PartKind::time) return taken_by(part.function, stop_);
    return std::nullopt;
  }

  static std::optional<double> evaluate(const Formula& formula, const std::vector<MaybeTaken>& parts, const std::vector<std::size_t>& atoms,
                                        std::size_t bits) {
    std::vector<std::optional<double>> value(parts.size());
    const auto sum = [&](const AffineSum& x) -> std::optional<double> {
      double total = x.constant.value;
      for (const auto& [part, coefficient] : x.terms) {
        const std::optional<double>& each = value[static_cast<std::size_t>(part)];
        if (!each) return std::nullopt;
        total += coefficient.value * *each;
      }
      return total;
    };
    for (std::size_t k = 0; k < parts.size(); ++k) {
      const FormulaPart& part = formula.parts[k];
      const auto atom = static_cast<std::size_t>(std::find(atoms.begin(), atoms.end(), k) - atoms.begin());
      const bool is_high = atom < atoms.size() && ((bits >> atom) & 1U) != 0;
      if (part.kind == PartKind::choice)
        value[k] = sum(is_high ? part.above : part.below);
      else if (parts[k])
        value[k] = is_high ? parts[k]->values.back() : parts[k]->values.front();
      else if (part.kind == PartKind::positive)
        if (const std::optional<double> argument = sum(part.argument)) value[k] = std::max(*argument, 0.0);
    }
    return sum(formula.value);
  }

  std::multimap<NodeIndex, const Instance*> holders_;
  std::map<NodeIndex, MaybeTaken> gates_;
  std::vector<const Instance*> used_;
  double stop_ = model::forever;  ///< of the run
  int depth_ = 0;
};

constexpr std::string_view refused_derivative = "the derivative of a product that jumps has no piecewise-linear form";

std::string refusal(const FormulaPart& part) {
  if (part.kind == PartKind::call && part.called.name == "tanh") return "tanh of a signal has no piecewise-linear form; try limit(x,-1,1)";
  if (part.kind == PartKind::call)
    return fmt::format("{} has no piecewise-linear form",
                       part.called.name == "pow" ? "a power of a signal" : fmt::format("{} of a signal", part.called.name));
  return part.kind == PartKind::quotient
             ? "a division by a signal has no piecewise-linear form, unless that is a voltage of two levels, neither of them zero"
             : "a product of signals has no piecewise-linear form, unless one of them is a voltage of two levels";
}

class Products {
 public:
  Products(FlatCircuit& circuit, Reporter& reporter) : circuit_(circuit), reporter_(reporter), levels_(circuit) {}

  void resolve() {
    for (std::size_t k = 0; k < circuit_.instances.size(); ++k) resolve(static_cast<int>(k));
    std::vector<int> sources;
    for (const Refusal& refusal : refusals_) sources.push_back(refusal.source);
    const std::vector<UnreadPart> parts = circuit_.written_by_ltspice ? leave_out_unread(circuit_, sources) : std::vector<UnreadPart>{};
    for (const Refusal& refusal : refusals_) {
      const std::string text = fmt::format("{}: {}", circuit_.instances[static_cast<std::size_t>(refusal.source)].name, refusal.text);
      const auto part = std::find_if(parts.begin(), parts.end(), [&](const UnreadPart& each) { return each.source == refusal.source; });
      if (part == parts.end())
        reporter_.error("E-not-piecewise-linear", refusal.span, text);
      else
        reporter_.warning("W-unread-part", refusal.span, fmt::format("{}; {}", text, what_is_left_out(*part)));
    }
  }

 private:
  struct Refusal {
    int source = -1;
    SourceSpan span;
    std::string text;
  };

  static std::string what_is_left_out(const UnreadPart& part) {
    const std::string with = part.elements.empty() ? "" : fmt::format(", with {}", fmt::join(part.elements, ", "));
    return fmt::format("nothing reads its output, so V({}) {} left out{}; try the expression in .meas", fmt::join(part.nodes, "), V("),
                       part.nodes.size() == 1 ? "is" : "are", with);
  }

  void resolve(int source) {
    Instance& instance = circuit_.instances[static_cast<std::size_t>(source)];
    if (!instance.formula || instance.formula->open_products.empty()) return;
    const auto levels = [&](int pair) { return of(instance, pair); };
    int failed = -1;
    const auto constant = [&](int pair) -> std::optional<double> {
      const MaybeTaken found = levels_.of(instance.control_nodes[static_cast<std::size_t>(pair)]);
      return found && found->values.size() == 1 ? std::optional(found->values.front()) : std::nullopt;
    };
    (void)levels_.take_used();
    std::optional<Formula> formula = elements::without_products(*instance.formula, levels, constant, failed);
    if (formula) {
      instance.formula = std::move(formula);
      for (const Instance* used : levels_.take_used())
        circuit_.folded.push_back({static_cast<int>(used - circuit_.instances.data()), source});
      return;
    }
    const auto& open = instance.formula->open_products;
    const auto found = std::find_if(open.begin(), open.end(), [&](const auto& product) { return product.first == failed; });
    refusals_.push_back({source, found != open.end() ? found->second : instance.span,
                         found != open.end()
                             ? refusal(instance.formula->parts[static_cast<std::size_t>(failed)]) + slow_edges(instance, failed)
                             : std::string(refused_derivative)});
  }

  /// Why a voltage between two levels is no factor: "" if the part reads none.
  std::string slow_edges(const Instance& instance, int part) {
    for (const AffineSum* sum :
         {&instance.formula->parts[static_cast<std::size_t>(part)].above, &instance.formula->parts[static_cast<std::size_t>(part)].below})
      for (const auto& term : sum->terms) {
        const FormulaPart& factor = instance.formula->parts[static_cast<std::size_t>(term.first)];
        if (factor.kind != PartKind::voltage) continue;
        const elements::NodePair& pair = instance.control_nodes[static_cast<std::size_t>(factor.index)];
        const MaybeTaken found = levels_.of(pair);
        if (found && found->values.size() == 2 && found->edges == Edges::long_ones)
          return fmt::format("; V({}) is none: its edges between {} and {} are long, a ramp or a triangle", node_name(pair),
                             found->values[0], found->values[1]);
      }
    return "";
  }

  std::optional<elements::Levels> of(const Instance& instance, int pair) {
    const MaybeTaken found = levels_.of(instance.control_nodes[static_cast<std::size_t>(pair)]);
    if (!found || (found->values.size() == 2 && found->edges == Edges::long_ones)) return std::nullopt;
    const elements::Levels levels{found->values.front(), found->values.back()};
    if (found->edges != Edges::none) note_edges(instance, pair, levels);
    return levels;
  }

  const std::string& node_name(const elements::NodePair& pair) { return circuit_.nodes()[static_cast<std::size_t>(pair.p)].name; }

  void note_edges(const Instance& instance, int pair, const elements::Levels& levels) {
    if (!reporter_.first_time(fmt::format("edges:{}:{}", instance.name, pair))) return;
    reporter_.note("N-switched-product", instance.span,
                   fmt::format("{}: as a factor V({}) counts as {} above {} and as {} below: its edges take no time there", instance.name,
                               node_name(instance.control_nodes[static_cast<std::size_t>(pair)]), levels.high,
                               0.5 * (levels.low + levels.high), levels.low));
  }

  FlatCircuit& circuit_;
  Reporter& reporter_;
  NodeLevels levels_;
  std::vector<Refusal> refusals_;
};

}  // namespace

void resolve_products(FlatCircuit& circuit, Reporter& reporter) {
  const auto is_open = [](const Instance& instance) { return instance.formula && !instance.formula->open_products.empty(); };
  if (std::none_of(circuit.instances.begin(), circuit.instances.end(), is_open)) return;
  Products products(circuit, reporter);
  products.resolve();
}

}  // namespace pwlsim::circuit
