#include "elements/transistor.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "elements/complementarity.hpp"

namespace pwlsim::elements {
namespace {

constexpr std::size_t gate = 1, source = 2;

/// A gate that rests at the threshold leaves the channel open, as in SPICE: the usual Vto = 0 with a drive of 0 V. So far above it, of the threshold or
/// of a volt, a channel closes.
constexpr double above_threshold = 1e-6;

double level_of(const Channel& channel) {
  const double level = channel.p_type ? -channel.threshold : channel.threshold;
  return level + above_threshold * std::max(std::abs(level), 1.0);
}

TwinEnds control_of(const Twin& twin, const Channel& channel) {
  TwinEnds control{channel.twin_gate.empty() ? twin.node(twin.instance().nodes[gate]) : channel.twin_gate,
                   twin.node(twin.instance().nodes[source])};
  if (channel.p_type) std::swap(control.p, control.n);
  return control;
}

}  // namespace

void take_junction_current(Model& model, const Settings& settings) {
  if (!model.values.has("I0")) model.values.set("I0", settings.tangent_current);
}

void refuse_drive(const Model& model, std::string_view name, Diagnostics& diagnostics) {
  diagnostics.error(
      "E-not-idealised", model.span,
      fmt::format("the {} {} is not a switch: a drive of {} V does not reach its threshold {} = {} V; try Ron= on the model, or "
                  ".options vdrive=",
                  model.kind->text, model.name, model.values.get("Vdrive"), name, model.values.get(name)));
}

void add_channel(Emission& emission, const Channel& channel) {
  const std::vector<model::NodeIndex>& nodes = emission.instance().nodes;
  model::Switch item;
  item.label = emission.label();
  item.p = nodes[0];
  item.n = nodes[source];
  item.resistance = channel.resistance;
  item.control = model::voltage_between(channel.gate, nodes[source], channel.p_type ? -1.0 : 1.0);
  item.on_level = item.off_level = level_of(channel);
  item.written = model::WrittenControl{channel.p_type ? -1.0 : 1.0, 0.0, "V"};
  item.law = channel.law;
  emission.result().item = emission.builder().add(std::move(item));
  emission.result().current.push_back({Quantity::switch_current, emission.result().item, 1.0});
}

void add_following_channel(Emission& emission, const Channel& channel) {
  const std::vector<model::NodeIndex>& nodes = emission.instance().nodes;
  const double sign = channel.p_type ? -1.0 : 1.0;
  const double resistance = std::max(channel.resistance, model::least_channel_resistance), conductance = 1.0 / resistance;
  const auto excess_over = [&](std::size_t terminal) {
    model::LinearForm excess = model::voltage_between(channel.gate, nodes[terminal], sign);
    excess.push_back(model::constant(-sign * channel.threshold));
    model::LinearForm part = add_positive_part(emission, excess);
    if (channel.law)
      emission.builder().network().complementarities.back().half =
          model::ChannelHalf{*channel.law, resistance, channel.threshold, channel.p_type, terminal == source};
    return part;
  };
  model::LinearForm current;
  model::accumulate(current, excess_over(source), sign * conductance);
  model::accumulate(current, excess_over(0), -sign * conductance);
  emission.result().current = current;
  emission.builder().add(model::Injection{emission.label(), nodes[0], nodes[source], std::move(current)});
}

void twin_of_channel(Twin& twin, const Channel& channel) {
  const double level = level_of(channel);
  twin.contact({}, {twin.ends().p, twin.node(twin.instance().nodes[source])}, control_of(twin, channel),
               {channel.resistance, infinite, level, level, false});
}

void twin_of_following_channel(Twin& twin, const Channel& channel) {
  const std::string drain = twin.ends().p, outer_source = twin.node(twin.instance().nodes[source]);
  const std::string at_gate = channel.twin_gate.empty() ? twin.node(twin.instance().nodes[gate]) : channel.twin_gate;
  const double sign = channel.p_type ? -1.0 : 1.0;
  const auto excess_over = [&](const std::string& terminal) {
    return fmt::format("max({}*({}-({})),0)", sign, voltage_text({at_gate, terminal}), channel.threshold);
  };
  twin.behaviour(
      "channel", {drain, outer_source}, true,
      fmt::format("{}*({}-{})", sign / std::max(channel.resistance, twin.sharpness()), excess_over(outer_source), excess_over(drain)));
}

TwinEvent event_of_channel(const Twin& twin, const Channel& channel) {
  return {control_of(twin, channel), level_of(channel), level_of(channel)};
}

int add_junction(Emission& emission, const Junction& junction, double share) {
  NodePair ends = junction.ends;
  if (junction.p_type) {
    std::swap(ends.p, ends.n);
    share = -share;
  }
  if (ends.p == ends.n) return -1;
  const int forward =
      emission.builder().add(model::Diode{emission.label(junction.part), ends.p, ends.n, junction.law.resistance, junction.law.drop});
  emission.builder().network().diodes.back().law = junction.exponential;
  if (share != 0.0) emission.result().current.push_back({Quantity::diode_current, forward, share});
  if (std::isinf(junction.reverse)) return forward;
  const std::string part = std::string(junction.part) + " reverse";
  const int reverse = emission.builder().add(model::Diode{emission.label(part), ends.n, ends.p, 0.0, junction.reverse});
  if (share != 0.0) emission.result().current.push_back({Quantity::diode_current, reverse, -share});
  return forward;
}

void twin_of_junction(Twin& twin, const Junction& junction, const TwinEnds& ends) {
  if (ends.p == ends.n) return;
  const TwinEnds forward = junction.p_type ? TwinEnds{ends.n, ends.p} : ends;
  twin.diode(junction.part, forward, {junction.law.resistance, infinite, junction.law.drop, 0.0, junction.reverse});
}

std::optional<model::ExponentialLaw> in_parallel(std::optional<model::ExponentialLaw> law, double devices) {
  if (law) law->parallel = devices;
  return law;
}

std::string words_of(const Tangent& law) { return fmt::format("Vfwd = {:.6g} V, Ron = {:.6g} ohm", law.drop, law.resistance); }

void note_idealised(Emission& emission, const std::string& became) {
  const Model& model = emission.model();
  emission.diagnostics().note("N-idealised", model.span, fmt::format("the {} {} is idealised: {}", model.kind->text, model.name, became));
}

}  // namespace pwlsim::elements
