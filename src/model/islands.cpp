#include "model/islands.hpp"

#include <algorithm>
#include <map>
#include <optional>

#include "base/disjoint_sets.hpp"
#include "model/forms.hpp"
#include "model/things.hpp"

namespace pwlsim::model {

namespace {

/// A node held at a voltage of time alone by a source to ground. What hangs on a rail from different sides shares nothing: every part
/// gets its own copy of the source, and the source's current is the sum over the copies.
struct Rails {
  explicit Rails(const Network& n) : branch_of(n.nodes.size(), -1) {
    std::vector<char> current_read(n.branches.size(), 0);
    const auto read = [&](const LinearForm& form) {
      for (const auto& term : form)
        if (term.kind == Term::Kind::branch_current) current_read[static_cast<std::size_t>(term.index)] = 1;
    };
    for_each_equation(n, read);
    for (const auto& s : n.switches) read(s.control);
    for (std::size_t i = 0; i < n.branches.size(); ++i) {
      const Branch& b = n.branches[i];
      if ((b.p == ground) == (b.n == ground) || current_read[i] != 0) continue;
      auto& holder = branch_of[static_cast<std::size_t>(b.p == ground ? b.n : b.p)];
      if (holder < 0 && is_independent(b.voltage)) holder = static_cast<int>(i);
    }
    for (const auto& c : n.node_conditions)  // a forced voltage speaks of the one node as it stands
      if (c.node != ground) branch_of[static_cast<std::size_t>(c.node)] = -1;
  }
  [[nodiscard]] bool holds(NodeIndex node) const { return node != ground && branch_of[static_cast<std::size_t>(node)] >= 0; }
  [[nodiscard]] bool reads(const Term& term) const { return term.kind == Term::Kind::node_voltage && holds(term.index); }

  std::vector<int> branch_of;  ///< node -> the branch that holds it, −1: none
};

/// What a Connector takes for a connection: terminals and what forms read, or terminals and complementarities alone.
enum class Links { all, without_controlled };

/// Joins what is connected; with `rails`, not across them.
class Connector {
 public:
  Connector(const Network& network, const Things& things, const Rails* rails, Links links = Links::all, Controls controls = Controls::apart)
      : things_(things), rails_(rails), sets_(things.count) {
    const auto join = [&](int element, NodeIndex node) {
      if (node != ground && !is_rail(node)) sets_.join(element, things.node + node);
    };
    for_each_terminal(network, things, join);
    for_each_terminal(network.branches, things.branch, join);
    if (rails)
      for (std::size_t i = 0; i < rails->branch_of.size(); ++i)
        if (rails->branch_of[i] >= 0) sets_.join(things.node + static_cast<int>(i), things.branch + rails->branch_of[i]);
    for (const auto& k : network.couplings) sets_.join(things.inductor + k.inductor_a, things.inductor + k.inductor_b);
    for (std::size_t i = 0; i < network.diodes.size(); ++i)
      for (const int s : network.diodes[i].enabled_by) sets_.join(things.diode + static_cast<int>(i), things.switch_ + s);
    for (std::size_t i = 0; i < network.complementarities.size(); ++i)
      form(network.complementarities[i].slack, things.complementarity + static_cast<int>(i));
    if (links == Links::without_controlled) return;
    for (std::size_t i = 0; i < network.branches.size(); ++i) form(network.branches[i].voltage, things.branch + static_cast<int>(i));
    for (std::size_t i = 0; i < network.injections.size(); ++i) form(network.injections[i].current, things.injection + static_cast<int>(i));
    for (std::size_t i = 0; i < network.switches.size(); ++i) {
      control(network.switches[i].control);
      if (controls == Controls::joined) form(network.switches[i].control, things.switch_ + static_cast<int>(i));
    }
  }
  [[nodiscard]] DisjointSets take() { return std::move(sets_); }

 private:
  [[nodiscard]] bool is_rail(NodeIndex node) const { return rails_ && rails_->holds(node); }

  void form(const LinearForm& terms, int with) {
    for (const auto& term : terms) {
      const int thing = things_.of(term);
      if (thing < 0 || (rails_ && rails_->reads(term))) continue;
      if (with < 0) with = thing;
      sets_.join(with, thing);
    }
  }

  /// A control that reads nothing but rails lives where they do.
  void control(const LinearForm& terms) {
    const bool only_rails =
        std::all_of(terms.begin(), terms.end(), [&](const Term& t) { return things_.of(t) < 0 || (rails_ && rails_->reads(t)); });
    if (!only_rails) return form(terms, -1);
    int with = -1;
    for (const auto& term : terms) {
      const int thing = things_.of(term);
      if (thing < 0) continue;
      if (with >= 0) sets_.join(with, thing);
      with = thing;
    }
  }

  const Things& things_;
  const Rails* rails_;
  DisjointSets sets_;
};

/// Copies elements into their island and remembers their new numbers.
class Distributor {
 public:
  Distributor(const Network& network, const Things& things, const Rails& rails, DisjointSets& sets, DisjointSets& parts, Controls controls)
      : network_(network),
        things_(things),
        rails_(rails),
        sets_(sets),
        parts_(parts),
        controls_(controls),
        local_(static_cast<std::size_t>(things.count), -1) {}

  std::vector<Island> run(const std::function<bool(const Island&)>& must_run) {
    for (std::size_t i = 0; i < network_.nodes.size(); ++i) {
      Island& island = island_of(things_.node + static_cast<int>(i));
      local_[static_cast<std::size_t>(things_.node) + i] = static_cast<int>(island.network.nodes.size());
      island.network.nodes.push_back(network_.nodes[i]);
    }
    copy(network_.resistors, things_.resistor, &Network::resistors);
    copy(network_.capacitors, things_.capacitor, &Network::capacitors);
    copy(network_.inductors, things_.inductor, &Network::inductors);
    copy(network_.branches, things_.branch, &Network::branches);
    copy(network_.injections, things_.injection, &Network::injections);
    copy(network_.diodes, things_.diode, &Network::diodes);
    copy_complementarities();
    copy(network_.switches, things_.switch_, &Network::switches);
    for (const auto& k : network_.couplings) {
      const int a = things_.inductor + k.inductor_a;
      island_of(a).network.couplings.push_back({k.label, local(a), local(things_.inductor + k.inductor_b), k.coefficient});
    }
    for (auto& island : islands_) {
      for (auto& diode : island.network.diodes)
        for (int& s : diode.enabled_by) s = local(things_.switch_ + s);
      translate_forms(island);
    }
    add_conditions();
    add_switches();
    add_signals();
    name_islands();
    mark_needed(must_run);
    return std::move(islands_);
  }

 private:
  [[nodiscard]] int local(int thing) const { return local_[static_cast<std::size_t>(thing)]; }

  std::size_t island_index(int thing) {
    const int root = sets_.find(thing);
    const auto [it, is_new] = index_.try_emplace(root, islands_.size());
    if (is_new) {
      islands_.emplace_back();
      islands_.back().part = parts_.find(thing);
    }
    return it->second;
  }
  Island& island_of(int thing) { return islands_[island_index(thing)]; }

  template <class Element>
  void copy(const std::vector<Element>& elements, int first, std::vector<Element> Network::*list) {
    for (std::size_t i = 0; i < elements.size(); ++i) {
      const int thing = first + static_cast<int>(i);
      const std::size_t which = island_index(thing);
      Element element = elements[i];
      // A rail's copy may join the same list on the way.
      for (NodeIndex* node : {&element.p, &element.n})
        if (*node != ground) *node = node_in(which, *node);
      auto& target = islands_[which].network.*list;
      local_[static_cast<std::size_t>(thing)] = static_cast<int>(target.size());
      target.push_back(std::move(element));
    }
  }

  void copy_complementarities() {
    for (std::size_t i = 0; i < network_.complementarities.size(); ++i) {
      const int thing = things_.complementarity + static_cast<int>(i);
      auto& list = island_of(thing).network.complementarities;
      local_[static_cast<std::size_t>(thing)] = static_cast<int>(list.size());
      list.push_back(network_.complementarities[i]);
    }
  }

  /// The island's own number of a node; a rail that it does not hold yet is copied in, with its source.
  int node_in(std::size_t which, NodeIndex node) {
    const int thing = things_.node + node;
    if (!rails_.holds(node) || island_index(thing) == which) return local(thing);
    const auto [it, is_new] = copies_.try_emplace({which, node}, static_cast<int>(islands_[which].network.nodes.size()));
    if (!is_new) return it->second;
    const int copy = it->second;
    const int branch = rails_.branch_of[static_cast<std::size_t>(node)];
    Network& network = islands_[which].network;
    network.nodes.push_back(network_.nodes[static_cast<std::size_t>(node)]);
    Branch source = network_.branches[static_cast<std::size_t>(branch)];
    (source.p == ground ? source.n : source.p) = copy;
    for (auto& term : source.voltage) term = translated(term, islands_[which]);
    branch_copies_[branch].emplace_back(which, static_cast<int>(network.branches.size()));
    islands_[which].copied_branches.push_back(static_cast<int>(network.branches.size()));
    network.branches.push_back(std::move(source));
    return copy;
  }

  [[nodiscard]] Term translated(const Term& term, Island& island) {
    Term result = term;
    if (term.kind == Term::Kind::source) result.index = source_in(island, term.index);
    const int thing = things_.of(term);
    if (thing >= 0)
      result.index = rails_.reads(term) ? node_in(static_cast<std::size_t>(&island - islands_.data()), term.index) : local(thing);
    return result;
  }

  /// A source lives in every island that uses it.
  int source_in(Island& island, int source) {
    const std::size_t which = static_cast<std::size_t>(&island - islands_.data());
    const auto [it, is_new] = sources_.try_emplace({which, source}, static_cast<int>(island.network.sources.size()));
    if (is_new) island.network.sources.push_back(network_.sources[static_cast<std::size_t>(source)]);
    return it->second;
  }

  void translate_forms(Island& island) {
    // Copies of rail sources, some of which join the list on the way, are translated already.
    for (std::size_t i = 0; i < island.network.branches.size(); ++i) {
      const auto& copied = island.copied_branches;
      if (std::find(copied.begin(), copied.end(), static_cast<int>(i)) != copied.end()) continue;
      LinearForm form = island.network.branches[i].voltage;
      for (auto& term : form) term = translated(term, island);
      island.network.branches[i].voltage = std::move(form);
    }
    for (auto& i : island.network.injections)
      for (auto& term : i.current) term = translated(term, island);
    for (auto& c : island.network.complementarities)
      for (auto& term : c.slack) term = translated(term, island);
  }

  void add_conditions() {
    for (const auto& c : network_.node_conditions)
      if (c.node != ground) {
        const int thing = things_.node + c.node;
        island_of(thing).network.node_conditions.push_back({c.label, local(thing), c.voltage});
      }
    for (const auto& c : network_.current_conditions) {
      const int thing = things_.inductor + c.inductor;
      island_of(thing).network.current_conditions.push_back({c.label, local(thing), c.current});
    }
  }

  /// The island a form reads (rails do not count beside other things); one of its own where it reads constants and sources only.
  std::size_t home_of(const LinearForm& form) {
    for (const bool rails_too : {false, true})
      for (const auto& term : form)
        if (const int thing = things_.of(term); thing >= 0 && (rails_too || !rails_.reads(term))) return island_index(thing);
    islands_.emplace_back();
    return islands_.size() - 1;
  }

  void add_switches() {
    for (std::size_t i = 0; i < network_.switches.size(); ++i)
      island_of(things_.switch_ + static_cast<int>(i)).switch_number.push_back(static_cast<int>(i));
    if (controls_ == Controls::joined) {
      for (auto& island : islands_)
        for (auto& s : island.network.switches)
          for (auto& term : s.control) term = translated(term, island);
      return;
    }
    for (std::size_t i = 0; i < network_.switches.size(); ++i) {
      const auto& s = network_.switches[i];
      Island& home = islands_[home_of(s.control)];
      Island::ControlForm control{{}, static_cast<int>(i), s.on_level, s.off_level};
      for (const auto& term : s.control) control.value.push_back(translated(term, home));
      home.controls.push_back(std::move(control));
    }
  }

  void add_signals() {
    for (std::size_t i = 0; i < network_.signals.size(); ++i) {
      const auto& signal = network_.signals[i];
      std::map<std::size_t, LinearForm> shares;
      std::size_t first = islands_.size();
      for (const auto& term : signal.form)
        if (const int thing = things_.of(term); thing >= 0 && first == islands_.size()) first = island_index(thing);
      if (first == islands_.size()) first = home_of(signal.form);
      for (const auto& term : signal.form) {
        const int thing = things_.of(term);
        const std::size_t home = thing >= 0 ? island_index(thing) : first;
        shares[home].push_back(translated(term, islands_[home]));
        if (term.kind != Term::Kind::branch_current) continue;
        for (const auto& [which, branch] : branch_copies_[term.index]) shares[which].push_back({term.kind, branch, term.coefficient});
      }
      for (auto& [home, form] : shares) {
        islands_[home].network.signals.push_back({signal.name, std::move(form)});
        islands_[home].signal_number.push_back(static_cast<int>(i));
      }
    }
  }

  void name_islands() {
    for (auto& island : islands_) {
      const Network& n = island.network;
      if (!n.nodes.empty())
        island.name = "node " + n.nodes.front().name;
      else if (!n.branches.empty())
        island.name = n.branches.front().label.name;
      else if (!n.complementarities.empty())
        island.name = n.complementarities.front().label.name;
      else
        island.name = "the sources";
    }
  }

  void mark_needed(const std::function<bool(const Island&)>& must_run) {
    std::vector<char> switch_needed(network_.switches.size(), 0);
    for (auto& island : islands_) island.needed = !island.network.signals.empty() || (must_run && must_run(island));
    for (bool changed = true; changed;) {
      changed = false;
      for (auto& island : islands_) {
        if (island.needed)
          for (const int s : island.switch_number) switch_needed[static_cast<std::size_t>(s)] = 1;
      }
      for (auto& island : islands_) {
        if (island.needed) continue;
        for (const auto& control : island.controls)
          if (switch_needed[static_cast<std::size_t>(control.driven)] != 0) island.needed = changed = true;
      }
    }
    for (auto& island : islands_)
      std::erase_if(island.controls, [&](const auto& c) { return switch_needed[static_cast<std::size_t>(c.driven)] == 0; });
  }

  const Network& network_;
  const Things& things_;
  const Rails& rails_;
  DisjointSets& sets_;
  DisjointSets& parts_;
  Controls controls_;
  std::vector<int> local_;
  std::vector<Island> islands_;
  std::map<int, std::size_t> index_;
  std::map<std::pair<std::size_t, int>, int> sources_;
  std::map<std::pair<std::size_t, NodeIndex>, int> copies_;                ///< (island, rail) -> local node
  std::map<int, std::vector<std::pair<std::size_t, int>>> branch_copies_;  ///< rail source -> (island, local branch)
};

/// Parts that others drive through controlled sources, and that nothing needed reads: a filter behind a buffer that nobody saves.
class IdleParts {
 public:
  IdleParts(const Network& network, const Things& things, const Rails& rails)
      : network_(network),
        things_(things),
        blocks_(Connector(network, things, &rails, Links::without_controlled).take()),
        needed_(static_cast<std::size_t>(things.count), 0) {
    for (const auto& signal : network.signals) need(signal.form);
    while (spread()) {
    }
  }

  /// The network with every value that an idle part reads of a needed one replaced by a source, so that the two fall apart. Nothing where
  /// no part is idle.
  [[nodiscard]] std::optional<Network> cut() const {
    if (!any_across()) return std::nullopt;
    Network result = network_;
    for (std::size_t i = 0; i < result.branches.size(); ++i)
      cut_form(things_.branch + static_cast<int>(i), result.branches[i].voltage, result);
    for (std::size_t i = 0; i < result.injections.size(); ++i)
      cut_form(things_.injection + static_cast<int>(i), result.injections[i].current, result);
    return result;
  }

 private:
  [[nodiscard]] bool is_needed(int thing) const { return needed_[static_cast<std::size_t>(blocks_.find(thing))] != 0; }
  void need(const LinearForm& form) {
    for (const auto& term : form)
      if (const int thing = things_.of(term); thing >= 0) needed_[static_cast<std::size_t>(blocks_.find(thing))] = 1;
  }
  /// What needed elements read is needed; true when that was news.
  bool spread() {
    const auto before = needed_;
    for (std::size_t i = 0; i < network_.branches.size(); ++i)
      if (is_needed(things_.branch + static_cast<int>(i))) need(network_.branches[i].voltage);
    for (std::size_t i = 0; i < network_.injections.size(); ++i)
      if (is_needed(things_.injection + static_cast<int>(i))) need(network_.injections[i].current);
    for (std::size_t i = 0; i < network_.complementarities.size(); ++i)
      if (is_needed(things_.complementarity + static_cast<int>(i))) need(network_.complementarities[i].slack);
    for (std::size_t i = 0; i < network_.switches.size(); ++i)
      if (is_needed(things_.switch_ + static_cast<int>(i))) need(network_.switches[i].control);
    return needed_ != before;
  }
  /// An idle reader of what is needed.
  [[nodiscard]] bool is_across(int reader, const Term& term) const {
    const int thing = things_.of(term);
    return thing >= 0 && !is_needed(reader) && is_needed(thing);
  }
  [[nodiscard]] bool any_across() const {
    const auto across = [&](std::size_t reader, const LinearForm& form) {
      return std::any_of(form.begin(), form.end(), [&](const Term& term) { return is_across(static_cast<int>(reader), term); });
    };
    for (std::size_t i = 0; i < network_.branches.size(); ++i)
      if (across(static_cast<std::size_t>(things_.branch) + i, network_.branches[i].voltage)) return true;
    for (std::size_t i = 0; i < network_.injections.size(); ++i)
      if (across(static_cast<std::size_t>(things_.injection) + i, network_.injections[i].current)) return true;
    return false;
  }
  void cut_form(int reader, LinearForm& form, Network& network) const {
    for (auto& term : form) {
      if (!is_across(reader, term)) continue;
      term = {Term::Kind::source, static_cast<int>(network.sources.size()), term.coefficient};
      network.sources.push_back({{}, Dc{0.0}, true});
    }
  }

  const Network& network_;
  const Things& things_;
  mutable DisjointSets blocks_;
  std::vector<char> needed_;
};

std::vector<Island> split(const Network& network, const Things& things, const Rails& rails,
                          const std::function<bool(const Island&)>& must_run, Controls controls) {
  DisjointSets sets = Connector(network, things, &rails, Links::all, controls).take();
  DisjointSets parts = Connector(network, things, nullptr).take();
  return Distributor(network, things, rails, sets, parts, controls).run(must_run);
}

}  // namespace

std::vector<Island> split_islands(const Network& network, const std::function<bool(const Island&)>& must_run, Controls controls) {
  const Things things(network);
  const Rails rails(network);
  const std::optional<Network> cut = IdleParts(network, things, rails).cut();
  if (!cut) return split(network, things, rails, must_run, controls);
  std::vector<Island> islands = split(*cut, Things(*cut), Rails(*cut), must_run, controls);
  // What must run after all must run on its true input.
  const bool stand_in_runs = std::any_of(islands.begin(), islands.end(), [](const Island& island) {
    const auto& sources = island.network.sources;
    return island.needed && std::any_of(sources.begin(), sources.end(), [](const Source& source) { return source.stands_in; });
  });
  return stand_in_runs ? split(network, things, rails, must_run, controls) : islands;
}

}  // namespace pwlsim::model
