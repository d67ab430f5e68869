#include "waveform/svg_plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>

#include <fmt/format.h>

namespace pwlsim::waveform {
namespace {

constexpr double width = 930.0, left = 110.0, right = 20.0, top = 40.0, panel_height = 180.0, gap = 34.0, bottom = 50.0;
constexpr double plot_width = width - left - right;
constexpr double row_height = 16.0, bar_height = 11.0;
constexpr double flat_margin = 0.05;    ///< of the value of a flat curve
constexpr double rounding = 1e-12;      ///< of the largest value: a span below it has no ticks of its own
constexpr int columns_per_unit = 2;     ///< of marks and lanes
constexpr std::size_t least_crowd = 4;  ///< columns with ticks side by side
constexpr double crowd_shade = 0.4;
constexpr std::string_view pale = "#dddddd", dark = "#666666";
constexpr std::array<std::string_view, 6> colours{"#1f5fbf", "#d1480a", "#1b7f3b", "#7a3fa0", "#8a6d00", "#b0154f"};

std::string escaped(std::string_view text) {
  std::string result;
  for (char c : text) {
    if (c == '<') {
      result += "&lt;";
    } else if (c == '>') {
      result += "&gt;";
    } else if (c == '&') {
      result += "&amp;";
    } else if (static_cast<unsigned char>(c) >= ' ') {
      result += c;
    }
  }
  return result;
}

struct Span {
  double from = std::numeric_limits<double>::infinity(), to = -std::numeric_limits<double>::infinity();

  void take(double value) {
    if (!std::isfinite(value)) return;
    from = std::min(from, value);
    to = std::max(to, value);
  }
  /// With `margin` of its length on either side. A single value, or values that differ by rounding, are in the middle.
  [[nodiscard]] Span opened(double margin) const {
    if (from > to) return {0.0, 1.0};
    const double size = std::max(std::abs(from), std::abs(to));
    const double open = to - from > rounding * size ? margin * (to - from) : flat_margin * std::max(size, 1.0);
    return {from - open, to + open};
  }
};

struct Scale {
  Span span;
  double start = 0.0, length = 1.0;  ///< in the picture

  [[nodiscard]] double at(double value) const { return start + length * (value - span.from) / (span.to - span.from); }
};

/// A power of 1000 and its prefix, such that the largest of the span reads as 1 to 999.
struct Prefix {
  double factor = 1.0;
  std::string_view text;
};

Prefix prefix_for(const Span& span) {
  constexpr std::array<std::string_view, 11> names{"f", "p", "n", "µ", "m", "", "k", "M", "G", "T", "P"};
  constexpr int without = 5;
  const double size = std::max(std::abs(span.from), std::abs(span.to));
  if (size == 0.0) return {};
  const int power = std::clamp(static_cast<int>(std::floor(std::log10(size * (1.0 + 1e-9)) / 3.0)), -without, without);
  return {std::pow(1000.0, power), names[static_cast<std::size_t>(power + without)]};
}

std::string number(double value) { return fmt::format("{:.6g}", value); }

class Picture {
 public:
  explicit Picture(const Figure& figure) : figure_(figure) {
    Span times;
    for (const Panel& panel : figure.panels)
      for (const Curve& curve : panel.curves)
        for (double x : curve.x) times.take(x);
    if (figure.panels.empty()) {
      for (const Lane& lane : figure.lanes)
        for (double x : lane.times) times.take(x);
    }
    across_ = {times.opened(0.0), left, plot_width};
    place_legend();
  }

  std::string draw() {
    const double above = top + legend_rows_ * row_height + (legend_rows_ > 0 ? 8.0 : 0.0);
    const double strip = above + static_cast<double>(figure_.panels.size()) * (panel_height + gap) - gap + (rows() > 0 ? row_height : 0.0);
    const double axis = strip + static_cast<double>(rows()) * row_height;
    text_ = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" font-family=\"sans-serif\" "
        "font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
        width, axis + bottom);
    label(left, 20.0, figure_.title, "font-size=\"14\" font-weight=\"bold\"");
    text_ += legend_;
    for (std::size_t k = 0; k < figure_.panels.size(); ++k)
      draw_panel(figure_.panels[k], above + static_cast<double>(k) * (panel_height + gap));
    draw_strip(strip);
    draw_axis(axis);
    return std::move(text_) + "</svg>\n";
  }

 private:
  /// Entries side by side, in as many rows as they need.
  void place_legend() {
    constexpr double line_length = 20.0, letter = 7.0, between = 24.0;
    double x = left;
    for (const LegendEntry& entry : figure_.legend) {
      const double length = line_length + 6.0 + letter * static_cast<double>(entry.name.size());
      if (legend_rows_ == 0 || x + length > left + plot_width) {
        ++legend_rows_;
        x = left;
      }
      const double y = top - 4.0 + (legend_rows_ - 1) * row_height;
      legend_ += fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\" stroke-width=\"2\"/>\n", x,
                             y - 4.0, x + line_length, y - 4.0, entry.colour);
      legend_ += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" fill=\"#333\">{}</text>\n", x + line_length + 6.0, y, escaped(entry.name));
      x += length + between;
    }
  }

  void label(double x, double y, std::string_view text, std::string_view attributes) {
    text_ += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" {}>{}</text>\n", x, y, attributes, escaped(text));
  }

  void line(double x1, double y1, double x2, double y2, std::string_view colour) {
    text_ += fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\"/>\n", x1, y1, x2, y2, colour);
  }

  [[nodiscard]] std::size_t rows() const { return figure_.marks.size() + figure_.lanes.size(); }

  void draw_panel(const Panel& panel, double y) {
    Span values;
    for (const Curve& curve : panel.curves)
      for (double value : curve.y) values.take(value);
    const Scale up{values.opened(0.05), y + panel_height, -panel_height};
    draw_grid(up, y, panel.unit);
    label(left, y - 6.0, panel.title, "fill=\"#333\"");
    draw_legend(panel, y);
    for (std::size_t k = 0; k < panel.curves.size(); ++k) draw_curve(panel.curves[k], up, colour_of(panel, k));
  }

  static std::string_view colour_of(const Panel& panel, std::size_t k) {
    if (!panel.curves[k].colour.empty()) return panel.curves[k].colour;
    const auto first =
        std::find_if(panel.curves.begin(), panel.curves.end(), [&](const Curve& c) { return c.name == panel.curves[k].name; });
    return colours[static_cast<std::size_t>(first - panel.curves.begin()) % colours.size()];
  }

  /// Lines up to the panel or the strip above are drawn there.
  void draw_axis(double y) {
    Prefix in_x = prefix_for(across_.span);
    if (figure_.is_logarithmic) {
      in_x = {};
      for (double tick : ticks_across()) {
        const double value = std::pow(10.0, tick);
        const Prefix own = prefix_for({value, value});
        label(across_.at(tick), y + 16.0, number(value / own.factor) + std::string(own.text), "text-anchor=\"middle\"");
      }
    } else {
      for (double tick : ticks_across()) label(across_.at(tick), y + 16.0, number(tick / in_x.factor), "text-anchor=\"middle\"");
    }
    label(left + 0.5 * plot_width, y + 36.0, fmt::format("{} ({}{})", figure_.x_name, in_x.text, figure_.x_unit), "text-anchor=\"middle\"");
  }

  /// Decades, and where there are few of them 2 and 5 as well.
  [[nodiscard]] std::vector<double> ticks_across() const {
    if (!figure_.is_logarithmic) return round_ticks(across_.span.from, across_.span.to, 10);
    constexpr double many = 5.0, rounding_of_log = 1e-9;
    const bool is_long = across_.span.to - across_.span.from > many;
    std::vector<double> ticks;
    for (double decade = std::floor(across_.span.from); decade <= across_.span.to; decade += 1.0)
      for (const double factor : {1.0, 2.0, 5.0}) {
        const double tick = decade + std::log10(factor);
        const bool is_inside = tick >= across_.span.from - rounding_of_log && tick <= across_.span.to + rounding_of_log;
        if (is_inside && (factor == 1.0 || !is_long)) ticks.push_back(tick);
      }
    return ticks;
  }

  void draw_strip(double y) {
    for (double tick : ticks_across())
      if (rows() > 0) line(across_.at(tick), y, across_.at(tick), y + static_cast<double>(rows()) * row_height, pale);
    if (rows() > 0 && !figure_.strip_title.empty()) label(left, y - 3.0, figure_.strip_title, "fill=\"#333\" font-size=\"11\"");
    for (const Marks& marks : figure_.marks) {
      row_label(marks.name, y, marks.colour);
      draw_ticks(marks, y + 2.0);
      y += row_height;
    }
    for (const Lane& lane : figure_.lanes) {
      row_label(lane.name, y);
      draw_bars(lane, y + 2.0);
      y += row_height;
    }
  }

  /// Ticks in neighbouring columns, which could not be told apart, become a pale bar.
  void draw_ticks(const Marks& marks, double y) {
    const std::string_view colour = marks.colour.empty() ? colours[1] : std::string_view(marks.colour);
    std::vector<double> places;
    for (double x : marks.x) {
      const double column = std::floor(columns_per_unit * across_.at(x));
      if (inside(x) && (places.empty() || places.back() != column)) places.push_back(column);
    }
    for (std::size_t k = 0; k < places.size();) {
      std::size_t end = k + 1;
      while (end < places.size() && places[end] == places[end - 1] + 1.0) ++end;
      const bool is_crowd = end - k >= least_crowd;
      if (is_crowd) bar(places[k] / columns_per_unit, y, static_cast<double>(end - k) / columns_per_unit, colour, crowd_shade);
      for (; k < end; ++k)
        if (!is_crowd) line(places[k] / columns_per_unit, y, places[k] / columns_per_unit, y + bar_height, colour);
    }
  }

  void bar(double x, double y, double length, std::string_view colour, double shade) {
    text_ += fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"{}\" fill-opacity=\"{}\"/>\n", x, y, length, bar_height,
                         colour, shade);
  }

  /// The end of a long name tells more than its beginning.
  void row_label(const std::string& name, double y, const std::string& colour = "") {
    constexpr std::size_t most_letters = 16;
    std::size_t begin = name.size() <= most_letters ? 0 : name.size() - most_letters + 1;
    while (begin < name.size() && (static_cast<unsigned char>(name[begin]) & 0xC0U) == 0x80U) ++begin;  // within a letter of several bytes
    const std::string text = begin == 0 ? name : "…" + name.substr(begin);
    const std::string fill = colour.empty() ? "" : fmt::format(" fill=\"{}\"", colour);
    label(left - 6.0, y + bar_height, text, "text-anchor=\"end\" font-size=\"11\"" + fill);
  }

  [[nodiscard]] bool inside(double x) const { return x >= across_.span.from && x <= across_.span.to; }

  /// How much of each column of the picture the lane is on.
  [[nodiscard]] std::vector<double> column_shares(const Lane& lane) const {
    constexpr auto columns = static_cast<std::size_t>(columns_per_unit * plot_width);
    std::vector<double> shares(columns, 0.0);
    for (std::size_t k = 0; k < lane.times.size(); ++k) {
      if (lane.shares[k] == 0.0) continue;
      const double begin = columns_per_unit * (across_.at(lane.times[k]) - left);
      const double end = columns_per_unit * (across_.at(k + 1 < lane.times.size() ? lane.times[k + 1] : across_.span.to) - left);
      for (auto c = static_cast<std::size_t>(std::max(0.0, begin)); c < columns && static_cast<double>(c) < end; ++c)
        shares[c] += lane.shares[k] * (std::min(end, static_cast<double>(c + 1)) - std::max(begin, static_cast<double>(c)));
    }
    return shares;
  }

  void draw_bars(const Lane& lane, double y) {
    constexpr double shades = 16.0;
    const std::vector<double> shares = column_shares(lane);
    for (std::size_t c = 0; c < shares.size();) {
      const double shade = std::ceil(shades * shares[c] - 1e-6) / shades;
      const std::size_t first = c;
      while (c < shares.size() && std::ceil(shades * shares[c] - 1e-6) / shades == shade) ++c;
      if (shade > 0.0)
        bar(left + static_cast<double>(first) / columns_per_unit, y, static_cast<double>(c - first) / columns_per_unit, colours[0],
            std::min(shade, 1.0));
    }
  }

  void draw_grid(const Scale& up, double y, std::string_view unit) {
    const Prefix in_y = prefix_for(up.span);
    for (double tick : ticks_across()) line(across_.at(tick), y, across_.at(tick), y + panel_height, pale);
    for (double tick : round_ticks(up.span.from, up.span.to, 5)) {
      line(left, up.at(tick), left + plot_width, up.at(tick), tick == 0.0 ? dark : pale);
      label(left - 6.0, up.at(tick) + 4.0,
            fmt::format("{}{}{}{}", number(tick / in_y.factor), tick == 0.0 || (in_y.text.empty() && unit.empty()) ? "" : " ",
                        tick == 0.0 ? "" : in_y.text, tick == 0.0 ? "" : unit),
            "text-anchor=\"end\"");
    }
    text_ += fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"{}\"/>\n", left, y, plot_width,
                         panel_height, dark);
  }

  void draw_legend(const Panel& panel, double y) {
    double x = left + plot_width;
    for (std::size_t k = panel.curves.size(); k-- > 0;) {
      const Curve& curve = panel.curves[k];
      if (curve.name.empty()) continue;
      label(x, y - 6.0, curve.name, "text-anchor=\"end\" fill=\"#333\"");
      x -= 7.0 * static_cast<double>(curve.name.size()) + 6.0;
      text_ += fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\" stroke-width=\"2\"{}/>\n", x - 24.0,
                           y - 10.0, x, y - 10.0, colour_of(panel, k), dash(curve));
      x -= 36.0;
    }
  }

  static std::string_view dash(const Curve& curve) { return curve.dashed ? " stroke-dasharray=\"6 4\"" : ""; }

  void draw_curve(const Curve& curve, const Scale& up, std::string_view colour) {
    std::string points;
    const auto add = [&](std::size_t k) { points += fmt::format("{:.2f},{:.2f} ", across_.at(curve.x[k]), up.at(curve.y[k])); };
    for (std::size_t k = 0; k < curve.x.size();) {
      const double column = std::floor(across_.at(curve.x[k]));
      std::size_t low = curve.x.size(), high = curve.x.size(), first = k, last = k;
      for (; k < curve.x.size() && std::floor(across_.at(curve.x[k])) == column; ++k) {
        if (!std::isfinite(curve.y[k])) continue;
        if (low == curve.x.size() || curve.y[k] < curve.y[low]) low = k;
        if (high == curve.x.size() || curve.y[k] > curve.y[high]) high = k;
        last = k;
      }
      if (low == curve.x.size()) continue;
      std::array<std::size_t, 4> chosen{first, low, high, last};
      std::sort(chosen.begin(), chosen.end());
      const auto end = std::unique(chosen.begin(), chosen.end());
      for (auto at = chosen.begin(); at != end; ++at)
        if (std::isfinite(curve.y[*at])) add(*at);
    }
    text_ += fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.5\"{}/>\n", points, colour, dash(curve));
  }

  const Figure& figure_;
  Scale across_;
  int legend_rows_ = 0;
  std::string legend_, text_;
};

}  // namespace

std::string ramp_colour(double share) {
  constexpr std::array<std::array<double, 3>, 5> stops{{{43, 63, 158}, {26, 134, 184}, {42, 157, 75}, {201, 138, 0}, {194, 47, 47}}};
  const double at = std::clamp(share, 0.0, 1.0) * (stops.size() - 1);
  const auto low = std::min(static_cast<std::size_t>(at), stops.size() - 2);
  std::string text = "#";
  for (std::size_t k = 0; k < 3; ++k)
    text += fmt::format("{:02x}", std::lround(std::lerp(stops[low][k], stops[low + 1][k], at - static_cast<double>(low))));
  return text;
}

std::string svg(const Figure& figure) { return Picture(figure).draw(); }

std::vector<double> round_ticks(double from, double to, int wanted) {
  const double rough = (to - from) / wanted;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  const double share = rough / power;
  const double step = power * (share < 1.5 ? 1.0 : share < 3.5 ? 2.0 : share < 7.5 ? 5.0 : 10.0);
  std::vector<double> ticks;
  const double slack = 1e-9 * step;
  for (double k = std::ceil((from - slack) / step); k * step <= to + slack; k += 1.0) ticks.push_back(k == 0.0 ? 0.0 : k * step);
  return ticks;
}

}  // namespace pwlsim::waveform
