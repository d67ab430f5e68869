#pragma once
/// An exponential diode as straight lines: its tangents at one, two or three currents.
///
/// v(i) is concave, so that every tangent lies above it, and their minimum is a drop v̂(i) ≥ v(i). Weighted by the charge q(i) that is carried at each current,
/// m is the mean of v̂ − v and s its standard deviation. All tangents are lowered by m, so that the diode loses as much energy as the exponential one; s is the remaining error.

#include <vector>

#include "measure/diode_currents.hpp"
#include "model/exponential_law.hpp"
#include "model/network.hpp"

namespace pwlsim::analysis {

struct DiodeLines {
  std::vector<double> currents;       ///< currents of the tangents, ascending; A of one of the parallel diodes
  std::vector<model::Tangent> lines;  ///< of all parallel diodes together, lowered; the first has the largest resistance
};

/// One of the two positive parts of a channel that follows its gate, as a diode of concave voltage: i(v) rises by gain·v/(1 + series·gain·v) per volt of the
/// excess v over the threshold, so that the difference of two such parts is SPICE's level 1, behind its resistances where the channel is hard on.
struct ChannelCurve {
  model::ChannelLaw law;
  [[nodiscard]] double current(double voltage) const;
  [[nodiscard]] double voltage(double current) const;
  [[nodiscard]] model::Tangent tangent(double current) const;
};

/// The fewest tangents for which s is at most `tolerance` V, three if none has that. A single tangent is taken at `mean`, A.
[[nodiscard]] DiodeLines fit_lines(const model::ExponentialLaw& law, const std::vector<measure::ChargeSpectrum::Bin>& spectrum, double mean,
                                   double tolerance);
[[nodiscard]] DiodeLines fit_lines(const ChannelCurve& curve, const std::vector<measure::ChargeSpectrum::Bin>& spectrum, double mean,
                                   double tolerance);

/// Parallel diodes with the characteristic of the lines, i = max over lines of (v − drop)/resistance: the first line, and for each other one a diode in
/// parallel that conducts from the corner on, with the conductance that is added there.
[[nodiscard]] std::vector<model::Tangent> parallel_diodes(const std::vector<model::Tangent>& lines);

}  // namespace pwlsim::analysis
