#pragma once
/// What M, J and Q share: the parts that transistors are idealised to. Voltages and currents count as in an N type; a P type is its mirror image.

#include <optional>
#include <string>
#include <string_view>

#include "elements/emission.hpp"
#include "elements/tangent.hpp"
#include "elements/twin.hpp"

namespace pwlsim::elements {

/// A parameter of other simulators' models without effect on a switch.
constexpr Parameter without_effect(std::string_view name) {
  return {name, "", 0.0, Range::any, true, "No effect on a switch.", Use::ignored};
}

inline constexpr Parameter junction_current{
    "I0", "A", 1.0, Range::positive, false, "Current at which the tangents are taken; .options i0= sets it for all."};
/// Takes it from the options if the model does not give it.
void take_junction_current(Model& model, const Settings& settings);

/// E-not-idealised: the gate drive does not reach the threshold, which the model calls `name`.
void refuse_drive(const Model& model, std::string_view name, Diagnostics& diagnostics);

/// A contact from drain to source, closed while v(gate, source) is above the threshold.
struct Channel {
  bool p_type = false;
  double threshold = 0.0;                  ///< V
  double resistance = 0.0;                 ///< ohm
  model::NodeIndex gate = model::ground;   ///< the node itself, or an inner one after a resistance
  std::string twin_gate{};                 ///< likewise in a twin; "": the node itself
  std::optional<model::ChannelLaw> law{};  ///< if preliminary runs find the gate voltage
};

/// Between the nodes drain, gate, source of the instance. Its current is that of the element.
void add_channel(Emission& emission, const Channel& channel);
/// The same if the current changes v(gate, source), so that at its threshold no position of a switch is valid: a source follower, a resistance in the
/// source. With g = 1/Ron
///
///     i = g max(0, v(gate, source) - threshold) - g max(0, v(gate, drain) - threshold)
///
/// that is v(drain, source)/Ron when on, no current when off, and in between the current that the gate allows.
void add_following_channel(Emission& emission, const Channel& channel);
void twin_of_channel(Twin& twin, const Channel& channel);
void twin_of_following_channel(Twin& twin, const Channel& channel);
[[nodiscard]] TwinEvent event_of_channel(const Twin& twin, const Channel& channel);

/// A diode between two nodes.
struct Junction {
  std::string_view part;
  bool p_type = false;
  NodePair ends;
  Tangent law;
  double reverse = infinite;  ///< V, breakdown
  std::optional<model::ExponentialLaw> exponential{};
};
/// The index of its forward diode in the network, which follows `exponential` if preliminary runs find its current; -1 if there is none because both ends are one node. `share` of its current is added to that of the element.
int add_junction(Emission& emission, const Junction& junction, double share);
void twin_of_junction(Twin& twin, const Junction& junction, const TwinEnds& ends);

/// The same for so many devices in parallel.
[[nodiscard]] std::optional<model::ExponentialLaw> in_parallel(std::optional<model::ExponentialLaw> law, double devices);

/// "0.8 V and 10 mohm"
[[nodiscard]] std::string words_of(const Tangent& law);

/// Reports for the instance's model what its transistors became, once for each text.
void note_idealised(Emission& emission, const std::string& became);

}  // namespace pwlsim::elements
