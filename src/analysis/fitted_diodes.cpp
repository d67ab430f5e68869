#include "analysis/fitted_diodes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/quantity.hpp"
#include "analysis/short_list.hpp"
#include "analysis/tangent_points.hpp"
#include "measure/diode_currents.hpp"
#include "model/builder.hpp"

namespace pwlsim::analysis {
namespace {

constexpr int most_runs = 6, most_long_runs = 3;
constexpr std::size_t long_run = 10'000;      ///< pieces of the solution
constexpr double first_current = 1.0;         ///< A, of the tangents that a deck is compiled with
constexpr double least_current = 1e-9;        ///< A; a diode that carries less, and would at its highest voltage, stays as it is
constexpr double least_of_saturation = 10.0;  ///< likewise: below, the exponential is no straight line anywhere
constexpr double most_current = 1e6;          ///< A, that a voltage may ask for
constexpr std::size_t most_named = 8;         ///< diodes in the note
constexpr double two_digits = 10.0;           ///< two of them: what lies between changes a drop by less than a thousandth of kT/q
constexpr double four_digits = 1000.0;        ///< of an overdrive: a channel's level lies a rounding above its threshold
/// What one tangent may be off, RMS: of n·kT/q, or of the voltage that the diode blocks. Above, there are two or three.
constexpr double least_misfit = 0.15, misfit_of_blocked = 5e-4;
constexpr double settled_drop = 0.05;        ///< of n·kT/q: lines that move by less stand
constexpr double settled_resistance = 0.02;  ///< of a channel's resistance, likewise
constexpr double least_overdrive = 0.01;     ///< V; a gate that stays closer to its threshold counts as this far beyond it

double rounded(double value, double digits = two_digits) {
  const double unit = std::pow(10.0, std::floor(std::log10(value))) / digits;
  return std::round(value / unit) * unit;
}

/// A diode with a law, and the lines in its place.
struct Fitted {
  std::size_t diode = 0;  ///< of the network
  DiodeLines lines{{first_current}, {}};
};

/// A channel with a law, and its resistance.
struct FittedChannel {
  std::size_t contact = 0;  ///< of the network
  double resistance = 0.0;
  double overdrive = 0.0;  ///< V, found; 0: none
};

/// A channel that follows its gate. In SPICE its current is gain/2 (s² − d²), where s and d are what the gate exceeds its threshold by against source and
/// drain, and 0 below: gain (s + d)/2 times s − d.
struct FollowingChannel {
  std::size_t half = 0;  ///< complementarity of the network, that of the source; the drain's is the next
  double resistance = 0.0;
  double overdrive = 0.0;  ///< V, (s + d)/2
  double before = 0.0;     ///< V, of the run before; 0: none
  double answer = 0.0;     ///< V, what that run found
};

/// Each diode's current where there are others in parallel.
void count_parallel_ones(model::LinearForm& form, const std::vector<std::vector<int>>& added) {
  const std::size_t terms = form.size();
  for (std::size_t k = 0; k < terms; ++k) {
    if (form[k].kind != model::Term::Kind::diode_current || static_cast<std::size_t>(form[k].index) >= added.size()) continue;
    const double coefficient = form[k].coefficient;
    for (const int other : added[static_cast<std::size_t>(form[k].index)])
      form.push_back({model::Term::Kind::diode_current, other, coefficient});
  }
}

void give_resistances(model::Network& network, const std::vector<FittedChannel>& channels) {
  for (const FittedChannel& each : channels) network.switches[each.contact].resistance = each.resistance;
}

/// The factor of a positive part by its input.
double part_of_input(const model::ChannelHalf& half, double resistance) { return resistance / half.resistance; }

void give_slopes(model::Network& network, const std::vector<FollowingChannel>& channels) {
  for (const FollowingChannel& each : channels)
    for (std::size_t k = each.half; k < each.half + 2; ++k) {
      model::Complementarity& part = network.complementarities[k];
      for (model::Term& term : part.slack)
        if (term.kind == model::Term::Kind::slack_input && term.index == static_cast<int>(k))
          term.coefficient = part_of_input(*part.half, each.resistance);
    }
}

/// The network with the lines in place of the tangents at 1 A.
void give_lines(model::Network& network, const std::vector<Fitted>& fitted) {
  std::vector<std::vector<int>> added(network.diodes.size());
  for (const Fitted& each : fitted) {
    if (each.lines.lines.empty()) continue;
    const std::vector<model::Tangent> diodes = parallel_diodes(each.lines.lines);
    for (std::size_t k = 0; k < diodes.size(); ++k) {
      model::Diode diode = network.diodes[each.diode];
      diode.resistance = diodes[k].resistance;
      diode.drop = diodes[k].drop;
      if (k == 0) {
        network.diodes[each.diode] = std::move(diode);
        continue;
      }
      diode.label.name += fmt::format(" line {}", k + 1);
      diode.law.reset();
      added[each.diode].push_back(static_cast<int>(network.diodes.size()));
      network.diodes.push_back(std::move(diode));
    }
  }
  for (model::Branch& item : network.branches) count_parallel_ones(item.voltage, added);
  for (model::Injection& item : network.injections) count_parallel_ones(item.current, added);
  for (model::Complementarity& item : network.complementarities) count_parallel_ones(item.slack, added);
  for (model::Switch& item : network.switches) count_parallel_ones(item.control, added);
  for (model::Signal& item : network.signals) count_parallel_ones(item.form, added);
}

class Fit {
 public:
  Fit(const circuit::Compiled& compiled, EngineChoice choice, double reltol, const std::atomic<int>* interrupt)
      : network_(compiled.network), choice_(choice), reltol_(reltol), interrupt_(interrupt) {
    network_.signals.clear();
    for (std::size_t k = 0; k < network_.diodes.size(); ++k) {
      const model::Diode& diode = network_.diodes[k];
      if (!diode.law) continue;
      fitted_.push_back({k});
      network_.signals.push_back({"", {{model::Term::Kind::diode_current, static_cast<int>(k), 1.0}}});
      network_.signals.push_back({"", model::voltage_between(diode.p, diode.n)});
    }
    for (std::size_t k = 0; k < network_.switches.size(); ++k) {
      const model::Switch& contact = network_.switches[k];
      if (!contact.law) continue;
      channels_.push_back({k, contact.resistance});
      model::LinearForm overdrive = contact.control;
      overdrive.push_back(model::constant(-contact.on_level));
      network_.signals.push_back({"", overdrive});
      network_.signals.push_back({"", std::move(overdrive)});
    }
    for (std::size_t k = 0; k + 1 < network_.complementarities.size(); ++k) {
      const auto& half = network_.complementarities[k].half;
      if (!half || !half->is_source || !network_.complementarities[k + 1].half) continue;
      following_.push_back({k, half->resistance, 1.0 / (half->law.gain * (half->resistance - half->law.series))});
      const auto part = [](std::size_t index) { return model::Term{model::Term::Kind::slack_input, static_cast<int>(index), 0.5}; };
      const model::LinearForm overdrive{part(k), part(k + 1)};
      network_.signals.push_back({"", overdrive});
      network_.signals.push_back({"", overdrive});
    }
  }

  [[nodiscard]] bool is_needed() const { return !fitted_.empty() || !channels_.empty() || !following_.empty(); }

  /// False where a run does not come to its end.
  bool run(const circuit::Analyses& analyses) {
    int runs = most_runs;
    for (int k = 0; k < runs; ++k) {
      measure::DiodeCurrents found(fitted_.size() + channels_.size() + following_.size(), analyses.transient->stop.seconds);
      if (!measure(analyses, found)) return false;
      if (!take(found)) return true;
      if (found.pieces() > long_run) runs = most_long_runs;
    }
    return true;
  }

  /// Tangents at the operating point: each at the diode's current there, until none moves. That is Newton's method. False where there is no operating point, or
  /// it does not settle.
  bool settle() {
    constexpr int most = 50;
    for (int k = 0; k < most; ++k) {
      model::Network network = network_;
      give_measured(network);
      Diagnostics unheard;
      const PreparedEngine engine = prepare_engine(network, choice_, reltol_, unheard);
      if (!engine.operating_point) return false;
      const engine::OperatingPoint point = engine.operating_point();
      if (point.answer.outcome != engine::Outcome::completed || (interrupt_ != nullptr && *interrupt_ != 0)) return false;
      if (!take_point(point.values)) return true;
    }
    return false;
  }

  void give(model::Network& network) const {
    give_lines(network, fitted_);
    give_resistances(network, channels_);
    give_slopes(network, following_);
  }

  /// The same with what is measured.
  void give_measured(model::Network& network) const {
    give(network);
    const std::size_t first = 2 * (fitted_.size() + channels_.size());
    for (std::size_t k = 0; k < following_.size(); ++k)
      for (const std::size_t signal : {first + 2 * k, first + 2 * k + 1})
        for (model::Term& term : network.signals[signal].form)
          term.coefficient = 0.5 * part_of_input(*network.complementarities[following_[k].half].half, following_[k].resistance);
  }

  [[nodiscard]] Diagnostics notes() const {
    Diagnostics notes;
    if (const auto note = note_of_diodes()) notes.note(note->id, note->span, note->text);
    if (const auto note = note_of_channels()) notes.note(note->id, note->span, note->text);
    return notes;
  }

 private:
  /// Of the channels that have another resistance than before; none: nothing.
  [[nodiscard]] std::optional<Diagnostic> note_of_channels() const {
    ShortList list(most_named);
    SourceSpan first;
    const auto name = [&](const model::Label& label, double gate, double resistance) {
      if (list.empty()) first = label.span;
      list.add(fmt::format("{} at {} (Ron = {:.6g} ohm)", label.name, quantity(gate, "V", 2), resistance));
    };
    for (const FittedChannel& each : channels_) {
      if (each.overdrive <= 0.0) continue;
      const model::Switch& contact = network_.switches[each.contact];
      const double sign = contact.written ? contact.written->sense : 1.0;
      name(contact.label, sign * (contact.on_level + each.overdrive), each.resistance);
    }
    for (const FollowingChannel& each : following_) {
      if (each.before <= 0.0) continue;
      const model::Complementarity& part = network_.complementarities[each.half];
      name(part.label, part.half->level + (part.half->is_p_type ? -each.overdrive : each.overdrive), each.resistance);
    }
    if (list.empty()) return std::nullopt;
    return Diagnostic{
        Severity::note, "N-gate-drive", first,
        fmt::format("a preliminary run finds the gate voltages of MOSFETs; their resistances are taken there: {}", list.str())};
  }

  /// Of the diodes whose tangent is another than before; none: nothing.
  [[nodiscard]] std::optional<Diagnostic> note_of_diodes() const {
    ShortList list(most_named);
    SourceSpan first;
    for (const Fitted& each : fitted_) {
      if (each.lines.lines.empty()) continue;
      const model::Label& label = network_.diodes[each.diode].label;
      if (list.empty()) first = label.span;
      list.add(label.name + " at " + words_of(each.lines));
    }
    if (list.empty()) return std::nullopt;
    return Diagnostic{
        Severity::note, "N-diode-current", first,
        fmt::format("a preliminary run finds the currents of exponential diodes; their tangents are taken there: {}", list.str())};
  }

  static std::string words_of(const DiodeLines& lines) {
    std::string text;
    for (std::size_t k = 0; k < lines.lines.size(); ++k)
      text += fmt::format("{}{} (Ron = {:.6g} ohm, Vfwd = {:.6g} V)", k > 0 ? " and " : "", quantity(lines.currents[k], "A", 2),
                          lines.lines[k].resistance, lines.lines[k].drop);
    return text;
  }

  bool measure(const circuit::Analyses& analyses, measure::DiodeCurrents& found) const {
    model::Network network = network_;
    give_measured(network);
    Diagnostics unheard;
    const PreparedEngine engine = interrupt_ != nullptr ? prepare_engine(network, choice_, reltol_, unheard, *interrupt_)
                                                        : prepare_engine(network, choice_, reltol_, unheard);
    if (!engine.simulate) return false;
    engine::Request request = request_of(analyses, {});
    request.grid = {};
    request.interrupt = interrupt_;
    request.unsaved_signals = network.signals.size();
    request.probes = {{}, 0.0, request.stop, &found};
    for (std::size_t k = 0; k < network.signals.size(); ++k) request.probes.signals.push_back(static_cast<int>(k));
    NoRows sink;
    return engine.simulate(request, sink).outcome == engine::Outcome::completed;
  }

  /// Whether a line has moved.
  bool take(const measure::DiodeCurrents& found) {
    bool has_moved = false;
    for (std::size_t k = 0; k < fitted_.size(); ++k) {
      Fitted& each = fitted_[k];
      const std::optional<DiodeLines> lines = lines_of(each, found, k);
      if (!lines || is_same(*lines, each.lines, *network_.diodes[each.diode].law)) continue;
      each.lines = *lines;
      has_moved = true;
    }
    for (std::size_t k = 0; k < channels_.size(); ++k) has_moved |= take_overdrive(channels_[k], usual(found.spectrum(fitted_.size() + k)));
    for (std::size_t k = 0; k < following_.size(); ++k)
      has_moved |= take_overdrive(following_[k], usual(found.spectrum(fitted_.size() + channels_.size() + k)));
    return has_moved;
  }

  /// The level of the bin that holds most: where a gate stays, and not its edges. 0: none.
  static double usual(const measure::ChargeSpectrum& spectrum) {
    const std::vector<measure::ChargeSpectrum::Bin> bins = spectrum.bins();
    const auto most = std::max_element(bins.begin(), bins.end(), [](const auto& a, const auto& b) { return a.charge < b.charge; });
    return most == bins.end() ? 0.0 : most->current;
  }

  /// Whether the resistance has moved.
  bool take_overdrive(FittedChannel& each, double overdrive) const {
    if (!(overdrive > 0.0)) return false;
    overdrive = rounded(std::max(overdrive, least_overdrive), four_digits);
    const double resistance = network_.switches[each.contact].law->resistance(overdrive);
    if (std::abs(resistance - each.resistance) <= settled_resistance * each.resistance) return false;
    each.resistance = resistance;
    each.overdrive = overdrive;
    return true;
  }

  /// Where a given current flows, the overdrive falls as the slope rises, and two runs in turn return to the same value: the next is where the line through two
  /// answers, in logarithms, is its own.
  bool take_overdrive(FollowingChannel& each, double overdrive) const {
    if (!(overdrive > 0.0)) return false;
    overdrive = std::max(overdrive, least_overdrive);
    const double last = each.overdrive, answer = overdrive;
    if (each.before > 0.0 && each.before != last) {
      const double slope = std::log(answer / each.answer) / std::log(last / each.before);
      if (slope < 0.0) overdrive = last * std::pow(answer / last, 1.0 / (1.0 - slope));
    }
    overdrive = rounded(overdrive, four_digits);
    const double resistance =
        std::max(network_.complementarities[each.half].half->law.resistance(overdrive), model::least_channel_resistance);
    if (std::abs(resistance - each.resistance) <= settled_resistance * each.resistance) return false;
    each.before = last;
    each.answer = answer;
    each.overdrive = overdrive;
    each.resistance = resistance;
    return true;
  }

  /// Whether a tangent has moved.
  bool take_point(const std::vector<double>& values) {
    constexpr double settled = 1e-9;  // of a current
    bool has_moved = false;
    for (std::size_t k = 0; k < fitted_.size(); ++k) {
      Fitted& each = fitted_[k];
      const model::ExponentialLaw& law = *network_.diodes[each.diode].law;
      const double least = std::max(least_current, least_of_saturation * law.saturation), before = each.lines.currents.front();
      double current = values[2 * k] / law.parallel;
      if (!(current > least)) current = std::min(law.current(values[2 * k + 1]), before);
      if (!(current > least && current < most_current) || std::abs(current - before) <= settled * before) continue;
      each.lines = {{current}, {law.tangent(current)}};
      has_moved = true;
    }
    for (std::size_t k = 0; k < channels_.size(); ++k) has_moved |= take_overdrive(channels_[k], values[2 * (fitted_.size() + k)]);
    for (std::size_t k = 0; k < following_.size(); ++k)
      has_moved |= take_overdrive(following_[k], values[2 * (fitted_.size() + channels_.size() + k)]);
    return has_moved;
  }

  /// None where it carries next to nothing.
  [[nodiscard]] std::optional<DiodeLines> lines_of(const Fitted& each, const measure::DiodeCurrents& found, std::size_t k) const {
    const model::ExponentialLaw& law = *network_.diodes[each.diode].law;
    const double least = std::max(least_current, least_of_saturation * law.saturation);
    double mean = found.mean(k) / law.parallel;
    std::vector<measure::ChargeSpectrum::Bin> spectrum;
    if (mean > least) {
      spectrum = found.spectrum(k).bins();
      for (measure::ChargeSpectrum::Bin& bin : spectrum) bin.current /= law.parallel;
      std::erase_if(spectrum, [&](const auto& bin) { return bin.current <= least; });
    } else {
      mean = std::min(law.current(found.highest_voltage(k)), each.lines.currents.front());
    }
    if (!(mean > least && mean < most_current)) return std::nullopt;
    const double tolerance = std::max(least_misfit * law.slope, -misfit_of_blocked * found.lowest_voltage(k));
    return fit_lines(law, spectrum, rounded(mean), tolerance);
  }

  static bool is_same(const DiodeLines& now, const DiodeLines& before, const model::ExponentialLaw& law) {
    if (before.lines.empty()) return now.currents == before.currents;
    if (now.lines.size() != before.lines.size()) return false;
    for (std::size_t k = 0; k < now.lines.size(); ++k)
      if (std::abs(now.lines[k].drop - before.lines[k].drop) > settled_drop * law.slope) return false;
    return true;
  }

  model::Network network_;  ///< as it was compiled, with the signals that are measured
  EngineChoice choice_;
  double reltol_;
  const std::atomic<int>* interrupt_;
  std::vector<Fitted> fitted_;  ///< the diodes that have a law
  std::vector<FittedChannel> channels_;
  std::vector<FollowingChannel> following_;
};

}  // namespace

Diagnostics fit_diodes(circuit::Compiled& compiled, EngineChoice choice, double reltol, const std::atomic<int>* interrupt) {
  if (!compiled.analyses.transient && !compiled.analyses.operating_point) return {};
  Fit fit(compiled, choice, reltol, interrupt);
  if (!fit.is_needed() || !(compiled.analyses.transient ? fit.run(compiled.analyses) : fit.settle())) return {};
  fit.give(compiled.network);
  return fit.notes();
}

}  // namespace pwlsim::analysis
