#include "analysis/orbit_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/bode_figure.hpp"
#include "analysis/orbit_verdict.hpp"
#include "analysis/quantity.hpp"

namespace pwlsim::analysis {
namespace {

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) result += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : std::string(1, c);
  return result;
}

/// The complex plane from −reach to reach, with the unit circle.
class Plane {
 public:
  Plane(double reach, std::string_view what) : reach_(reach) {
    text_ = fmt::format(
        "<svg role=\"img\" aria-label=\"{0}\" width=\"{1}\" height=\"{1}\" viewBox=\"0 0 {1} {1}\">\n"
        "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
        what, size);
    text_ += fmt::format(
        "<path d=\"M0 {0}H{1}M{0} 0V{1}\" stroke=\"#dddddd\"/>\n<circle cx=\"{0}\" cy=\"{0}\" r=\"{2:.2f}\" fill=\"none\" "
        "stroke=\"#666666\"/>\n",
        size / 2.0, size, size / 2.0 / reach_);
  }
  void dot(std::complex<double> value, std::string_view colour) {
    text_ += fmt::format("<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"4\" fill=\"{}\"/>\n", x(value), y(value), colour);
  }
  void curve(const std::vector<std::complex<double>>& values) {
    std::string points;
    for (const auto& value : values)
      if (std::abs(value) < 10.0 * reach_) points += fmt::format("{:.2f},{:.2f} ", x(value), y(value));
    text_ += fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"#1f5fbf\" stroke-width=\"1.5\"/>\n", points);
  }
  std::string take() { return std::move(text_) + "</svg>\n"; }

 private:
  static constexpr double size = 320.0;
  [[nodiscard]] double x(std::complex<double> value) const { return size / 2.0 * (1.0 + value.real() / reach_); }
  [[nodiscard]] double y(std::complex<double> value) const { return size / 2.0 * (1.0 - value.imag() / reach_); }
  double reach_;
  std::string text_;
};

std::string multipliers_html(const SteadyState& state) {
  constexpr std::size_t most_listed = 40;
  const steady::Orbit& orbit = state.orbit;
  if (orbit.multipliers.empty()) return "";
  constexpr double margin = 1.2;
  Plane plane(margin * std::max(1.0, std::abs(orbit.multipliers.front().value)), "Floquet multipliers in the unit circle");
  std::string rows;
  for (std::size_t k = 0; k < orbit.multipliers.size(); ++k) {
    const steady::Multiplier& m = orbit.multipliers[k];
    plane.dot(m.value, m.trivial ? "#666666" : std::abs(m.value) > 1.0 + marginal_multiplier ? "#b3261e" : "#1f5fbf");
    if (k >= most_listed) continue;
    const auto shares = shares_of(state, m.direction);
    rows += fmt::format("<tr><td>{:.6g}{}</td><td>{:.6g}</td><td>{}</td></tr>\n", m.value.real(),
                        m.value.imag() == 0.0 ? "" : fmt::format(" {} {:.6g}j", m.value.imag() < 0.0 ? "−" : "+", std::abs(m.value.imag())),
                        std::abs(m.value),
                        m.trivial        ? "along the orbit"
                        : shares.empty() ? ""
                                         : escaped(shares.front().first));
  }
  return "<h3>Floquet multipliers</h3>\n" + plane.take() +
         "<div class=\"scroll\"><table><tr><th>multiplier</th><th>magnitude</th><th>mostly</th></tr>\n" + rows + "</table></div>\n";
}

}  // namespace

std::string orbit_section(const RunOutcome& outcome) {
  const bool has_orbit = outcome.steady_state && outcome.steady_state->is_found;
  if (!has_orbit && !outcome.small_signal) return "";
  std::string text = "<section id=\"steady-state\">\n";
  if (has_orbit) {
    const steady::Orbit& orbit = outcome.steady_state->orbit;
    text += fmt::format("<h2>Steady state</h2>\n<p>Period {}; residual {:.1g} after {} and {}.</p>\n", quantity(orbit.period, "s"),
                        orbit.residual, counted(static_cast<std::uint64_t>(orbit.iterations), "Newton step"),
                        counted(static_cast<std::uint64_t>(orbit.periods_simulated), "period"));
    text += multipliers_html(*outcome.steady_state);
  }
  if (outcome.small_signal) {
    text += "<h2>Small signals</h2>\n<div class=\"scroll\">" + waveform::svg(bode_figure("", *outcome.small_signal)) + "</div>\n";
    if (const auto& loop = outcome.small_signal->loop; loop) {
      constexpr double reach = 3.0;
      Plane plane(reach, "Nyquist plot of the loop gain");
      plane.curve(loop->values);
      plane.dot(-1.0, "#b3261e");
      text += "<h3>Nyquist plot of the loop gain</h3>\n" + plane.take();
    }
  }
  return text + "</section>\n";
}

}  // namespace pwlsim::analysis
