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
constexpr double misfit_of_channel =
    0.05;  ///< of the RMS of what a gate exceeds its threshold by: what one tangent may be off; above, there are two or three
constexpr double least_overdrive = 0.01;  ///< V; a gate that stays closer to its threshold counts as this far beyond it

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

/// A channel that follows its gate: the difference of a curve at what the gate exceeds its threshold by against source and against drain, and of lines in its place.
struct FollowingChannel {
  std::size_t half = 0;  ///< complementarity of the network, that of the source; the drain's is the next
  ChannelCurve curve;
  double resistance = 0.0;  ///< ohm, that the deck is compiled with
  DiodeLines lines{};       ///< none: the slope that the deck is compiled with
};

/// To each term of kind `kind` the same of what was added beside its index.
void count_added(model::LinearForm& form, model::Term::Kind kind, const std::vector<std::vector<int>>& added) {
  const std::size_t terms = form.size();
  for (std::size_t k = 0; k < terms; ++k) {
    if (form[k].kind != kind || static_cast<std::size_t>(form[k].index) >= added.size()) continue;
    const double coefficient = form[k].coefficient;
    for (const int other : added[static_cast<std::size_t>(form[k].index)]) form.push_back({kind, other, coefficient});
  }
}

void count_added(model::Network& network, model::Term::Kind kind, const std::vector<std::vector<int>>& added) {
  for (model::Branch& item : network.branches) count_added(item.voltage, kind, added);
  for (model::Injection& item : network.injections) count_added(item.current, kind, added);
  for (model::Complementarity& item : network.complementarities) count_added(item.slack, kind, added);
  for (model::Switch& item : network.switches) count_added(item.control, kind, added);
  for (model::Signal& item : network.signals) count_added(item.form, kind, added);
}

void give_resistances(model::Network& network, const std::vector<FittedChannel>& channels) {
  for (const FittedChannel& each : channels) network.switches[each.contact].resistance = each.resistance;
}

/// What the gate exceeds its threshold by: the slack without its own input.
model::LinearForm excess_of(const model::Network& network, std::size_t half) {
  model::LinearForm excess;
  for (model::Term term : network.complementarities[half].slack) {
    if (term.kind == model::Term::Kind::slack_input && term.index == static_cast<int>(half)) continue;
    term.coefficient = -term.coefficient;
    excess.push_back(term);
  }
  return excess;
}

/// A positive part of the excess beyond the drop of `line`, of which the current is written by `half.resistance`.
model::Complementarity part_of_half(const model::Complementarity& half, const model::LinearForm& excess, std::size_t index,
                                    const model::Tangent& line) {
  model::Complementarity part{
      half.label, {{model::Term::Kind::slack_input, static_cast<int>(index), line.resistance / half.half->resistance}}, {}};
  model::accumulate(part.slack, excess, -1.0);
  part.slack.push_back(model::constant(line.drop));
  return part;
}

/// The network with the lines in place of the slopes that the deck is compiled with.
void give_slopes(model::Network& network, const std::vector<FollowingChannel>& channels) {
  std::vector<std::vector<int>> added(network.complementarities.size());
  std::vector<std::pair<std::size_t, model::Complementarity>> parts;  // with their places
  std::size_t next = network.complementarities.size();
  for (const FollowingChannel& each : channels) {
    if (each.lines.lines.empty()) continue;
    const std::vector<model::Tangent> lines = parallel_diodes(each.lines.lines);
    for (std::size_t half = each.half; half < each.half + 2; ++half) {
      const model::LinearForm excess = excess_of(network, half);
      for (std::size_t k = 0; k < lines.size(); ++k) {
        const std::size_t index = k == 0 ? half : next++;
        model::Complementarity part = part_of_half(network.complementarities[half], excess, index, lines[k]);
        if (k > 0) part.label.name += fmt::format(" line {}", k + 1);
        if (k > 0) added[half].push_back(static_cast<int>(index));
        parts.emplace_back(index, std::move(part));
      }
    }
  }
  // An excess is of voltages of nodes: no part reads another, and its own input is not to be counted again.
  for (auto& [index, part] : parts) {
    if (index >= network.complementarities.size()) network.complementarities.resize(index + 1);
    network.complementarities[index] = {part.label, {}, network.complementarities[index].half};
  }
  count_added(network, model::Term::Kind::slack_input, added);
  for (auto& [index, part] : parts) network.complementarities[index].slack = std::move(part.slack);
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
  count_added(network, model::Term::Kind::diode_current, added);
}

/// What a circuit is must not depend on how its exact solution is found: the lines of a diode are chosen by the charge in bins of its current, which another cut of the solution into pieces rounds
/// in another way.
EngineChoice engine_of_preliminary_runs(EngineChoice choice) {
  return choice == EngineChoice::krylov || choice == EngineChoice::modes ? EngineChoice::exact : choice;
}

class DiodeFit {
 public:
  DiodeFit(const circuit::Compiled& compiled, EngineChoice choice, double reltol, const std::atomic<int>* interrupt)
      : network_(compiled.network), choice_(engine_of_preliminary_runs(choice)), reltol_(reltol), interrupt_(interrupt) {
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
      following_.push_back({k, {half->law}, half->resistance});
      for (const std::size_t part : {k, k + 1})
        for (int twice = 0; twice < 2; ++twice) network_.signals.push_back({"", excess_of(network_, part)});
    }
  }

  [[nodiscard]] bool is_needed() const { return !fitted_.empty() || !channels_.empty() || !following_.empty(); }

  /// False where a run does not come to its end.
  bool run(const circuit::Analyses& analyses) {
    int runs = most_runs;
    for (int k = 0; k < runs; ++k) {
      measure::DiodeCurrents found(fitted_.size() + channels_.size() + 2 * following_.size(), analyses.transient->stop.seconds);
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
      give(network);
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
    const auto add = [&](const model::Label& label, const std::string& at) {
      if (list.empty()) first = label.span;
      list.add(label.name + " at " + at);
    };
    for (const FittedChannel& each : channels_) {
      if (each.overdrive <= 0.0) continue;
      const model::Switch& contact = network_.switches[each.contact];
      const double sign = contact.written ? contact.written->sense : 1.0;
      add(contact.label, words_at(sign * (contact.on_level + each.overdrive), each.resistance));
    }
    for (const FollowingChannel& each : following_) {
      const model::Complementarity& part = network_.complementarities[each.half];
      std::string at;
      for (std::size_t k = 0; k < each.lines.lines.size(); ++k) {
        const double excess = each.curve.voltage(each.lines.currents[k]);
        at +=
            (k > 0 ? " and " : "") + words_at(part.half->level + (part.half->is_p_type ? -excess : excess), each.lines.lines[k].resistance);
      }
      if (!at.empty()) add(part.label, at);
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

  static std::string words_at(double gate, double resistance) {
    return fmt::format("{} (Ron = {:.6g} ohm)", quantity(gate, "V", 2), resistance);
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
    give(network);
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
      has_moved |= take_lines(following_[k], excesses(found, fitted_.size() + channels_.size() + 2 * k));
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

  /// Of the gate against source and drain.
  static measure::ChargeSpectrum excesses(const measure::DiodeCurrents& found, std::size_t at_source) {
    measure::ChargeSpectrum sum;
    for (const std::size_t k : {at_source, at_source + 1}) sum.add(found.spectrum(k), found.charge(k));
    return sum;
  }

  /// Where to take a tangent next. A first run gives an excess if the circuit holds the gate's voltage, and a current if it holds that: the larger of the two
  /// excesses, from which Newton's method falls to the answer.
  static double next_excess(const FollowingChannel& each, double excess) {
    return each.lines.lines.empty() ? std::max(excess, each.curve.voltage(excess / each.resistance)) : excess;
  }

  /// Whether the lines have moved.
  static bool take_lines(FollowingChannel& each, const measure::ChargeSpectrum& spectrum) {
    std::vector<measure::ChargeSpectrum::Bin> bins = spectrum.bins();
    std::erase_if(bins, [](const auto& bin) { return bin.current < least_overdrive; });
    double all = 0.0, first = 0.0, second = 0.0;
    for (measure::ChargeSpectrum::Bin& bin : bins) {
      bin.current = next_excess(each, bin.current);
      all += bin.charge;
      first += bin.charge * bin.current;
      second += bin.charge * bin.current * bin.current;
      bin.current = each.curve.current(bin.current);
    }
    if (!(all > 0.0)) return false;
    const double mean = rounded(first / all, four_digits);
    return take_lines(each, fit_lines(each.curve, bins, each.curve.current(mean), misfit_of_channel * std::sqrt(second / all)));
  }

  static bool take_lines(FollowingChannel& each, DiodeLines lines) {
    const std::vector<model::Tangent>&now = lines.lines, &before = each.lines.lines;
    const auto is_same = [&](const model::Tangent& a, const model::Tangent& b) {
      return std::abs(a.resistance - b.resistance) <= settled_resistance * b.resistance &&
             std::abs(a.drop - b.drop) <= settled_resistance * b.drop;
    };
    if (std::equal(now.begin(), now.end(), before.begin(), before.end(), is_same)) return false;
    each.lines = std::move(lines);
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
    for (std::size_t k = 0; k < following_.size(); ++k) {
      const std::size_t at = 2 * (fitted_.size() + channels_.size() + 2 * k);
      has_moved |= take_excesses(following_[k], values[at], values[at + 2]);
    }
    return has_moved;
  }

  /// Tangents at both excesses, or one between them where they are next to one another.
  static bool take_excesses(FollowingChannel& each, double at_source, double at_drain) {
    if (at_source > 0.0) at_source = next_excess(each, at_source);
    if (at_drain > 0.0) at_drain = next_excess(each, at_drain);
    constexpr double next_to_one_another = 1.2;  // a ratio
    const auto [low, high] = std::minmax(at_source, at_drain);
    if (!(high > 0.0)) return false;
    const auto line = [&](DiodeLines& lines, double excess) {
      lines.currents.push_back(each.curve.current(std::max(excess, least_overdrive)));
      lines.lines.push_back(each.curve.tangent(lines.currents.back()));
    };
    DiodeLines lines;
    if (low > least_overdrive && high > next_to_one_another * low) line(lines, low);
    line(lines, low > 0.0 && high <= next_to_one_another * low ? 0.5 * (low + high) : high);
    return take_lines(each, std::move(lines));
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
  DiodeFit fit(compiled, choice, reltol, interrupt);
  if (!fit.is_needed() || !(compiled.analyses.transient ? fit.run(compiled.analyses) : fit.settle())) return {};
  fit.give(compiled.network);
  return fit.notes();
}

}  // namespace pwlsim::analysis
