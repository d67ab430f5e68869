#pragma once
/// Curves as a self-contained SVG picture: panels one above the other, then marks and lanes, with a common horizontal axis.

#include <string>
#include <vector>

namespace pwlsim::waveform {

struct Curve {
  std::string name;       ///< in the legend; curves of one name share a colour and one entry
  std::vector<double> x;  ///< ascending; equal values are a vertical piece
  std::vector<double> y;  ///< as many; values that are not finite are left out
  bool dashed = false;
  std::string colour = {};  ///< "#1f5fbf"; empty: one of a palette
};

/// An entry of a legend above all panels.
struct LegendEntry {
  std::string name, colour;
};

struct Panel {
  std::string title;
  std::vector<Curve> curves;
  std::string unit = {};  ///< of the vertical axis
};

/// A row of ticks.
struct Marks {
  std::string name;
  std::vector<double> x;    ///< ascending
  std::string colour = {};  ///< of ticks and name; empty: the common one
};

/// A row of bars, for something that is on or off.
struct Lane {
  std::string name;
  std::vector<double> times;   ///< ascending, the first is where the lane begins
  std::vector<double> shares;  ///< as many: from each time to the next, or the picture's end, on for this share of it
};

struct Figure {
  std::string title;
  std::string x_name, x_unit;  ///< "time", "s": the axis takes a prefix for the unit
  std::vector<Panel> panels;
  std::vector<Marks> marks = {};
  std::vector<Lane> lanes = {};
  std::vector<LegendEntry> legend = {};
  std::string strip_title = {};  ///< above marks and lanes
  bool is_logarithmic = false;   ///< all x are decimal logarithms; the axis shows the numbers
};

/// A colour between blue, green and red, 0 ≤ share ≤ 1, dark enough on white.
[[nodiscard]] std::string ramp_colour(double share);

/// Curves with more points than the picture has columns are drawn by their extremes in each column: no peak is lost.
[[nodiscard]] std::string svg(const Figure& figure);

/// Round numbers (1, 2, 5 times a power of ten apart) within [from, to], about `wanted` of them; from < to.
[[nodiscard]] std::vector<double> round_ticks(double from, double to, int wanted);

}  // namespace pwlsim::waveform
